"""What axe finds wrong with reports, live plots, the viewer and replays: nothing; and none is wider than its window."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page, expect

import symofros as sf
from reference_models import MODELS
from symofros.blocks import LivePlot, Sine
from symofros.studio.viewer.drawing.poses import Mechanism
from tests.studio.editor.browser.conftest import Faults, Picture
from tests.studio.waiting import fits, until

pytestmark = pytest.mark.browser

REPORTS = sorted((Path(__file__).parents[4] / "reports").glob("*.html"))
# The two that decide, in every run.
FIRST = ("index", "pareto")
CURVES = 10


@pytest.fixture
def looked(page: Page, faults: Faults) -> Callable[[], None]:
    """Looks at the page in dark colours on a desk, in light ones on a phone and at 200 %."""

    def look() -> None:
        for colours, width in (("dark", 1100), ("light", 640), ("light", 375)):
            page.emulate_media(color_scheme=colours)
            page.set_viewport_size({"width": width, "height": 800})
            assert faults() == [], (colours, width)
            fits(page, width)

    return look


@pytest.mark.parametrize(
    "report",
    [pytest.param(file, id=file.stem, marks=[] if file.stem in FIRST else pytest.mark.slow) for file in REPORTS],
)
def test_reports_are_accessible(page: Page, looked: Callable[[], None], report: Path) -> None:
    page.goto(report.as_uri())
    looked()


@pytest.fixture
def live() -> Iterator[LivePlot]:
    """A plot of more curves than there are colours, whose run is over."""
    d = sf.Diagram("live")
    signals = tuple(f"s{i}" for i in range(CURVES))
    for i, name in enumerate(signals):
        d.add(Sine(name=f"{name}_source", amplitude=1.0 + 0.2 * i, frequency=5.0))
    plot = LivePlot(name="plot", signals=signals, title="Ten sines", period=0.01, open_browser=False)
    d.add(plot, **{name: f"{name}_source.y" for name in signals})
    sf.Simulation(d).run(1.5, dt=1e-2, realtime=True)
    yield plot
    plot.__dict__["_page"].close()


def test_live_plots_are_accessible(page: Page, looked: Callable[[], None], live: LivePlot) -> None:
    page.goto(live.url)
    expect(page.get_by_role("status")).to_have_text("ended at t = 1.50 s")
    expect(page.get_by_role("checkbox")).to_have_count(CURVES)
    looked()
    page.set_viewport_size({"width": 1100, "height": 700})
    ground = "getComputedStyle(document.body).backgroundColor"

    def level() -> int:
        return int(page.evaluate(ground).split("(")[1].split(",")[0])

    for colours in ("dark", "light"):
        page.emulate_media(color_scheme=colours)
        is_dark = colours == "dark"
        until(page, lambda is_dark=is_dark: level() < 60 if is_dark else level() > 200)


@pytest.fixture
def replay(tmp_path: Path) -> Path:
    """A robot that turns by 1 rad in 2 s and bends, shown at half its speed."""
    t, q = np.linspace(0, 2, 41), np.zeros((41, 10))
    q[:, 0], q[:, 4] = 0.5 * t, 0.01 * np.sin(3 * t)
    return sf.record(MODELS["planar_robot"], (t, q), tmp_path / "m.html", rate=10, exaggeration=5, speed=0.5)


def test_replays_are_accessible(page: Page, looked: Callable[[], None], replay: Path, picture: Picture) -> None:
    page.emulate_media(color_scheme="dark")
    page.set_viewport_size({"width": 800, "height": 500})
    page.goto(replay.as_uri())
    expect(page).to_have_title("planar_robot - SYMOFROS")
    beside = page.get_by_role("region", name="Replay")
    bar, instant = beside.get_by_role("img", name="Scale: "), beside.locator("p")
    expect(bar).to_be_visible()
    scheme = page.locator("html")
    expect(scheme).to_have_attribute("data-mantine-color-scheme", "dark")
    # While it plays, the time is the motion's; the coordinates have units.
    expect(instant).to_have_text(re.compile(r"^t = 1\.\d{3} s, deformation × 5, at 0\.5 × its speed$"))
    page.locator("body").press("Space")
    beside.get_by_text("Coordinates", exact=True).click()

    def turned() -> bool:
        angle = float(beside.get_by_role("row", name="q1 ").get_by_role("cell").first.inner_text())
        return angle == pytest.approx(0.5 * float(instant.inner_text().split()[2]), abs=1e-3)

    until(page, turned)
    expect(beside.get_by_role("row", name="q1 ")).to_contain_text("rad")
    picture("replay-dark")

    # The camera that comes first sees 1.4 times the mechanism's size (Camera.of); near, less.
    def metre() -> float:
        number, unit = (bar.text_content() or "").split()
        box = bar.bounding_box()
        assert box is not None
        return box["width"] / (float(number) * {"m": 1.0, "cm": 0.01, "mm": 0.001}[unit])

    canvas = page.locator("canvas").last.bounding_box()
    assert canvas is not None
    first = canvas["height"] / (1.4 * Mechanism(MODELS["planar_robot"]).drawing().size)
    until(page, lambda: metre() == pytest.approx(first, rel=0.05))
    page.mouse.move(600, 300)
    for _ in range(8):
        page.mouse.wheel(0, -300)
    until(page, lambda: metre() > 1.5 * first)
    beside.get_by_text("Plot", exact=True).click()
    expect(beside.get_by_role("slider", name="Time [s], in the plot of ")).to_be_visible()
    picture("replay-plot")
    looked()
    expect(scheme).to_have_attribute("data-mantine-color-scheme", "light")  # The last that was looked at.


@pytest.mark.parametrize("colours", ["dark", "light"])
def test_the_viewer_is_accessible(page: Page, looked: Callable[[], None], colours: str) -> None:
    """It keeps the colours of who opens it first."""
    page.emulate_media(color_scheme=colours)
    with sf.Viewer(MODELS["four_bar"], port=0) as viewer:
        page.goto(viewer.url)
        expect(page.get_by_role("slider", name=viewer.sliders[0].label)).to_be_visible()
        expect(page.locator("html")).to_have_attribute("data-mantine-color-scheme", colours)
        looked()
