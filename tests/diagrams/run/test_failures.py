"""What ends a run of a diagram is named: the block, its output, the line of Python."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import ForwardDynamics, PythonBlock
from tests.simulation.oscillator import oscillator_system

PERIOD = 0.01


def run_with(function: Callable[[float, Any], Any], **options: Any) -> sf.DiagramRun:
    """An oscillator that a function of Python's pushes."""
    diagram = sf.Diagram("pushed")
    diagram.add_model("plant", oscillator_system())
    diagram.add(PythonBlock(name="law", function=function, outputs={"force": (1,)}, period=PERIOD))
    diagram.add(ForwardDynamics(name="plant", model="plant"), u="law.force")
    return sf.Simulation(diagram).run(0.2, **options)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_an_output_that_is_not_finite_names_block_and_line(method: str, bad: float) -> None:
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


@pytest.mark.parametrize("method", ["rk4", "semi_implicit_euler"])
def test_a_step_past_the_limit_of_stability_is_told(method: str) -> None:
    """A spring of 1000 rad/s beside a controller, by steps of 1 ms to 5 ms."""
    diagram = sf.Diagram("stiff")
    diagram.add_model("plant", oscillator_system(k=1e6), start={"x": 1e-3})
    diagram.add(PythonBlock(name="law", function=lambda t, _: {"force": [0.0]}, outputs={"force": (1,)}, period=PERIOD))
    diagram.add(ForwardDynamics(name="plant", model="plant"), u="law.force")
    simulation = sf.Simulation(diagram)
    assert not simulation.run(0.2, method="rk4", dt=1e-4, record=PERIOD).outcome.notes
    (note,) = simulation.run(0.05, method=method, dt=5e-3, record=PERIOD).outcome.notes
    assert "past the limit of stability" in note and "oscillates at 1000 rad/s" in note
    far = simulation.run(20.0, method=method, dt=5e-3, record=PERIOD).outcome
    assert far.kind == "diverged" and "stability" in far.reason and "dt below 0.00" in far.advice
