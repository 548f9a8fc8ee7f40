"""Ports that appear, move or change their names can be wired by mouse at once."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Serve
from tests.studio.waiting import at_rest

pytestmark = pytest.mark.browser

PICKED = """symofros_diagram: 1
models: {arm: {file: arm.yaml}}
blocks:
  plant: {kind: forward_dynamics, model: arm}
  choice: {kind: pick, model: arm, inputs: {u: plant.q}}
  total: {kind: sum, signs: "+", unit: rad}
"""


def wire(page: Page, source: str, target: str) -> None:
    """Drag from port to port; blocks that are being arranged move both."""
    at_rest(steps.port(page, source))
    at_rest(steps.port(page, target))
    steps.port(page, source).drag_to(steps.port(page, target))


def test_ports_of_blocks_of_a_diagram(opened: Serve, page: Page, tmp_path: Path) -> None:
    shutil.copy(steps.PENDULUM, tmp_path / "arm.yaml")
    opened("picked.yaml", content=PICKED)
    # The block gets its output when it is told which entries it picks.
    steps.open_window(page, "blocks/choice")
    steps.fill(page, "Entries", "q1")
    steps.accept(page)
    # And the other one a second input.
    steps.open_window(page, "blocks/total")
    steps.fill(page, "Signs", "+-")
    steps.accept(page)
    wire(page, "output y of choice", "input u2 of total")
    expect(steps.wire(page, "blocks/total/inputs/u2")).to_have_count(1)
    # Undo takes wire and input away; the input comes back at its place.
    page.keyboard.press("Control+z")
    expect(steps.wire(page, "blocks/total/inputs/u2")).to_have_count(0)
    page.keyboard.press("Control+z")
    expect(steps.port(page, "input u2 of total")).to_have_count(0)
    page.keyboard.press("Control+y")
    expect(steps.port(page, "input u2 of total")).to_have_count(1)
    wire(page, "output y of choice", "input u2 of total")
    expect(steps.wire(page, "blocks/total/inputs/u2")).to_have_count(1)
