"""Windows say what the file says: to open one and accept it changes nothing, whatever is in it."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

import symofros as sf
from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Serve

pytestmark = pytest.mark.browser

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
def test_a_window_that_is_only_looked_at_changes_nothing(opened: Serve, page: Page, file: str) -> None:
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
    steps.fill(page, "Name of a new entry of couplings of coordinates", "gear")
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
