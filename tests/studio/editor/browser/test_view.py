"""The 3-D pane: the mechanism is drawn, moves by its sliders, keeps its loops, follows the document."""

from __future__ import annotations

import csv
import re
from typing import Literal

import numpy as np
import pytest
from playwright.sync_api import Page, Request, Response, expect

from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Faults, Picture, Serve
from tests.studio.pictures import MANY, changed, differing, settled
from tests.studio.waiting import at_rest, until

pytestmark = pytest.mark.browser

PANEL = '[class*="tabler-icon-cloud"]'  # viser's sign of the connection, at the head of its panel.


def slide(page: Page, label: str, value: float) -> dict[str, float]:
    """Put a slider somewhere; where the coordinates are then."""

    # A coordinate, a parameter, or the exaggeration.
    moved = f'"{label.removesuffix(", slider").partition(" [")[0]}"'

    def is_of_slider(answer: Response) -> bool:
        return answer.url.endswith("/api/pose") and moved in (answer.request.post_data or "")

    with page.expect_response(is_of_slider) as answered:
        page.get_by_role("slider", name=label, exact=True).fill(str(value))
    found: dict[str, float] = answered.value.json()["q"]
    return found


def test_a_flexible_robot_is_drawn_bends_and_follows_its_file(opened: Serve, page: Page, picture: Picture) -> None:
    opened("robot.yaml", source=steps.ROBOT)
    steps.open_view(page)
    # Neither viser's panel nor a second scale bar lies over the picture.
    inside = page.frame_locator("iframe.view")
    expect(inside.locator(PANEL).first).to_be_hidden()
    expect(inside.get_by_role("img", name="Scale: ")).to_be_hidden()
    expect(page.get_by_role("img", name="Scale: ")).to_be_visible()
    for fold in ("Elastic coordinates", "Parameters"):
        page.get_by_role("group", name="Pose").get_by_text(fold, exact=True).click()
    straight = settled(page)

    assert slide(page, "q2 [rad]", 0.9)["q2"] == pytest.approx(0.9, abs=0.01)
    turned = changed(page, straight)
    expect(page.get_by_role("group", name="Pose")).to_contain_text("0.9")

    # A bending of millimetres is seen once it is exaggerated.
    slide(page, "link1.bend_y[0] [m]", 0.008)
    page.wait_for_timeout(1000)
    bent = settled(page)
    assert differing(bent, turned) < MANY * 10
    slide(page, "exaggeration", 20)
    exaggerated = changed(page, bent)
    assert differing(exaggerated, turned) > differing(bent, turned)
    page.get_by_role("button", name="Show the whole diagram").click()
    page.get_by_role("button", name="Reset", exact=True).scroll_into_view_if_needed()
    picture("3d")

    page.get_by_role("button", name="Reset", exact=True).click()
    slide(page, "exaggeration", 1)
    changed(page, exaggerated)
    # While the picture moves it is coarser; what is seen through something else depends on the order it is drawn in.
    until(page, lambda: differing(settled(page), straight) < differing(exaggerated, straight) / 4)
    back = settled(page)

    # A parameter moves the picture while its slider is dragged, and is changed in the document when that is let go.
    slide(page, "L1, slider", 1.2)
    expect(page.get_by_role("button", name="Undo", exact=True)).to_be_disabled()
    longer = changed(page, back)
    page.get_by_role("slider", name="L1, slider").press("ArrowRight")
    expect(page.get_by_role("button", name="Undo: change L1")).to_be_enabled()
    longer = settled(page)
    page.get_by_role("button", name="Undo: change L1").click()
    changed(page, longer)
    until(page, lambda: differing(settled(page), straight) < differing(longer, straight) / 4)


def tab(page: Page, name: str) -> None:
    page.get_by_label("Side pane").get_by_role("tab", name=name, exact=True).click()


def chosen_text(page: Page) -> list[str]:
    """The lines of the text that are marked."""
    expect(page.locator(".text-pane .cm-chosen").first).to_be_in_viewport()
    return [line.strip() for line in page.locator(".text-pane .cm-chosen").all_inner_texts()]


def marked(picture: np.ndarray) -> np.ndarray:
    """Pixels in the colour of what is chosen: red and blue, no green (height, width)."""
    red, green, blue = np.moveaxis(picture, 2, 0)
    return (red > 120) & (green < red / 3) & (blue > red / 4)


def test_the_selection_is_marked_in_all_views(opened: Serve, page: Page) -> None:
    opened("robot.yaml", source=steps.ROBOT)

    # On the canvas: a body. The tree and the text show it.
    steps.block(page, "bodies/link2").get_by_text("link2").click()
    tab(page, "Tree")
    rows = page.get_by_role("tree", name="Elements")
    expect(rows.get_by_role("treeitem", selected=True)).to_have_text(["link2 beam"])
    tab(page, "YAML")
    until(page, lambda: (text := chosen_text(page))[0] == "link2:" and len(text) == 3)

    # In the text: the caret chooses what its line defines; what is chosen elsewhere comes into sight.
    page.locator(".text-pane").get_by_text("axis: {position").first.click()
    expect(steps.block(page, "bodies/housing2").locator(".block-frame.marked")).to_have_text("axis")
    until(page, lambda: len(chosen_text(page)) == 1)
    tab(page, "Tree")
    expect(rows.get_by_role("treeitem", selected=True)).to_have_text(["axis frame"])

    # In the tree, by keys: a joint. Then a frame on the canvas.
    rows.get_by_role("treeitem", selected=True).press("ArrowUp")
    expect(rows.get_by_role("treeitem", selected=True)).to_have_text(["seat2: fixed joint"])
    expect(steps.wire(page, "bodies/housing2/joint")).to_contain_class("selected")
    steps.block(page, "bodies/load").get_by_text("tool").click()
    expect(rows.get_by_role("treeitem", selected=True)).to_have_text(["tool frame"])
    expect(rows.get_by_role("treeitem", selected=True)).to_be_in_viewport()

    # In the picture: what is chosen has a colour of its own; a click there chooses.
    rows.get_by_role("treeitem").get_by_text("link1", exact=True).click()
    steps.open_view(page)
    until(page, lambda: bool(marked(settled(page)).sum() > 20))
    shown = marked(settled(page))
    y, x = np.argwhere(shown)[len(np.argwhere(shown)) // 2]
    page.locator(".react-flow__pane").click(position={"x": 5, "y": 5})
    expect(page.locator(".react-flow__node.selected")).to_have_count(0)
    until(page, lambda: bool(marked(settled(page)).sum() < shown.sum() / 4))
    frame = at_rest(page.locator("iframe.view"))
    page.mouse.click(frame["x"] + int(x), frame["y"] + int(y))
    expect(steps.block(page, "bodies/link1")).to_contain_class("selected")


def is_seek(request: Request) -> bool:
    return request.url.endswith("/api/pose") and "run" in (request.post_data or "")


def a_second_run_is_compared(page: Page, picture: Picture) -> None:
    """Beside the first, which keeps the name that it was given."""
    results = steps.results(page)
    results.get_by_label("Name of run 1").fill("from 1.2")
    steps.job(page, "Simulate", Start_of_q1="0.7", Duration="0.8")
    expect(results.get_by_label("Name of run 2")).to_be_visible()
    curves = results.get_by_role("img", name="q1, q2 over time").locator("path.series")
    expect(curves).to_have_count(2)
    results.get_by_label("Draw from 1.2").check()
    expect(curves).to_have_count(4)
    expect(results.get_by_text("q1, from 1.2")).to_have_count(3)  # Angle, speed, input.
    picture("runs")

    # Once the model has changed both are of an earlier state; they can be saved all the same.
    steps.open_window(page, "bodies/upper")
    steps.tab(page, "Inertia")
    steps.fill(page, "Mass", "3")
    steps.accept(page)
    expect(results.get_by_text("outdated")).to_have_count(2)
    with page.expect_download() as saved:
        results.get_by_label("Kept runs").get_by_role("button", name="CSV").first.click()
    assert saved.value.suggested_filename == "from_1_2.csv"
    rows = list(csv.DictReader(saved.value.path().read_text().splitlines()))
    assert float(rows[0]["q1"]) == 1.2 and float(rows[-1]["t"]) == pytest.approx(0.8)


def test_a_motion_plays_at_the_cursor_of_the_plots_and_runs_are_compared(
    opened: Serve, page: Page, picture: Picture
) -> None:
    opened("pendulum.yaml", source=steps.PENDULUM)
    steps.job(page, "Simulate", Start_of_q1="1.2", Duration="0.8")
    results = steps.results(page)
    motion = results.get_by_role("group", name="Motion")

    # It plays: the 3-D pane opens, and stands at the end where the slider does.
    motion.get_by_role("button", name="Play").click()
    angle = page.get_by_role("slider", name="q1 [rad]")
    expect(angle).to_be_visible(timeout=steps.JOB)
    expect(motion.get_by_role("button", name="Play")).to_be_visible(timeout=steps.JOB)
    expect(motion.get_by_role("status")).to_have_text("0.8 s")
    # The slider's time is the cursor's of every plot and the view's.
    with page.expect_request_finished(is_seek):
        motion.get_by_role("slider", name="Time [s]").fill("0")
    expect(angle).to_have_value(re.compile(r"^1\.20"))  # In steps of 0.01.
    expect(results.locator(".cursor")).to_have_count(results.locator("figure.plot").count())
    expect(results.locator(".legend").get_by_text("1.2", exact=True)).to_have_count(1)
    box = at_rest(results.get_by_role("img", name="q1, q2 over time"))
    with page.expect_request_finished(is_seek):
        page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + box["height"] / 2)
    expect(motion.get_by_role("status")).not_to_have_text("0 s")

    # Frames are seen through the bodies; the motion is saved as a film.
    page.get_by_label("Frames").click()
    expect(page.get_by_label("Frames")).to_be_checked()
    page.get_by_label("Frames").click()
    # Its pictures take seconds of processor time, which a busy machine gives in minutes.
    with page.expect_download(timeout=5 * steps.JOB) as film:
        results.get_by_label("Film of run 1, GIF").click()
    assert film.value.suggested_filename == "run_1.gif" and film.value.path().read_bytes()[:6] == b"GIF89a"

    # The picture takes the page's colours.
    scheme = page.frame_locator("iframe.view").locator("html")
    for colours in ("dark", "light"):
        page.get_by_role("button", name="Dark or light").click()
        expect(scheme).to_have_attribute("data-mantine-color-scheme", colours)

    a_second_run_is_compared(page, picture)


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_forces_of_a_run_are_drawn_at_its_time(
    opened: Serve, page: Page, faults: Faults, picture: Picture, theme: Literal["light", "dark"]
) -> None:
    page.emulate_media(color_scheme=theme)
    opened("bar.yaml", source=next(steps.MODELS.glob("*/four_bar.yaml")))
    still = steps.open_view(page)
    pose = page.get_by_role("group", name="Pose")
    pose.get_by_label("Forces").click()
    expect(pose.get_by_label("Forces")).to_be_checked()
    expect(pose).to_contain_text("simulate, then move its time")
    steps.job(page, "Simulate", Duration="0.4", Speed_of_q1="3")
    steps.results(page).get_by_role("slider", name="Time [s]").fill("0.2")
    expect(pose).to_contain_text("forces (red):", timeout=steps.JOB)
    assert faults() == []

    def red(shown: np.ndarray) -> int:
        r, g, b = (shown[..., k].astype(int) for k in range(3))
        return int(((r > 150) & (g < 90) & (b < 90)).sum())

    until(page, lambda: red(settled(page)) > red(still) + 30, "no arrows are drawn")
    picture(f"forces-{theme}")
    pose.get_by_label("Forces").click()
    until(page, lambda: red(settled(page)) <= red(still) + 10, "arrows are still drawn")


def test_the_view_is_back_with_the_server(opened: Serve, serve: Serve, page: Page) -> None:
    server = opened("arm.yaml", source=steps.PENDULUM)
    steps.open_view(page)
    server.kill()
    expect(page.get_by_text("The server does not answer")).to_be_visible()
    serve("arm.yaml", port=server.port)
    expect(page.get_by_text("The server does not answer")).to_have_count(0)
    before = steps.drawn(page)
    assert slide(page, "q1 [rad]", 1.0)["q1"] == pytest.approx(1.0, abs=0.01)
    changed(page, before)
