"""What axe finds wrong with the page, in each of its states: nothing."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Faults, Picture, Serve, Server
from tests.studio.waiting import fits, lies_within

pytestmark = pytest.mark.browser

# A fast loop within a slow one; nothing is wrong with it.
DRAWN = """symofros_diagram: 1
simulation: {t_end: 1, dt: 0.01}
blocks:
  wave: {kind: sine, unit: rad}
  slow: {kind: hold, period: 0.1, inputs: {u: wave.y}}
  fast: {kind: gain, gain: 2, period: 0.01, inputs: {u: slow}}
  sight: {kind: scope, signals: [held, wave], inputs: {held: fast, wave: wave.y}}
"""


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_the_page_and_its_windows_are_accessible(
    opened: Serve, page: Page, faults: Faults, picture: Picture, theme: str
) -> None:
    page.emulate_media(color_scheme=theme)
    opened("robot.yaml", source=steps.ROBOT)
    assert faults() == []
    steps.open_window(page, "bodies/link1")
    expect(steps.window(page).get_by_role("img", name="The beam and its first vibrations")).to_be_visible()
    expect(steps.window(page).get_by_label("EA", exact=True)).to_have_count(0)
    assert faults() == []
    picture(f"beam-{theme}")
    steps.window(page).get_by_label("Shown", exact=True).select_option("all")
    expect(steps.window(page).get_by_label("EA", exact=True)).to_be_visible()
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
    assert faults() == []
    page.keyboard.press("Escape")
    steps.job(page, "Simulate", Duration="0.3", Speed_of_q1="2")
    assert faults() == []
    if theme == "dark":
        picture("dark")


def test_a_diagram_and_its_windows_are_accessible(opened: Serve, page: Page, faults: Faults) -> None:
    opened("drawn.yaml", content=DRAWN)
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


# Kind of document -> a block, fields of its window, the command that runs it and what is typed then.
KINDS = {
    "model": (
        "bodies/link1",
        ("Shape functions along y", "Shape functions of twist", "Length"),
        "Simulate",
        {"Duration": "0.3"},
    ),
    "diagram": ("blocks/slow", ("Name", "Sample time", "Source of u"), "Run", {}),
}


@pytest.mark.parametrize(("width", "height"), [(640, 380), (375, 667)], ids=["zoomed to 200 %", "phone"])
@pytest.mark.parametrize("kind", KINDS)
def test_small_windows_cut_nothing_off(
    opened: Serve, page: Page, faults: Faults, kind: str, width: int, height: int
) -> None:
    """Nothing is cut off: no page is wider than the window, and what is pressed lies in it, or is scrolled into it."""

    def look() -> None:
        assert faults() == []
        fits(page, width)
        for button in page.get_by_role("banner").get_by_role("button").all():
            button.scroll_into_view_if_needed()
            lies_within(button, width)

    block, labels, command, typed = KINDS[kind]
    page.set_viewport_size({"width": width, "height": height})
    opened("small.yaml", **{"source": steps.ROBOT} if kind == "model" else {"content": DRAWN})
    look()
    steps.open_window(page, block)
    assert faults() == []
    for label in labels:
        steps.window(page).get_by_label(label, exact=True).click(trial=True)  # Nothing lies over it.
    lies_within(steps.window(page).get_by_role("button", name="OK"), width, height)
    page.keyboard.press("Escape")
    steps.run(page, f"{command}…")
    assert faults() == []
    page.keyboard.press("Escape")
    steps.job(page, command, **typed)
    expect(steps.results(page).get_by_role("img").first).to_be_visible(timeout=60_000)
    lies_within(steps.results(page).locator("figure.plot").first, width)
    look()


@pytest.mark.parametrize("name", ["arm.yaml", "an_arm_with_a_rather_long_name_for_a_phone.yaml"])
def test_a_phone_shows_that_work_is_unsaved(opened: Serve, page: Page, name: str) -> None:
    page.set_viewport_size({"width": 400, "height": 760})
    opened(name, source=steps.PENDULUM)
    page.get_by_role("button", name="Rigid body", exact=True).click()
    word = page.get_by_role("heading", level=1).get_by_text("unsaved", exact=True)
    expect(word).to_be_visible()
    lies_within(word, 400)


def test_results_fit_a_window_that_became_lower(arm: Server, page: Page) -> None:
    """As when a page is enlarged to 200 %: the results keep within what is left, above the status."""
    page.get_by_role("banner").get_by_role("button", name="No problems").click()
    expect(steps.results(page)).to_be_visible()
    page.set_viewport_size({"width": 640, "height": 380})
    lies_within(steps.results(page), 640, 380)
    assert page.evaluate("document.documentElement.scrollHeight") <= 380


def test_the_progress_of_a_job_fits_a_phone(arm: Server, page: Page) -> None:
    page.set_viewport_size({"width": 375, "height": 667})
    page.route("**/api/jobs/*", lambda route: None)  # Its end is not answered.
    steps.run(page, "Compile")
    expect(page.get_by_role("contentinfo").get_by_role("button", name="Cancel")).to_be_visible()
    for part in page.get_by_role("contentinfo").locator(":scope > *, :scope button").all():
        assert (box := part.bounding_box()) is None or box["x"] + box["width"] <= 375
    assert page.evaluate("document.documentElement.scrollWidth") <= 375
    page.unroute_all(behavior="ignoreErrors")


def test_a_window_holds_the_focus_and_gives_it_back(arm: Server, page: Page) -> None:
    steps.open_window(page, "bodies/upper")
    for _ in range(40):
        page.keyboard.press("Tab")
        # Beyond the last field the browser's own controls have the focus: then it is on the body, never on the page.
        assert page.evaluate("document.activeElement === document.body || !!document.activeElement.closest('dialog')")
    page.keyboard.press("Escape")
    expect(steps.window(page)).to_have_count(0)
    expect(steps.block(page, "bodies/upper")).to_be_focused()


def test_a_body_is_added_and_opened_by_the_keyboard_alone(opened: Serve, page: Page) -> None:
    opened("new.yaml")
    page.get_by_role("button", name="Rigid body", exact=True).focus()
    page.keyboard.press("Enter")
    expect(steps.block(page, "bodies/body")).to_be_visible()
    steps.open_window(page, "bodies/body")
    page.keyboard.type("arm")
    page.keyboard.press("Enter")
    expect(steps.block(page, "bodies/arm")).to_be_visible()
