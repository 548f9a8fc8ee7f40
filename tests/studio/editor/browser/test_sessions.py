"""Recorded sessions of a beginner, by mouse, with keys for names and numbers only; what each may cost at most."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect

import symofros as sf
from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Faults, Picture, Serve
from tests.studio.editor.browser.hand import Hand
from tests.studio.editor.browser.measures import noted

pytestmark = pytest.mark.browser

# Session -> clicks and keys at most.
BARS = {
    "an example, changed and run": (8, 4),
    "three bodies to C": (40, 30),
    "a four-bar": (20, 4),
    "a diagram with a subsystem": (20, 4),
    "PD, subsystem and scopes": (40, 20),
    "the tour": (10, 4),
}


@pytest.fixture
def hand(page: Page) -> Hand:
    return Hand(page)


def within(hand: Hand, session: str) -> None:
    """Hold a session to its bar; `-s` prints what it took."""
    cost, most = hand.cost(), BARS[session]
    noted("session", name=session, clicks=cost[0], keys=cost[1], most_clicks=most[0], most_keys=most[1])
    assert cost[0] <= most[0] and cost[1] <= most[1], (session, cost)
    assert cost[0] > 3, "nothing was counted"


def button(page: Page, name: str) -> Locator:
    """A button of the tool bar."""
    return page.get_by_role("banner").get_by_role("button", name=name, exact=True)


def simulated(page: Page) -> None:
    expect(steps.results(page)).to_contain_text("s of computing", timeout=steps.JOB)


def test_an_example_is_opened_changed_and_run(opened: Serve, page: Page, hand: Hand, picture: Picture) -> None:
    opened("new.yaml")
    hand.press(page.get_by_role("button", name="Open an example"))
    picture("examples")
    hand.press(steps.window(page).get_by_role("button", name="Double pendulum Two rods"))
    expect(page.get_by_role("heading", level=1)).to_contain_text("double_pendulum.yaml")
    hand.put(page.get_by_label("Value of L2", exact=True), "0.8")
    hand.enter()
    steps.problems(page, 0)
    hand.press(button(page, "Simulate…"))
    hand.press(steps.window(page).get_by_role("button", name="Simulate", exact=True))
    simulated(page)
    hand.press(steps.results(page).get_by_role("button", name="Play"))
    expect(page.frame_locator("iframe.view").locator("canvas").first).to_be_visible(timeout=steps.JOB)
    within(hand, "an example, changed and run")


@pytest.mark.slow
def test_three_bodies_are_drawn_run_played_checked_and_exported(
    opened: Serve, page: Page, hand: Hand, tmp_path: Path
) -> None:
    opened("new.yaml")
    for name in ("Rigid body", "Rigid body", "Flexible beam"):
        hand.press(page.get_by_role("button", name=name, exact=True))
    expect(steps.block(page, "bodies/beam")).to_be_visible()
    hand.press(page.get_by_role("button", name="Show the whole diagram"))
    for block, name in (("bodies/body", "upper"), ("bodies/body2", "fore")):
        hand.twice(steps.block(page, block).locator(".block-title"))
        page.keyboard.type(name)  # The window opens with its name chosen.
        hand.press(steps.window(page).get_by_role("button", name="OK"))
        expect(steps.window(page)).to_have_count(0)
    steps.problems(page, 0)
    hand.press(button(page, "Simulate…"))
    hand.press(steps.window(page).get_by_role("button", name="Simulate", exact=True))
    simulated(page)
    hand.press(steps.results(page).get_by_role("button", name="Play"))
    expect(page.frame_locator("iframe.view").locator("canvas").first).to_be_visible(timeout=steps.JOB)
    hand.press(button(page, "Cross-check"))
    expect(steps.results(page)).to_contain_text(re.compile("engines? agree|All|agree"), timeout=4 * steps.JOB)
    hand.press(button(page, "Export…"))
    hand.press(steps.window(page).get_by_role("button", name="Export", exact=True))
    expect(steps.results(page).get_by_text(re.compile(r"\.c\b")).first).to_be_visible(timeout=steps.JOB)
    assert list(tmp_path.glob("*_c/**/*.c"))
    within(hand, "three bodies to C")


def test_a_four_bar_is_drawn_and_run(opened: Serve, page: Page, hand: Hand) -> None:
    opened("new.yaml")

    def rigid_body() -> None:
        hand.press(page.get_by_role("button", name="Rigid body", exact=True))

    rigid_body()
    expect(steps.block(page, "bodies/body")).to_be_visible()
    rigid_body()
    expect(steps.block(page, "bodies/body2")).to_be_visible()
    hand.press(page.get_by_role("button", name="Show the whole diagram"))
    hand.press(steps.block(page, "world").locator(".block-title"))
    rigid_body()
    expect(steps.block(page, "bodies/body3")).to_be_visible()
    hand.press(page.get_by_role("button", name="Show the whole diagram"))
    hand.twice(steps.block(page, "bodies/body3").locator(".block-title"))
    hand.put(steps.window(page).get_by_label("Position x", exact=True), "1")
    hand.press(steps.window(page).get_by_role("button", name="OK"))
    expect(steps.window(page)).to_have_count(0)
    ends = [
        steps.block(page, f"bodies/{name}").get_by_label(f"frame tip of {name}", exact=True)
        for name in ("body2", "body3")
    ]
    hand.draw(*ends)
    hand.press(steps.window(page).get_by_role("button", name="Closure"))
    hand.press(steps.window(page).get_by_label("y", exact=True).first)
    hand.press(steps.window(page).get_by_role("button", name="OK"))
    steps.problems(page, 0)
    hand.press(page.get_by_role("tab", name="3-D"))
    start = page.get_by_role("group", name="Pose").get_by_role("button", name="Start here")
    expect(start).to_be_enabled(timeout=steps.JOB)
    hand.press(start)
    hand.press(steps.window(page).get_by_role("button", name="Simulate", exact=True))
    simulated(page)
    expect(steps.results(page).locator(".bad")).to_have_count(0)
    within(hand, "a four-bar")


def test_blocks_become_a_subsystem_that_one_goes_into(
    opened: Serve, page: Page, hand: Hand, picture: Picture, faults: Faults, tmp_path: Path
) -> None:
    opened("new.yaml")
    hand.press(page.get_by_role("button", name="Open an example"))
    hand.press(steps.window(page).get_by_role("button", name="Held arm"))
    expect(steps.block(page, "blocks/pd")).to_be_visible()
    whole = sf.load_diagram(steps.MODELS / "held_arm.yaml")
    page.keyboard.down("Control")
    for name in ("pd", "weight", "effort"):
        hand.press(steps.block(page, f"blocks/{name}").locator(".block-title"))
    page.keyboard.up("Control")
    steps.block(page, "blocks/weight").locator(".block-title").click(button="right")
    assert faults() == []
    picture("context-menu")
    hand.press(page.get_by_role("menuitem", name="Group into a subsystem"))
    expect(steps.block(page, "parts/subsystem")).to_be_visible()
    expect(steps.block(page, "blocks/pd")).to_have_count(0)
    steps.problems(page, 0)
    picture("subsystem")
    hand.press(button(page, "Run"))
    simulated(page)
    # A step on and back in the run: records of 10 ms.
    bar = steps.results(page).get_by_role("group", name="Motion")
    for step, shown in (("A step on", "0.01 s"), ("A step on", "0.02 s"), ("A step back", "0.01 s")):
        hand.press(bar.get_by_role("button", name=step))
        expect(bar.locator("output")).to_have_text(shown)
    hand.twice(steps.block(page, "parts/subsystem").locator(".block-title"))
    expect(steps.block(page, "blocks/pd")).to_be_visible()
    hand.press(page.get_by_role("button", name=re.compile("^←")))
    # Going in left the diagram around it unsaved, and it is kept.
    expect(steps.block(page, "parts/subsystem")).to_be_visible()
    steps.saved(page)
    within(hand, "a diagram with a subsystem")
    runs = [
        sf.Simulation(each).interpret(0.1, dt=0.01)
        for each in (whole, sf.load_diagram(next(tmp_path.glob("held_arm*.yaml"))))
    ]
    assert (runs[0]["plant.q"] == runs[1]["plant.q"]).all()


def test_a_law_with_a_subsystem_and_scopes_is_drawn_and_run(
    serve: Serve, page: Page, hand: Hand, picture: Picture, faults: Faults, tmp_path: Path
) -> None:
    """An empty diagram beside the file of an arm: four blocks, four wires, gains, a subsystem, two scopes, a run."""
    shutil.copy(steps.PENDULUM, tmp_path / "arm.yaml")
    page.goto(serve("law.yaml", content="symofros_diagram: 1\nblocks: {}\n").url)
    palette = page.get_by_role("navigation", name="Palette")
    hand.press(palette.get_by_role("button", name="Generic"))
    for title, block in (
        ("Model", "models/model"),
        ("forward dynamics", "blocks/forward_dynamics"),
        ("constant", "blocks/constant"),
        ("joint pd", "blocks/joint_pd"),
    ):
        hand.press(palette.get_by_role("button", name=title, exact=True))
        expect(steps.block(page, block)).to_be_visible()
    hand.twice(steps.block(page, "blocks/constant").locator(".block-title"))
    hand.put(steps.window(page).get_by_label("Value", exact=True), "[0.6,-0.4]")
    hand.press(steps.window(page).get_by_role("button", name="OK"))
    hand.twice(steps.block(page, "blocks/joint_pd").locator(".block-title"))
    hand.put(steps.window(page).get_by_label("Proportional gain", exact=True), "60")
    hand.put(steps.window(page).get_by_label("Derivative gain", exact=True), "9")
    hand.press(steps.window(page).get_by_role("button", name="OK"))
    hand.press(page.get_by_role("button", name="Show the whole diagram"))
    for source, target, edge in (
        ("output y of constant", "input q_desired of joint_pd", "joint_pd/inputs/q_desired"),
        ("output q of forward_dynamics", "input q of joint_pd", "joint_pd/inputs/q"),
        ("output v of forward_dynamics", "input v of joint_pd", "joint_pd/inputs/v"),
        ("output effort of joint_pd", "input u of forward_dynamics", "forward_dynamics/inputs/u"),
    ):
        hand.draw(steps.port(page, source), steps.port(page, target))
        expect(steps.wire(page, f"blocks/{edge}")).to_have_count(1)
    hand.press(page.get_by_role("button", name="Arrange the blocks"))
    steps.problems(page, 0)
    picture("law-drawn")
    page.keyboard.down("Control")  # The law is chosen since it was linked.
    hand.press(steps.block(page, "blocks/constant").locator(".block-title"))
    page.keyboard.up("Control")
    steps.block(page, "blocks/joint_pd").locator(".block-title").click(button="right")
    hand.press(page.get_by_role("menuitem", name="Group into a subsystem"))
    expect(steps.block(page, "parts/subsystem")).to_be_visible()
    expect(steps.block(page, "blocks/constant")).to_have_count(0)
    hand.press(page.get_by_role("button", name="Arrange the blocks"))
    for k, output in enumerate(("q", "v")):
        wire = page.locator(f'.react-flow__edge[data-id^="parts/subsystem"][data-id$="{output}"]')
        hand.press_line(wire.locator(".react-flow__edge-interaction"))
        hand.press(page.get_by_role("button", name="Add a scope"))
        expect(page.locator('.react-flow__node[data-id^="blocks/scope"]')).to_have_count(k + 1)
    steps.problems(page, 0)
    hand.press(button(page, "Run"))
    simulated(page)
    for signal in ("q", "v"):
        expect(steps.results(page).get_by_role("img", name=f"forward_dynamics.{signal}")).to_be_visible()
    picture("law-run")
    assert faults() == []
    steps.saved(page)
    within(hand, "PD, subsystem and scopes")
    run = sf.Simulation(sf.load_diagram(tmp_path / "law.yaml")).run(3.0)
    assert run.q[-1] == pytest.approx([0.6, -0.4], abs=0.5)


def test_the_tour_ends_with_a_motion(opened: Serve, page: Page, hand: Hand, picture: Picture, faults: Faults) -> None:
    opened("new.yaml")
    hand.press(page.get_by_role("button", name="Take the tour"))
    tour = page.get_by_role("complementary", name="Tour")
    expect(tour).to_contain_text("1 of 5")
    assert faults() == []
    hand.press(tour.get_by_role("button", name="Open it"))
    expect(tour).to_contain_text("2 of 5: Choose a body")
    hand.press(steps.block(page, "bodies/lower").locator(".block-title"))
    expect(tour).to_contain_text("3 of 5: Change a parameter")
    picture("tour")
    hand.put(page.get_by_label("Value of L2", exact=True), "0.6")
    hand.enter()
    expect(tour).to_contain_text("4 of 5: Simulate")
    hand.press(button(page, "Simulate…"))
    hand.press(steps.window(page).get_by_role("button", name="Simulate", exact=True))
    expect(tour).to_contain_text("5 of 5: Play it", timeout=steps.JOB)
    hand.press(steps.results(page).get_by_role("button", name="Play"))
    expect(tour).to_have_count(0)
    within(hand, "the tour")


def test_a_window_has_help_and_its_page(opened: Serve, page: Page, faults: Faults, picture: Picture) -> None:
    opened("robot.yaml", source=steps.ROBOT)
    steps.open_window(page, "bodies/link1")
    steps.window(page).get_by_text("Help", exact=True).click()
    text = steps.window(page).get_by_role("region", name="Help")
    expect(text).to_contain_text("Number of shape functions for the displacement along y")
    text.get_by_text("docs/theory/beams.md", exact=True).click()
    expect(text.get_by_role("region", name="docs/theory/beams.md")).to_contain_text("A beam is one body")
    assert faults() == []
    text.scroll_into_view_if_needed()
    picture("help")


def test_a_phone_shows_the_diagram_first(serve: Serve, page: Page) -> None:
    page.set_viewport_size({"width": 400, "height": 760})
    steps.open_editor(page, serve("new.yaml").url)
    page.get_by_role("button", name="Open an example").click()
    expect(steps.window(page)).to_contain_text("Double pendulum")
