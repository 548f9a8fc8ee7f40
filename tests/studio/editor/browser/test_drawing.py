"""Links drawn by hand: a four-bar whose loop is closed from frame to frame."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

import symofros as sf
from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Picture, Serve
from tests.studio.waiting import at_rest

pytestmark = pytest.mark.browser

FOUR_BAR = Path(__file__).parents[4] / "reference_models" / "closed" / "four_bar.yaml"


def add(page: Page, name: str, on: str) -> None:
    """Add a rigid body that the block `on` carries, and name it."""
    page.get_by_role("button", name="Show the whole diagram").click()
    at_rest(steps.block(page, on))
    steps.block(page, on).click()
    page.get_by_role("button", name="Rigid body", exact=True).click()
    steps.open_window(page, "bodies/body")
    steps.fill(page, "Name", name)
    steps.accept(page)


def test_a_loop_is_closed_by_a_link(opened: Serve, page: Page, picture: Picture) -> None:
    server = opened("four_bar.yaml")
    add(page, "crank", "world")
    add(page, "coupler", "bodies/crank")
    add(page, "rocker", "world")
    page.get_by_role("button", name="Show the whole diagram").click()
    at_rest(steps.block(page, "bodies/coupler"))

    # A joint's link is taken away, and drawn again.
    steps.wire(page, "bodies/coupler/joint").focus()
    page.keyboard.press("Enter")
    page.keyboard.press("Escape")
    steps.wire(page, "bodies/coupler/joint").click(force=True)
    page.keyboard.press("Delete")
    expect(page.get_by_role("button", name="Undo: remove coupler")).to_be_enabled()
    steps.draw(
        page,
        steps.anchor(page, "bodies/crank", "frame tip of crank"),
        steps.anchor(page, "bodies/coupler", "joint of coupler"),
    )
    expect(page.get_by_role("button", name="Undo: mount coupler")).to_be_enabled()
    steps.open_window(page, "bodies/coupler")
    expect(steps.window(page).get_by_label("Parent", exact=True)).to_have_value("crank")
    steps.accept(page)

    steps.open_window(page, "bodies/rocker")
    steps.fill(page, "Position x", "1")
    steps.accept(page)
    steps.draw(
        page,
        steps.anchor(page, "bodies/coupler", "frame tip of coupler"),
        steps.anchor(page, "bodies/rocker", "frame tip of rocker"),
    )
    expect(steps.window(page)).to_contain_text("Join coupler.tip and rocker.tip")
    picture("join")
    steps.window(page).get_by_role("button", name="Closure").click()
    steps.window(page).get_by_label("y", exact=True).first.uncheck()
    picture("closure")
    steps.accept(page)
    expect(steps.wire(page, "closures/loop")).to_have_count(1)
    steps.problems(page, 0)
    picture("four-bar")

    steps.run(page, "Compile")
    expect(steps.results(page)).to_contain_text("constraints 2", timeout=steps.JOB)
    steps.saved(page)
    model = sf.compile(sf.load(server.file))
    assert (model.nq, model.nc) == (3, 2)

    # Its links lie in one line, and it is simulated nevertheless, from the pose that the 3-D pane closes.
    page.get_by_role("tab", name="3-D").click()
    pose = page.get_by_role("group", name="Pose")
    expect(pose).to_contain_text("Loops closed within", timeout=steps.JOB)
    shown = float(pose.get_by_role("slider").first.input_value())
    pose.get_by_role("button", name="Start here").click()
    start = steps.window(page).get_by_label("Start of q1", exact=True)
    assert float(start.input_value()) == pytest.approx(shown, abs=0.02)
    steps.fill(page, "Duration", "0.1")
    steps.window(page).get_by_role("button", name="Simulate", exact=True).click()
    expect(steps.results(page)).to_contain_text("of computing", timeout=steps.JOB)

    # Out of reach, the pane says by how much.
    steps.open_window(page, "bodies/rocker")
    steps.fill(page, "Position x", "9")
    steps.accept(page)
    expect(pose).to_contain_text(re.compile(r"A loop is open by [\d.]+ m"), timeout=steps.JOB)
    expect(pose.get_by_role("button", name="Start here")).to_be_disabled()


def test_a_typed_start_is_kept_or_refused(opened: Serve, page: Page) -> None:
    opened("bar.yaml", source=FOUR_BAR)

    def simulate(**starts: str) -> None:
        steps.run(page, "Simulate")
        steps.fill(page, "Duration", "0.1")
        for name, text in starts.items():
            steps.fill(page, f"Start of {name}", text)
        with steps.ended(page):
            steps.window(page).get_by_role("button", name="Simulate", exact=True).click()

    simulate(q1="1", q2="-0.5", q3="0.3")
    expect(steps.results(page)).to_contain_text("q2 = -0.5 would be")
    simulate(q1="1", q2="", q3="")
    expect(steps.results(page)).to_contain_text("of computing")


def test_a_double_pendulum_is_drawn_from_an_empty_canvas(opened: Serve, page: Page, picture: Picture) -> None:
    server = opened("double.yaml")
    picture("empty")

    # The first body is dragged from the palette, the second put on the selected one by a click.
    body = page.get_by_role("button", name="Rigid body", exact=True)
    body.drag_to(page.locator(".react-flow__pane"), target_position={"x": 320, "y": 200})
    expect(steps.block(page, "bodies/body")).to_be_visible()
    steps.open_window(page, "bodies/body")
    steps.fill(page, "Name", "upper")
    steps.fill(page, "Axis x", "0")
    steps.fill(page, "Axis y", "1")
    steps.fill(page, "Axis z", "0")
    picture("joint")

    # A formula that is wrong, then a name that nobody gives, then right.
    steps.tab(page, "Inertia")
    mass = steps.fill(page, "Mass", "2*m1 +")
    expect(steps.window(page).get_by_role("alert")).to_contain_text("formula")
    expect(mass).to_have_attribute("aria-invalid", "true")
    picture("wrong-formula")
    mass.fill("2*m1")
    expect(steps.window(page).get_by_role("alert")).to_contain_text("unknown symbol 'm1'")
    steps.window(page).get_by_role("button", name="Add parameter m1").click()
    expect(steps.window(page).get_by_role("alert")).to_have_count(0)
    steps.accept(page)
    expect(steps.block(page, "bodies/upper")).to_contain_text("2*m1")

    steps.block(page, "bodies/upper").click()
    body.click()
    steps.open_window(page, "bodies/body")
    steps.fill(page, "Name", "lower")
    steps.fill(page, "Axis y", "1")
    steps.fill(page, "Axis z", "0")
    expect(steps.window(page).get_by_label("Parent", exact=True)).to_have_value("upper")
    expect(steps.window(page).get_by_label("Frame", exact=True)).to_have_value("tip")
    steps.accept(page)
    expect(steps.wire(page, "bodies/lower/joint")).to_have_count(1)
    steps.problems(page, 0)

    steps.run(page, "Compile")
    expect(steps.results(page).get_by_role("rowheader", name="mass matrix", exact=True)).to_be_visible(
        timeout=steps.JOB
    )
    picture("compiled")
    steps.run(page, "Simulate")
    steps.fill(page, "Duration", "2")
    steps.fill(page, "Start of q1", "1.2")
    picture("simulate")
    steps.window(page).get_by_role("button", name="Simulate").click()
    plot = steps.results(page).get_by_role("img", name="q1, q2 over time")
    expect(plot).to_be_visible(timeout=steps.JOB)
    plot.hover()
    expect(steps.results(page).get_by_text("t = 0.9").first).to_be_visible()
    picture("simulated")

    steps.saved(page)
    model = sf.compile(sf.load(server.file))
    assert (model.nq, model.parameters["m1"]) == (2, 1.0)
