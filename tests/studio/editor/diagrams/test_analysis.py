"""What the editor makes of a diagram's text: what is drawn of it, and where each of its faults is shown."""

from __future__ import annotations

import zipfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from symofros.studio.editor.document.analysis import analyse
from symofros.studio.editor.document.meaning import Analysis

SQUARE = Path(__file__).parents[4] / "reference_models" / "square.yaml"
CHAIN = """symofros_diagram: 1
blocks:
  a: {kind: constant, value: [1, 2], unit: m}
  b: {kind: gain, gain: 2, unit_in: m, unit_out: m, period: 0.01, inputs: {u: a}}
  c: {kind: sum, inputs: {u1: b.y, u2: a.y}}
"""
LOOP = """symofros_diagram: 1
blocks:
  a: {kind: sum, inputs: {u1: b.y, u2: c}}
  b: {kind: gain, inputs: {u: a}}
  c: {kind: constant, value: 1}
"""

UNIT = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="unit" guid="unit">
  <CoSimulation modelIdentifier="unit" canHandleVariableCommunicationStepSize="true"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="2" {}/></Outputs></ModelStructure>
</fmiModelDescription>
"""
FED = """symofros_diagram: 1
blocks:
  unit: {kind: fmu, file: unit.fmu, period: 0.1, inputs: {u: back}}
  back: {kind: gain, gain: 0.5, period: 0.1, inputs: {u: unit.y}}
"""


def drawn(text: str) -> Analysis:
    found = analyse(SQUARE.with_name("drawn.yaml"), text)
    assert found.diagram is not None
    return found


def node(found: Analysis, name: str) -> dict[str, Any]:
    assert found.diagram is not None
    return next(node for node in found.diagram["nodes"] if node["id"] == name)


def test_the_papers_square_is_drawn_whole() -> None:
    found = analyse(SQUARE, SQUARE.read_text())
    assert found.problems == [] and found.diagram is not None
    kinds = [node["id"].split("/")[0] for node in found.diagram["nodes"]]
    assert (kinds.count("models"), kinds.count("blocks"), len(found.diagram["wires"])) == (2, 14, 25)
    pd = node(found, "blocks/pd")
    assert pd["group"] == "controllers" and pd["period"] == 1e-3
    assert [(port["name"], port["shape"]) for port in pd["inputs"]][0] == ("q_desired", [3])
    assert found.diagram["models"]["control"]["q"] == ["q1", "e1", "q2", "q3"]


def test_open_inlets_are_no_faults_where_their_shapes_are_known() -> None:
    text = CHAIN.replace(", inputs: {u: a}", "") + "inlets:\n  far: {to: b.u, shape: [2]}\n"
    assert drawn(text).problems == []
    (unknown,) = drawn(text.replace(", shape: [2]", "")).problems
    assert (unknown["line"], unknown["found"]) == (7, "its shape is unknown")
    (twice,) = drawn(text.replace("b.u", "c.u1")).problems[:1]
    assert "'c.u1' is fed twice" in twice["object"]


def test_a_wire_leaves_the_port_that_its_source_means() -> None:
    found = drawn(CHAIN)
    assert found.problems == [] and found.diagram is not None
    ends = {wire["id"]: (wire["source"], wire["source_port"], wire["period"]) for wire in found.diagram["wires"]}
    assert ends["blocks/b/inputs/u"] == ("blocks/a", "y", None)
    assert ends["blocks/c/inputs/u1"] == ("blocks/b", "y", 0.01)


@pytest.mark.parametrize(
    ("old", "new", "path", "port"),
    [
        ("unit_in: m", "unit_in: rad", ["blocks", "b", "inputs", "u"], "u"),
        ("u2: a.y", "u2: nothing.y", ["blocks", "c", "inputs", "u2"], "u2"),
        ("value: [1, 2]", "value: fish", ["blocks", "a", "value"], ""),
        ("{u1: b.y, u2: a.y}", "{u1: b.y}", ["blocks", "c"], "u2"),
        ("kind: gain", "kind: gian", ["blocks", "b"], ""),
    ],
)
def test_a_fault_is_shown_at_its_block_and_port(old: str, new: str, path: list[str], port: str) -> None:
    assert old in CHAIN
    found = drawn(CHAIN.replace(old, new))
    assert path in [problem["path"] for problem in found.problems], found.problems
    shown = next(problem for problem in found.problems if problem["path"] == path)
    assert shown["line"] > 0 and (port == "" or shown["port"] == port)
    assert node(found, "/".join(path[:2]))["problems"] >= 1
    if port:
        ports = {item["name"]: item["fault"] for item in node(found, "/".join(path[:2]))["inputs"]}
        assert ports[port]


def test_wires_of_an_unreadable_block_are_drawn_without_further_faults() -> None:
    found = drawn(CHAIN.replace("gain: 2", "gain: {x: [y, {}]}"))
    assert found.diagram is not None
    assert len(found.diagram["wires"]) == 3
    assert {problem["node"] for problem in found.problems} == {"blocks/b"}


def test_algebraic_loops_are_marked_while_other_things_are_wrong() -> None:
    other = "  d: {kind: gain, unit_in: m, inputs: {u: f}}\n  e: {kind: sum, inputs: {u1: c}}\n"
    other += "  f: {kind: constant, value: 1, unit: rad}\n  g: {kind: gian}\n"
    second = "  h: {kind: sum, inputs: {u1: h, u2: c}}\n"
    found = drawn(LOOP + other + second)
    assert found.diagram is not None and {problem["node"] for problem in found.problems} >= {"blocks/e", "blocks/g"}
    marked = {wire["id"] for wire in found.diagram["wires"] if wire["loop"]}
    assert marked == {"blocks/a/inputs/u1", "blocks/b/inputs/u", "blocks/h/inputs/u1"}
    assert sum("algebraic loop" in problem["object"] for problem in found.problems) == 2


@pytest.mark.parametrize("text", ["symofros_diagram: 1\n", "symofros_diagram: 2\nblocks: 3\nmodels: [a]\n"])
def test_a_diagram_without_anything_to_draw_is_a_diagram(text: str) -> None:
    assert drawn(text).diagram == {"nodes": [], "wires": [], "models": {}, "moving": []}


def test_step_responses_of_open_inputs_are_refused() -> None:
    """What is not connected is no number, of which a step would have none either."""
    integrator = "{kind: integrator, period: 0.01, reset: rising, unit_in: m, inputs: {u: a.y}}"
    text = CHAIN + f"  d: {integrator}\n  e: {{kind: gain, gain: 2, inputs: {{u: d.y}}}}\n"
    (problem,) = drawn(text).problems
    assert "'d.reset' is not connected" in problem["object"]


@pytest.mark.skipif(find_spec("fmpy") is None, reason="reads a unit by FMPy")
def test_a_unit_that_is_exchanged_is_read_anew(tmp_path: Path) -> None:
    """The first one's output depends on its input at once, which closes a loop; that of the second does not."""
    loops = []
    for stated in ("", 'dependencies=""'):
        with zipfile.ZipFile(tmp_path / "unit.fmu", "w") as archive:
            archive.writestr("modelDescription.xml", UNIT.format(stated))
        loops.append(["algebraic loop" in one["object"] for one in analyse(tmp_path / "fed.yaml", FED).problems])
    assert loops == [[True], []]
