"""Interpreted runs locate crossings as compiled ones do: the same ones at the same instants, states to rounding."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import symofros as sf
from symofros import blocks
from tests.diagrams.parts import Ball, moving
from tests.diagrams.test_conditional import SAME_BITS
from tests.diagrams.test_enabled import EVERY, whole
from tests.exports.test_diagram import switching
from tests.models import GUESSES, compiled
from tests.simulation.oscillator import oscillator_system
from validation.references import MODELS


def ball() -> sf.Diagram:
    """A ball that bounces: states change at crossings."""
    diagram = sf.Diagram("ball")
    diagram.add(Ball(name="ball"))
    return diagram


def relayed() -> sf.Diagram:
    """An arm that a relay drives, and an integral that the relay resets."""
    diagram = moving(MODELS["double_pendulum"], {"q1": 0.6}, u="effort.y")
    diagram.add(blocks.Pick(name="first", entries=0), u="plant.q")
    diagram.add(blocks.Relay(name="relay", lower=1.3, upper=1.4, on=-3.0, off=3.0), u="first.y")
    diagram.add(blocks.Constant(name="none", value=0.0))
    diagram.add(blocks.Join(name="effort", unit="N m"), u1="relay.y", u2="none.y")
    diagram.add(blocks.Integrator(name="sum", reset="both"), u="first.y", reset="relay.y")
    return diagram


def looped() -> sf.Diagram:
    """A loop whose crank switches a relay: states within steps are projected."""
    model = compiled("parallelogram")
    first = sf.assemble(model, GUESSES["parallelogram"], np.full(model.nv, 2.0))
    start = {**dict(zip(model.names.q, first.q, strict=True)), "dq1": float(first.v[0])}
    diagram = moving(MODELS["parallelogram"], start)
    diagram.add(blocks.Pick(name="crank", entries=0), u="plant.q")
    diagram.add(blocks.Relay(name="relay", lower=0.89, upper=0.91), u="crank.y")
    return diagram


def rounded() -> sf.Diagram:
    """Relays whose inputs differ by rounding: they switch at one instant, whichever is found first."""
    diagram = sf.Diagram("rounded")
    diagram.add(blocks.Integrator(name="x"), u="rate.y")
    diagram.add(blocks.Formula(name="rate", formulas={"y": "cos(3*t)"}))
    for i, factor in enumerate((1.0, 3.0, 7.0, 0.1, 1.7)):
        diagram.add(blocks.Formula(name=f"by{i}", formulas={"y": f"({factor}*x)/{factor}"}), x="x.y")
        diagram.add(blocks.Relay(name=f"r{i}", lower=-0.2, upper=0.2), u=f"by{i}.y")
    return diagram


CASES: dict[str, Callable[[], sf.Diagram]] = {
    "ball": ball,
    "relayed": relayed,
    "looped": looped,
    "switching": lambda: switching()[0],
    **{signal: lambda signal=signal: whole(EVERY, signal) for signal in ("wave", "relay", "sampled")},  # type: ignore[misc]
}


@pytest.mark.parametrize("name", CASES)
def test_crossings_are_those_of_the_compiled_run(name: str) -> None:
    simulation = sf.Simulation(CASES[name](), SAME_BITS)
    t_end = 0.25 if name == "looped" else 1.1
    run = simulation.run(t_end, dt=5e-3, record=0.05)
    other = simulation.interpret(t_end, dt=5e-3, record=0.05, compiled=False)
    assert run.outcome.kind == other.outcome.kind == "finished"
    assert run.outcome.notes == other.outcome.notes
    assert run.crossings and [one[:2] for one in run.crossings] == [one[:2] for one in other.crossings]
    near = {"rtol": 1e-11, "atol": 1e-11}
    np.testing.assert_allclose([one.t for one in other.crossings], [one.t for one in run.crossings], **near)
    np.testing.assert_allclose(other.t, run.t, **near)
    for source, values in other.values.items():
        np.testing.assert_allclose(values, run[".".join(source)], **near, err_msg=".".join(source))


def test_instants_have_the_bits_of_the_compiled_run_where_signals_do() -> None:
    """Those of formulas of time, with steps that begin anew at each."""
    simulation = sf.Simulation(whole(EVERY, "wave"), SAME_BITS)
    run, other = simulation.run(2.5, dt=5e-3), simulation.interpret(2.5, dt=5e-3, compiled=False)
    assert len(run.crossings) == 24 and run.crossings == other.crossings and np.array_equal(run.t, other.t)


def test_crossings_that_differ_by_rounding_are_met_at_one_instant() -> None:
    """In any order; none is lost behind the one that is found first."""
    runs = [sf.Simulation(rounded(), SAME_BITS).interpret(1.5, dt=5e-3), sf.Simulation(rounded()).run(1.5, dt=5e-3)]
    for run in runs:
        assert sorted(one[:2] for one in run.crossings) == [
            (f"r{i}", which) for i in range(5) for which in ("off", "on")
        ]


def test_endless_crossings_end_an_interpreted_run() -> None:
    diagram = sf.Diagram("chatter")
    diagram.add(blocks.Formula(name="error", formulas={"y": "t - 0.51 - 0.2*u"}), u="relay.y")
    diagram.add(blocks.Relay(name="relay", lower=-0.05, upper=0.05, on=1.0, off=0.0), u="error.y")
    simulation = sf.Simulation(diagram)
    run, other = simulation.run(1.0, dt=1e-2), simulation.interpret(1.0, dt=1e-2)
    assert run.outcome.kind == other.outcome.kind == "interrupted"
    assert run.outcome.reason == other.outcome.reason and run.outcome.t == pytest.approx(other.outcome.t, abs=1e-12)


def test_steps_with_crossings_are_examined() -> None:
    """A spring that a relay drives: long steps are noted, short ones are not, and a part begins behind a crossing."""
    diagram = moving(oscillator_system(k=1e-6), {"x": 1.0, "dx": 0.0}, u="force.y")
    diagram.add(blocks.Pick(name="x", entries=0), u="plant.q")
    diagram.add(blocks.Relay(name="relay", lower=-0.05, upper=0.05, on=-1.0, off=1.0), u="x.y")
    diagram.add(blocks.Formula(name="force", formulas={"y": ["-300*x^3 + 0.5*r"]}), x="x.y", r="relay.y")
    simulation = sf.Simulation(diagram)
    notes = {dt: simulation.interpret(4.0, dt=dt, record=0.1).outcome.notes for dt in (0.1, 2e-3)}
    assert notes[0.1] and not notes[2e-3]


def test_crossings_that_are_not_followed_are_noted() -> None:
    diagram = sf.Diagram("fast")
    diagram.add(blocks.Integrator(name="x"), u="one.y")
    diagram.add(blocks.Constant(name="one", value=1.0))
    diagram.add(blocks.Formula(name="wave", formulas={"y": "sin(1e9*x)"}), x="x.y")
    diagram.add(blocks.Relay(name="relay", lower=-2.0, upper=2.0), u="wave.y")
    (note,) = sf.Simulation(diagram).interpret(0.01, dt=1e-2, record=1e-2).outcome.notes
    assert "changes too often in the step from t = 0 s on" in note
