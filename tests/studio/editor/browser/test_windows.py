"""Every window of the page: axe finds nothing wrong with it, in light and dark colors, and a phone shows all of it."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import Page, expect

from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Faults, Picture, Server
from tests.studio.waiting import at_rest, lies_within

pytestmark = pytest.mark.browser


def _file(command: str) -> Callable[[Page, Server], None]:
    return lambda page, server: steps.menu(page, "File", command)


def _key(key: str) -> Callable[[Page, Server], None]:
    return lambda page, server: page.locator("body").press(key)


def _changed_on_disk(page: Page, server: Server) -> None:
    steps.set_parameter(page, "m1", "2.5")
    steps.has_value(page, "m1", "2.5")
    server.file.write_text(server.file.read_text().replace("value: 0.5, unit: m", "value: 0.8, unit: m"))
    page.locator("body").press("Control+s")


def _discard(page: Page, server: Server) -> None:
    steps.set_parameter(page, "m1", "2.5")
    steps.has_value(page, "m1", "2.5")
    steps.menu(page, "File", "New")
    steps.fill(page, "File", "other")
    steps.window(page).get_by_role("button", name="Create").click()


def _save_part(page: Page, server: Server) -> None:
    steps.block(page, "bodies/lower").click()
    page.get_by_role("button", name="Save selection").click()


def _link(page: Page, server: Server) -> None:
    page.get_by_role("button", name="Show the whole diagram").click()
    at_rest(steps.block(page, "bodies/lower"))
    first = steps.anchor(page, "bodies/upper", "frame elbow of upper")
    steps.draw(page, first, steps.anchor(page, "bodies/lower", "frame tip of lower"))


# Title of a window -> what opens it.
WINDOWS: dict[str, Callable[[Page, Server], None]] = {
    "New document": _file("New"),
    "Examples": _file("Examples"),
    "Open": _key("Control+o"),
    "Save as": _key("Control+Shift+S"),
    "Keys": _key("?"),
    "Find": _key("Control+k"),
    "System": lambda page, server: steps.menu(page, "Edit", "System"),
    "Contact": lambda page, server: page.get_by_role("button", name="Contact", exact=True).click(),
    "Export": lambda page, server: steps.run(page, "Export…"),
    "The file has changed on disk": _changed_on_disk,
    "Unsaved changes": _discard,
    "Save as a part": _save_part,
    "Join": _link,
}


@pytest.mark.parametrize("title", WINDOWS)
def test_each_window_is_accessible(arm: Server, page: Page, faults: Faults, picture: Picture, title: str) -> None:
    WINDOWS[title](page, arm)
    expect(page.get_by_role("dialog", name=title)).to_be_visible()
    for colors in ("light", "dark"):
        page.emulate_media(color_scheme=colors)
        assert faults() == [], colors
        picture(f"window-{title.replace(' ', '-').lower()}-{colors}")
    page.set_viewport_size({"width": 375, "height": 667})
    assert faults() == []
    lies_within(steps.window(page), 375, 667)
    for part in steps.window(page).get_by_role("button").all() + steps.window(page).get_by_role("textbox").all():
        part.scroll_into_view_if_needed()
        lies_within(part, 375, 667)
    picture(f"window-{title.replace(' ', '-').lower()}-phone")
