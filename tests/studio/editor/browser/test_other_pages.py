"""What axe finds wrong with reports and live plots: nothing; and none is wider than its window."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

import symofros as sf
from symofros.blocks import LivePlot, Sine
from tests.studio.waiting import fits, until

pytestmark = pytest.mark.browser

REPORTS = sorted((Path(__file__).parents[4] / "reports").glob("*.html"))
# The two that decide, in every run.
FIRST = ("index", "pareto")
CURVES = 10


@pytest.fixture
def looked(page: Page, faults: Callable[[], list[str]]) -> Callable[[], None]:
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
def test_reports(page: Page, looked: Callable[[], None], report: Path) -> None:
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


def test_live_plots(page: Page, looked: Callable[[], None], live: LivePlot, picture: Callable[[str], None]) -> None:
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
        picture(f"live-{colours}")
        is_dark = colours == "dark"
        until(page, lambda is_dark=is_dark: level() < 60 if is_dark else level() > 200)
