"""Two documents, one after the other or in two pages: nothing of one reaches the other."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, Route, expect

from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Serve, Server
from tests.studio.waiting import at_rest, until

pytestmark = pytest.mark.browser

# The same names of bodies and parameters, so that what is meant for one could be taken by the other.
OTHER = steps.PENDULUM.read_text().replace("mass: m2", "mass: 2*m2")
DRIVEN = """symofros: 1
inputs: {tau: {unit: N m}}
bodies:
  arm: {joint: {kind: revolute, name: q, effort: tau}, inertia: {mass: 1, moments: [1, 1, 1]}}
"""
WAVE = "symofros_diagram: 1\nblocks: {wave: {kind: sine}, seen: {kind: scope, signals: [y], inputs: {y: wave.y}}}\n"


@pytest.fixture(autouse=True)
def beside(tmp_path: Path) -> Path:
    """The other document."""
    (tmp_path / "other.yaml").write_text(OTHER)
    return tmp_path / "other.yaml"


def simulated(page: Page, **typed: str) -> None:
    steps.job(page, "Simulate", Duration="0.1", **typed)


def test_laws_and_starts_are_of_one_document_and_of_its_names(opened: Serve, page: Page) -> None:
    opened("driven.yaml", content=DRIVEN)
    simulated(page, Formula_of_tau="sin(t)", Start_of_q="0.3")
    # A new name: the law follows.
    name = page.get_by_label("Name of tau", exact=True)
    name.fill("torque")
    name.press("Enter")
    steps.problems(page, 0)
    steps.run(page, "Simulate…")
    expect(steps.window(page).get_by_label("Formula of torque")).to_have_value("sin(t)")
    page.keyboard.press("Escape")
    # An input that is gone: its law is left out, and said.
    page.locator("body").press("Control+z")
    expect(page.get_by_label("Name of tau", exact=True)).to_be_visible()
    steps.run(page, "Simulate…")
    left = steps.window(page).get_by_role("status")
    expect(left).to_contain_text("torque = sin(t)")
    left.get_by_role("button", name="Forget them").click()
    expect(left).to_have_count(0)
    steps.window(page).get_by_role("button", name="Clear starts and inputs").click()
    expect(steps.window(page).get_by_label("Start of q")).to_have_value("")
    page.keyboard.press("Escape")
    simulated(page, Start_of_q="0.4")
    steps.saved(page)
    # Another document asks for itself, and the first one goes on where it was left.
    steps.open_file(page, "other.yaml")
    expect(steps.results(page)).to_have_count(0)
    steps.run(page, "Simulate…")
    expect(steps.window(page).get_by_label("Duration")).to_have_value("5")
    expect(steps.window(page).get_by_role("status")).to_have_count(0)
    page.keyboard.press("Escape")
    steps.open_file(page, "driven.yaml")
    steps.run(page, "Simulate…")
    expect(steps.window(page).get_by_label("Start of q")).to_have_value("0.4")


@pytest.mark.parametrize(("command", "field", "text"), [("Simulate…", "Formula", "sin(t)"), ("Analyse…", "Value", "2")])
def test_a_window_opened_before_a_new_name_is_answered_follows_it(
    opened: Serve, page: Page, command: str, field: str, text: str
) -> None:
    opened("driven.yaml", content=DRIVEN)
    steps.run(page, command)
    steps.fill(page, f"{field} of tau", text)
    steps.window(page).get_by_role("button", name=command.rstrip("…"), exact=True).click()
    held: list[Route] = []
    page.route("**/api/edit", lambda route: held.append(route))
    name = page.get_by_label("Name of tau", exact=True)
    name.fill("torque")
    name.press("Enter")
    until(page, lambda: bool(held))
    steps.run(page, command)
    expect(steps.window(page).get_by_label(f"{field} of tau")).to_have_value(text)
    for route in held:
        route.continue_()
    expect(steps.window(page).get_by_label(f"{field} of torque")).to_have_value(text)
    expect(steps.window(page).get_by_role("status")).to_have_count(0)


def test_a_run_is_asked_for_by_document(opened: Serve, page: Page, beside: Path) -> None:
    beside.write_text(WAVE)
    opened("first.yaml", content=WAVE)
    steps.job(page, "Run", End="0.5")
    steps.open_file(page, beside.name)
    steps.run(page, "Run…")
    expect(steps.window(page).get_by_label("End", exact=True)).to_have_value("")


def test_results_are_not_shown_in_a_document_opened_later(arm: Server, page: Page) -> None:
    held: list[Route] = []
    page.route("**/api/jobs/*", lambda route: held.append(route))
    steps.run(page, "Compile")
    until(page, lambda: bool(held))
    steps.open_file(page, "other.yaml")
    for route in held:
        route.continue_()
    page.unroute("**/api/jobs/*")
    page.wait_for_timeout(1500)
    expect(steps.results(page)).to_have_count(0)


@pytest.mark.parametrize("key", ["Control+o", "Control+s"])
def test_typed_text_goes_to_its_own_file(arm: Server, page: Page, key: str) -> None:
    """Text that the server has not seen yet is sent before the document is left, or saved."""
    steps.type_at_the_head(page, "# typed\n")
    page.keyboard.press(key)  # Before the pause after which it is sent.
    if key == "Control+o":
        steps.window(page).get_by_label("Filter files").fill("other.yaml")
        page.keyboard.press("Enter")
        expect(page.get_by_role("dialog", name="Unsaved changes")).to_be_visible()
        steps.window(page).get_by_role("button", name="Save").click()
        expect(page.get_by_role("heading", level=1)).to_contain_text("other.yaml")
        expect(page.get_by_label("Text of the file")).to_contain_text("2*m2")
        expect(page.get_by_label("Text of the file")).not_to_contain_text("# typed")
    until(page, lambda: arm.file.read_text() == f"# typed\n{steps.PENDULUM.read_text()}")
    expect(page.get_by_role("banner").get_by_text("unsaved")).to_have_count(0)


def in_a_window(page: Page, overtake: Callable[[], None]) -> str:
    """Properties, in a window, of a body that the other document has, too."""
    steps.open_window(page, "bodies/upper")
    steps.fill(page, "Axis z", "0.5")
    overtake()
    expect(page.get_by_role("heading", level=1)).to_contain_text("other.yaml")
    expect(steps.window(page)).to_have_count(0)
    return "a window of arm.yaml was open here"


def in_a_field(page: Page, _: object) -> str:
    steps.set_parameter(page, "m1", "2.5")
    return "your last change was not made"


def in_the_text(page: Page, _: object) -> str:
    steps.type_at_the_head(page, "# typed\n")
    return "your last change was not made"


def in_the_picture(page: Page, _: object) -> str:
    box = at_rest(steps.block(page, "bodies/lower"))
    page.mouse.move(box["x"] + 40, box["y"] + 8)
    page.mouse.down()
    page.mouse.move(box["x"] + 60, box["y"] + 40)
    page.mouse.move(box["x"] + 80, box["y"] + 72)
    page.mouse.up()
    return ""


WAYS = {in_a_window: "nothing", in_a_field: "edit", in_the_text: "text", in_the_picture: "layout"}


@pytest.mark.parametrize("change", WAYS, ids=lambda way: way.__name__)
def test_a_change_is_not_made_to_a_document_that_another_page_has_opened(
    arm: Server, page: Page, other: Page, beside: Path, change: Callable[[Page, Callable[[], None]], str]
) -> None:
    def overtake(route: Route | None = None) -> None:
        """The other page opens another file before this change arrives."""
        steps.open_file(other, "other.yaml")
        if route is not None:
            route.continue_()

    page.route(f"**/api/{WAYS[change]}", overtake)
    if said := change(page, overtake):
        expect(page.get_by_role("log")).to_contain_text(said)
    expect(page.get_by_role("heading", level=1)).to_contain_text("other.yaml")
    page.wait_for_timeout(500)
    assert not beside.with_name(".other.editor.json").exists()
    expect(page.get_by_role("banner").get_by_text("unsaved")).to_have_count(0)
    assert beside.read_text() == OTHER
