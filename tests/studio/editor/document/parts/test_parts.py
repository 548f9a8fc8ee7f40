"""Parts: what belongs to some bodies, taken out and put in, alone or many times."""

from __future__ import annotations

from pathlib import Path

import pytest

from symofros.studio.editor.document.analysis import analyse
from symofros.studio.editor.document.parts.parts import extracted, insertion
from symofros.studio.editor.document.parts.parts_library import Library
from symofros.studio.editor.document.workspace import FileError, Workspace
from symofros.studio.editor.editing.data_edits import EditError
from symofros.studio.editor.editing.yaml_edits import with_references
from symofros.studio.editor.editing.yaml_rendering import block
from symofros.studio.editor.editing.yaml_spans import YamlText
from tests.studio.editor.texts import DATA, FILES, TEXTS


def test_a_part_holds_its_bodies_parameters_and_inner_constraints() -> None:
    part = extracted(DATA["four_bar"], ["rocker", "coupler"])
    assert list(part) == ["symofros", "parameters", "bodies", "closures"]
    assert list(part["bodies"]) == ["coupler", "rocker"]  # In the document's order.
    assert "parent" not in part["bodies"]["coupler"]["joint"] and "frame" not in part["bodies"]["coupler"]["joint"]
    assert "closures" not in extracted(DATA["four_bar"], ["rocker"])
    for bodies, says in (([], "no bodies"), (["nobody"], "no such body")):
        with pytest.raises(EditError) as caught:
            extracted(DATA["four_bar"], bodies)
        assert says in caught.value.problem.found
    wrist = extracted(DATA["planar_robot"], ["motor3", "housing3"])
    assert list(wrist["parameters"]) == ["n3", "J3"]
    assert wrist["bodies"]["motor3"]["joint"]["parent"] == "housing3"


@pytest.mark.parametrize("name", ["planar_robot", "joint_zoo"])
def test_a_part_inserted_twice_gives_a_valid_mechanism(name: str) -> None:
    data, text = DATA[name], TEXTS[name]
    part = extracted(data, [body for body, entry in data["bodies"].items() if "joint" in entry])
    before = list(data["bodies"])
    for _ in range(2):
        text = with_references(text, insertion(YamlText(text).root.plain(), part, before[0], None))
    found = analyse(FILES[name], text)
    assert found.problems == []
    assert len(found.data["bodies"]) == 3 * len(part["bodies"]) + len(before) - len(part["bodies"])
    assert found.data.get("parameters", {}) == data.get("parameters", {})  # Equal ones are shared.


def test_unequal_parameters_get_different_names() -> None:
    part = extracted(DATA["four_bar"], ["rocker"])
    part["parameters"] = {**part["parameters"], "L": 2.0}
    text = with_references(TEXTS["four_bar"], insertion(DATA["four_bar"], part, "crank", "end"))
    data = YamlText(text).root.plain()
    assert data["parameters"]["L2"] == 2.0
    joint = data["bodies"]["rocker2"]["joint"]
    assert joint["position"] == ["L2", 0, 0] and joint["parent"] == "crank" and joint["name"] == "q4"


def test_the_library_keeps_lists_and_does_not_overwrite(tmp_path: Path) -> None:
    library = Library(Workspace(tmp_path))
    library.keep("my leg!", DATA["four_bar"], ["rocker"])
    (tmp_path / "parts" / "broken.yaml").write_text("a: [")
    (tmp_path / "parts" / "other.yaml").write_text("a: 1")
    assert library.listed() == [{"name": "my_leg_", "path": "parts/my_leg_.yaml", "bodies": ["rocker"]}]
    assert not analyse(tmp_path / "parts" / "my_leg_.yaml", (tmp_path / "parts" / "my_leg_.yaml").read_text()).problems
    with pytest.raises(FileError, match="there already"):
        library.keep("my leg!", DATA["four_bar"], ["coupler"])
    with pytest.raises(FileError, match="no such file"):
        library.part("nothing")
    with pytest.raises(FileError, match="not in the workspace"):
        library.part("../../etc/x")


HUNG = """symofros: 1
parameters: {k: {value: 50.0, unit: N/m}, on: 1.0, h: {value: 1.0, unit: m}}
bodies:
  ground: {frames: {hook: {position: [0, 0, h]}, other: {position: [9, 0, 0]}}}
  bob:
    joint: {kind: prismatic, axis: [0, 0, 1]}
    inertia: {mass: 1.0}
connections:
  spring: {first: {body: world, frame: hook}, second: {body: bob}, stiffness: k, length: 1.0}
contacts:
  floor: {first: {body: bob}, second: {body: ground, frame: hook}, stiffness: 1.0e+5}
closures:
  hold: {first: {body: world}, second: {body: bob}, translations: [x]}
switches:
  hold: {engaged: on}
"""


def test_a_part_keeps_its_links_to_the_ground(tmp_path: Path) -> None:
    part = extracted(YamlText(HUNG).root.plain(), ["bob"])
    assert list(part["bodies"]) == ["ground", "bob"]
    assert list(part["bodies"]["ground"]["frames"]) == ["hook"]  # None that no link is at.
    assert {"k", "on", "h"} == set(part["parameters"])
    assert part["switches"] == {"hold": {"engaged": "on"}}
    assert not analyse(tmp_path / "part.yaml", "\n".join(block(part, (), 0)) + "\n").problems


@pytest.mark.parametrize(
    ("document", "frame", "body"),
    [
        (HUNG, "hook", "ground"),  # An equal frame is shared.
        (HUNG.replace("[0, 0, h]", "[0, 1, h]"), "hook2", "ground"),
        (HUNG.replace("ground", "mast"), "hook", "mast"),
        ("symofros: 1\nbodies:\n  bob:\n    joint: {kind: revolute}\n    inertia: {mass: 1.0}\n", "hook", "ground"),
        ("symofros: 1\nbodies:\n  base: {}\n", "hook", "base"),
    ],
)
def test_what_holds_a_part_to_the_ground_holds_it_where_it_is_put(
    document: str, frame: str, body: str, tmp_path: Path
) -> None:
    data = YamlText(document).root.plain()
    part = extracted(YamlText(HUNG).root.plain(), ["bob"])
    text = with_references(document, insertion(data, part, "bob" if "bob" in data["bodies"] else None, None))
    found = analyse(tmp_path / "model.yaml", text)
    assert found.problems == []
    second = "2" if "spring" in document else ""
    assert found.data["connections"][f"spring{second}"]["first"]["frame"] == frame
    assert found.data["contacts"][f"floor{second}"]["second"] == {"body": body, "frame": frame}
    assert f"hold{second}" in found.data["closures"] and f"hold{second}" in found.data["switches"]
    assert found.data["bodies"][body]["frames"][frame] == {"position": [0, 0, "h"]}
