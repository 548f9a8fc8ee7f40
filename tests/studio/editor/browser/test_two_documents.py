"""Two documents, one after the other or in two pages: nothing of one reaches the other."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, Route, expect

from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Server
from tests.studio.waiting import at_rest, until

pytestmark = pytest.mark.browser

PENDULUM = Path(__file__).parents[4] / "reference_models" / "rigid" / "double_pendulum.yaml"
# The same names of bodies and parameters, so that what is meant for one could be taken by the other.
OTHER = PENDULUM.read_text().replace("mass: m2", "mass: 2*m2")
DRIVEN = """symofros: 1
inputs: {tau: {unit: N m}}
bodies:
  arm: {joint: {kind: revolute, name: q, effort: tau}, inertia: {mass: 1, moments: [1, 1, 1]}}
"""
JOB = 60_000


@pytest.fixture
def server(serve: Callable[..., Server], tmp_path: Path) -> Server:
    (tmp_path / "other.yaml").write_text(OTHER)
    return serve("arm.yaml", source=PENDULUM)


def open_file(page: Page, name: str) -> None:
    page.keyboard.press("Control+o")
    steps.window(page).get_by_label("Filter files").fill(name)
    page.keyboard.press("Enter")
    expect(page.get_by_role("heading", level=1)).to_contain_text(name)
    expect(steps.window(page)).to_have_count(0)


def new_file(page: Page, name: str) -> None:
    page.get_by_role("button", name="File", exact=True).click()
    page.get_by_role("menuitem", name="New…").click()
    steps.fill(page, "File", name)
    steps.window(page).get_by_role("button", name="Create").click()
    expect(page.get_by_role("heading", level=1)).to_contain_text(name)


def simulated(page: Page) -> None:
    steps.window(page).get_by_role("button", name="Simulate", exact=True).click()
    expect(page.get_by_role("dialog")).to_have_count(0)
    expect(steps.results(page).get_by_text("s of computing")).to_be_visible(timeout=JOB)


def test_laws_and_starts_are_of_one_document_and_of_its_names(
    serve: Callable[..., Server], page: Page, tmp_path: Path
) -> None:
    (tmp_path / "other.yaml").write_text(OTHER)
    server = serve("driven.yaml", content=DRIVEN)
    steps.open_editor(page, server.url)
    steps.run(page, "Simulate…")
    steps.fill(page, "Formula of t of tau", "sin(t)")
    steps.fill(page, "Start of q", "0.3")
    steps.fill(page, "Duration", "0.1")
    simulated(page)
    # A new name: the law follows.
    name = page.get_by_label("Name of tau", exact=True)
    name.fill("torque")
    name.press("Enter")
    steps.problems(page, 0)
    steps.run(page, "Simulate…")
    expect(steps.window(page).get_by_label("Formula of t of torque")).to_have_value("sin(t)")
    simulated(page)
    # An input that is gone: its law is left out, and said.
    page.locator("body").press("Control+z")
    expect(page.get_by_label("Name of tau", exact=True)).to_be_visible()
    steps.run(page, "Simulate…")
    left = steps.window(page).get_by_role("status")
    expect(left).to_contain_text("torque = sin(t)")
    simulated(page)
    steps.run(page, "Simulate…")
    left.get_by_role("button", name="Forget them").click()
    expect(left).to_have_count(0)
    steps.window(page).get_by_role("button", name="Clear starts and inputs").click()
    expect(steps.window(page).get_by_label("Start of q")).to_have_value("")
    steps.fill(page, "Start of q", "0.4")
    simulated(page)
    steps.saved(page)
    # Another document asks for itself, and the first one goes on where it was left.
    open_file(page, "other.yaml")
    expect(steps.results(page)).to_have_count(0)
    steps.run(page, "Simulate…")
    expect(steps.window(page).get_by_label("Duration")).to_have_value("5")
    expect(steps.window(page).get_by_role("status")).to_have_count(0)
    steps.fill(page, "Duration", "0.1")
    simulated(page)
    open_file(page, "driven.yaml")
    steps.run(page, "Simulate…")
    expect(steps.window(page).get_by_label("Start of q")).to_have_value("0.4")
    page.keyboard.press("Escape")
    new_file(page, "third.yaml")
    page.get_by_role("button", name="Rigid body", exact=True).click()
    expect(steps.block(page, "bodies/body")).to_be_visible()
    steps.run(page, "Simulate…")
    expect(steps.window(page).get_by_label("Duration")).to_have_value("5")
    expect(steps.window(page).get_by_label("Start of q")).to_have_value("")


def test_a_run_is_asked_for_by_document(serve: Callable[..., Server], page: Page, tmp_path: Path) -> None:
    source = (
        "symofros_diagram: 1\nblocks: {wave: {kind: sine}, seen: {kind: scope, signals: [y], inputs: {y: wave.y}}}\n"
    )
    (tmp_path / "second.yaml").write_text(source)
    server = serve("first.yaml", content=source)
    steps.open_editor(page, server.url)
    steps.run(page, "Run…")
    steps.fill(page, "End", "0.5")
    steps.window(page).get_by_role("button", name="Run").click()
    expect(steps.results(page).get_by_text("s of computing")).to_be_visible(timeout=JOB)
    open_file(page, "second.yaml")
    steps.run(page, "Run…")
    expect(steps.window(page).get_by_label("End", exact=True)).to_have_value("")


def test_a_run_that_ends_after_another_document_was_opened_is_not_shown_in_it(server: Server, page: Page) -> None:
    steps.open_editor(page, server.url)
    held: list[Route] = []
    page.route("**/api/jobs/*", lambda route: held.append(route))
    steps.run(page, "Compile")
    until(page, lambda: bool(held))
    open_file(page, "other.yaml")
    for route in held:
        route.continue_()
    page.unroute("**/api/jobs/*")
    page.wait_for_timeout(1500)
    expect(steps.results(page)).to_have_count(0)


def test_what_is_typed_when_another_document_is_opened_goes_to_neither(
    server: Server, page: Page, tmp_path: Path
) -> None:
    """Text that the server has not seen yet is sent before the document is left."""
    steps.open_editor(page, server.url)
    page.get_by_role("tab", name="YAML").click()
    page.get_by_label("Text of the file").click()
    page.keyboard.press("Control+Home")
    page.keyboard.type("# typed\n")
    page.keyboard.press("Control+o")  # Before the pause after which it is sent.
    steps.window(page).get_by_label("Filter files").fill("other.yaml")
    page.keyboard.press("Enter")
    expect(page.get_by_role("dialog", name="Unsaved changes")).to_be_visible()
    steps.window(page).get_by_role("button", name="Save").click()
    expect(page.get_by_role("heading", level=1)).to_contain_text("other.yaml")
    assert server.file.read_text() == f"# typed\n{PENDULUM.read_text()}"
    expect(page.get_by_label("Text of the file")).to_contain_text("2*m2")
    expect(page.get_by_label("Text of the file")).not_to_contain_text("# typed")
    expect(page.get_by_role("banner").get_by_text("unsaved")).to_have_count(0)


def test_what_is_typed_is_in_the_file_that_is_saved_at_once(server: Server, page: Page) -> None:
    steps.open_editor(page, server.url)
    page.get_by_role("tab", name="YAML").click()
    page.get_by_label("Text of the file").click()
    page.keyboard.press("Control+Home")
    page.keyboard.type("# typed\n")
    page.keyboard.press("Control+s")
    until(page, lambda: server.file.read_text() == f"# typed\n{PENDULUM.read_text()}")
    expect(page.get_by_role("banner").get_by_text("unsaved")).to_have_count(0)


@pytest.mark.parametrize("how", ["window", "field", "text", "move"])
def test_a_change_is_not_made_to_a_document_that_another_page_has_opened(
    server: Server, page: Page, chromium: Browser, tmp_path: Path, how: str
) -> None:
    other = chromium.new_page()
    for each in (page, other):
        steps.open_editor(each, server.url)

    def overtake(route: Route) -> None:
        """The other page opens another file before this change arrives."""
        open_file(other, "other.yaml")
        route.continue_()

    if how == "window":
        # Opened before: the window of a body that the other document has, too.
        steps.open_window(page, "bodies/upper")
        steps.fill(page, "Axis z", "0.5")
        open_file(other, "other.yaml")
        expect(page.get_by_role("heading", level=1)).to_contain_text("other.yaml")
        expect(steps.window(page)).to_have_count(0)
        expect(page.get_by_role("log")).to_contain_text("a window of arm.yaml was open here")
    elif how == "field":
        page.route("**/api/edit", overtake)
        value = page.get_by_label("Value of m1", exact=True)
        value.fill("2.5")
        value.press("Enter")
        expect(page.get_by_role("log")).to_contain_text("your last change was not made")
    elif how == "text":
        page.get_by_role("tab", name="YAML").click()
        page.route("**/api/text", overtake)
        page.get_by_label("Text of the file").click()
        page.keyboard.press("Control+Home")
        page.keyboard.type("# typed\n")
        expect(page.get_by_role("log")).to_contain_text("your last change was not made")
    else:
        page.route("**/api/layout", overtake)
        box = at_rest(steps.block(page, "bodies/lower"))
        page.mouse.move(box["x"] + 40, box["y"] + 8)
        page.mouse.down()
        page.mouse.move(box["x"] + 60, box["y"] + 40)
        page.mouse.move(box["x"] + 80, box["y"] + 72)
        page.mouse.up()
        expect(page.get_by_role("heading", level=1)).to_contain_text("other.yaml")
        page.wait_for_timeout(500)
        assert not (tmp_path / ".other.editor.json").exists()
    expect(page.get_by_role("heading", level=1)).to_contain_text("other.yaml")
    expect(page.get_by_role("banner").get_by_text("unsaved")).to_have_count(0)
    assert (tmp_path / "other.yaml").read_text() == OTHER
    other.close()
