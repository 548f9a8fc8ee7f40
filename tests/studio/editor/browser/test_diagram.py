"""Diagrams in the page: the paper's square is opened and run; another one is drawn, checked, mended, saved."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from playwright.sync_api import Page, Position, expect

from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Picture, Serve, Server
from tests.studio.waiting import at_rest, until

pytestmark = pytest.mark.browser

MIDDLE: Position = {"x": 60, "y": 12}
DRAWN = """symofros_diagram: 1
name: drawn   # a comment that stays
blocks:
  source: {kind: sine, unit: rad}
  speed: {kind: gain, unit_in: rad/s, unit_out: "rad/s", inputs: {}}
"""
# Position and speed of an arm exchanged, a scalar that a vector of one takes.
EXCHANGED = """symofros_diagram: 1
models: {arm: {file: arm.yaml}}
blocks:
  plant: {kind: forward_dynamics, model: arm, inputs: {u: pd}}
  place: {kind: pick, entries: [q1, q2], model: arm, of: q, inputs: {u: plant.q}}
  speed: {kind: pick, entries: [q1, q2], model: arm, of: v, inputs: {u: plant.v}}
  one: {kind: constant, value: 1, unit: rad}
  first: {kind: pick, entries: [0], inputs: {u: one}}
  pd: {kind: joint_pd, kp: 3, kd: 1, inputs: {q_desired: goal, q: speed, v: place}}
  goal: {kind: constant, value: [0.1, 0.2], unit: rad}
"""
HELD = """symofros_diagram: 1
models: {arm: {file: arm.yaml}}
blocks:
  plant: {kind: forward_dynamics, model: arm, inputs: {u: pd}}
  pd:
    kind: joint_pd   # holds it
    kp: 3
    kd: 8.0e-1
    inputs: {q_desired: where, q: plant.q, v: plant.v}
  where: {kind: constant, value: [0.1, 0.2], unit: rad}
"""


@pytest.fixture
def square(serve: Serve, tmp_path: Path) -> Server:
    shutil.copytree(steps.MODELS / "flexible", tmp_path / "flexible")
    return serve("square.yaml", source=steps.MODELS / "square.yaml")


def curve(page: Page) -> str:
    """The flexible robot's tool in the picture of figure 9."""
    picture = steps.results(page).get_by_role("img", name="Tool and path: tip.p, path.p in a plane")
    expect(picture).to_be_visible(timeout=steps.JOB)
    expect(steps.results(page).get_by_text("s of computing")).to_be_visible(timeout=steps.JOB)
    return picture.locator("path.series").first.get_attribute("d") or ""


def test_the_papers_square_runs_and_another_model_is_one_choice(square: Server, page: Page, picture: Picture) -> None:
    text = square.file.read_text()
    steps.open_editor(page, square.url)
    expect(page.locator(".signal-block")).to_have_count(16)
    steps.problems(page, 0)
    picture("diagram")

    steps.run(page, "Run…")
    steps.fill(page, "Pause at", "4")
    steps.window(page).get_by_role("button", name="Run").click()
    going = steps.results(page).get_by_role("button", name="Go on")
    expect(going).to_be_visible(timeout=steps.JOB)
    expect(steps.results(page).get_by_text("paused at t = 4 s")).to_be_visible()
    # Drawn while it waits.
    until(page, lambda: bool(steps.results(page).locator("path.series").first.get_attribute("d")))
    going.click()
    flexible = curve(page)
    picture("square")

    # The same with a rigid plant: one choice, one entry of the file.
    page.get_by_label("Shape functions of plant").select_option("0")
    expect(steps.results(page).get_by_text("The diagram has changed since")).to_be_visible()
    steps.run(page, "Run…")
    steps.fill(page, "Pause at", "")
    steps.window(page).get_by_role("button", name="Run").click()
    expect(steps.results(page).get_by_text("The diagram has changed since")).to_have_count(0)
    until(page, lambda: curve(page) != flexible)
    steps.saved(page)
    plant = "plant: {file: flexible/planar_robot.yaml, start: {q1: -0.1, q2: 0.1, q3: 0}"
    assert square.file.read_text() == text.replace(f"{plant}}}", f"{plant}, functions: 0}}")


def test_a_model_has_a_canvas_of_its_own_and_a_way_back(opened: Serve, page: Page, tmp_path: Path) -> None:
    shutil.copy(steps.PENDULUM, tmp_path / "arm.yaml")
    server = opened("held.yaml", content=HELD)
    steps.problems(page, 0)
    steps.block(page, "models/arm").dblclick()
    expect(steps.block(page, "bodies/upper")).to_be_visible()
    page.get_by_role("button", name="← held.yaml").click()
    # The window of a block, and a new name, which all that refers to it follows.
    steps.block(page, "blocks/pd").dblclick()
    steps.fill(page, "Name", "law")
    steps.fill(page, "Proportional gain", "[6.0e1, 25]")
    steps.accept(page)
    expect(steps.wire(page, "blocks/plant/inputs/u")).to_have_count(1)
    steps.problems(page, 0)
    steps.saved(page)
    changed = HELD.replace("u: pd", "u: law").replace("  pd:", "  law:").replace("kp: 3", "kp: [60, 25]")
    assert server.file.read_text() == changed


def copied_and_taken_back(page: Page) -> None:
    """Blocks are copied with the wires between them, as text; the loops show though the copies are not fed."""
    for name in ("speed", "sum"):
        steps.block(page, f"blocks/{name}").click(modifiers=["Control"] if name == "sum" else [], position=MIDDLE)
    page.keyboard.press("Control+c")
    page.keyboard.press("Control+v")
    expect(steps.wire(page, "blocks/sum2/inputs/u1")).to_have_count(1)
    expect(steps.block(page, "blocks/speed2")).to_be_visible()
    steps.problems(page, 3)
    expect(page.locator(".react-flow__edge.loop")).to_have_count(2)
    assert '"symofros_blocks"' in page.evaluate("navigator.clipboard.readText()")
    page.keyboard.press("Control+z")
    expect(steps.block(page, "blocks/sum2")).to_have_count(0)


def test_a_diagram_is_checked_as_it_is_drawn_and_saved_with_every_other_byte_as_it_was(
    opened: Serve, page: Page, picture: Picture
) -> None:
    server = opened("drawn.yaml", content=DRAWN)
    steps.problems(page, 1)  # Nothing feeds the gain.

    # From port to port; the server's check of the units stands on the wire.
    steps.port(page, "output y of source").drag_to(steps.port(page, "input u of speed"))
    expect(page.locator(".react-flow__edge.wrong")).to_have_count(1)
    expect(page.locator(".wire-label")).to_have_text("rad → rad/s")
    steps.wire(page, "blocks/speed/inputs/u").focus()
    page.keyboard.press("Space")
    page.keyboard.press("Delete")
    expect(steps.wire(page, "blocks/speed/inputs/u")).to_have_count(0)
    page.keyboard.press("Control+z")
    expect(steps.wire(page, "blocks/speed/inputs/u")).to_have_count(1)

    # Mended in the source's window; then a loop, which shows where it is.
    steps.open_window(page, "blocks/speed")
    steps.fill(page, "Unit in", "rad")
    steps.accept(page)
    steps.problems(page, 0)
    page.get_by_label("Find a block").fill("sum")
    page.get_by_role("button", name="sum", exact=True).drag_to(
        page.locator(".react-flow__pane"), target_position={"x": 300, "y": 500}
    )
    expect(steps.block(page, "blocks/sum")).to_be_visible()
    steps.port(page, "output y of speed").drag_to(steps.port(page, "input u1 of sum"))
    expect(steps.wire(page, "blocks/sum/inputs/u1")).to_have_count(1)
    steps.port(page, "output y of sum").drag_to(steps.port(page, "input u2 of sum"))
    expect(page.locator(".react-flow__edge.loop")).to_have_count(1)
    expect(page.locator(".wire-label")).to_have_text("algebraic loop")
    picture("diagram-loop")

    copied_and_taken_back(page)

    # Fed by a signal of the same unit, by the keyboard alone; a scope on a signal; then it runs.
    steps.open_window(page, "blocks/sum")
    steps.window(page).get_by_label("Source of u2").select_option("speed.y")
    steps.accept(page)
    expect(page.locator(".react-flow__edge.loop")).to_have_count(0)
    steps.wire(page, "blocks/sum/inputs/u1").focus()
    page.keyboard.press("Space")
    page.get_by_role("button", name="Add a scope").click()
    expect(steps.block(page, "blocks/scope")).to_be_visible()
    steps.problems(page, 0)
    steps.run(page, "Run…")
    steps.window(page).get_by_label("How").select_option("interpreted")
    steps.window(page).get_by_role("button", name="Run").click()
    expect(steps.results(page).get_by_role("img", name="speed.y over time")).to_be_visible(timeout=steps.JOB)
    steps.saved(page)
    assert server.file.read_text() == DRAWN.replace(
        'rad/s, unit_out: "rad/s", inputs: {}', 'rad, unit_out: "rad/s", inputs: {u: source.y}'
    ) + (
        "  sum: {kind: sum, inputs: {u1: speed.y, u2: speed.y}}\n"
        "  scope: {kind: scope, signals: [y], inputs: {y: speed.y}}\n"
    )


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


def test_ports_of_diagram_blocks_follow_their_fields(opened: Serve, page: Page, tmp_path: Path) -> None:
    shutil.copy(steps.PENDULUM, tmp_path / "arm.yaml")
    opened("picked.yaml", content=PICKED)
    # The block gets its output when its entries are chosen.
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


def test_states_that_are_exchanged_are_refused_in_units(opened: Serve, page: Page, tmp_path: Path) -> None:
    shutil.copy(steps.PENDULUM, tmp_path / "arm.yaml")
    opened("law.yaml", content=EXCHANGED)
    steps.problems(page, 2)
    page.get_by_role("banner").get_by_role("button", name="2 problems").click()
    for words in ("speed.y -> pd.q: units differ", "place.y -> pd.v: units differ", "rad/s"):
        expect(steps.results(page)).to_contain_text(words)
    expect(steps.results(page)).not_to_contain_text("shapes differ")


def test_comments_stand_on_the_canvas_and_in_the_file(opened: Serve, page: Page, picture: Picture) -> None:
    server = opened("drawn.yaml", content=DRAWN)
    pane = page.locator(".react-flow__pane")
    pane.click(button="right", position={"x": 420, "y": 60})
    page.get_by_role("menuitem", name="Comment…").click()
    steps.fill(page, "Text", "The source is a sine;\nthe gain is its unit.")
    steps.accept(page)
    comment = steps.block(page, "blocks/comment")
    expect(comment).to_contain_text("the gain is its unit.")
    pane.click(button="right", position={"x": 420, "y": 160})
    page.get_by_role("menuitem", name="Comment…").click()
    steps.fill(page, "Text", "Speed of a joint")
    steps.window(page).get_by_label("Heading").check()
    steps.accept(page)
    expect(steps.block(page, "blocks/comment2").locator(".heading")).to_have_text("Speed of a joint")
    picture("diagram-comments")
    steps.problems(page, 1)  # As before: nothing feeds the gain.
    steps.saved(page)
    words = '  comment: {kind: comment, text: "The source is a sine;\\nthe gain is its unit."}\n'
    assert server.file.read_text().startswith(DRAWN)
    assert server.file.read_text()[len(DRAWN) :] == (
        words + "  comment2: {kind: comment, text: 'Speed of a joint', heading: true}\n"
    )


@pytest.mark.parametrize("later", [0, 1])
def test_wires_of_a_new_block_are_drawn_when_it_is_measured_late(
    serve: Serve, page: Page, tmp_path: Path, later: int
) -> None:
    """A browser that is busy says how large a block is only after the block has changed again."""
    page.add_init_script(f"""
        const Observer = window.ResizeObserver;
        window.ResizeObserver = class extends Observer {{
          constructor(act) {{ super((entries, observer) => setTimeout(() => act(entries, observer), {later})); }}
        }};
    """)
    shutil.copy(steps.PENDULUM, tmp_path / "arm.yaml")
    page.goto(serve("held.yaml", content=HELD).url)
    page.get_by_role("button", name="Arrange the blocks").click()
    at_rest(steps.block(page, "blocks/where"))
    steps.block(page, "blocks/where").locator(".block-title").click()
    page.keyboard.down("Control")
    steps.block(page, "blocks/pd").locator(".block-title").click()
    page.keyboard.up("Control")
    steps.block(page, "blocks/pd").locator(".block-title").click(button="right")
    page.get_by_role("menuitem", name="Group into a subsystem").click()
    for wire in ("parts/subsystem/inputs/q", "parts/subsystem/inputs/v", "blocks/plant/inputs/u"):
        expect(steps.wire(page, wire)).to_have_count(1)


def test_a_state_machine_is_drawn_by_the_mouse(serve: Serve, page: Page) -> None:
    page.goto(serve("law.yaml", content="symofros_diagram: 1\nblocks: {}\n").url)
    palette = page.get_by_role("navigation", name="Palette")
    palette.get_by_role("button", name="Generic").click()
    # Every name can be read, and nothing lies beside the palette.
    assert palette.evaluate("nav => nav.scrollWidth <= nav.clientWidth")
    assert palette.locator(".fold").evaluate_all("all => all.every(one => one.scrollWidth <= one.clientWidth)")
    palette.get_by_role("button", name="state machine", exact=True).click()
    steps.problems(page, 0)  # Of one state.
    steps.open_window(page, "blocks/state_machine")
    steps.fill(page, "Name of a new entry of states", "open")
    states = steps.window(page).get_by_role("group", name="States", exact=True)
    states.get_by_role("button", name="Add", exact=True).last.click()
    transitions = steps.window(page).get_by_role("group", name="Transitions", exact=True)
    transitions.get_by_role("button", name="Add", exact=True).click()
    transitions.get_by_label("Leave", exact=True).select_option("x")
    transitions.get_by_label("Enter", exact=True).select_option("open")
    transitions.get_by_label("When", exact=True).fill("t - 0.5")
    steps.fill(page, "Sample time", "0.1")
    steps.accept(page)
    steps.problems(page, 0)
    with steps.ended(page):
        page.get_by_role("banner").get_by_role("button", name="Run", exact=True).click()
    expect(steps.results(page).get_by_role("img", name="state_machine.state")).to_be_visible()


def test_a_long_path_of_a_model_is_read_in_full(serve: Serve, page: Page, tmp_path: Path) -> None:
    name = "variants/the_second_of_the_arms_with_a_long_tool_and_a_stiff_wrist.yaml"
    (tmp_path / "variants").mkdir()
    shutil.copy(steps.PENDULUM, tmp_path / name)
    content = f"symofros_diagram: 1\nmodels: {{arm: {{file: {name}}}}}\nblocks: {{}}\n"
    page.goto(serve("law.yaml", content=content).url)
    path = page.get_by_label("Model arm").locator(".model-path")
    for width in (1200, 400):
        page.set_viewport_size({"width": width, "height": 760})
        expect(path).to_have_text(name)
        box = at_rest(path)
        assert 0 <= box["x"] and box["x"] + box["width"] <= width
        assert path.evaluate("line => line.scrollWidth <= line.clientWidth")
