"""What axe finds wrong with the page, in each of its states: nothing."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Server
from tests.studio.waiting import fits, lies_within

pytestmark = pytest.mark.browser

MODELS = Path(__file__).parents[4] / "reference_models"
# A fast loop within a slow one; nothing is wrong with it.
DRAWN = """symofros_diagram: 1
simulation: {t_end: 1, dt: 0.01}
blocks:
  wave: {kind: sine, unit: rad}
  slow: {kind: hold, period: 0.1, inputs: {u: wave.y}}
  fast: {kind: gain, gain: 2, period: 0.01, inputs: {u: slow}}
  sight: {kind: scope, signals: [held, wave], inputs: {held: fast, wave: wave.y}}
"""


SMALL = pytest.mark.parametrize(("width", "height"), [(640, 380), (375, 667)], ids=["zoomed to 200 %", "phone"])


def look(page: Page, faults: Callable[[], list[str]], width: int) -> None:
    """Nothing is wrong with the page, nor wider than the window; the head's buttons can be scrolled into it."""
    assert faults() == []
    fits(page, width)
    for button in page.get_by_role("banner").get_by_role("button").all():
        button.scroll_into_view_if_needed()
        lies_within(button, width)


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_the_page_and_its_windows(
    serve: Callable[..., Server],
    page: Page,
    faults: Callable[[], list[str]],
    picture: Callable[[str], None],
    theme: str,
) -> None:
    page.emulate_media(color_scheme=theme)
    server = serve("robot.yaml", source=MODELS / "flexible" / "planar_robot.yaml")
    steps.open_editor(page, server.url)
    assert faults() == []
    steps.open_window(page, "bodies/link1")
    assert faults() == []
    for name in ("Joint", "Frames", "Forces"):
        steps.tab(page, name)
        assert faults() == []
    page.keyboard.press("Escape")
    page.keyboard.press("Control+k")
    page.keyboard.type("link")
    assert faults() == []
    page.keyboard.press("Escape")
    page.get_by_role("tab", name="Tree").click()
    page.get_by_role("treeitem", name="link1 beam").click()
    assert faults() == []
    page.get_by_role("tab", name="YAML").click()
    page.get_by_label("Text of the file").wait_for()
    assert faults() == []
    page.get_by_role("tab", name="3-D").click()
    page.get_by_role("group", name="Pose").get_by_text("Elastic coordinates").click()
    page.get_by_role("group", name="Pose").get_by_text("Parameters").click()
    assert faults() == []
    steps.run(page, "Simulate")
    steps.fill(page, "Duration", "0.3")
    steps.fill(page, "Speed of q1", "2")
    assert faults() == []
    steps.window(page).get_by_role("button", name="Simulate").click()
    expect(steps.results(page).get_by_role("img").first).to_be_visible(timeout=60_000)
    assert faults() == []
    if theme == "dark":
        picture("dark")


def test_a_diagram_and_its_windows(serve: Callable[..., Server], page: Page, faults: Callable[[], list[str]]) -> None:
    server = serve("drawn.yaml", content=DRAWN)
    steps.open_editor(page, server.url)
    assert faults() == []
    steps.open_window(page, "blocks/slow")
    assert faults() == []
    page.keyboard.press("Escape")
    steps.wire(page, "blocks/slow/inputs/u").focus()
    page.keyboard.press("Space")
    steps.run(page, "Run…")
    steps.fill(page, "Pause at", "0.5")
    assert faults() == []
    steps.window(page).get_by_role("button", name="Run").click()
    expect(steps.results(page).get_by_role("button", name="Go on")).to_be_visible(timeout=60_000)
    assert faults() == []
    steps.results(page).get_by_role("button", name="Stop").click()
    expect(steps.results(page).get_by_text("s of computing")).to_be_visible()
    page.emulate_media(color_scheme="dark")
    assert faults() == []


@SMALL
def test_small_pages(
    serve: Callable[..., Server],
    page: Page,
    faults: Callable[[], list[str]],
    picture: Callable[[str], None],
    width: int,
    height: int,
) -> None:
    """Nothing is cut off: no page is wider than the window, and what is pressed lies in it, or is scrolled into it."""
    page.set_viewport_size({"width": width, "height": height})
    server = serve("robot.yaml", source=MODELS / "flexible" / "planar_robot.yaml")
    steps.open_editor(page, server.url)
    look(page, faults, width)
    picture(f"small-{width}")
    steps.open_window(page, "bodies/link1")
    assert faults() == []
    for label in ("Modes along y", "Modes of shear along z", "Length"):
        steps.window(page).get_by_label(label, exact=True).click(trial=True)  # Nothing lies over it.
    lies_within(steps.window(page).get_by_role("button", name="OK"), width, height)
    picture(f"small-window-{width}")
    page.keyboard.press("Escape")
    steps.run(page, "Simulate")
    steps.fill(page, "Duration", "0.3")
    steps.window(page).get_by_role("button", name="Simulate").click()
    expect(steps.results(page).get_by_role("img").first).to_be_visible(timeout=60_000)
    look(page, faults, width)
    picture(f"small-results-{width}")


@SMALL
def test_a_diagram_on_small_pages(
    serve: Callable[..., Server],
    page: Page,
    faults: Callable[[], list[str]],
    picture: Callable[[str], None],
    width: int,
    height: int,
) -> None:
    page.set_viewport_size({"width": width, "height": height})
    server = serve("drawn.yaml", content=DRAWN)
    steps.open_editor(page, server.url)
    look(page, faults, width)
    picture(f"small-diagram-{width}")
    steps.open_window(page, "blocks/slow")
    assert faults() == []
    for label in ("Name", "Sample time", "Source of u"):
        steps.window(page).get_by_label(label, exact=True).click(trial=True)  # Nothing lies over it.
    page.keyboard.press("Escape")
    steps.run(page, "Run…")
    assert faults() == []
    steps.window(page).get_by_role("button", name="Run").click()
    expect(steps.results(page).get_by_text("s of computing")).to_be_visible(timeout=60_000)
    lies_within(steps.results(page).locator("figure.plot").first, width)
    look(page, faults, width)
    picture(f"small-diagram-run-{width}")


def test_a_window_holds_the_focus_and_gives_it_back(serve: Callable[..., Server], page: Page) -> None:
    server = serve("robot.yaml", source=MODELS / "rigid" / "double_pendulum.yaml")
    steps.open_editor(page, server.url)
    steps.open_window(page, "bodies/upper")
    for _ in range(40):
        page.keyboard.press("Tab")
        # Beyond the last field the browser's own controls have the focus: then it is on the body, never on the page.
        assert page.evaluate("document.activeElement === document.body || !!document.activeElement.closest('dialog')")
    page.keyboard.press("Escape")
    expect(steps.window(page)).to_have_count(0)
    expect(steps.block(page, "bodies/upper")).to_be_focused()


def test_a_body_is_added_and_opened_by_the_keyboard_alone(serve: Callable[..., Server], page: Page) -> None:
    server = serve("new.yaml")
    steps.open_editor(page, server.url)
    page.get_by_role("button", name="Rigid body", exact=True).focus()
    page.keyboard.press("Enter")
    expect(steps.block(page, "bodies/body")).to_be_visible()
    steps.open_window(page, "bodies/body")
    page.keyboard.type("arm")
    page.keyboard.press("Enter")
    expect(steps.block(page, "bodies/arm")).to_be_visible()
