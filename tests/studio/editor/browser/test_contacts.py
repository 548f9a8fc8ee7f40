"""Contacts and switches: made, changed and taken away in the page, with what is wrong beside the field."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

import symofros as sf
from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Faults, Picture, Serve, Server

pytestmark = pytest.mark.browser

LOOP = """symofros: 1
bodies:
  arm:
    joint: {kind: revolute, name: q1, axis: [0, 1, 0]}
    inertia: {mass: 1, moments: [1, 1, 1]}
    frames: {tip: {position: [1, 0, 0]}}
closures:
  grip: {first: {body: arm, frame: tip}, second: {body: world}}
"""


def test_a_contact_is_made_changed_and_taken_away(arm: Server, page: Page, faults: Faults, picture: Picture) -> None:
    steps.block(page, "bodies/lower").click()
    page.get_by_role("button", name="Contact", exact=True).click()
    window = steps.window(page)
    balls, surface = (window.get_by_role("group", name=f"Frame of the {of}") for of in ("balls", "surface"))
    expect(balls.get_by_label("Body", exact=True)).to_have_value("lower")
    expect(surface.get_by_label("Body", exact=True)).to_have_value("world")
    expect(window.get_by_label("Size x", exact=True)).to_have_count(0)
    window.get_by_label("Surface", exact=True).select_option("box")
    expect(window.get_by_label("Size x", exact=True)).to_be_visible()
    expect(window.get_by_label("Radius of the rim", exact=True)).to_have_count(0)
    steps.accept(page)
    steps.problems(page, 1)  # It has no size yet: that is said beside the field.
    steps.open_window(page, "contacts/touch")
    expect(window.get_by_role("alert")).to_contain_text("not given. state it")
    for axis in "xyz":
        steps.fill(page, f"Size {axis}", "0.4")
    steps.fill(page, "Radius of the balls", "0.05")
    window.get_by_label("Kind", exact=True).select_option("restitution")
    expect(window.get_by_label("Stiffness", exact=True)).to_have_count(0)
    for colors in ("light", "dark"):
        page.emulate_media(color_scheme=colors)  # type: ignore[arg-type]
        assert faults() == []
        picture("contact" if colors == "light" else "contact-dark")
    page.emulate_media(color_scheme="light")
    page.set_viewport_size({"width": 400, "height": 700})
    assert faults() == []
    picture("contact-phone")
    page.set_viewport_size({"width": 1280, "height": 760})
    steps.accept(page)
    steps.problems(page, 0)

    # It is doubled, alone and with its body, each in one step of undo.
    for chosen in (steps.wire(page, "contacts/touch"), steps.block(page, "bodies/lower")):
        chosen.press("Space")
        page.keyboard.press("Control+d")
        expect(steps.wire(page, "contacts/touch2")).to_have_count(1)
        steps.problems(page, 0)
        page.keyboard.press("Control+z")
        expect(steps.wire(page, "contacts/touch2")).to_have_count(0)
    steps.open_view(page)
    picture("contact-drawn")
    page.get_by_role("tab", name="Tree").click()
    page.get_by_role("treeitem", name="touch contact").click()
    steps.saved(page)
    (contact,) = sf.load(arm.file).contacts
    assert contact.rigid and contact.surface == "box"
    steps.wire(page, "contacts/touch").press("Space")
    page.keyboard.press("Delete")
    expect(page.get_by_role("treeitem", name="touch contact")).to_have_count(0)
    steps.saved(page)
    assert not sf.load(arm.file).contacts


def test_a_switch_goes_with_its_constraint(opened: Serve, page: Page, faults: Faults, picture: Picture) -> None:
    server = opened("grip.yaml", content=LOOP)
    steps.open_window(page, "closures/grip")
    window = steps.window(page)
    window.get_by_role("button", name="Add switch").click()
    steps.fill(page, "Engaged", "0")
    window.get_by_label("Pose", exact=True).select_option("moment")
    assert faults() == []
    picture("switch")
    steps.fill(page, "Name", "hold")
    steps.accept(page)
    steps.saved(page)
    assert [switch.constraint for switch in sf.load(server.file).switches] == ["hold"]
    steps.wire(page, "closures/hold").press("Space")
    page.keyboard.press("Delete")
    expect(steps.wire(page, "closures/hold")).to_have_count(0)
    steps.saved(page)
    assert not sf.load(server.file).switches
