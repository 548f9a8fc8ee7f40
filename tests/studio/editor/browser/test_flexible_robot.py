"""The paper's planar flexible robot: made rigid in its windows, compiled anew, cross-checked."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page, expect

from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Faults, Picture, Serve

pytestmark = pytest.mark.browser

JOB = 120_000


@pytest.mark.slow
def test_beams_become_rigid_and_the_engines_agree(opened: Serve, page: Page, picture: Picture) -> None:
    server = opened("robot.yaml", source=steps.ROBOT)
    picture("robot")
    steps.run(page, "Compile")
    expect(steps.results(page)).to_contain_text("nq 10", timeout=JOB)

    for beam in ("link1", "link2"):
        steps.open_window(page, f"bodies/{beam}")
        curves = steps.window(page).get_by_role("img", name="3 shape functions")
        expect(curves.locator("path.series")).to_have_count(3)
        if beam == "link1":
            picture("beam")
        steps.fill(page, "Shape functions along y", "0")
        expect(steps.window(page)).to_contain_text("the beam is rigid")
        steps.accept(page)
        expect(steps.block(page, f"bodies/{beam}")).to_contain_text("rigid")

    steps.run(page, "Compile")
    expect(steps.results(page)).to_contain_text("nq 4", timeout=JOB)
    steps.run(page, "Cross-check")
    expect(steps.results(page)).to_contain_text("All engines agree", timeout=JOB)
    expect(steps.results(page).get_by_text("pinocchio").first).to_be_visible()
    picture("cross-check")

    steps.saved(page)
    before, after = steps.ROBOT.read_text().splitlines(), server.file.read_text().splitlines()
    changed = [(old, new) for old, new in zip(before, after, strict=True) if old != new]
    assert [new for _, new in changed] == [old.replace("bend_y: 3", "bend_y: 0") for old, _ in changed]
    assert len(changed) == 2


def test_a_beam_is_stated_by_material_and_shape_and_shows_its_frequencies(opened: Serve, page: Page) -> None:
    opened("pendulum.yaml", source=steps.ROBOT.with_name("flexible_pendulum.yaml"))
    steps.open_window(page, "bodies/rod")
    figures = steps.window(page).get_by_role("status", name="What the section brings")
    expect(figures).to_contain_text("Hz")
    steps.window(page).get_by_label("stated by").select_option("shape")
    expect(figures).to_contain_text("rhoA 0.27 kg/m")
    steps.fill(page, "Density", "5400")
    expect(figures).to_contain_text("rhoA 0.54 kg/m")
    expect(figures).to_contain_text("bending along y 11.63")
    steps.accept(page)
    steps.problems(page, 0)


def test_how_far_its_theory_reaches_is_shown_on_the_beam(
    opened: Serve, page: Page, picture: Picture, faults: Faults
) -> None:
    text = steps.ROBOT.with_name("flexible_pendulum.yaml").read_text()
    opened("pendulum.yaml", content=text.replace("value: 20.0", "value: 0.25"))
    # In its window, before anything has moved.
    steps.open_window(page, "bodies/rod")
    figures = steps.window(page).get_by_role("status", name="What the section brings")
    expect(figures).to_contain_text("Its theory errs by 1 % at 0.099 m (0.15 rad)")
    page.keyboard.press("Escape")
    # After a run: beside the curves, on the block, in the window.
    steps.job(page, "Simulate", Start_of_swing="1.2", Duration="0.3")
    beams = steps.results(page).get_by_role("table", name="Beams where their theory errs most")
    expect(beams).to_be_visible(timeout=JOB)
    expect(beams.get_by_role("row", name="rod")).to_contain_text("% of its deflection")
    expect(steps.results(page)).to_contain_text("second-order theory errs by about")  # The run's own note.
    badge = steps.block(page, "bodies/rod").locator(".block-theory")
    expect(badge).to_have_text(re.compile(r"^± \d+(\.\d)? %$"))
    picture("beam-theory")
    assert faults() == []
    steps.open_window(page, "bodies/rod")
    expect(figures).to_contain_text("In the newest simulation beam 'rod' bends by")
    page.keyboard.press("Escape")
    # A pose says the same of itself, whatever the picture exaggerates.
    page.get_by_role("tab", name="3-D").click()
    theory = page.get_by_role("group", name="Theory of the beams")
    page.get_by_role("slider", name="exaggeration").fill("40")
    expect(theory).to_have_count(0)  # It is straight.
    instant = beams.get_by_role("row", name="rod").inner_text().partition("t = ")[2].split(" s")[0]
    steps.results(page).get_by_role("slider", name="Time [s]").fill(instant)
    expect(theory).to_contain_text("beam 'rod' bends by", timeout=JOB)
    # Once the model is another one, nothing is said of it.
    steps.open_window(page, "bodies/rod")
    steps.fill(page, "Length", "1.1")
    steps.accept(page)
    expect(badge).to_have_count(0)


def test_a_job_is_cancelled(opened: Serve, page: Page) -> None:
    opened("robot.yaml", source=steps.ROBOT)
    steps.run(page, "Cross-check")
    steps.results(page).get_by_role("button", name="Cancel").click()
    expect(steps.results(page)).to_contain_text("Cancelled")
    expect(page.get_by_role("button", name="Cross-check")).to_be_enabled()
