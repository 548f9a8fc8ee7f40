"""A model of thirty bodies stays fluid while it is moved: the time between frames, measured in the browser."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page

import symofros as sf
from reference_models.rigid.chain import chain
from tests.gui.browser import steps
from tests.gui.browser.conftest import Server

pytestmark = pytest.mark.browser

BODIES = 30
# Half of 20 frames a second: generous, since a shared machine without a graphics card draws by its processor.
WORST_MEDIAN_MS = 100.0

RECORD = """() => {
    window.frames_ = [];
    let last = performance.now();
    const next = (now) => { window.frames_.push(now - last); last = now; window.going_ = requestAnimationFrame(next); };
    window.going_ = requestAnimationFrame(next);
}"""
STOP = "() => { cancelAnimationFrame(window.going_); return window.frames_.slice(1); }"


def frames_of(page: Page, x: float, y: float) -> np.ndarray:
    """Times between frames [ms] while the pointer drags from a point in a circle."""
    page.mouse.move(x, y)
    page.mouse.down()
    page.evaluate(RECORD)
    for step in range(90):
        angle = 2 * np.pi * step / 45
        page.mouse.move(x + 90 * np.sin(angle), y + 60 * (1 - np.cos(angle)))
    times = np.array(page.evaluate(STOP))
    page.mouse.up()
    return times


def test_thirty_bodies_stay_fluid(
    serve: Callable[..., Server], page: Page, tmp_path: Path, record_property: Callable[[str, object], None]
) -> None:
    sf.save(chain(BODIES), tmp_path / "chain.yaml")
    server = serve("chain.yaml")
    steps.open_editor(page, server.url)
    assert page.locator(".react-flow__node").count() == BODIES + 1
    page.wait_for_timeout(500)
    block = page.locator(".react-flow__node").nth(12).bounding_box()
    assert block is not None
    figures = {
        "pan": frames_of(page, 700, 700),
        "drag a block": frames_of(page, block["x"] + block["width"] / 2, block["y"] + 6),
    }
    medians = {what: float(np.median(times)) for what, times in figures.items()}
    worst = {what: float(np.quantile(times, 0.95)) for what, times in figures.items()}
    print(json.dumps({"median_ms": medians, "95_percent_ms": worst}))
    record_property("frame_ms", medians)
    assert max(medians.values()) < WORST_MEDIAN_MS
