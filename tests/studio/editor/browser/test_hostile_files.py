"""Files that can't be read, or say anything but a model: the page shows why, and the text can be mended there."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.description.hostile.test_hostile import CASES
from tests.models import sampled
from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Serve
from validation.studies.fuzz_inputs import corpus, mutated

pytestmark = pytest.mark.browser

SOUND = "symofros: 1\nbodies: {a: {joint: {kind: fixed}}}\n"
# Text -> the line where its problem is shown; 0: none.
UNREADABLE = {
    "": 0,
    "symofros: 1\n\tbodies: {}\n": 2,
    "symofros: 1\nbodies: {\n": 3,
    "\x00\x01\x02binary": 0,
    "- 1\n- 2\n": 1,
    "a word\n": 1,
    "~\n": 1,
}
LARGEST = 1 << 20  # What the editor takes.


@pytest.mark.parametrize("text", UNREADABLE)
def test_unreadable_files_are_shown_with_their_problem_and_can_be_mended(
    serve: Serve, page: Page, tmp_path: Path, text: str
) -> None:
    (tmp_path / "wrong.yaml").write_text(text)
    server = serve("wrong.yaml")
    for go in (lambda: page.goto(server.url), page.reload):  # A reload opens the same file.
        go()
        steps.problems(page, 1)
        shown = steps.results(page)
        expect(shown).to_contain_text("found:")
        if UNREADABLE[text]:
            expect(shown).to_contain_text(f"line {UNREADABLE[text]}")
        expect(page.get_by_label("Text of the file")).to_be_visible()
    page.get_by_label("Text of the file").click()
    page.keyboard.press("Control+a")
    page.keyboard.press("Delete")
    page.keyboard.insert_text(SOUND)
    expect(steps.block(page, "bodies/a")).to_be_visible()
    steps.saved(page)
    assert (tmp_path / "wrong.yaml").read_text() == SOUND


def hostile() -> dict[str, bytes]:
    """Name of a file -> its bytes: what the readers are tried with, and seeded mutations of the corpus."""
    files = {
        f"{name.replace(' ', '_')}.yaml": text.encode()
        for name, (suffix, content, _) in CASES.items()
        if suffix == "yaml" and len(text := content()) < LARGEST
    }
    files |= {f"corpus{i}.yaml": data for i, data in enumerate((*corpus("yaml")[:4], *corpus("diagram")[:2]))}
    for kind in ("yaml", "diagram"):
        files |= {f"{kind}{i}.yaml": data for i, data in enumerate(islice(mutated(kind, 1), 16))}
    return files


HOSTILE = hostile()
# Those that take seconds to be read or drawn are for the slow tier.
LARGE = [name for name, data in HOSTILE.items() if len(data) > 30_000]
PARTS = 4


@pytest.mark.parametrize("part", sampled([*range(PARTS), *LARGE], list(range(PARTS))))
def test_no_file_leaves_a_blank_page(opened: Serve, page: Page, tmp_path: Path, part: int | str) -> None:
    small = [name for name in HOSTILE if name not in LARGE]
    names = small[part::PARTS] if isinstance(part, int) else [part]
    for name in names:
        (tmp_path / name).write_bytes(HOSTILE[name])
    opened("start.yaml", content=SOUND)
    for name in names:
        page.keyboard.press("Control+o")
        steps.window(page).get_by_label("Filter files").fill(name)
        with page.expect_response(lambda answer: answer.url.endswith("/api/open")) as opened:
            page.keyboard.press("Enter")
        if not opened.value.ok:  # Not UTF-8: it says so, and what was open stays.
            expect(page.get_by_role("log")).to_contain_text("is not UTF-8")
            page.keyboard.press("Escape")  # The window of files lies over the notice.
            expect(page.get_by_role("dialog")).to_have_count(0)
            page.get_by_role("log").get_by_role("button").first.click()
            continue
        expect(page.get_by_role("heading", level=1)).to_contain_text(name)
        assert page.locator(".failed").count() == 0, name
        count = len(opened.value.json()["problems"])
        steps.problems(page, count)
        if count:
            if steps.results(page).count() == 0:
                page.get_by_role("banner").get_by_role("button", name="problem").click()
            expect(steps.results(page).get_by_role("listitem")).to_have_count(count)
        for node in page.locator(".react-flow__node").all()[:2]:
            node.focus()
            page.keyboard.press("Enter")
            if steps.window(page).count():
                assert page.locator(".failed").count() == 0, name
                page.keyboard.press("Escape")
                expect(steps.window(page)).to_have_count(0)


def test_blocks_beyond_the_drawing_limit_are_reported(serve: Serve, page: Page) -> None:
    lines = (f"  b{i}: {{joint: {{kind: fixed}}}}\n" for i in range(1600))
    server = serve("many.yaml", content=f"symofros: 1\nbodies:\n{''.join(lines)}")
    page.goto(server.url)
    expect(page.get_by_text("1601 blocks are more than the 1500 that are drawn")).to_be_visible()
    expect(page.get_by_label("Text of the file")).to_contain_text("b0")


def test_a_failing_part_of_the_page_shows_the_reason_and_spares_the_others(serve: Serve, chromium: Browser) -> None:
    """The server's answer is spoilt, so that the diagram can't be drawn: a fault of the page itself."""
    server = serve("arm.yaml", source=steps.PENDULUM)
    page = chromium.new_page()
    spoilt = [True]

    def spoil(document: dict[str, object]) -> dict[str, object]:
        return document | {"graph": {"nodes": [{"id": "bodies/a", "kind": "beam", "ports": []}], "edges": []}}

    page.route(
        "**/api/document",
        lambda route: route.fulfill(json=spoil(route.fetch().json())) if spoilt[0] else route.continue_(),
    )
    page.goto(server.url)
    failed = page.get_by_role("main").get_by_role("alert")
    expect(failed).to_contain_text("The diagram can't be shown.")
    expect(failed).to_contain_text("TypeError")
    with page.expect_download() as download:
        failed.get_by_role("button", name="Download the text").click()
    assert download.value.path().read_text() == steps.PENDULUM.read_text()
    failed.get_by_role("button", name="Show the text").click()
    expect(page.get_by_label("Text of the file")).to_contain_text("double_pendulum")
    spoilt[0] = False
    failed.get_by_role("button", name="Reload the page").click()
    expect(steps.block(page, "bodies/upper")).to_be_visible()
    page.close()


def test_a_document_that_the_server_fails_to_send_is_reported(serve: Serve, page: Page) -> None:
    server = serve("arm.yaml", source=steps.PENDULUM)
    fault = {"object": "the server met a fault of its own", "found": "KeyError", "rule": "none", "remedy": "report it"}
    page.route("**/api/document", lambda route: route.fulfill(status=500, json={"error": fault}))
    page.goto(server.url)
    expect(page.get_by_text("The document could not be loaded.")).to_be_visible()
    expect(page.get_by_role("log")).to_contain_text("KeyError")
    page.unroute("**/api/document")
    page.get_by_role("button", name="Reload the page").click()
    expect(steps.block(page, "bodies/upper")).to_be_visible()
