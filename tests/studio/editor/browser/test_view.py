"""The 3-D pane: the mechanism is drawn, moves by its sliders, keeps its loops, follows the document."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, Response, expect

from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Picture, Serve
from tests.studio.pictures import MANY, changed, differing, settled
from tests.studio.waiting import until

pytestmark = pytest.mark.browser

PANEL = '[class*="tabler-icon-cloud"]'  # viser's sign of the connection, at the head of its panel.


def slide(page: Page, label: str, value: float) -> dict[str, float]:
    """Put a slider somewhere; where the coordinates are then."""

    def is_last(answer: Response) -> bool:
        return answer.url.endswith("/api/pose")

    with page.expect_response(is_last) as answered:
        page.get_by_role("slider", name=label, exact=True).fill(str(value))
    found: dict[str, float] = answered.value.json()["q"]
    return found


def test_a_flexible_robot_is_drawn_bends_and_follows_its_file(opened: Serve, page: Page, picture: Picture) -> None:
    opened("robot.yaml", source=steps.ROBOT)
    steps.open_view(page)
    # Neither viser's panel nor a second scale bar lies over the picture.
    inside = page.frame_locator("iframe.view")
    expect(inside.locator(PANEL).first).to_be_hidden()
    expect(inside.get_by_role("img", name="Scale: ")).to_be_hidden()
    expect(page.get_by_role("img", name="Scale: ")).to_be_visible()
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
