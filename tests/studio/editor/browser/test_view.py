"""The 3-D pane: the mechanism is drawn, moves by its sliders, keeps its loops, follows the document."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, Response, expect

import symofros as sf
from symofros.studio.viewer.drawing.poses import Mechanism
from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Server
from tests.studio.editor.browser.scene import FEW, MANY, changed, differing, open_view, settled
from tests.studio.waiting import at_rest, until

pytestmark = pytest.mark.browser

MODELS = Path(__file__).parents[4] / "reference_models"
ROBOT = MODELS / "flexible" / "planar_robot.yaml"
PANEL = '[class*="tabler-icon-cloud"]'  # viser's sign of the connection, at the head of its panel.
LINE = 66  # Pixels of the line that says so and, below it, the scale bar, which makes room for it.


def slide(page: Page, label: str, value: float) -> dict[str, float]:
    """Put a slider somewhere; where the coordinates are then."""

    def is_last(answer: Response) -> bool:
        return answer.url.endswith("/api/pose")

    with page.expect_response(is_last) as answered:
        page.get_by_role("slider", name=label, exact=True).fill(str(value))
    found: dict[str, float] = answered.value.json()["q"]
    return found


def test_a_flexible_robot_is_drawn_bends_and_follows_its_file(
    serve: Callable[..., Server], page: Page, picture: Callable[[str], None]
) -> None:
    server = serve("robot.yaml", source=ROBOT)
    steps.open_editor(page, server.url)
    open_view(page)
    # Neither viser's panel nor a second scale bar lies over the picture.
    inside = page.frame_locator("iframe.view")
    expect(inside.locator(PANEL).first).to_be_hidden()
    expect(inside.get_by_role("img", name="Scale: ")).to_be_hidden()
    expect(page.get_by_role("img", name="Scale: ")).to_be_visible()
    # A word on machines without a graphics card floats over the picture.
    page.frame_locator("iframe.view").locator("body").evaluate(
        "body => body.insertAdjacentHTML('beforeend', '<style>.mantine-Notification-root {display: none}</style>')"
    )
    for fold in ("Elastic coordinates", "Parameters"):
        page.get_by_role("group", name="Pose").get_by_text(fold, exact=True).click()
    straight = settled(page)

    assert slide(page, "q2 [rad]", 0.9)["q2"] == pytest.approx(0.9, abs=0.01)
    turned = changed(page, straight)
    expect(page.get_by_role("group", name="Pose")).to_contain_text("0.9")

    # A bending of millimetres is seen once it is exaggerated.
    slide(page, "link1.bend_y[0] [m]", 0.008)
    page.wait_for_timeout(1000)
    bent = settled(page)
    assert differing(bent, turned) < MANY * 10
    slide(page, "exaggeration", 20)
    exaggerated = changed(page, bent)
    assert differing(exaggerated, turned) > differing(bent, turned)
    page.get_by_role("button", name="Show the whole diagram").click()
    page.get_by_role("button", name="Reset", exact=True).scroll_into_view_if_needed()
    picture("3d")

    page.get_by_role("button", name="Reset", exact=True).click()
    slide(page, "exaggeration", 1)
    changed(page, exaggerated)
    # While the picture moves it is coarser; what is seen through something else depends on the order it is drawn in.
    until(page, lambda: differing(settled(page), straight) < differing(exaggerated, straight) / 4)
    back = settled(page)

    # A parameter moves the picture while its slider is dragged, and is changed in the document when that is let go.
    slide(page, "L1, slider", 1.2)
    expect(page.get_by_role("button", name="Undo", exact=True)).to_be_disabled()
    longer = changed(page, back)
    page.get_by_role("slider", name="L1, slider").press("ArrowRight")
    expect(page.get_by_role("button", name="Undo: change L1")).to_be_enabled()
    longer = settled(page)
    page.get_by_role("button", name="Undo: change L1").click()
    changed(page, longer)
    until(page, lambda: differing(settled(page), straight) < differing(longer, straight) / 4)


@pytest.mark.slow  # In every run: a robot that bends and follows its file.
def test_a_loop_stays_closed(serve: Callable[..., Server], page: Page) -> None:
    server = serve("four_bar.yaml", source=MODELS / "closed" / "four_bar.yaml")
    steps.open_editor(page, server.url)
    before = open_view(page)
    pose = page.get_by_role("group", name="Pose")
    expect(pose).to_contain_text("Loops closed within")
    sliders = pose.get_by_role("slider").all()
    label = sliders[0].get_attribute("aria-label") or ""
    with page.expect_response("**/api/pose") as answered:
        sliders[0].fill("1.2")
    stand = answered.value.json()
    assert stand["q"][label.split(" ")[0]] == pytest.approx(1.2, abs=0.01)
    assert stand["why"] == "" and stand["gap"] < 1e-9
    # The others have followed, and their sliders say so.
    for slider in sliders[1:]:
        name = (slider.get_attribute("aria-label") or "").split(" ")[0]
        place = pytest.approx(stand["q"][name], abs=0.02)
        until(page, lambda slider=slider, place=place: float(slider.input_value()) == place)
    changed(page, before)


@pytest.mark.slow
def test_it_follows_edits_and_keeps_the_last_that_was_sound(serve: Callable[..., Server], page: Page) -> None:
    server = serve("arm.yaml")
    steps.open_editor(page, server.url)
    for _ in range(2):
        page.get_by_role("button", name="Rigid body", exact=True).click()
    steps.problems(page, 0)
    before = open_view(page)
    slide(page, "q2 [rad]", 0.7)
    bent = changed(page, before)

    steps.open_window(page, "bodies/body")
    steps.tab(page, "Frames")
    steps.fill(page, "Position x", "2")
    steps.accept(page)
    changed(page, bent)
    # Coordinates stay where they were; the new model may be drawn at rest before.
    angle, place = page.get_by_role("slider", name="q2 [rad]"), pytest.approx(0.7, abs=0.02)
    until(page, lambda: bool(float(angle.input_value()) == place))
    longer = settled(page)

    steps.open_window(page, "bodies/body")
    steps.tab(page, "Inertia")
    steps.fill(page, "Mass", "mm")
    steps.accept(page)
    steps.problems(page, 1)
    expect(page.get_by_text("The last model without problems is shown")).to_be_visible()
    # Below the line that says so and the scale bar, everything is as it was.
    until(page, lambda: differing(settled(page)[LINE:], longer[LINE:]) < FEW)
    page.get_by_role("button", name="Undo: ").first.click()
    expect(page.get_by_text("The last model without problems is shown")).to_have_count(0)


@pytest.mark.slow
def test_a_scale_bar_follows_the_zoom(serve: Callable[..., Server], page: Page, picture: Callable[[str], None]) -> None:
    server = serve("robot.yaml", source=ROBOT)
    steps.open_editor(page, server.url)
    open_view(page)
    bar = page.get_by_role("img", name=re.compile("^Scale: "))
    frame = at_rest(page.locator("iframe.view"))

    def pixels_of_a_metre() -> float:
        number, unit = (bar.text_content() or "").split()
        box = bar.bounding_box()
        assert box is not None and box["width"] <= 0.3 * frame["height"] + 4
        return box["width"] / (float(number) * {"m": 1.0, "cm": 0.01, "mm": 0.001}[unit])

    # The camera that comes first sees 1.4 times the mechanism's size (Camera.of).
    size = Mechanism(sf.load(ROBOT)).drawing().size
    stated = pytest.approx(frame["height"] / (1.4 * size), rel=0.05)
    until(page, lambda: bool(pixels_of_a_metre() == stated))
    picture("scale")
    before = pixels_of_a_metre()
    page.mouse.move(frame["x"] + frame["width"] / 3, frame["y"] + frame["height"] / 2)
    text = bar.text_content() or ""
    for _ in range(8):
        page.mouse.wheel(0, -300)
        page.wait_for_timeout(100)
    expect(bar).not_to_have_text(text)
    until(page, lambda: pixels_of_a_metre() > 1.5 * before)
    page.set_viewport_size({"width": 375, "height": 667})
    page.wait_for_timeout(500)
    picture("scale-375")
