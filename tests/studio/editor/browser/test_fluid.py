"""A model of thirty bodies stays fluid: moving it draws nothing anew but what moves; subtrees fold, names are found."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page, expect

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


@pytest.mark.slow
def test_thirty_bodies_stay_fluid_fold_and_are_found(serve: Callable[..., Server], page: Page, tmp_path: Path) -> None:
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

    # What a body carries folds into it, and what is looked for comes out again.
    steps.block(page, "bodies/link10").focus()
    page.keyboard.press("Space")
    expect(steps.block(page, "bodies/link10")).to_have_class(re.compile("selected"))
    page.keyboard.press("f")
    expect(blocks).to_have_count(11)
    page.keyboard.press("Control+k")
    page.keyboard.type("link20")
    page.keyboard.press("Enter")
    expect(blocks).to_have_count(BODIES + 1)
    expect(steps.block(page, "bodies/link20")).to_have_class(re.compile("selected"))

    # Of hundreds of parameters a page is drawn; one is found by its name, in the pane and from anywhere.
    values = page.get_by_label(re.compile("^Value of "))
    expect(values).to_have_count(50)
    page.get_by_label("Find a parameter").fill("lx29")
    expect(values).to_have_count(1)
    page.keyboard.press("Control+k")
    page.keyboard.type("ly30")
    page.keyboard.press("Enter")
    expect(page.get_by_label("Value of ly30")).to_be_visible()

    # A window asks about all of its formulas at once.
    with page.expect_response("**/api/expression") as asked:
        steps.open_window(page, "bodies/link20")
    assert len(asked.value.json()["checks"]) > 1
