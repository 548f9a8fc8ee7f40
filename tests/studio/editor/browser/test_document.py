"""Undo, redo, save, two pages on one document, a file that somebody else writes, a server that dies."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Page, Route, expect

from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Picture, Serve, Server
from tests.studio.waiting import at_rest, until

pytestmark = pytest.mark.browser


def test_unchanged_parts_of_the_file_keep_their_bytes(serve: Serve, page: Page) -> None:
    server = serve("arm.yaml", source=steps.PENDULUM)
    before = server.file.read_bytes()
    steps.open_editor(page, server.url)
    steps.set_parameter(page, "m2", "9.0e-1")
    steps.has_value(page, "m2", "0.9")
    steps.open_window(page, "bodies/upper")
    steps.fill(page, "Axis z", "1.0e-3")
    steps.accept(page)
    steps.saved(page)
    changed = before.replace(b"m2: {value: 0.7,", b"m2: {value: 9.0e-1,")
    assert server.file.read_bytes() == changed.replace(b"axis: [0, 1, 0]", b"axis: [0, 1, 1.0e-3]", 1)
    page.reload()
    page.wait_for_selector(".react-flow__node")
    steps.has_value(page, "m2", "0.9")
    steps.set_parameter(page, "m2", "0.7")
    steps.has_value(page, "m2", "0.7")
    steps.open_window(page, "bodies/upper")
    steps.fill(page, "Axis z", "0")
    steps.accept(page)
    steps.saved(page)
    assert server.file.read_bytes() == before


def test_a_dropped_file_is_imported(arm: Server, page: Page) -> None:
    text = steps.PENDULUM.read_text().replace("upper", "boom")
    files = page.evaluate_handle(
        """text => {
            const given = new DataTransfer();
            given.items.add(new File([text], "dropped.yaml"));
            return given;
        }""",
        text,
    )
    page.dispatch_event(".react-flow__pane", "drop", {"dataTransfer": files})
    expect(steps.block(page, "bodies/boom")).to_be_visible()
    expect(page.get_by_role("heading", level=1)).to_contain_text("unsaved")


def test_find_goes_to_a_block_and_enter_opens_it(arm: Server, page: Page, picture: Picture) -> None:
    page.keyboard.press("/")
    page.keyboard.type("elb")
    expect(steps.window(page).get_by_role("option")).to_have_count(1)
    picture("find")
    page.keyboard.press("Enter")
    expect(steps.window(page)).to_have_count(0)
    expect(steps.block(page, "bodies/upper")).to_contain_class("selected")
    page.keyboard.press("Enter")
    expect(page.get_by_role("dialog", name="Body upper")).to_be_visible()


def test_text_and_diagram_stay_in_step(arm: Server, page: Page, picture: Picture) -> None:
    page.get_by_role("tab", name="YAML").click()
    text = page.get_by_label("Text of the file")
    line = text.locator(".cm-line", has_text="moments: [m2*r^2/2")
    line.click()
    page.keyboard.press("End")
    page.keyboard.press("Backspace")
    steps.problems(page, 1)
    page.keyboard.press("Home")
    page.keyboard.press("Home")
    picture("text")
    page.get_by_role("banner").get_by_role("button", name="1 problem").click()
    expect(steps.results(page)).to_contain_text("the text is not YAML")
    text.click()
    page.keyboard.press("Control+z")
    steps.problems(page, 0)
    page.get_by_role("button", name="Rigid body", exact=True).click()
    expect(text).to_contain_text("body:")


@pytest.mark.parametrize("how", ["edit", "text"])
def test_a_stale_change_is_made_again_on_the_newest_document(arm: Server, page: Page, other: Page, how: str) -> None:
    stale: list[int] = []

    def overtake(route: Route) -> None:
        """The other page is quicker: the first request comes too late."""
        if not stale:
            steps.set_parameter(other, "m1", "2.5")
            steps.autosaved(other)
        stale.append(route.request.post_data_json["revision"])
        route.continue_()

    page.route(f"**/api/{how}", overtake)
    if how == "edit":
        steps.set_parameter(page, "L1", "0.6")
    else:
        page.get_by_role("tab", name="YAML").click()
        page.get_by_label("Text of the file").locator(".cm-line", has_text="unit: m, description").click()
        page.keyboard.press("Home")
        page.keyboard.type("L3: 0.6\n")  # The next line is indented by itself.
        expect(page.get_by_label("Text of the file")).to_contain_text("value: 2.5, unit: kg")
        page.get_by_role("tab", name="Parameters").click()
    steps.has_value(page, "L1" if how == "edit" else "L3", "0.6")
    steps.has_value(page, "m1", "2.5")
    until(page, lambda: len(stale) == 2, "the change is not made again")
    assert stale[0] < stale[1]


def test_a_value_typed_while_a_name_is_on_its_way_goes_to_the_new_name(arm: Server, page: Page) -> None:
    held: list[Route] = []
    page.route("**/api/edit", lambda route: held.append(route), times=1)
    page.get_by_label("Name of m1", exact=True).fill("mass")
    page.keyboard.press("Tab")
    page.keyboard.type("2.5")
    until(page, lambda: len(held) == 1, "the name is not sent")
    page.keyboard.press("Enter")
    held[0].continue_()
    steps.has_value(page, "mass", "2.5")
    expect(page.get_by_label("Value of mass", exact=True)).to_be_focused()
    expect(page.get_by_label("Value of m1", exact=True)).to_have_count(0)
    steps.saved(page)
    assert "mass: {value: 2.5" in arm.file.read_text()


def test_a_file_that_somebody_else_wrote_is_not_overwritten_unseen(arm: Server, page: Page, picture: Picture) -> None:
    steps.set_parameter(page, "m1", "2.5")
    steps.has_value(page, "m1", "2.5")
    theirs = arm.file.read_text().replace("value: 0.5, unit: m", "value: 0.8, unit: m")
    arm.file.write_text(theirs)
    page.locator("body").press("Control+s")
    expect(page.get_by_role("dialog", name="The file has changed on disk")).to_be_visible()
    picture("conflict")
    assert arm.file.read_text() == theirs
    steps.window(page).get_by_role("button", name="Take the text on disk").click()
    steps.has_value(page, "L1", "0.8")
    steps.has_value(page, "m1", "1")
    page.keyboard.press("Control+z")
    steps.has_value(page, "m1", "2.5")
    page.locator("body").press("Control+s")
    steps.window(page).get_by_role("button", name="Overwrite it").click()
    expect(steps.window(page)).to_have_count(0)
    assert "value: 2.5" in arm.file.read_text()


def test_work_survives_a_server_that_is_killed(serve: Serve, page: Page, picture: Picture) -> None:
    server = serve("arm.yaml", source=steps.PENDULUM)
    before = server.file.read_text()
    steps.open_editor(page, server.url)
    steps.set_parameter(page, "m1", "2.5")
    steps.has_value(page, "m1", "2.5")
    steps.autosaved(page)
    steps.open_window(page, "bodies/upper")
    steps.fill(page, "Name", "boom")
    server.kill()
    steps.window(page).get_by_role("button", name="OK").click()
    expect(page.get_by_text("The server does not answer")).to_be_visible()
    picture("lost")

    # The same window, with what was typed, goes on with the new server.
    again = serve("arm.yaml", port=server.port)
    assert again.file.read_text() == before
    expect(page.get_by_text("The server does not answer")).to_have_count(0, timeout=20_000)
    expect(page.get_by_text("Unsaved work of an earlier run")).to_be_visible()
    picture("recovered")
    steps.accept(page)
    expect(steps.block(page, "bodies/boom")).to_be_visible()
    steps.has_value(page, "m1", "2.5")
    page.get_by_role("button", name="Save it").click()
    expect(page.get_by_text("Unsaved work of an earlier run")).to_have_count(0)
    assert "boom:" in again.file.read_text() and "value: 2.5" in again.file.read_text()


def test_recovered_work_asks_before_it_overwrites_a_file_that_was_changed_meanwhile(
    opened: Serve, serve: Serve, page: Page
) -> None:
    server = opened("arm.yaml", source=steps.PENDULUM)
    steps.set_parameter(page, "m1", "2.5")
    steps.has_value(page, "m1", "2.5")
    steps.autosaved(page)
    server.kill()
    theirs = server.file.read_text().replace("value: 0.5, unit: m", "value: 0.8, unit: m")
    server.file.write_text(theirs)

    again = serve("arm.yaml")
    steps.open_editor(page, again.url)
    expect(page.get_by_text("Unsaved work of an earlier run")).to_be_visible()
    expect(page.get_by_text("Somebody else has written the file")).to_be_visible()
    page.get_by_role("button", name="Save it").click()
    expect(page.get_by_role("dialog", name="The file has changed on disk")).to_be_visible()
    assert again.file.read_text() == theirs
    steps.window(page).get_by_role("button", name="Overwrite it").click()
    expect(steps.window(page)).to_have_count(0)
    assert "value: 2.5" in again.file.read_text()
    expect(page.get_by_text("Somebody else has written the file")).to_have_count(0)


def test_a_new_token_is_asked_for(opened: Serve, serve: Serve, page: Page) -> None:
    server = opened("arm.yaml", source=steps.PENDULUM)
    server.kill()
    serve("arm.yaml", port=server.port, token="another")
    expect(page.get_by_text("The server was started anew")).to_be_visible(timeout=20_000)


def test_a_problem_leads_to_its_field(opened: Serve, page: Page, tmp_path: Path, picture: Picture) -> None:
    source = tmp_path / "wrong.txt"
    source.write_text(
        steps.PENDULUM.read_text().replace("mass: m2,", "mass: m3,").replace("frame: elbow", "frame: elbov")
    )
    opened("arm.yaml", source=source)
    steps.problems(page, 2)
    expect(page.get_by_role("button", name="Compile")).to_be_disabled()
    page.get_by_role("button", name="2 problems").click()
    picture("problems")
    steps.results(page).get_by_role("button", name="elbov").click()
    expect(page.get_by_role("dialog", name="Body lower")).to_be_visible()
    expect(steps.window(page).get_by_role("alert")).to_contain_text("elbow")
    steps.tab(page, "Inertia")
    expect(steps.window(page).get_by_role("alert")).to_contain_text("unknown symbol 'm3'")


def test_work_that_cannot_be_stored_is_reported(serve: Serve, page: Page) -> None:
    server = serve("arm.yaml", source=steps.PENDULUM)
    fault = {"object": "autosave", "found": "the disk is full", "rule": "it is kept", "remedy": "make room"}
    page.route("**/api/document", lambda route: route.fulfill(json={**route.fetch().json(), "unkept": fault}))
    steps.open_editor(page, server.url)
    expect(page.get_by_role("alert")).to_contain_text("the disk is full. make room")


def test_outdated_results_are_marked_and_unreadable_parts_stay_visible(arm: Server, page: Page) -> None:
    steps.run(page, "Compile")
    expect(steps.results(page)).to_contain_text("Operations of a call", timeout=60_000)
    expect(steps.results(page)).not_to_contain_text("The model has changed since")
    unit = page.get_by_label("Unit of m2", exact=True)
    unit.fill("bananas")
    unit.press("Enter")
    expect(unit).to_have_attribute("aria-invalid", "true")
    expect(unit).to_have_attribute("title", re.compile("no such unit: 'bananas'"))
    unit.fill("kg")
    unit.press("Enter")
    expect(unit).to_have_attribute("aria-invalid", "false")
    value = page.get_by_label("Value of m2", exact=True)
    value.fill("0,5")
    value.press("Enter")
    steps.problems(page, 1)
    expect(value).to_have_value("0,5")
    expect(steps.results(page)).to_contain_text("The model has changed since")
    value.fill("0.5")
    value.press("Enter")
    steps.problems(page, 0)
    with steps.ended(page):
        steps.run(page, "Compile")
    expect(steps.results(page)).to_contain_text("Operations of a call")
    expect(steps.results(page)).not_to_contain_text("The model has changed since")


def test_moves_of_blocks_are_undone_in_turn_with_edits(arm: Server, page: Page) -> None:
    lower = steps.block(page, "bodies/lower")

    def place() -> tuple[int, int]:
        box = at_rest(lower)
        return round(box["x"]), round(box["y"])

    first = x, y = place()
    page.mouse.move(x + 40, y + 8)
    page.mouse.down()
    page.mouse.move(x + 72, y + 40)
    page.mouse.move(x + 104, y + 72)
    page.mouse.up()
    second = place()
    assert second != first
    steps.set_parameter(page, "m1", "1.5")
    for name, there in (("change m1", second), ("move lower", first)):
        page.get_by_role("button", name=f"Undo: {name}").click()
        until(page, lambda there=there: place() == there)
    expect(page.get_by_role("button", name="Undo", exact=True)).to_be_disabled()
    for name in ("move lower", "change m1"):
        page.get_by_role("button", name=f"Redo: {name}").click()
        expect(page.get_by_role("button", name=f"Undo: {name}")).to_be_enabled()
        until(page, lambda: place() == second)
    steps.has_value(page, "m1", "1.5")


def test_a_run_is_cancelled_from_a_page_that_was_loaded_again(arm: Server, page: Page) -> None:
    """A run of a million seconds, by mistake, whose tab is closed: the next page shows it, and can end it."""
    steps.run(page, "Simulate…")
    steps.fill(page, "Duration", "1e6")
    steps.window(page).get_by_role("button", name="Simulate", exact=True).click()
    expect(page.get_by_role("contentinfo")).to_contain_text("s of 1e+06 s", timeout=steps.JOB)
    steps.open_editor(page, arm.url)
    page.get_by_role("contentinfo").get_by_role("button", name="Cancel").click()
    expect(page.get_by_role("contentinfo").get_by_role("button", name="Cancel")).to_have_count(0)
    steps.job(page, "Simulate", Duration="0.1")
