"""WebAssembly of diagrams: the bits of the C program under Node; what is asked wrongly is refused in words."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.diagrams.run.test_switching import CASES as SWITCHING
from tests.diagrams.run.test_switching import diagram as switching
from tests.docs import pages
from tests.exports.cases import need, run
from tests.exports.test_controller import CASES, RUN, STEPS, driven, given, outlets_of
from tests.exports.wasm.test_wasm import doubles

# Doubles as 16 hexadecimal digits, so that no digit is lost on the way.
_DRIVE = """\
import { load } from "./NAME.mjs";

const { t, values, outputs } = JSON.parse(process.argv[2]);
const program = await load(), it = program.instance();
const hex = (x) => Array.from(new BigUint64Array(Float64Array.from(x).buffer), (bits) => bits.toString(16));
const rows = t.map((now, k) => {
  for (const [name, given] of Object.entries(values)) it.set(name, given[k]);
  it.advance(now);
  return outputs.flatMap((name) => hex(it.get(name)));
});
console.log(JSON.stringify({ rows, inputs: program.inputs, period: program.period }));
"""
_MISUSE = """\
import { load } from "./NAME.mjs";

const program = await load(), it = program.instance();
const said = [];
const refused = (call) => { try { call(); said.push("nothing"); } catch (error) { said.push(error.message); } };
refused(() => it.set("efort", 1));
refused(() => it.set("effort", [1, 2, 3]));
refused(() => it.set("effort", NaN));
refused(() => it.set("q", 1));
it.advance(0.01);
refused(() => it.advance(0.005));
it.set("arm.m2", -1);
refused(() => it.prepare());
refused(() => it.advance(0.02));
it.set("arm.m2", 0.7);
it.start();
const first = [it.t, it.advance(0.01), it.t];
it.free();
refused(() => it.get("q"));
console.log(JSON.stringify({ said, first }));
"""

_ASK = """
import { load } from "./latch.mjs";
const it = (await load()).instance(), shut = [];
shut.push(it.get("m.shut")[0]);
it.advance(0.5);
shut.push(it.get("m.shut")[0]);
it.set("m.shut", 1);
it.prepare();
shut.push(it.get("m.shut")[0]);
it.set("m.shut", 0);
it.set("m.shut", 1);
it.start();
shut.push(it.get("m.shut")[0]);
console.log(JSON.stringify(shut));
"""


@pytest.mark.tools
@pytest.mark.parametrize("case", ["rates", "inside"])
def test_a_module_has_the_bits_of_the_program(case: str, tmp_path: Path) -> None:
    need("node")
    diagram = CASES[case]()
    values, outputs = given(diagram), outlets_of(diagram)
    folder = sf.export(diagram, "wasm", tmp_path / "controller", name="controller").folder
    run("node", "selftest.mjs", cwd=folder)
    (folder / "drive.mjs").write_text(_DRIVE.replace("NAME", "controller"))
    asked = {"t": RUN.tolist(), "values": {name: rows.tolist() for name, rows in values.items()}, "outputs": outputs}
    answer = json.loads(run("node", "drive.mjs", json.dumps(asked), cwd=folder))
    found = np.array([doubles(row) for row in answer["rows"]])
    assert found.shape[0] == STEPS and answer["period"] == 1e-3
    np.testing.assert_array_equal(found, driven(diagram, tmp_path / "c", values))
    if case == "rates":
        (block,) = (one for one in pages.blocks("docs/exports.md", "js") if "controller" in one.text)
        (tmp_path / "page.mjs").write_text(f"{block.text}\nconsole.log(it.get('effort').length, it.t);")
        assert run("node", "page.mjs", cwd=tmp_path).split() == ["2", "0.001"]
        assert answer["inputs"]["goal"] == {"at": 0, "width": 2, "shape": [2], "units": ["rad", "rad"]}


@pytest.mark.tools
def test_parameters_are_what_actions_have_set(tmp_path: Path) -> None:
    """A latch that breaks: it was said to be shut, as it was at the start; set again, it stayed broken."""
    need("node")
    folder = sf.export(switching(SWITCHING["latch"]), "wasm", tmp_path / "wasm", name="latch", dt=1e-3).folder
    (folder / "ask.mjs").write_text(_ASK)
    assert json.loads(run("node", "ask.mjs", cwd=folder)) == [1, 0, 1, 1]


@pytest.mark.tools
def test_what_is_asked_wrongly_is_refused_in_words(tmp_path: Path) -> None:
    need("node")
    folder = sf.export(CASES["plant"](), "wasm", tmp_path / "wasm").folder
    (folder / "misuse.mjs").write_text(_MISUSE.replace("NAME", "plant"))
    answer = json.loads(run("node", "misuse.mjs", cwd=folder))
    unknown, width, infinite, output, backwards, refused, still, freed = answer["said"]
    assert unknown.startswith("no 'efort'; there are: effort, ")
    assert "takes 2 finite numbers" in width and "takes 2 finite numbers" in infinite
    assert output.startswith("no 'q'") and "lies before 0.01 s" in backwards
    assert refused.startswith("refused: ") and "mass" in refused and still == refused
    assert freed == "the instance was freed" and answer["first"] == [0, True, 0.01]
    types = (folder / "plant.d.ts").read_text()
    assert 'export type InputName = "effort";' in types and 'export type OutputName = "q" | "v";' in types
