"""Diagrams with inlets as programs: inputs in, outputs out, with the bits of the same blocks in one diagram."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros import blocks
from tests.diagrams.parts import Counter, Spoken
from tests.exports import cases
from tests.exports.cases import build, run

MODELS = Path(__file__).parents[2] / "reference_models"
STEPS = 40
RUN = np.arange(STEPS) / 1000.0


def rates() -> sf.Diagram:
    """A diagram of samples alone, at three rates."""
    diagram = sf.Diagram("rates")
    diagram.add(blocks.Hold(name="slow", period=5e-3))
    diagram.add(blocks.JointPD(name="pd", kp=[50.0, 30.0], kd=[5.0, 3.0], period=1e-3), q_desired="slow")
    diagram.add(Counter(name="ticks", period=2e-3))
    diagram.add_inlet("goal", "slow.u", shape=(2,), unit="rad")
    diagram.add_inlet("q", "pd.q", shape=(2,))
    diagram.add_inlet("v", "pd.v", shape=(2,), start=[0.5, -0.5])
    diagram.outlets = {"effort": "pd.effort", "slow": "slow", "ticks": "ticks"}
    return diagram


def inside() -> sf.Diagram:
    """A controller that moves a mechanism of its own between samples."""
    diagram = sf.Diagram("inside")
    diagram.add_model("arm", sf.load(MODELS / "rigid" / "double_pendulum.yaml"), start={"q1": 0.3})
    diagram.add(blocks.Hold(name="felt", period=2e-3))
    diagram.add(blocks.ForwardDynamics(name="model", model="arm"), u="felt")
    diagram.add(blocks.JointPD(name="pd", kp=20.0, kd=2.0, period=1e-3), q="model.q", v="model.v")
    diagram.add_inlet("goal", "pd.q_desired")
    diagram.add_inlet("load", "felt.u", shape=(2,))
    diagram.outlets = {"effort": "pd.effort", "guess": "model.q"}
    return diagram


def plant() -> sf.Diagram:
    """A mechanism with efforts that hold over each step."""
    diagram = sf.Diagram("plant")
    diagram.add_model("arm", sf.load(MODELS / "rigid" / "double_pendulum.yaml"), start={"q1": 0.3})
    diagram.add(blocks.ForwardDynamics(name="arm", model="arm"))
    diagram.add_inlet("effort", "arm.u")
    diagram.outlets = {"q": "arm.q", "v": "arm.v"}
    return diagram


def machine() -> sf.Diagram:
    """A state machine, whose conditions are of an input and of the time in a state."""
    diagram = sf.Diagram("machine")
    states = {
        "off": blocks.MachineState(during={"y": "0"}, exit={"count": "count + 1"}),
        "on": blocks.MachineState(during={"y": "u[0]*elapsed"}, entry={"y": "u[1]"}),
    }
    ways = (blocks.Transition("off", "on", "u[0]"), blocks.Transition("on", "off", "elapsed - 0.003"))
    outputs = {"y": 0.0, "count": 0.0}
    diagram.add(blocks.StateMachine(name="m", period=1e-3, machine_states=states, transitions=ways, outputs=outputs))
    diagram.add_inlet("u", "m.u", shape=(2,))
    diagram.outlets = {"y": "m.y", "count": "m.count", "state": "m.state"}
    return diagram


def conditional() -> sf.Diagram:
    """A part that is enabled by one input, and runs at edges of another."""
    part = sf.Diagram("part")
    part.add(blocks.Integrator(name="sum", start=0.5, period=1e-3))
    part.add(Counter(name="runs", period=1e-3))
    part.add_inlet("u", "sum.u")
    part.outlets = {"y": "sum.y", "runs": "runs"}
    diagram = sf.Diagram("conditional")
    diagram.add(blocks.Hold(name="signals", period=1e-3))
    diagram.add(blocks.Pick(name="a", entries=[0]), u="signals")
    diagram.add(blocks.Pick(name="b", entries=[1]), u="signals")
    reset: Any = {"outputs": "reset", "states": "reset", "initial": {"y": -1.0}}
    diagram.include("enabled", part, None, sf.Condition(enabled="a", **reset), u="b")
    diagram.include("triggered", part, None, sf.Condition(triggered="b", edge="either"), u="a")
    diagram.add_inlet("u", "signals.u", shape=(2,))
    diagram.outlets |= {"y": "enabled.y", "runs": "enabled.runs", "sum": "triggered.y", "edges": "triggered.runs"}
    return diagram


CASES: dict[str, Callable[[], sf.Diagram]] = {
    "rates": rates,
    "inside": inside,
    "plant": plant,
    "machine": machine,
    "conditional": conditional,
}


def outlets_of(diagram: sf.Diagram) -> list[str]:
    """Outlets of the diagram's own."""
    return [name for name in diagram.outlets if "." not in name]


def given(diagram: sf.Diagram) -> dict[str, np.ndarray]:
    """Values of each inlet at each instant: those of the inputs of its program."""
    rng = np.random.default_rng(7)
    return {name: rng.uniform(-1.0, 1.0, (STEPS, 2)) for name in diagram.inlets}


def closed(diagram: sf.Diagram, values: Mapping[str, np.ndarray]) -> sf.Diagram:
    """The same blocks as one diagram, which gives them those values."""
    whole = sf.Diagram("whole")
    for name, rows in values.items():
        whole.add(blocks.Sequence(name=name, t=RUN, values=rows, kind="hold"))
    fed: dict[str, Any] = {name: name for name in values}
    whole.include("part", diagram, **fed)
    return whole


def driven(
    diagram: sf.Diagram,
    folder: Path,
    values: Mapping[str, np.ndarray],
    *words: str,
    outputs: Any = None,
    times: int = 1,
) -> np.ndarray:
    """What the program of a diagram gives, line by line, begun so many times."""
    rows = np.tile(np.column_stack([RUN, *values.values()]), (times, 1))
    return cases.driven(diagram, folder, rows, *words, outputs=outputs)


@pytest.mark.parametrize("case", CASES)
def test_a_program_driven_by_steps_has_the_bits_of_one_diagram(case: str, tmp_path: Path) -> None:
    diagram = CASES[case]()
    values = given(diagram)
    # What a mechanism feels over a step is set before it: the first row is set twice.
    late = {name: rows[np.maximum(np.arange(STEPS) - 1, 0)] for name, rows in values.items()}
    found, again = driven(diagram, tmp_path / "driven", late if case == "plant" else values, times=2).reshape(
        2, STEPS, -1
    )
    assert (again == found).all()
    whole = closed(diagram, values)
    outputs = [f"part.{name}" for name in outlets_of(diagram)]
    assert (found == driven(whole, tmp_path / "whole", {}, outputs=outputs)).all()
    signals: dict[str, Any] = {name: sf.Signal(RUN, rows, "hold") for name, rows in values.items()}
    moved = sf.Simulation(diagram).run(RUN[-1], dt=1e-3, record=1e-3, inputs=signals)
    ours = np.concatenate([moved[name].reshape(STEPS, -1) for name in outlets_of(diagram)], axis=1)
    np.testing.assert_allclose(found, ours, rtol=1e-11, atol=1e-11)


def test_parameters_by_name_change_what_a_program_gives(tmp_path: Path) -> None:
    values = given(rates())
    found = driven(rates(), tmp_path / "c", values, "pd.kp[0]", "10", "pd.kd[1]", "0")
    moved = sf.Simulation(rates()).run(
        RUN[-1],
        record=1e-3,
        inputs={name: sf.Signal(RUN, rows, "hold") for name, rows in values.items()},
        parameters={"pd.kp": [10.0, 30.0], "pd.kd": [5.0, 0.0]},
    )
    np.testing.assert_allclose(found[:, :2], moved["effort"], rtol=1e-14)
    wrong = subprocess.run([tmp_path / "c" / "driven", "pd.kq", "1"], capture_output=True)
    assert wrong.returncode == 3


@pytest.mark.parametrize("compiler", [("gcc", "-std=c99"), ("g++", "-x", "c++")])
def test_the_header_names_inputs_outputs_and_parameters(compiler: tuple[str, ...], tmp_path: Path) -> None:
    folder = sf.export(rates(), "c", tmp_path / "c").folder
    (folder / "sizes.c").write_text(
        '#include "rates.h"\n'
        "int sizes[(RATES_IN_GOAL == 0 && RATES_IN_Q_WIDTH == 2 && RATES_IN_V == 4 && RATES_INPUTS == 6 &&\n"
        "           RATES_OUT_SLOW == 2 && RATES_OUT_TICKS_WIDTH == 1 && RATES_OUTPUTS == 5 &&\n"
        "           RATES_PAR_PD_KD == 2 && RATES_PARAMETERS == 4) ? 1 : -1];\n"
    )
    run(*compiler, "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "sizes.c", cwd=folder)
    check = subprocess.run([build(folder, "program"), "--check"], capture_output=True, text=True)
    assert check.returncode == 0, check.stdout
    readme = (folder / "README.md").read_text()
    assert "| `v` | 4 | 2 | rad/s | 0.5, -0.5 |" in readme
    assert "| `effort` | 0 | 2 | N m |  |" in readme


_TIMES = r"""
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "inside.h"
int main(void) {
    const size_t size = sym_program_size(inside_program());
    void *memory = malloc(size), *kept = malloc(size);
    sym_program_instance *it = sym_program_init(memory, size, inside_program());
    double last[2][INSIDE_OUTPUTS];
    int k, turn;
    it->inputs[INSIDE_IN_GOAL] = 0.7;
    for (k = 0; k <= 10; ++k) (void)sym_program_advance(it, k / 1000.0);
    memcpy(kept, memory, size);
    for (turn = 0; turn < 2; ++turn, memcpy(memory, kept, size)) {
        if (turn == 1) { /* refused, with nothing moved */
            const double wrong[] = {0.009, -1.0, NAN, HUGE_VAL};
            for (k = 0; k < 4; ++k) printf("%d ", (int)sym_program_advance(it, wrong[k]));
            printf("%d ", (int)sym_program_advance(it, 0.01 - 1e-15));
        }
        for (k = 11; k <= 20; ++k) (void)sym_program_advance(it, k / 1000.0);
        memcpy(last[turn], it->signals, sizeof last[turn]);
    }
    printf("%d\n", memcmp(last[0], last[1], sizeof last[0]));
    free(memory), free(kept);
    return 0;
}
"""


def test_a_program_refuses_times_before_the_present_and_goes_on_from_copies_of_its_memory(tmp_path: Path) -> None:
    folder = sf.export(inside(), "c", tmp_path, dt=1e-3).folder
    (folder / "times.c").write_text(_TIMES)
    build(folder, "times", *(name for name in cases.sources(folder) if name != "main.c"))
    assert run(folder / "times", cwd=folder).split() == ["-1", "-1", "-1", "-1", "1", "0"]


@pytest.mark.parametrize(
    ("inputs", "words"),
    [
        (None, "inlet 'q' is not given"),
        ({"goal": 0.0, "q": [0.0, 0.0]}, "inlet 'v' is not given"),
        ({"goal": 0.0, "q": 0.0, "v": 0.0, "w": 1.0}, "no inlet 'w'"),
        ({"goal": 0.0, "q": [0.0, 0.0, 0.0], "v": 0.0}, "inlet 'q': does not fit"),
        ({"goal": 0.0, "q": [[0.0], [0.0]], "v": 0.0}, r"inlet 'q': does not fit\n  found:  shape \(2, 1\)"),
        ({"goal": "1/(t - t)", "q": 0.0, "v": 0.0}, r"formula '1/\(t - t\)' has no value"),
        ({"goal": "sin(q)", "q": 0.0, "v": 0.0}, "formulas of inlets are of the time t"),
        ({"goal": "sin(", "q": 0.0, "v": 0.0}, "inlet 'goal'"),
        ({"goal": float("nan"), "q": 0.0, "v": 0.0}, "inlet .goal.: a number is not finite"),
    ],
)
def test_inputs_that_do_not_fit_are_refused(inputs: Any, words: str) -> None:
    with pytest.raises(sf.SymofrosError, match=words):
        sf.Simulation(rates()).run(0.01, inputs=inputs)


def test_numbers_signals_and_formulas_of_inlets_run_both_ways() -> None:
    inputs: dict[str, Any] = {"goal": ["sin(t)", 0.25], "q": 0.5, "v": sf.Signal([0.0, 0.01], [[0, 0], [1, 2]])}
    moved = sf.Simulation(rates()).run(0.01, record=1e-3, inputs=inputs)
    stepped = sf.Simulation(rates()).interpret(0.01, record=1e-3, inputs=inputs, compiled=False)
    np.testing.assert_allclose(moved["effort"], stepped["effort"], rtol=1e-13)
    np.testing.assert_allclose(moved["goal"], np.column_stack([np.sin(moved.t), np.full(11, 0.25)]), atol=1e-15)
    np.testing.assert_allclose(moved["v"][-1], [1.0, 2.0])
    assert (moved["q"] == 0.5).all()


def test_open_diagrams_that_cannot_leave_are_refused(tmp_path: Path) -> None:
    diagram = rates()
    diagram.add(Spoken(name="spoken", period=0.01, heard=[]), x="pd.effort")
    diagram.add(Spoken(name="heard", period=0.01, heard=[]), x="pd.effort")
    with pytest.raises(sf.ExportError, match="block 'spoken' calls Python; block 'heard' calls Python"):
        sf.export(diagram, "c", tmp_path / "c")
    unknown, twice, same = rates(), rates(), rates()
    unknown.inlet_ports.clear()
    with pytest.raises(sf.DescriptionError, match=r"its shape is unknown(?s:.)*shape=\(n,\)"):
        sf.export(unknown, "c", tmp_path / "c")
    twice.add_inlet("more", "pd.q")
    with pytest.raises(sf.DescriptionError, match="'pd.q' is fed twice"):
        sf.export(twice, "c", tmp_path / "c")
    same.add_inlet("ticks", "pd.v_desired")
    with pytest.raises(sf.DescriptionError, match="an inlet and a block are named 'ticks'"):
        sf.export(same, "c", tmp_path / "c")
    with pytest.raises(sf.ExportError, match="a program, function of Matlab, block, FMU or module"):
        sf.export(rates(), "urdf", tmp_path / "c")


def test_matrices_of_inlets_are_not_turned() -> None:
    def doubled(value: Any, start: Any = None) -> Any:
        diagram = sf.Diagram("matrix")
        diagram.add(blocks.Gain(name="twice", gain=2.0))
        diagram.add_inlet("x", "twice.u", shape=(2, 3), start=start)
        diagram.outlets = {"y": "twice"}
        return sf.Simulation(diagram).run(0.01, dt=1e-3, inputs={"x": value})["y"][-1]

    table = np.arange(6.0).reshape(2, 3)
    np.testing.assert_array_equal(doubled(table), 2.0 * table)
    np.testing.assert_array_equal(doubled(table.ravel()), 2.0 * table)
    for value, start in ((table.T, None), (table, table.T)):
        with pytest.raises(sf.DescriptionError, match=r"inlet 'x': does not fit\n  found: .*\(3, 2\)"):
            doubled(value, start)


@pytest.mark.parametrize("given", [{"frames": ["tip"]}, {"functions": ["dynamics"]}, {"start": {"q1": 1.0}}])
def test_arguments_of_models_are_refused_for_diagrams(given: dict[str, Any], tmp_path: Path) -> None:
    with pytest.raises(sf.ExportError, match=f"{next(iter(given))} is an argument of models"):
        sf.export(rates(), "c", tmp_path / "c", **given)
    assert not (tmp_path / "c").exists()


def test_a_program_bears_the_name_that_is_given(tmp_path: Path) -> None:
    there = {path.name for path in sf.export(rates(), "c", tmp_path / "c", name="own").files}
    assert {"own.h", "own_program.c"} <= there and not any(name.startswith("rates") for name in there)
    assert "own_program(void)" in (tmp_path / "c" / "own.h").read_text()
