"""What a person does in the editor, as words for the tests."""

from __future__ import annotations

import re

from playwright.sync_api import Locator, Page, expect


def block(page: Page, node: str) -> Locator:
    """A block of the diagram by its id, such as `bodies/upper`."""
    return page.locator(f'.react-flow__node[data-id="{node}"]')


def wire(page: Page, edge: str) -> Locator:
    """A link of the diagram by its id, such as `bodies/upper/joint`."""
    return page.locator(f'.react-flow__edge[data-id="{edge}"]')


def open_editor(page: Page, url: str) -> None:
    """Load the page and wait for the diagram."""
    page.goto(url)
    page.wait_for_selector(".react-flow__node")


def window(page: Page) -> Locator:
    """The window that is open."""
    return page.get_by_role("dialog")


def open_window(page: Page, node: str) -> Locator:
    """Open the properties of a block or a link by the keyboard."""
    page.locator(f'.react-flow [data-id="{node}"]').focus()
    page.keyboard.press("Enter")
    expect(window(page)).to_be_visible()
    return window(page)


def tab(page: Page, name: str) -> None:
    """Turn to a page of the window."""
    window(page).get_by_role("tab", name=name, exact=True).click()


def fill(page: Page, label: str, text: str, nth: int = 0) -> Locator:
    """Type into a field of the window."""
    field = window(page).get_by_label(label, exact=True).nth(nth)
    field.fill(text)
    return field


def accept(page: Page) -> None:
    """Close the window by its OK."""
    window(page).get_by_role("button", name="OK").click()
    expect(window(page)).to_have_count(0)


def problems(page: Page, count: int) -> None:
    """Wait for a number of problems in the tool bar."""
    text = "No problems" if count == 0 else re.compile(rf"^{count} problem")
    expect(page.get_by_role("banner").get_by_role("button", name=text)).to_be_visible()


def run(page: Page, command: str) -> None:
    """Press a button of the tool bar, such as Compile."""
    page.get_by_role("banner").get_by_role("button", name=command).click()


def results(page: Page) -> Locator:
    """The pane of results."""
    return page.get_by_role("region", name="Results")


def saved(page: Page) -> None:
    """Save by the keyboard, and wait until it is done."""
    page.locator("body").press("Control+s")
    expect(page.get_by_role("banner").get_by_text("unsaved")).to_have_count(0)
