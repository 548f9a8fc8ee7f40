"""The library in the page: equilibrium, modes and linear model, in tables and in three dimensions."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Faults, Picture, Serve, Server
from tests.studio.pictures import shot
from tests.studio.waiting import at_rest, lies_within, until

pytestmark = pytest.mark.browser


def analysed(page: Page, what: str, says: str) -> None:
    """Analyse the model by the window, and wait for the words of the result."""
    steps.run(page, "Analyse…")
    steps.window(page).get_by_label(what).check()
    steps.window(page).get_by_role("button", name="Analyse", exact=True).click()
    expect(steps.results(page)).to_contain_text(says, timeout=steps.JOB)


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_a_model_is_analysed_and_its_modes_play(
    opened: Serve, page: Page, faults: Faults, picture: Picture, theme: Literal["light", "dark"]
) -> None:
    """The double pendulum hangs down, swings in two modes and is simulated from there."""
    page.emulate_media(color_scheme=theme)
    opened("arm.yaml", source=steps.PENDULUM)
    name = "" if theme == "light" else "-dark"
    steps.job(page, "Simulate", Speed_of_q1="3", Duration="0.1")  # Speeds of a run are not those of a rest.
    analysed(page, "Equilibrium", "Equilibrium after")
    expect(steps.results(page).get_by_role("row", name="q1 [rad]")).to_contain_text("1.571")
    steps.run(page, "Analyse…")
    picture(f"analyse{name}")
    assert not faults()
    page.keyboard.press("Escape")
    analysed(page, "Vibration modes", "2 modes about the equilibrium")
    expect(steps.results(page).get_by_role("row", name="1.626")).to_be_visible()
    steps.results(page).get_by_label("Shown in 3-D").select_option(index=1)
    steps.results(page).get_by_role("button", name="Play").click()
    expect(page.frame_locator("iframe.view").locator("canvas").first).to_be_visible(timeout=steps.JOB)
    expect(steps.results(page).get_by_role("button", name="Play")).to_be_visible(timeout=steps.JOB)
    # The pane that a play opens has the colours of the page.
    until(page, lambda: (np.median(shot(page)) < 128) == (theme == "dark"), "the picture is of the other colour")
    assert not faults()
    steps.results(page).get_by_role("slider", name="Time [s]").fill("0.1")
    steps.settled(page)
    picture(f"modes{name}")
    with page.expect_download() as saved:
        steps.results(page).get_by_role("button", name="Modes as CSV").click()
    assert saved.value.suggested_filename == "Modes.csv"
    assert saved.value.path().read_text("utf-8").startswith("Mode,|s|/2π [Hz],")
    steps.results(page).get_by_role("button", name="Simulate from here…").click()
    assert float(steps.window(page).get_by_label("Start of q1", exact=True).input_value()) == pytest.approx(
        1.5707963268
    )
    page.keyboard.press("Escape")
    analysed(page, "Linear model", "4 states, 2 inputs")
    expect(steps.results(page).get_by_role("region", name="B", exact=True)).to_be_visible()
    page.set_viewport_size({"width": 400, "height": 760})
    assert not faults()
    picture(f"linear-narrow{name}")
    steps.run(page, "Analyse…")
    lies_within(steps.window(page), 400, 760)
    picture(f"analyse-narrow{name}")
    assert not faults()


def test_a_parameter_is_swept_and_an_event_found(arm: Server, page: Page, faults: Faults, picture: Picture) -> None:
    """Frequencies over a length; five motions, of which one plays; the instant of an event."""
    steps.run(page, "Analyse…")
    steps.window(page).get_by_label("Sweep").check()
    steps.window(page).get_by_label("Parameter", exact=True).select_option("L2")
    expect(steps.window(page).get_by_label("From", exact=True)).to_have_value("0.2")
    assert not faults()
    steps.window(page).get_by_role("button", name="Analyse", exact=True).click()
    expect(steps.results(page).get_by_role("img", name="Frequencies over L2: mode 1, mode 2")).to_be_visible(
        timeout=steps.JOB
    )
    steps.run(page, "Analyse…")
    steps.window(page).get_by_label("Drawn").select_option("motion")
    steps.window(page).get_by_role("button", name="Analyse", exact=True).click()
    expect(steps.results(page).get_by_role("img", name="q1: L2 = 0.2, L2 = 0.3")).to_be_visible(timeout=steps.JOB)
    expect(steps.results(page).get_by_role("img", name="dq2")).to_have_count(0)
    steps.results(page).get_by_text("Signals").click()
    steps.results(page).get_by_label("dq2").check()
    expect(steps.results(page).get_by_role("img", name="dq2: L2 = 0.2")).to_be_visible()
    assert not faults()
    picture("swept")
    plot = steps.results(page).get_by_role("img", name="q1: L2 = 0.2")
    last = plot.locator(".tick text").last
    expect(last).to_have_text("5")
    box = at_rest(plot)
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 60)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 60, steps=3)
    page.mouse.up()
    expect(last).not_to_have_text("5")
    with page.expect_download() as saved:
        steps.results(page).get_by_role("button", name="CSV of q1: L2 = 0.2").click()
    head, first, *rest = saved.value.path().read_text("utf-8").splitlines()
    assert head.startswith("t [s],L2 = 0.2,") and float(first.split(",")[0]) == 0.0 and len(rest) == 400
    with page.expect_download() as saved:
        steps.results(page).get_by_role("button", name="SVG of q1: L2 = 0.2").click()
    svg = saved.value.path().read_text("utf-8")
    assert svg.startswith("<svg") and "L2 = 0.2" in svg and svg.count('class="series') == 5
    assert not faults()
    steps.results(page).get_by_role("button", name="Whole").click()
    expect(last).to_have_text("5")
    steps.run(page, "Simulate…")
    steps.window(page).get_by_role("button", name="Add an event").click()
    expect(steps.window(page).get_by_role("button", name="Simulate", exact=True)).to_be_disabled()
    expect(steps.window(page).get_by_placeholder("formula, zero at the event")).to_be_visible()
    steps.fill(page, "Formula of event 1", "q1 - 1")
    steps.window(page).get_by_label("ends the run").check()
    steps.fill(page, "Duration", "2")
    picture("events")
    assert not faults()
    steps.window(page).get_by_role("button", name="Simulate", exact=True).click()
    expect(steps.results(page).get_by_role("row", name="event 1")).to_be_visible(timeout=steps.JOB)
    run_end = steps.results(page).get_by_role("slider", name="Time [s]").get_attribute("max")
    assert run_end is not None and 0.1 < float(run_end) < 2.0


def test_a_model_without_parameters_says_what_a_sweep_needs(opened: Serve, page: Page) -> None:
    opened("empty.yaml")
    page.get_by_role("button", name="Rigid body", exact=True).click()
    steps.problems(page, 0)
    steps.run(page, "Analyse…")
    steps.window(page).get_by_label("Sweep").check()
    expect(steps.window(page)).to_contain_text("The model has no parameter that a sweep could change.")
    expect(steps.window(page).get_by_label("From", exact=True)).to_have_count(0)
    expect(steps.window(page).get_by_role("button", name="Analyse", exact=True)).to_be_disabled()


def test_a_body_that_is_drawn_falls(opened: Serve, page: Page) -> None:
    """A body as the palette has it, simulated as the window says: something moves."""
    opened("empty.yaml")
    page.get_by_role("button", name="Rigid body", exact=True).click()
    steps.problems(page, 0)
    steps.job(page, "Simulate", Duration="0.5")
    with page.expect_download() as saved:
        steps.results(page).get_by_role("button", name="CSV").first.click()
    last = saved.value.path().read_text("utf-8").splitlines()[-1]
    assert abs(float(last.split(",")[1])) > 0.5
