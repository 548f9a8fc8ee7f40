"""Big models stay fluid: moving one draws nothing anew but what moves; subtrees fold, names are found.

`-s` prints the times between frames, and from a key to the picture that follows.
"""

from __future__ import annotations

import re
import time
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page, expect

import symofros as sf
from reference_models import MODELS
from reference_models.rigid.chain import chain
from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Serve
from tests.studio.editor.browser.measures import noted
from tests.studio.pictures import MANY, shot
from tests.studio.waiting import at_rest, until
from validation.inputs.cases import ROBOTS, robot_file

pytestmark = pytest.mark.browser

BODIES = 30
EDITS = 10

RECORD = """() => {
    const seen = window.seen_ = {frames: [], blocks: new Set(), begin: performance.now()};
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


# From the edit asked for after RECORD began to the frame that shows the document's next revision, and what of it the
# server took [ms]. However late the page is asked, it finds that edit.
ANSWERED = """() => new Promise((done) => {
    const look = () => {
        const asked = performance.getEntriesByType("resource").filter(({name}) => name.endsWith("/api/edit")).at(-1);
        if (asked && asked.startTime > window.seen_.begin && !document.querySelector(".react-flow__node.stale"))
            requestAnimationFrame(() => requestAnimationFrame(() =>
                done([performance.now() - asked.startTime, asked.responseEnd - asked.startTime])));
        else requestAnimationFrame(look);
    };
    look();
})"""


# Model -> a body of it.
BIG = {"chain60": "link13", "mss": "spdm_left_link5", "talos": "arm_left_3_link"}


def big(name: str) -> sf.System:
    """A chain of 60 bodies; two arms on a base, 22 joints; a humanoid of 38 speeds."""
    if name == "chain60":
        return chain(60)
    return MODELS["mss"] if name == "mss" else sf.load(robot_file(ROBOTS["talos"].file), floating_base=True)


def frames(page: Page, x: float, y: float, what: str) -> list[str]:
    """Print the times between frames of a drag; the blocks that it touched."""
    times, touched = dragged(page, x, y)
    noted("frames", of=what, median_ms=float(np.median(times)), most_ms=float(np.quantile(times, 0.95)))
    return touched


@pytest.mark.slow
@pytest.mark.parametrize("name", BIG)
def test_big_models_stay_fluid(opened: Serve, page: Page, tmp_path: Path, name: str) -> None:
    sf.save(big(name), tmp_path / "big.yaml")
    opened("big.yaml")
    steps.problems(page, 0)
    node = f"bodies/{BIG[name]}"
    box = at_rest(steps.block(page, node))
    at = box["x"] + box["width"] / 2, box["y"] + min(6, box["height"] / 8)
    page.mouse.click(*at)
    expect(steps.block(page, node)).to_contain_class("selected")
    assert frames(page, *at, f"{name}: drag") == [node]
    assert frames(page, 700, 715, f"{name}: pan") == []

    # A mass is changed in its window; nothing but the block that shows it is drawn anew.
    answers = []
    for mass in (f"{1.25 + 0.01 * k:g}" for k in range(EDITS)):
        steps.open_window(page, node)
        steps.tab(page, "Inertia")
        steps.fill(page, "Mass", mass)
        page.evaluate(RECORD)
        steps.window(page).get_by_role("button", name="OK").click()
        answers.append(page.evaluate(ANSWERED))
        touched = page.evaluate(STOP)[1]
        expect(steps.window(page)).to_have_count(0)
        assert set(touched) <= {node}
        expect(steps.block(page, node)).to_contain_text(mass)
    shown, answered = np.transpose(answers)
    figures = {"median_ms": float(np.median(shown)), "most_ms": float(np.quantile(shown, 0.95))}
    noted("edits", model=name, count=len(shown), **figures, answered_ms=float(np.median(answered)))


def test_a_page_shows_its_diagram_and_then_the_mechanism(serve: Serve, page: Page) -> None:
    server = serve("arm.yaml", source=steps.PENDULUM)
    began = time.perf_counter()
    steps.open_editor(page, server.url)
    diagram = time.perf_counter() - began
    began = time.perf_counter()
    steps.run(page, "3-D")
    page.frame_locator("iframe.view").locator("canvas").first.wait_for()
    until(page, lambda: bool((shot(page) < 200).any(axis=2).sum() >= MANY), "nothing is drawn")
    noted("first", diagram_s=diagram, picture_s=time.perf_counter() - began)


@pytest.mark.slow
def test_bodies_can_be_folded_and_found(opened: Serve, page: Page, tmp_path: Path) -> None:
    sf.save(chain(BODIES), tmp_path / "chain.yaml")
    opened("chain.yaml")
    blocks = page.locator(".react-flow__node")
    expect(blocks).to_have_count(BODIES + 1)
    steps.problems(page, 0)

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
