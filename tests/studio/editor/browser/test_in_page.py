"""A mechanism simulates in the editor's page by itself: also when the server is gone."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

from tests.late import require
from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Serve
from tests.studio.waiting import until

pytestmark = pytest.mark.browser

# The first module of a machine takes the compiler a minute or two.
JOB = 300_000


def test_the_flexible_robot_moves_on_without_the_server(opened: Serve, page: Page) -> None:
    require("ziglang", "zig")
    server = opened("robot.yaml", source=steps.ROBOT)
    steps.run(page, "Simulate…")
    for what, text in (("Start of q1", "0.3"), ("Speed of q2", "1"), ("Step", "0.0001")):
        steps.fill(page, what, text)
    steps.window(page).get_by_role("button", name="In this page").click()
    inner = steps.results(page).frame_locator("iframe.in-page")
    time = inner.locator("#time")
    expect(time).to_be_visible(timeout=JOB)
    server.kill()

    def reached() -> float:
        return float(time.inner_text().split()[0])

    before = reached()
    inner.get_by_role("slider", name="q1", exact=True).fill("3")  # An effort of the first motor.
    until(page, lambda: reached() > before + 0.2, "it does not go on")
    inner.get_by_role("button", name="Pause").click()
    assert inner.locator("#said").inner_text() == ""
