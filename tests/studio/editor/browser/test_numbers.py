"""Numbers that can't be are refused where they are typed, and names are shown whole."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Server

pytestmark = pytest.mark.browser

MODELS = Path(__file__).parents[4] / "reference_models"


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
