"""What is chosen in one of canvas, tree, text and 3-D view is marked in the others."""

from __future__ import annotations

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Serve
from tests.studio.pictures import settled
from tests.studio.waiting import at_rest, until

pytestmark = pytest.mark.browser


def tab(page: Page, name: str) -> None:
    page.get_by_label("Side pane").get_by_role("tab", name=name, exact=True).click()


def chosen_text(page: Page) -> list[str]:
    """The lines of the text that are marked."""
    expect(page.locator(".text-pane .cm-chosen").first).to_be_in_viewport()
    return [line.strip() for line in page.locator(".text-pane .cm-chosen").all_inner_texts()]


def marked(picture: np.ndarray) -> np.ndarray:
    """Pixels in the colour of what is chosen: red and blue, no green (height, width)."""
    red, green, blue = np.moveaxis(picture, 2, 0)
    return (red > 120) & (green < red / 3) & (blue > red / 4)


def test_what_is_chosen_is_marked_everywhere(opened: Serve, page: Page) -> None:
    opened("robot.yaml", source=steps.ROBOT)

    # On the canvas: a body. The tree and the text show it.
    steps.block(page, "bodies/link2").get_by_text("link2").click()
    tab(page, "Tree")
    rows = page.get_by_role("tree", name="Elements")
    expect(rows.get_by_role("treeitem", selected=True)).to_have_text(["link2 beam"])
    tab(page, "YAML")
    until(page, lambda: (text := chosen_text(page))[0] == "link2:" and len(text) == 3)

    # In the text: the caret chooses what its line defines; what is chosen elsewhere comes into sight.
    page.locator(".text-pane").get_by_text("axis: {position").first.click()
    expect(steps.block(page, "bodies/housing2").locator(".block-frame.marked")).to_have_text("axis")
    until(page, lambda: len(chosen_text(page)) == 1)
    tab(page, "Tree")
    expect(rows.get_by_role("treeitem", selected=True)).to_have_text(["axis frame"])

    # In the tree, by keys: a joint. Then a frame on the canvas.
    rows.get_by_role("treeitem", selected=True).press("ArrowUp")
    expect(rows.get_by_role("treeitem", selected=True)).to_have_text(["seat2: fixed joint"])
    expect(steps.wire(page, "bodies/housing2/joint")).to_contain_class("selected")
    steps.block(page, "bodies/load").get_by_text("tool").click()
    expect(rows.get_by_role("treeitem", selected=True)).to_have_text(["tool frame"])
    expect(rows.get_by_role("treeitem", selected=True)).to_be_in_viewport()

    # In the picture: what is chosen has a colour of its own; a click there chooses.
    rows.get_by_role("treeitem").get_by_text("link1", exact=True).click()
    steps.open_view(page)
    until(page, lambda: bool(marked(settled(page)).sum() > 20))
    shown = marked(settled(page))
    y, x = np.argwhere(shown)[len(np.argwhere(shown)) // 2]
    page.locator(".react-flow__pane").click(position={"x": 5, "y": 5})
    expect(page.locator(".react-flow__node.selected")).to_have_count(0)
    until(page, lambda: bool(marked(settled(page)).sum() < shown.sum() / 4))
    frame = at_rest(page.locator("iframe.view"))
    page.mouse.click(frame["x"] + int(x), frame["y"] + int(y))
    expect(steps.block(page, "bodies/link1")).to_contain_class("selected")
