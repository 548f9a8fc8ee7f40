"""A simulated motion plays in the 3-D pane, at the time of the plots' cursor; runs are kept, compared, saved."""

from __future__ import annotations

import csv
import re

import pytest
from playwright.sync_api import Page, Request, expect

from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Picture, Serve
from tests.studio.waiting import at_rest

pytestmark = pytest.mark.browser


def is_seek(request: Request) -> bool:
    return request.url.endswith("/api/pose") and "run" in (request.post_data or "")


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

    # A second run beside the first, which keeps the name that it was given.
    results.get_by_label("Name of run 1").fill("from 1.2")
    steps.job(page, "Simulate", Start_of_q1="0.7", Duration="0.8")
    expect(results.get_by_label("Name of run 2")).to_be_visible(
        timeout=steps.JOB
    )  # Results of the first stood until then.
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
