"""What a document says: its diagram, and problems at the entries that they are about."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from symofros.description.yaml import yaml_pieces
from symofros.studio.editor.document.analysis import analyse
from symofros.studio.editor.document.diagram import diagram
from symofros.studio.editor.document.expressions import check_field
from symofros.studio.editor.editing import yaml_spans
from symofros.studio.editor.editing.data_edits import Edit
from symofros.studio.editor.editing.formulas import formulas
from symofros.studio.editor.editing.yaml_edits import apply
from tests.studio.editor.texts import DATA, FILES, ODD, TEXTS

# A change of the four-bar, the path of the problem that follows, its block.
FAULTS = (
    (
        "parent: crank, frame: end",
        "parent: crank, frame: ennd",
        ["bodies", "coupler", "joint", "frame"],
        "bodies/coupler",
    ),
    ("[L/2, 0, 0]", "[K/2, 0, 0]", ["bodies", "crank", "inertia", "center_of_mass", 0], "bodies/crank"),
    ("{mass: m,", "{mass: m+,", ["bodies", "crank", "inertia", "mass"], "bodies/crank"),
    ("kind: revolute", "kind: revo", ["bodies", "crank", "joint", "kind"], "bodies/crank"),
    ("axis: [0, -1, 0]", "axis: [0, 0, 0]", ["bodies", "crank", "joint", "axis"], "bodies/crank"),
    ("axis: [0, -1, 0]", "axes: [0, -1, 0]", ["bodies", "crank", "joint", "axes"], "bodies/crank"),
    ("closures:", "closurs:", ["closurs"], ""),
    ("[x, z]", "[x, w]", ["closures", "loop", "translations", 1], ""),
    ("coupler, frame: end}, t", "coupler, frame: foo}, t", ["closures", "loop", "second", "frame"], ""),
    ("L: {value: 1.0", "L: {value: abc", ["parameters", "L", "value"], ""),
    ("system: {name", "system: {gravity: [0, 0, g], name", ["system", "gravity", 2], "world"),
)


@pytest.mark.parametrize(("old", "new", "path", "node"), FAULTS, ids=[fault[1] for fault in FAULTS])
def test_a_problem_is_at_the_entry_that_it_is_about(old: str, new: str, path: list[str], node: str) -> None:
    text = TEXTS["four_bar"].replace(old, new, 1)
    assert text != TEXTS["four_bar"]
    found = analyse(FILES["four_bar"], text)
    problem = found.problems[0]
    assert problem["path"] == path and problem["node"] == node
    assert new.split()[0].strip("[{,") in text.splitlines()[problem["line"] - 1]
    assert problem["object"] and problem["rule"] and problem["remedy"]
    assert sum(block["problems"] for block in found.graph["nodes"]) == (node != "")


def test_a_text_that_is_not_yaml_has_one_problem_with_its_line() -> None:
    found = analyse(FILES["four_bar"], TEXTS["four_bar"].replace("bodies:", "bodies: ]"))
    assert not found.readable and found.data is None
    assert [(p["line"], p["path"]) for p in found.problems] == [(8, [])]


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"], ids=["unix", "dos", "old"])
def test_every_element_has_the_lines_that_define_it(newline: str) -> None:
    text = """symofros: 1
system: {name: arm}
# Of two bodies.
bodies:
  upper:
    joint: {kind: revolute}
    inertia: {mass: 1}
    frames:
      tip:
        position: [1, 0, 0]
      # The last.
      end: {position: [2, 0, 0]}

  lower: {joint: {kind: fixed, parent: upper}}
closures: {loop: {first: {body: upper}, second: {body: world}}}
"""
    found = analyse(FILES["four_bar"], text.replace("\n", newline))
    assert found.lines == {
        "world": (2, 2),
        "bodies/upper": (5, 12),
        "bodies/upper/joint": (6, 6),
        "bodies/upper/frames/tip": (9, 10),
        "bodies/upper/frames/end": (12, 12),
        "bodies/lower": (14, 14),
        "bodies/lower/joint": (14, 14),
        "closures/loop": (15, 15),
    }


def test_problems_of_included_files_name_them(tmp_path: Path) -> None:
    (tmp_path / "hand.yaml").write_text("symofros: 1\nbodies: {b: {joint: {kind: what}}}\n")
    problem = analyse(tmp_path / "a.yaml", "symofros: 1\ninclude: [hand.yaml]\n").problems[0]
    assert "hand.yaml:2" in problem["object"] and problem["path"] == [] and problem["line"] == 0


@pytest.mark.parametrize("name", sorted(FILES))
def test_every_reference_model_is_drawn_whole(name: str) -> None:
    found = analyse(FILES[name], TEXTS[name])
    data, graph = DATA[name], found.graph
    assert found.problems == []
    blocks = {block["id"]: block for block in graph["nodes"]}
    ports = {(key, port["name"]) for key, block in blocks.items() for port in block["ports"]}
    bases = sum("joint" not in body for body in data["bodies"].values())
    assert len(blocks) == len(graph["nodes"]) == len(data["bodies"]) + 1 - bases + len(data.get("nonholonomic", {}))
    assert len([edge for edge in graph["edges"] if edge["kind"] == "joint"]) == len(data["bodies"]) - bases
    for kind in ("closure", "connection", "contact"):
        assert len([edge for edge in graph["edges"] if edge["kind"] == kind]) == len(data.get(f"{kind}s", {})), kind
    for edge in graph["edges"]:
        assert {(edge["source"], edge["source_port"]), (edge["target"], edge["target_port"])} <= ports
        assert all(step in (data := data[step] and data) for step in edge["path"][:1])
    assert len({edge["id"] for edge in graph["edges"]}) == len(graph["edges"])


def test_a_measure_that_a_contact_lacks_is_marked_at_its_own_key(tmp_path: Path) -> None:
    text = """symofros: 1
bodies: {ball: {joint: {kind: free, name: j}, inertia: {mass: 1, moments: [1, 1, 1]}}}
contacts: {c: {first: {body: ball}, second: {body: world}, stiffness: 1e4, surface: box}}
"""
    (problem,) = analyse(tmp_path / "c.yaml", text).problems
    assert problem["path"] == ["contacts", "c", "size"] and problem["line"] == 3


NO_DOCUMENTS = (
    *(None, 3, [], {"bodies": 1}),
    {"bodies": {"a": None, "b": [], "c": {"joint": 1}}},
    {"bodies": {"a": {"joint": {"parent": ["x"], "frame": {}}}}},
    {"closures": {"c": {"first": {"body": {}}, "second": 4}}, "nonholonomic": {"n": {"rolling": 1}}},
)


@pytest.mark.parametrize("data", NO_DOCUMENTS)
def test_whatever_stands_in_a_document_can_be_drawn(data: object) -> None:
    found = diagram(data)
    assert found["nodes"][0]["id"] == "world" and found["nodes"][0]["kind"] == "base"


def test_a_broken_wire_goes_to_the_body_itself_and_one_to_nowhere_is_left_out() -> None:
    body = {"joint": {"kind": "fixed", "parent": "a", "frame": "none"}}
    found = diagram({"bodies": {"a": {"joint": {"kind": "fixed"}}, "b": body, "c": {"joint": {"parent": "zz"}}}})
    assert [(edge["source"], edge["source_port"]) for edge in found["edges"]] == [("world", ""), ("bodies/a", "")]
    # The body without a joint is the ground.
    found = diagram({"bodies": {"ground": {"frames": {"m": {}}}, "a": {"joint": {"parent": "ground", "frame": "m"}}}})
    assert found["nodes"][0]["title"] == "ground" and found["nodes"][0]["path"] == ["bodies", "ground"]
    assert found["edges"][0]["source_port"] == "m"


def test_frames_may_be_called_like_ports() -> None:
    frames = {"root": {}, "body": {}}
    found = diagram(
        {"bodies": {"a": {"joint": {}, "frames": frames}, "b": {"joint": {"parent": "a", "frame": "body"}}}}
    )
    assert [(port["name"], port["kind"]) for port in found["nodes"][1]["ports"]] == [
        ("/root", "root"),
        ("", "origin"),
        ("root", "frame"),
        ("body", "frame"),
    ]
    assert found["edges"][1]["source_port"] == "body"


@pytest.mark.parametrize("value", ["0,5", "1e999"])
def test_a_parameter_that_cannot_be_read_stays_in_the_table(value: str) -> None:
    text = TEXTS["four_bar"].replace("L: {value: 1.0", f"L: {{value: {value!r}", 1)
    before, found = analyse(FILES["four_bar"], TEXTS["four_bar"]), analyse(FILES["four_bar"], text)
    assert [item["name"] for item in found.parameters] == [item["name"] for item in before.parameters]
    kept = next(item for item in found.parameters if item["name"] == "L")
    assert kept["value"] == value and kept["number"] is None and kept["unit"] == "m"
    assert found.problems[0]["path"] == ["parameters", "L", "value"]


def test_numbers_that_json_lacks_become_texts() -> None:
    found = analyse(FILES["four_bar"], ODD.replace("value: 1,", "value: .inf,"))
    assert found.data["parameters"]["L1"]["value"] == ".inf"


@pytest.mark.parametrize(("unit", "is_one"), [("kg m^2", True), ("N m/rad", True), ("", True), ("bananas", False)])
def test_an_invalid_unit_is_reported(unit: str, is_one: bool) -> None:
    text = TEXTS["four_bar"].replace("unit: m}", f"unit: {unit!r}}}", 1)
    found = {item["name"]: item for item in analyse(FILES["four_bar"], text).parameters}["L"]
    assert found["unit"] == unit and (found["unit_fault"] == "") == is_one
    assert is_one or "'bananas'" in found["unit_fault"] and "kg m^2" in found["unit_fault"]


def test_a_formula_of_another_unit_is_a_problem_of_its_entry() -> None:
    text = TEXTS["four_bar"].replace("unit: m}", "unit: N m}", 1)
    problems = [problem for problem in analyse(FILES["four_bar"], text).problems if "unit N m" in problem["object"]]
    assert problems and all(problem["path"][0] == "bodies" for problem in problems)
    assert all("position" in problem["path"] or "center_of_mass" in problem["path"] for problem in problems)


def test_a_text_is_read_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reading is what takes long: a text that was edited is not read again to be checked."""
    texts = []
    compose_text = yaml_pieces.compose_text

    def counted(text: str, file: str) -> object:
        texts.append(text)
        return compose_text(text, file)

    monkeypatch.setattr(yaml_pieces, "compose_text", counted)
    monkeypatch.setattr(yaml_spans, "compose_text", counted)
    text = TEXTS["four_bar"] + "# once\n"
    now = analyse(FILES["four_bar"], text)
    assert texts == [text] and not now.problems
    for path in (["bodies", "crank", "inertia", "mass"], ["parameters", "L", "value"]):
        typed = now.data[path[0]][path[1]]
        for step in path[2:]:
            typed = typed[step]
        assert check_field(FILES["four_bar"], text, now, tuple(path), str(typed))["ok"]
    assert texts == [text]


def _with(data: Any, path: tuple[Any, ...], value: Any) -> Any:
    """Plain data with one value exchanged."""
    if not path:
        return value
    step, rest = path[0], path[1:]
    if isinstance(data, list):
        return [_with(item, rest, value) if i == step else item for i, item in enumerate(data)]
    return {key: _with(item, rest, value) if key == step else item for key, item in data.items()}


def test_a_field_that_the_document_lacks_is_judged_in_its_draft() -> None:
    """Each formula of every body that can be written is asked for as if the window that has it were new."""
    file = Path(__file__).parents[4] / "validation" / "corpus" / "everything.yaml"
    text = file.read_text(encoding="utf-8")
    whole = analyse(file, text)
    for path, _ in formulas(whole.data):
        if path[0] != "bodies" or "beam" in path or "solid" in path:
            continue
        entry = path[:2]
        body = whole.data["bodies"][path[1]]
        draft = Edit("set", entry, _with(body, path[2:], "nobody"))
        # The field is not there while its window fills it in.
        lean = apply(text, Edit("remove", path[:3]))
        now = analyse(file, lean)
        found = check_field(file, lean, now, path, "nobody", draft)
        assert not found["ok"] and "unknown symbol 'nobody'" in found["error"]["found"], path
