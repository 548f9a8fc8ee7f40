"""A beginner at mouse and keyboard, whose presses the browser counts: what a session costs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tests.studio.editor.browser import steps
from tests.studio.waiting import at_rest

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page

# Only what came from a device: what scripts do to the page is no press.
_COUNT = """
window.presses = {clicks: 0, keys: 0};
addEventListener("pointerdown", (event) => event.isTrusted && window.presses.clicks++, true);
addEventListener("keydown", (event) => event.isTrusted && window.presses.keys++, true);
"""
# Of a path of SVG, in the window.
_MIDDLE = """path => {
  const {x, y} = path.getPointAtLength(path.getTotalLength() / 2).matrixTransform(path.getScreenCTM());
  return [x, y];
}"""


class Hand:
    """Moves the mouse, types names and numbers; the page that it works on counts."""

    def __init__(self, page: Page) -> None:
        self.page = page
        page.add_init_script(_COUNT)

    def press(self, target: Locator) -> None:
        """Click something once it stands still."""
        at_rest(target)
        target.click()

    def press_line(self, path: Locator) -> None:
        """Click the middle of a line, once it stands still."""
        at_rest(path)
        x, y = path.evaluate(_MIDDLE)
        self.page.mouse.click(x, y)

    def twice(self, target: Locator) -> None:
        """Double click something: two clicks."""
        at_rest(target)
        target.dblclick()

    def draw(self, start: Locator, end: Locator) -> None:
        """Drag from the middle of one thing to that of another: one press."""
        steps.draw(self.page, start, end)

    def put(self, field: Locator, text: str) -> None:
        """Type a name or a number over what a field says, which a double click chooses."""
        self.twice(field)
        self.page.keyboard.type(text)

    def enter(self) -> None:
        """Press Enter."""
        self.page.keyboard.press("Enter")

    def cost(self) -> tuple[int, int]:
        """Clicks and keys so far."""
        presses = self.page.evaluate("window.presses")
        return int(presses["clicks"]), int(presses["keys"])
