"""A new user, with mouse and keyboard alone: an arm of two links, one a beam; a PD law around it; run, play, export."""

from __future__ import annotations

import re
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

import symofros as sf
from tests.exports.cases import build
from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Picture, Serve
from tests.studio.pictures import changed
from tests.studio.waiting import at_rest

pytestmark = pytest.mark.browser


@contextmanager
def action(name: str) -> Iterator[None]:
    """Prints how long an action takes; shown by `-s`, kept in docs/editor.md."""
    began = time.perf_counter()
    yield
    print(f"{name}: {time.perf_counter() - began:.1f} s")


def put(page: Page, title: str, into: str) -> None:
    """Choose an entry of a diagram's palette, and name it."""
    page.get_by_label("Find a block").fill(title)
    page.get_by_role("button", name=title, exact=True).click()
    expect(steps.block(page, into)).to_be_visible()


def actuate(page: Page) -> None:
    steps.tab(page, "Forces")
    steps.window(page).get_by_label("Actuated").check()


def turn_about_z(page: Page) -> None:
    """The arm moves in a horizontal plane, in which its beam bends."""
    for axis, value in zip("xyz", "001", strict=True):
        steps.fill(page, f"Axis {axis}", value)


def draw_the_arm(page: Page, picture: Picture) -> None:
    page.get_by_role("button", name="Rigid body", exact=True).drag_to(
        page.locator(".react-flow__pane"), target_position={"x": 260, "y": 180}
    )
    steps.open_window(page, "bodies/body")
    steps.fill(page, "Name", "upper")
    turn_about_z(page)
    steps.tab(page, "Inertia")
    steps.window(page).get_by_label("Inertia by").select_option("solid")
    steps.fill(page, "Density", "1200")
    steps.window(page).get_by_label("Shape", exact=True).select_option("cylinder")
    expect(steps.window(page).get_by_label("X", exact=True)).to_have_count(0)  # A size of the box.
    steps.fill(page, "Radius", "0.02")
    steps.fill(page, "Length", "1")
    steps.window(page).get_by_label("Axis", exact=True).select_option("x")
    picture("solid")
    actuate(page)
    steps.accept(page)
    steps.block(page, "bodies/upper").click()
    page.get_by_role("button", name="Flexible beam", exact=True).click()
    steps.open_window(page, "bodies/beam")
    steps.fill(page, "Name", "fore")
    bending = {"Shape functions along y": "2", "Shape functions along z": "", "EI_y": "", "EI_z": "100"}
    for field, text in bending.items():
        steps.fill(page, field, text)
    steps.tab(page, "Joint")
    steps.window(page).get_by_label("Kind", exact=True).select_option("revolute")
    turn_about_z(page)
    actuate(page)
    steps.accept(page)
    steps.problems(page, 0)
    steps.saved(page)


def draw_the_law(page: Page) -> None:
    """A law reads the motors' entries of the arm's state: elastic coordinates are among the others."""
    put(page, "Model", "models/model")
    put(page, "forward dynamics", "blocks/forward_dynamics")
    for name, of in (("angles", "q"), ("rates", "v")):
        put(page, "pick", "blocks/pick")
        steps.open_window(page, "blocks/pick")
        steps.fill(page, "Name", name)
        steps.fill(page, "Entries", "actuated")
        steps.window(page).get_by_label("Model", exact=True).select_option("model")
        steps.fill(page, "Of", of)
        feed(page, "u", f"forward_dynamics.{of}")
        steps.accept(page)
    put(page, "constant", "blocks/constant")
    steps.open_window(page, "blocks/constant")
    steps.fill(page, "Value", "[0.6, -0.4]")
    steps.accept(page)
    put(page, "joint pd", "blocks/joint_pd")
    steps.open_window(page, "blocks/joint_pd")
    steps.fill(page, "Proportional gain", "[60, 20]")
    steps.fill(page, "Derivative gain", "[16, 4]")
    feed(page, "q_desired", "constant.y")
    feed(page, "q", "angles.y")
    feed(page, "v", "rates.y")
    steps.accept(page)
    # The last one with the mouse: from port to port.
    with page.expect_response(lambda answer: answer.url.endswith("/api/layout")):
        page.get_by_role("button", name="Arrange the blocks").click()
    output = steps.port(page, "output effort of joint_pd")
    at_rest(output)
    output.drag_to(steps.port(page, "input u of forward_dynamics"))
    expect(steps.wire(page, "blocks/forward_dynamics/inputs/u")).to_have_count(1)
    steps.problems(page, 0)
    steps.saved(page)


def feed(page: Page, name: str, source: str) -> None:
    """Choose what feeds an input, in the window of its block."""
    steps.window(page).get_by_label(f"Source of {name}", exact=True).select_option(source)


@pytest.mark.slow
def test_a_new_user_builds_plays_and_exports_a_controlled_arm(
    serve: Serve, page: Page, picture: Picture, tmp_path: Path
) -> None:
    server = serve("arm.yaml")
    with action("open the page"):
        steps.open_editor(page, server.url)
    with action("draw the arm: a rigid link, a beam, two motors"):
        draw_the_arm(page, picture)
    with action("begin a diagram"):
        steps.new_file(page, "held.yaml", "diagram")
    with action("draw the law: a model, five blocks, six wires"):
        draw_the_law(page)
    picture("new-user-law")

    with action("run it for 3 s"):
        steps.job(page, "Run", End="3")
    with action("see it in three dimensions"):
        still = steps.open_view(page)
        pose = page.get_by_role("group", name="Pose")
        expect(pose.get_by_label("q1 [rad]")).to_have_value("0")
    with action("play it at five times its speed"):
        page.get_by_label("Speed").select_option("5")
        steps.results(page).get_by_role("button", name="Play").click()
        expect(steps.results(page).get_by_role("button", name="Play")).to_be_visible(timeout=steps.JOB)
        # Where the law holds it, to a step of the slider.
        expect(pose.get_by_label("q1 [rad]")).to_have_value(re.compile(r"^0\.(59|60|61)"))
    changed(page, still)
    picture("new-user-played")

    with action("export C"):
        steps.run(page, "Export…")
        steps.fill(page, "Folder", "program")
        steps.window(page).get_by_role("button", name="Export").click()
        expect(steps.results(page).get_by_text("program/main.c")).to_be_visible(timeout=steps.JOB)
    # What was exported is a program that tells the same end.
    run = sf.Simulation(sf.load_diagram(tmp_path / "held.yaml")).run(3.0)
    reported = subprocess.run([build(tmp_path / "program", "program"), "3", "3"], capture_output=True, text=True)
    end = [float(x) for x in reported.stdout.splitlines()[-1].split(",")]
    assert end[1:] == pytest.approx([*run.q[-1], *run.v[-1]], abs=1e-7)
