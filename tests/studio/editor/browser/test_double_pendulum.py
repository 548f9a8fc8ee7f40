"""From an empty canvas to a motion: what a first user does."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

import symofros as sf
from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Picture, Serve

pytestmark = pytest.mark.browser


def test_a_double_pendulum_from_an_empty_canvas(opened: Serve, page: Page, picture: Picture) -> None:
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
