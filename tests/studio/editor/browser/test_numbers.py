"""Numbers that can't be are refused where they are typed, and names are shown whole."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Server
from tests.studio.waiting import until

pytestmark = pytest.mark.browser

MODELS = Path(__file__).parents[4] / "reference_models"
NAME = "m_payload_of_arm"
WHOLE = "(element) => element.scrollWidth <= element.clientWidth"


def test_numbers_beyond_the_range_and_too_many_modes_are_refused(serve: Callable[..., Server], page: Page) -> None:
    server = serve("pendulum.yaml", source=MODELS / "flexible" / "flexible_pendulum.yaml")
    steps.open_editor(page, server.url)
    steps.problems(page, 0)
    name = page.get_by_label("Value of ").first.get_attribute("aria-label") or ""
    value = page.get_by_label(name, exact=True)
    before = value.input_value()
    value.fill("1e999")
    value.press("Enter")
    steps.problems(page, 1)
    expect(value).to_have_value("1e999")  # What was typed stays to be mended.
    value.fill(before)
    value.press("Enter")
    steps.problems(page, 0)
    steps.open_window(page, "bodies/rod")
    modes = steps.fill(page, "Modes along y", "99")
    steps.window(page).get_by_role("button", name="OK").click()
    steps.problems(page, 1)
    page.get_by_role("banner").get_by_role("button", name="1 problem").click()
    expect(steps.results(page)).to_contain_text("99")
    expect(modes).to_have_count(0)


def test_names_are_shown_whole(serve: Callable[..., Server], page: Page) -> None:
    text = (MODELS / "rigid" / "double_pendulum.yaml").read_text().replace("m2", NAME)
    server = serve("arm.yaml", content=text)
    steps.open_editor(page, server.url)
    cell = page.get_by_label(f"Name of {NAME}", exact=True)
    expect(cell).to_have_value(NAME)
    until(page, lambda: bool(cell.evaluate(WHOLE)))
    for block in page.locator(".react-flow__node .block-name").all():
        until(page, lambda block=block: bool(block.evaluate(WHOLE)))
