"""Files that come in and go out: import, export, pictures, parts of the user's library."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest
from playwright.sync_api import Page, expect

from tests.studio.editor.browser import steps
from tests.studio.editor.browser.conftest import Serve, Server

pytestmark = pytest.mark.browser

URDF = """<robot name="arm">
  <link name="base"/>
  <link name="boom">
    <visual><geometry><sphere radius="0.1"/></geometry></visual>
    <inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="slew" type="continuous"><parent link="base"/><child link="boom"/><axis xyz="0 0 1"/></joint>
</robot>
"""


def test_a_urdf_is_imported(serve: Serve, page: Page, tmp_path: Path) -> None:
    server = serve("arm.yaml", source=steps.PENDULUM)
    (tmp_path / "robot.urdf").write_text(URDF)
    steps.open_editor(page, server.url)
    with page.expect_file_chooser() as chooser:
        steps.menu(page, "File", "Import")
    chooser.value.set_files(tmp_path / "robot.urdf")
    expect(steps.block(page, "bodies/boom")).to_contain_text("slew")
    expect(page.get_by_role("heading", level=1)).to_contain_text("unsaved")
    # What is not in the document is said, until it is read.
    remarks = page.get_by_role("status").filter(has_text="The import left out or changed")
    expect(remarks).to_contain_text("`symofros view robot.urdf` draws them")
    page.get_by_role("button", name="Close what the import says").click()
    expect(remarks).to_have_count(0)


@pytest.mark.parametrize("kind", ["SVG", "PNG"])
def test_a_picture_of_the_diagram_is_downloaded(arm: Server, page: Page, kind: str) -> None:
    with page.expect_download() as download:
        steps.menu(page, "File", f"Picture of the diagram, {kind}")
    data = Path(download.value.path()).read_bytes()
    if kind == "SVG":
        texts = [node.text for node in ElementTree.fromstring(data).iter("{http://www.w3.org/2000/svg}text")]
        assert {"world", "upper", "lower", "elbow", "q1", "q2"} <= set(texts)
    else:
        assert data.startswith(b"\x89PNG") and len(data) > 5000


def test_a_part_is_kept_and_used_in_another_model(arm: Server, page: Page) -> None:
    steps.block(page, "bodies/lower").click()
    page.get_by_role("button", name="Save selection").click()
    steps.fill(page, "Name", "forearm")
    steps.window(page).get_by_role("button", name="Save", exact=True).click()
    part = page.get_by_role("button", name="forearm")
    expect(part).to_be_visible()

    steps.menu(page, "File", "New")
    steps.fill(page, "File", "other")
    steps.window(page).get_by_role("button", name="Create").click()
    expect(steps.block(page, "bodies/upper")).to_have_count(0)
    part.click()
    expect(steps.block(page, "bodies/lower")).to_contain_text("q2")
    steps.problems(page, 0)
    expect(page.get_by_label("Value of m2", exact=True)).to_have_value("0.7")
