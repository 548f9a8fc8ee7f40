"""A model of thirty bodies stays fluid: moving it draws nothing anew but what moves; the frames' times are printed."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page

import symofros as sf
from reference_models.rigid.chain import chain
from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Server

pytestmark = pytest.mark.browser

BODIES = 30

RECORD = """() => {
    const seen = window.seen_ = {frames: [], blocks: new Set()};
    const observer = new MutationObserver((changes) => {
        for (const {target} of changes) {
            const element = target instanceof Element ? target : target.parentElement;
            const block = element && element.closest('.react-flow__node');
            if (block) seen.blocks.add(block.dataset.id);
        }
    });
    const options = {attributes: true, childList: true, characterData: true, subtree: true};
    observer.observe(document.querySelector('.react-flow__nodes'), options);
    let last = performance.now();
    const next = (now) => { seen.frames.push(now - last); last = now; seen.going = requestAnimationFrame(next); };
    seen.going = requestAnimationFrame(next);
    seen.stop = () => { cancelAnimationFrame(seen.going); observer.disconnect(); };
}"""
STOP = "() => { const {frames, blocks, stop} = window.seen_; stop(); return [frames.slice(1), [...blocks]]; }"


def dragged(page: Page, x: float, y: float) -> tuple[list[float], list[str]]:
    """Times between frames [ms], and the blocks that were touched, while the pointer drags from a point in circles."""
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 5, y + 5)
    page.evaluate(RECORD)
    for step in range(90):
        angle = 2 * np.pi * step / 45
        page.mouse.move(x + 90 * np.sin(angle), y + 60 * (1 - np.cos(angle)))
    found: tuple[list[float], list[str]] = page.evaluate(STOP)
    page.mouse.up()
    return found


def test_thirty_bodies_stay_fluid(serve: Callable[..., Server], page: Page, tmp_path: Path) -> None:
    sf.save(chain(BODIES), tmp_path / "chain.yaml")
    server = serve("chain.yaml")
    steps.open_editor(page, server.url)
    blocks = page.locator(".react-flow__node")
    assert blocks.count() == BODIES + 1
    page.wait_for_timeout(500)
    box, name = blocks.nth(12).bounding_box(), blocks.nth(12).get_attribute("data-id")
    assert box is not None
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + 6)
    runs: dict[str, Any] = {
        "drag": dragged(page, box["x"] + box["width"] / 2, box["y"] + 6),
        "pan": dragged(page, 700, 700),
    }
    for what, (times, _) in runs.items():
        print(what, json.dumps({"median_ms": np.median(times), "95_percent_ms": np.quantile(times, 0.95)}))
    assert runs["pan"][1] == []
    assert runs["drag"][1] == [name]
