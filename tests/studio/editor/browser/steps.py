"""What a person does in the editor, as words for the tests."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from playwright.sync_api import Locator, Page, Response, expect

from tests.studio.pictures import MANY, settled, shot
from tests.studio.waiting import PATIENCE, at_rest, until

MODELS = Path(__file__).parents[4] / "reference_models"
PENDULUM = MODELS / "rigid" / "double_pendulum.yaml"
ROBOT = MODELS / "flexible" / "planar_robot.yaml"
JOB = 120_000  # A job may take on a busy machine [ms].


def block(page: Page, node: str) -> Locator:
    """A block of the diagram by its id, such as `bodies/upper`."""
    return page.locator(f'.react-flow__node[data-id="{node}"]')


def wire(page: Page, edge: str) -> Locator:
    """A link of the diagram by its id, such as `bodies/upper/joint`."""
    return page.locator(f'.react-flow__edge[data-id="{edge}"]')


def anchor(page: Page, node: str, name: str) -> Locator:
    """A port of a block of a mechanism, such as `frame tip of crank`."""
    return block(page, node).get_by_label(name, exact=True)


def draw(page: Page, start: Locator, end: Locator) -> None:
    """Draw a link from the middle of one port to that of another."""
    a, b = at_rest(start), at_rest(end)
    page.mouse.move(a["x"] + a["width"] / 2, a["y"] + a["height"] / 2)
    page.mouse.down()
    page.mouse.move(b["x"] + b["width"] / 2, b["y"] + b["height"] / 2, steps=8)
    page.mouse.up()


def open_editor(page: Page, url: str) -> None:
    """Load the page and wait for the diagram."""
    page.goto(url)
    page.wait_for_selector(".react-flow__node")


def window(page: Page) -> Locator:
    """The window that is open."""
    return page.get_by_role("dialog")


def open_window(page: Page, node: str) -> Locator:
    """Open the properties of a block or a link by the keyboard."""
    page.locator(f'.react-flow [data-id="{node}"]').focus()
    page.keyboard.press("Enter")
    expect(window(page)).to_be_visible()
    return window(page)


def tab(page: Page, name: str) -> None:
    """Turn to a page of the window."""
    window(page).get_by_role("tab", name=name, exact=True).click()


def fill(page: Page, label: str, text: str, nth: int = 0) -> Locator:
    """Type into a field of the window."""
    field = window(page).get_by_label(label, exact=True).nth(nth)
    field.fill(text)
    return field


def accept(page: Page) -> None:
    """Close the window by its OK."""
    window(page).get_by_role("button", name="OK").click()
    expect(window(page)).to_have_count(0)


def problems(page: Page, count: int) -> None:
    """Wait for a number of problems in the tool bar."""
    text = "No problems" if count == 0 else re.compile(rf"^{count} problem")
    expect(page.get_by_role("banner").get_by_role("button", name=text)).to_be_visible()


def run(page: Page, command: str) -> None:
    """Press a button of the tool bar, such as Compile."""
    page.get_by_role("banner").get_by_role("button", name=command).click()


def results(page: Page) -> Locator:
    """The pane of results."""
    return page.get_by_role("region", name="Results")


def saved(page: Page) -> None:
    """Save by the keyboard, and wait until it is done."""
    page.locator("body").press("Control+s")
    expect(page.get_by_role("banner").get_by_text("unsaved")).to_have_count(0)


def autosaved(page: Page) -> None:
    """Wait until the server has answered the first edit: it writes unsaved work before it answers.

    A field shows what was typed at once, before the request is on its way.
    """
    expect(page.get_by_role("banner").get_by_text("unsaved")).to_be_visible()


def port(page: Page, name: str) -> Locator:
    """A port of a block of a diagram, such as `input u of speed`."""
    return page.locator(f'.react-flow__handle[aria-label^="{name}"]')


def menu(page: Page, title: str, command: str) -> None:
    """Choose a command of a menu of the tool bar."""
    page.get_by_role("banner").get_by_role("button", name=title, exact=True).click()
    page.get_by_role("menuitem", name=command).click()


def new_file(page: Page, name: str, kind: str = "") -> None:
    """Begin another document."""
    menu(page, "File", "New")
    fill(page, "File", name)
    if kind:
        window(page).get_by_label("Kind").select_option(kind)
    window(page).get_by_role("button", name="Create").click()
    expect(page.get_by_role("heading", level=1)).to_contain_text(name)


def open_file(page: Page, name: str) -> None:
    """Go to another file of the folder."""
    page.keyboard.press("Control+o")
    window(page).get_by_label("Filter files").fill(name)
    page.keyboard.press("Enter")
    expect(page.get_by_role("heading", level=1)).to_contain_text(name)
    expect(window(page)).to_have_count(0)


@contextmanager
def ended(page: Page) -> Iterator[None]:
    """Wait until the job that is started inside has ended; the server must start it at the first request.

    Until its request is answered, the page shows what an earlier one returned, so no words say that this one ended.
    """
    answers: list[Response] = []

    def keep(answer: Response) -> None:
        answers.append(answer)

    page.on("response", keep)
    try:
        with page.expect_response(lambda answer: answer.url.endswith("/api/jobs")) as started:
            yield
        assert started.value.ok, started.value.text()
        address = f"{started.value.url}/{started.value.json()['id']}"

        def has_ended() -> bool:
            return any(answer.url == address and answer.json()["state"] != "running" for answer in answers)

        until(page, has_ended, "the job does not end")
    finally:
        page.remove_listener("response", keep)


def job(page: Page, command: str, **typed: str) -> None:
    """A job from its command's window to its end; `Start_of_q1="1"` fills the field *Start of q1*."""
    run(page, f"{command}…")
    for label, text in typed.items():
        fill(page, label.replace("_", " "), text)
    with ended(page):
        window(page).get_by_role("button", name=command, exact=True).click()
    expect(page.get_by_role("dialog")).to_have_count(0)
    expect(results(page).get_by_text("s of computing")).to_be_visible(timeout=JOB)


def type_at_the_head(page: Page, text: str) -> None:
    """Type into the text of the file, before all else."""
    page.get_by_role("tab", name="YAML").click()
    page.get_by_label("Text of the file").click()
    page.keyboard.press("Control+Home")
    page.keyboard.type(text)


def set_parameter(page: Page, name: str, value: str) -> None:
    """Type a value into the table of parameters."""
    field = page.get_by_label(f"Value of {name}", exact=True)
    field.fill(value)
    field.press("Enter")


def has_value(page: Page, name: str, value: str) -> None:
    """Wait for a value in the table of parameters."""
    expect(page.get_by_label(f"Value of {name}", exact=True)).to_have_value(value)


def open_view(page: Page) -> np.ndarray:
    """Open the 3-D pane, and wait until the mechanism is drawn: its picture."""
    run(page, "3-D")
    return drawn(page)


def drawn(page: Page) -> np.ndarray:
    """The picture in the 3-D pane, once the mechanism is drawn."""
    page.frame_locator("iframe.view").locator("canvas").first.wait_for(timeout=1000 * PATIENCE)
    until(page, lambda: bool((shot(page) < 200).any(axis=2).sum() >= MANY), "nothing is drawn")
    return settled(page)
