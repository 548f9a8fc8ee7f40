"""Fields: what is typed is judged where it stands, is kept while nobody takes it, and is shown whole."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

import symofros as sf
from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Serve, Server
from tests.studio.waiting import fits, until

pytestmark = pytest.mark.browser

FREE = """symofros: 1
system: {gravity: [0, 0, 0]}
bodies:
  top: {joint: {kind: ball, name: top, actuated: true}, inertia: {mass: 1, moments: [1, 2, 3]}}
  craft: {joint: {kind: free, name: craft}, inertia: {mass: 1, moments: [1, 2, 3]}}
  puck: {joint: {kind: planar, name: puck, actuated: true}, inertia: {mass: 1, moments: [1, 2, 3]}}
  drum: {joint: {kind: revolute, name: drum, prescribed: true}, inertia: {mass: 1, moments: [1, 2, 3]}}
"""
WHOLE = "(element) => element.scrollWidth <= element.clientWidth"


def test_unknown_names_are_flagged_in_new_fields(arm: Server, page: Page) -> None:
    steps.open_window(page, "bodies/upper")
    steps.tab(page, "Forces")
    field = steps.fill(page, "Effort", "-tauu*3", nth=1)
    alert = steps.window(page).get_by_role("alert")
    expect(alert).to_contain_text("unknown symbol 'tauu'")
    alert.get_by_role("button", name="Add input tauu").click()
    expect(alert).to_have_count(0)
    field.fill("-kk*q1")
    expect(alert).to_contain_text("unknown symbol 'kk'")
    field.fill("-3*q1")
    expect(alert).to_have_count(0)
    # A load that is being added.
    group = steps.window(page).get_by_role("group", name="Loads", exact=True)
    group.get_by_role("button", name="Add", exact=True).click()
    force = steps.window(page).get_by_label("Force z", exact=True)
    force.fill("weight")
    expect(alert).to_contain_text("unknown symbol 'weight'")


def test_a_new_parent_takes_the_frame_of_the_old_one_away(arm: Server, page: Page) -> None:
    steps.open_window(page, "bodies/lower")
    frame = steps.window(page).get_by_label("Frame", exact=True)
    expect(frame).to_have_value("elbow")
    steps.window(page).get_by_label("Parent", exact=True).select_option("world")
    expect(frame).to_have_value("")
    steps.accept(page)
    steps.problems(page, 0)


def test_units_are_those_of_the_kind_of_joint(arm: Server, page: Page) -> None:
    steps.open_window(page, "bodies/upper")
    window = steps.window(page)
    for kind, unit, other in (("revolute", "N m s/rad", "N s/m"), ("prismatic", "N s/m", "N m s/rad")):
        steps.tab(page, "Joint")
        window.get_by_label("Kind", exact=True).select_option(kind)
        steps.tab(page, "Forces")
        if kind == "revolute":
            window.get_by_role("button", name="Add friction").click()
        expect(window.get_by_text(unit, exact=True)).to_be_visible()
        expect(window.get_by_text(other)).to_have_count(0)


def test_text_typed_while_offline_is_kept_and_sent(opened: Serve, serve: Serve, page: Page) -> None:
    server = opened("arm.yaml", source=steps.PENDULUM)
    page.get_by_role("tab", name="YAML").click()  # The text editor is loaded.
    expect(page.get_by_label("Text of the file")).to_be_visible()
    page.get_by_role("tab", name="Parameters").click()
    server.kill()
    value = page.get_by_label("Value of m1", exact=True)
    value.fill("2.5")
    value.press("Enter")
    expect(page.get_by_text("The server does not answer")).to_be_visible()
    expect(value).to_have_value("2.5")
    expect(value).to_have_attribute("aria-invalid", "true")
    expect(value).to_have_attribute("title", "Not sent: the server does not answer. 2.5 is sent when it is back.")
    again = serve("arm.yaml", port=server.port)
    expect(page.get_by_text("The server does not answer")).to_have_count(0, timeout=20_000)
    expect(value).to_have_attribute("aria-invalid", "false")
    expect(value).to_have_value("2.5")
    # The text, too, and after its pane was closed.
    for is_closed in (False, True):
        page.get_by_role("tab", name="YAML").click()
        again.kill()
        page.get_by_label("Text of the file").click()
        page.keyboard.press("Control+Home")
        page.keyboard.type(f"# typed {is_closed}\n")
        expect(page.get_by_text("The server does not answer")).to_be_visible()
        if is_closed:
            page.get_by_role("tab", name="Tree").click()
        again = serve("arm.yaml", port=server.port)
        expect(page.get_by_text("The server does not answer")).to_have_count(0, timeout=20_000)
        page.get_by_role("tab", name="YAML").click()
        expect(page.get_by_label("Text of the file")).to_contain_text(f"# typed {is_closed}")
    steps.saved(page)
    until(page, lambda: again.file.read_text().startswith("# typed True\n# typed False\n"))
    assert "value: 2.5" in again.file.read_text()


def test_a_pane_that_cannot_be_loaded_leaves_the_page(serve: Serve, chromium: Browser) -> None:
    """The text editor is loaded when it is opened: then the server may be gone."""
    server = serve("arm.yaml", source=steps.PENDULUM)
    page = chromium.new_page()
    steps.open_editor(page, server.url)
    server.kill()
    page.get_by_role("tab", name="YAML").click()
    expect(page.get_by_role("alert").filter(has_text="The pane can't be shown")).to_be_visible()
    expect(steps.block(page, "bodies/upper")).to_be_visible()
    page.get_by_role("tab", name="Tree").click()
    expect(page.get_by_role("tree")).to_be_visible()
    page.close()


def test_units_are_shown_whole(opened: Serve, page: Page) -> None:
    text = steps.PENDULUM.read_text().replace("unit: kg,", "unit: kg m^2/s,").replace("unit: kg}", "unit: kg m^2/s}")
    opened("arm.yaml", content=text)
    for width in (1280, 900, 640, 400):
        page.set_viewport_size({"width": width, "height": 760})
        if page.get_by_role("complementary").count() == 0:
            page.get_by_role("button", name="YAML").click()
            page.get_by_role("tab", name="Parameters").click()
        units = page.get_by_label("Unit of ")
        assert units.count() > 3
        for unit in units.all():
            until(page, lambda unit=unit: bool(unit.evaluate(WHOLE)), f"cut off at {width}")
        fits(page, width)


def test_the_sample_time_field_is_labelled(opened: Serve, page: Page) -> None:
    opened("wave.yaml", content="symofros_diagram: 1\nblocks: {wave: {kind: sine}}\n")
    steps.open_window(page, "blocks/wave")
    sample_time = page.get_by_label("Sample time", exact=True)
    row = steps.window(page).locator(".row").filter(has=sample_time)
    expect(row.locator(".row-unit")).to_have_text("s")
    expect(steps.window(page).get_by_text("Period", exact=True)).to_have_count(0)


def test_an_export_goes_to_a_folder_of_its_own(arm: Server, page: Page, tmp_path: Path) -> None:

    def export(kind: str, folder: str = "") -> None:
        steps.run(page, "Export…")
        steps.window(page).get_by_label(kind, exact=True).check()
        if folder:
            steps.fill(page, "Folder", folder)
        with steps.ended(page):
            steps.window(page).get_by_role("button", name="Export", exact=True).click()

    export("URDF")
    expect(steps.results(page)).to_contain_text("arm_urdf/")
    export("MJCF (MuJoCo)")
    expect(steps.results(page)).to_contain_text("arm_mjcf/")
    export("MJCF (MuJoCo)", "arm_urdf")
    expect(steps.results(page)).to_contain_text("holds another export, which would be removed")
    assert list((tmp_path / "arm_urdf").glob("*.urdf")) and list((tmp_path / "arm_mjcf").glob("*.xml"))
    export("URDF", "arm_urdf")  # The same again is written anew.
    expect(steps.results(page)).to_contain_text(".urdf")


def test_joints_of_several_coordinates_are_started_and_driven(opened: Serve, page: Page, tmp_path: Path) -> None:
    opened("free.yaml", content=FREE)
    steps.run(page, "Simulate…")
    typed = {
        "Duration": "0.2",
        "Start of top.yaw": "0.4",
        "Speed of top.wz": "0.5",
        "Start of craft.px": "2",
        "Speed of craft.vx": "3",
        "Start of craft.roll": "0.1",
        "Start of puck.x": "0.7",
        "Speed of puck.angle": "-1",
        "Formula of top.wx": "1",
        "Formula of puck.y": "sin(t)",
        "Formula of drum": "t^2/2",
        "Formula of ddrum": "t",
        "Formula of dddrum": "1",
    }
    for label, text in typed.items():
        steps.fill(page, label, text)
    with page.expect_request(lambda request: request.url.endswith("/api/jobs")) as asked:
        steps.window(page).get_by_role("button", name="Simulate", exact=True).click()
    expect(steps.results(page).get_by_text("s of computing")).to_be_visible(timeout=steps.JOB)
    expect(steps.results(page).locator(".bad")).to_have_count(0)
    options = asked.value.post_data_json["options"]
    assert options["inputs"] == {label.split()[-1]: text for label, text in typed.items() if "Formula" in label}
    assert options["v0"] == {"top.wz": 0.5, "craft.vx": 3, "puck.angle": -1}
    for joint in ("top", "craft"):
        assert sum(options["q0"][f"{joint}.{part}"] ** 2 for part in ("qx", "qy", "qz", "qw")) == pytest.approx(1)


# All kinds of joints; rotors and friction; closures and springs; both conditions; beams; nested forms of inertia.
FILES = (
    "rigid/joint_zoo.yaml",
    "rigid/friction_arm.yaml",
    "closed/andrews_squeezer.yaml",
    "closed/sleigh.yaml",
    "closed/rolling_disc.yaml",
    "flexible/spinning_beam.yaml",
    "../tests/studio/editor/browser/blade.yaml",  # Rods off the centres of their sections.
)


@pytest.mark.parametrize("file", FILES)
def test_viewing_a_window_changes_nothing(opened: Serve, page: Page, file: str) -> None:
    opened("model.yaml", source=steps.MODELS / file)
    seen = page.locator(".react-flow__node, .react-flow__edge.closure, .react-flow__edge.connection")
    for index in range(seen.count()):
        steps.open_window(page, str(seen.nth(index).get_attribute("data-id")))
        tabs = steps.window(page).get_by_role("tab")
        for number in range(tabs.count()):
            tabs.nth(number).click()
            expect(steps.window(page).get_by_role("alert")).to_have_count(0)
        steps.accept(page)
    expect(page.get_by_role("button", name="Undo", exact=True)).to_be_disabled()


def test_coordinates_are_coupled_by_formula(opened: Serve, page: Page) -> None:
    server = opened("pair.yaml", source=steps.PENDULUM)
    page.get_by_role("button", name="Coupling…").click()
    expect(page.get_by_label("Name of a new entry of couplings of coordinates")).to_be_focused()
    page.keyboard.type("gear")
    page.keyboard.press("Enter")
    steps.window(page).get_by_label("Couplings of coordinates gear", exact=True).fill("q2 - 3*q1")
    steps.accept(page)
    steps.problems(page, 0)
    steps.saved(page)
    system = sf.load(server.file)
    assert [item.name for item in system.constraints] == ["gear"]
    # A coordinate that there is not: its problem leads back to the window that has it.
    page.get_by_role("button", name="Coupling…").click()
    steps.window(page).get_by_label("Couplings of coordinates gear", exact=True).fill("q2 - 3*q9")
    steps.accept(page)
    steps.problems(page, 1)
    page.get_by_role("banner").get_by_role("button", name="1 problem").click()
    steps.results(page).get_by_role("button", name="q9").click()
    expect(steps.window(page).get_by_label("Couplings of coordinates gear", exact=True)).to_have_value("q2 - 3*q9")


@pytest.mark.parametrize("how", ["a base that is a body", "the ground alone"])
def test_gravity_is_in_the_window_of_the_ground(opened: Serve, page: Page, how: str) -> None:
    server = opened("pair.yaml", source=steps.PENDULUM)
    if how == "a base that is a body":
        page.get_by_role("button", name="Base", exact=True).click()
        expect(steps.block(page, "world")).to_contain_text("ground")
    steps.open_window(page, "world")
    steps.fill(page, "Gravity z", "-1.62")
    steps.accept(page)
    expect(steps.block(page, "world")).to_contain_text("[0, 0, -1.62]")
    steps.problems(page, 0)
    steps.saved(page)
    assert sf.load(server.file).gravity == (0.0, 0.0, -1.62)
