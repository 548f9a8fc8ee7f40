"""What ends a run of a diagram is named: the block, its output, the line of Python."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import Formula, PythonBlock, Sine
from tests.diagrams.parts import Lag, moving
from tests.simulation.mechanisms import turned
from tests.simulation.oscillator import oscillator_system

PERIOD = 0.01


def run_with(function: Callable[[float, Any], Any], **options: Any) -> sf.DiagramRun:
    """An oscillator that a function of Python's pushes."""
    diagram = moving(oscillator_system(), u="law.force")
    diagram.add(PythonBlock(name="law", function=function, outputs={"force": (1,)}, period=PERIOD))
    return sf.Simulation(diagram).run(0.2, **options)


@pytest.mark.parametrize(("method", "bad"), [("rk4", np.nan), ("dopri5", np.inf)])
def test_non_finite_outputs_name_block_and_line(method: str, bad: float) -> None:
    def push(t: float, inputs: Any) -> dict[str, list[float]]:
        return {"force": [bad if t > 0.095 else 0.0]}

    outcome = run_with(push, method=method, dt=1e-3).outcome
    assert outcome.kind == "input failed" and "smaller dt" not in outcome.advice
    line = push.__code__.co_firstlineno
    assert f"block 'law': output 'force' is {bad} at t = 0.1 s" in outcome.reason
    assert f"push (test_failures.py:{line})" in outcome.reason


def test_an_exception_names_block_and_line_and_keeps_its_traceback() -> None:
    def push(t: float, inputs: Any) -> dict[str, list[float]]:
        if t > 0.095:
            raise LookupError("no such gain")
        return {"force": [0.0]}

    outcome = run_with(push, dt=1e-3).outcome
    assert outcome.kind == "input failed" and isinstance(outcome.failure, LookupError)
    assert "block 'law' raised LookupError('no such gain') at test_failures.py:" in outcome.reason
    assert traceback.extract_tb(outcome.failure.__traceback__)[-1].name == "push"


def test_an_output_that_nothing_needs_is_noted_only() -> None:
    diagram = sf.Diagram("idle")
    diagram.add(PythonBlock(name="idle", function=lambda t, inputs: {"y": np.nan}, outputs={"y": ()}, period=PERIOD))
    outcome = sf.Simulation(diagram).run(0.05, dt=PERIOD).outcome
    assert outcome.ok and "block 'idle': output 'y' is nan" in outcome.notes[0]


def fed_back(formula: str, period: float | None = None) -> sf.Simulation:
    """An oscillator under a formula of its displacement."""
    diagram = moving(oscillator_system(k=100.0), start={"x": 0.1}, u="law.force")
    diagram.add(Formula(name="half", formulas={"y": "x[0]/2"}), x="plant.q")
    diagram.add(Formula(name="law", formulas={"force": [formula]}, period=period), x="half.y")
    return sf.Simulation(diagram)


@pytest.mark.parametrize("period", [None, 0.01])
@pytest.mark.parametrize(("formula", "value"), [("sqrt(x)", "nan"), ("-1/max(x - 0.02, 0)", "-inf")])
def test_non_finite_formulas_are_named_compiled_and_interpreted(formula: str, value: str, period: float | None) -> None:
    simulation = fed_back(formula, period)
    # Adaptive steps come closer to the pole of an infinite force without end: "step too small".
    methods = ("rk4", "dopri5", "euler") if value == "nan" else ("rk4", "euler")
    outcomes = [simulation.run(1.0, method=method, dt=1e-3).outcome for method in methods]
    outcomes.append(simulation.interpret(1.0, dt=1e-3, compiled=False).outcome)
    for outcome in outcomes:
        assert outcome.kind == "input failed", outcome
        when = "before t = 0." if period else "at t = 0."
        assert f"block 'law': output 'force' is {value} {when}" in outcome.reason
        assert period or ", with x = " in outcome.reason


def test_a_non_finite_first_output_is_named() -> None:
    with pytest.raises(sf.SymofrosError, match="block 'law': output 'force' is nan at t = 0 s, with x = 0.05"):
        fed_back("sqrt(-x)").run(1.0, dt=1e-3)
    assert "output 'force' is nan at t = 0 s" in fed_back("sqrt(-x)").interpret(1.0, compiled=False).outcome.reason


def test_a_signal_that_makes_a_state_non_finite_is_named() -> None:
    diagram = sf.Diagram("rate")
    diagram.add(Sine(name="wave", frequency=7.0 / (2.0 * np.pi)))
    diagram.add(Formula(name="root", formulas="sqrt(x)"), x="wave.y")
    diagram.add(Lag(name="lag"), x="root.y")
    outcome = sf.Simulation(diagram).run(1.0, dt=1e-3).outcome
    assert "block 'root': output 'y' is nan" in outcome.reason and outcome.t == pytest.approx(np.pi / 7, abs=2e-3)


def test_an_unstable_step_is_reported() -> None:
    """A spring of 1000 rad/s beside a controller, by steps of 1 ms to 5 ms."""
    diagram = moving(oscillator_system(k=1e6), start={"x": 1e-3}, u="law.force")
    diagram.add(PythonBlock(name="law", function=lambda t, _: {"force": [0.0]}, outputs={"force": (1,)}, period=PERIOD))
    simulation = sf.Simulation(diagram)
    assert not simulation.run(0.2, method="rk4", dt=1e-4, record=PERIOD).outcome.notes
    (note,) = simulation.run(0.05, method="semi_implicit_euler", dt=5e-3, record=PERIOD).outcome.notes
    assert "past the limit of stability" in note and "oscillates at 1000 rad/s" in note
    far = simulation.run(20.0, method="rk4", dt=5e-3, record=PERIOD).outcome
    assert far.kind == "diverged" and "stability" in far.reason and "dt below 0.00" in far.advice


@pytest.mark.parametrize("length", [1.0, 0.9])
@pytest.mark.parametrize("interpreted", [False, True])
def test_a_wire_may_prescribe_unit_quaternions_only(length: float, interpreted: bool) -> None:
    """A quaternion of another length would turn and stretch what it carries, without a word."""
    diagram = moving(turned(), u="turn.u")
    diagram.add(Formula(name="turn", formulas={"u": ["0*t", "0", "0", f"1 + {length - 1.0}*t", *["0"] * 6]}))
    simulation = sf.Simulation(diagram)
    run = simulation.interpret(1.0, dt=0.01, compiled=False) if interpreted else simulation.run(1.0, dt=0.01)
    if length == 1.0:
        assert run.outcome.ok
    else:
        assert run.outcome.kind == "input failed" and "block 'turn': output 'u' prescribes" in run.outcome.reason
        assert 0.0 < run.outcome.t < 0.1
