"""Blocks of diagrams by a stand-in for Simulink's header (simulink/): they have the numbers of one diagram of all."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from symofros import blocks
from tests.exports.c.test_sfunction import HEADERS
from tests.exports.cases import build, sources
from tests.exports.test_controller import CASES, STEPS, closed, driven, given, outlets_of


def block_of(diagram: sf.Diagram, folder: Path) -> Path:
    """The block of a diagram under the stand-in's engine."""
    sf.export(diagram, "sfunction", folder, dt=1e-3)
    files = [name for name in sources(folder) if name != "symofros_program_block.c"]
    return build(folder, "block", *files, include=HEADERS)


def called(block: Path, rows: np.ndarray, *words: str, parameters: str = "") -> subprocess.CompletedProcess[str]:
    text = "\n".join(" ".join(map(float.hex, row)) for row in rows.tolist())
    settings = {"BLOCK_PARAMETERS": parameters}
    return subprocess.run([block, *words], input=text, capture_output=True, text=True, env=settings)


def outputs(done: subprocess.CompletedProcess[str]) -> np.ndarray:
    assert done.returncode == 0, done.stdout[-300:]
    return np.array([[float.fromhex(word) for word in line.split()] for line in done.stdout.splitlines()])


def stacked(values: Mapping[str, np.ndarray]) -> np.ndarray:
    return np.column_stack(list(values.values()))


@pytest.mark.parametrize("case", CASES)
def test_a_block_has_the_numbers_of_one_diagram(case: str, tmp_path: Path) -> None:
    """Samples read the inputs of their instant, mechanisms feel those before: no delay, and no look into the future.

    Times of calls are k times the sample time, which has the bits of k/1000 s for most k alone.
    """
    diagram = CASES[case]()
    values = given(diagram)
    found = outputs(called(block_of(diagram, tmp_path / "block"), stacked(values)))
    shown = [f"part.{name}" for name in outlets_of(diagram)]
    whole = driven(closed(diagram, values), tmp_path / "whole", {}, outputs=shown)
    np.testing.assert_allclose(found, whole, rtol=1e-12, atol=1e-13)


def test_ports_answer_at_once_where_outputs_do(tmp_path: Path) -> None:
    """A mechanism's state does not; so a controller can be joined with it without an algebraic loop."""
    for case, feeds in (("plant", "{2, 0}"), ("rates", "{2, 1}, {2, 1}, {2, 1}")):
        folder = sf.export(CASES[case](), "sfunction", tmp_path / case).folder
        assert f"block_inputs[] = {{{feeds}}};" in (folder / f"{case}_sfun.c").read_text()
    gain = sf.Diagram("gain")
    gain.add(blocks.Gain(name="twice", gain=2.0))
    gain.add_inlet("x", "twice.u", shape=())
    gain.outlets = {"y": "twice"}
    text = (sf.export(gain, "sfunction", tmp_path / "gain").folder / "gain_sfun.c").read_text()
    assert "block_inputs[] = {{1, 1}};" in text


def test_a_block_begins_when_its_conditions_are_initialised(tmp_path: Path) -> None:
    """Its time is 0 then, whatever that of the simulation; times of calls bear rounding."""
    values = stacked(given(CASES["inside"]()))
    block = block_of(CASES["inside"](), tmp_path / "block")
    np.testing.assert_allclose(
        outputs(called(block, values, "0", "0.3")), outputs(called(block, values)), rtol=1e-9, atol=1e-12
    )


def test_a_slower_block_holds_its_inputs_between_calls(tmp_path: Path) -> None:
    """Samples in between read the inputs of the call before."""
    values = given(CASES["inside"]())
    held = {name: rows[np.arange(STEPS) // 4 * 4] for name, rows in values.items()}
    block = block_of(CASES["inside"](), tmp_path / "block")
    slow = outputs(called(block, stacked(values)[::4], "4e-3"))
    np.testing.assert_allclose(slow, outputs(called(block, stacked(held)))[::4], rtol=1e-13)


def test_parameters_of_a_block_are_those_of_its_readme(tmp_path: Path) -> None:
    values = given(CASES["rates"]())
    block = block_of(CASES["rates"](), tmp_path / "block")
    found = outputs(called(block, stacked(values), parameters="10 30 5 0"))
    assert (found == driven(CASES["rates"](), tmp_path / "c", values, "pd.kp[0]", "10", "pd.kd[1]", "0")).all()
    readme = (tmp_path / "block" / "README.md").read_text()
    assert "| `pd.kp` | 0 | 2 |" in readme and "| `pd.kd` | 2 | 2 |" in readme and "`[]` for 0.001 s" in readme
    wrong = called(block, stacked(values), parameters="1 2")
    assert wrong.returncode == 1 and "Parameters has one number a parameter" in wrong.stdout
    for period in ("-1", "nan"):
        refused = called(block, stacked(values), period)
        assert refused.returncode == 1 and "SampleTime is a time above zero" in refused.stdout


def test_a_motion_that_ends_is_reported(tmp_path: Path) -> None:
    """Refused parameters, and a beam beyond its theory."""
    boom = sf.Beam("boom", sf.Joint("clamp", "fixed"), length=1.0, rhoA=1.0, EI_z="EI", bend_y=3)
    system = sf.System("boom", [boom], [sf.Parameter("EI", 50.0)], gravity=(0, -9.81, 0))
    diagram = sf.Diagram("falling")
    diagram.add_model("m", system)
    diagram.add(blocks.ForwardDynamics(name="m", model="m"))
    diagram.outlets = {"q": "m.q"}
    block, none = block_of(diagram, tmp_path / "block"), np.zeros((0, 0))
    assert len(outputs(called(block, none))) == 100
    for parameter, words in (("1", "a beam bends beyond its theory"), ("-1", "EI")):
        done = called(block, none, "0.01", parameters=parameter)
        assert done.returncode == 1 and words in done.stdout.splitlines()[-1]
