"""The page asks before a diagram runs native code of a file: what it is, whose, of which bytes; and it takes a no."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import pytest
from playwright.sync_api import Page, expect

from symofros.studio.editor.document.workspace import digest
from tests.blocks.fmu.wilful import changed, wilful_unit
from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Faults, Picture, Serve
from tests.studio.waiting import fits, lies_within

pytestmark = pytest.mark.browser

FED = """symofros_diagram: 1
simulation: {t_end: 0.2, record: 0.1, plots: [[unit.pump_y]]}
blocks:
  wish: {kind: constant, value: 0.25, unit: N m}
  unit: {kind: fmu, file: wilful.fmu, period: 0.1, inputs: {pump_u: wish}}
"""


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_a_unit_runs_once_the_user_consents(
    opened: Serve, page: Page, faults: Faults, picture: Picture, tmp_path: Path, theme: Literal["light", "dark"]
) -> None:
    page.emulate_media(color_scheme=theme)
    unit = wilful_unit(tmp_path)
    opened("fed.yaml", content=FED)
    steps.problems(page, 0)

    steps.run(page, "Run…")
    steps.window(page).get_by_role("button", name="Run").click()
    window = steps.window(page)
    expect(window).to_contain_text("can do all that you can")
    for text in (str(unit), digest(unit.read_bytes()), "A. Pump", unit.owner(), "KiB"):
        expect(window).to_contain_text(text)
    assert faults() == []
    picture(f"consent-{theme}")
    page.set_viewport_size({"width": 400, "height": 760})
    fits(page, 400)
    lies_within(window, 400, 760)
    picture(f"consent-narrow-{theme}")
    page.set_viewport_size({"width": 1280, "height": 760})

    # Refused: nothing runs, and the page says why.
    expect(window.get_by_role("button", name="Run", exact=True)).to_be_disabled()
    window.get_by_role("button", name="Cancel").click()
    expect(page.get_by_role("log", name="Notices")).to_contain_text("would run native code of a file")
    expect(steps.results(page)).to_have_count(0)

    consent_and_run(page)
    # Not asked again, until the file is another.
    with steps.ended(page):
        page.get_by_role("banner").get_by_role("button", name="Run", exact=True).click()
    expect(steps.window(page)).to_have_count(0)
    changed(unit)
    consent_and_run(page)


def consent_and_run(page: Page) -> None:
    page.get_by_role("banner").get_by_role("button", name="Run", exact=True).click()
    steps.window(page).get_by_label("Run the native code of wilful.fmu").check()
    with steps.ended(page):
        steps.window(page).get_by_role("button", name="Run", exact=True).click()
    expect(steps.window(page)).to_have_count(0)
    expect(steps.results(page).get_by_text("s of computing")).to_be_visible(timeout=steps.JOB)
