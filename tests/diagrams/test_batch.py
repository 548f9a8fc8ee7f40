"""Simulation.run_batch: each run is that of Simulation.run, whatever becomes of the others."""

from __future__ import annotations

import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros import blocks
from symofros.diagrams import batch
from symofros.simulation.stepping.batch_stepper import run_batch_steppers
from tests.diagrams.parts import Ball, Lag, Spoken, arm, moving

PENDULUM = sf.load(Path(__file__).parents[2] / "reference_models" / "rigid" / "double_pendulum.yaml")
FOUR_BAR = sf.load(Path(__file__).parents[2] / "reference_models" / "closed" / "four_bar.yaml")
TOP = sf.load(Path(__file__).parents[2] / "reference_models" / "rigid" / "heavy_top.yaml")
FOUR_PARTS = r"[\s\S]*found:[\s\S]*rule:[\s\S]*remedy:"
N = 5


def bouncing() -> sf.Diagram:
    diagram = sf.Diagram("ball")
    diagram.add(Ball(name="ball"))
    return diagram


def lagging() -> sf.Diagram:
    """An inlet of two numbers behind a lag each, and one of one number."""
    diagram = sf.Diagram("lagging")
    diagram.add_inlet("goal", shape=(2,))
    diagram.add_inlet("one", shape=())
    diagram.add(blocks.Integrator(name="filter", start=[0.0, 1.0]), u="goal")
    diagram.add(Lag(name="lag"), x="one")
    return diagram


CASES: dict[str, tuple[Callable[[], sf.Diagram], dict[str, Any], dict[str, Any], tuple[str, ...]]] = {
    "arm": (
        lambda: arm(PENDULUM, 2.5e-3, q1=0.3),
        {"pd.kp": np.linspace([40.0, 20.0], [60.0, 40.0], N), "pd.kd": 4.0, "plant.m2": np.linspace(0.5, 1.5, N)},
        {"plant.q2": np.linspace(-1.0, 1.0, N), "plant.v": [0.1, 0.2]},
        ("plant.q", "pd.effort", "plant.a"),
    ),
    "ball": (bouncing, {}, {"ball.h": np.linspace(0.5, 1.0, N), "ball.n": 3.0}, ("ball.height", "ball.bounces")),
}


@pytest.mark.parametrize("options", [{}, {"method": "dopri5"}], ids=["rk4", "dopri5"])
@pytest.mark.parametrize("case", CASES)
def test_each_run_has_the_bits_of_a_single_one(case: str, options: dict[str, Any]) -> None:
    make, parameters, starts, signals = CASES[case]
    simulation = sf.Simulation(make())
    given = {"output": 0.05, **options}
    runs = simulation.run_batch(0.6, parameters=parameters, starts=starts, threads=2, **given)
    alone = simulation.run_batch(0.6, parameters=parameters, starts=starts, **given)
    assert runs.shape == (N,) and len(runs) == N and runs.ok.all()
    for i in range(N):
        one = [
            {name: np.asarray(of)[i] if np.shape(of)[:1] == (N,) else of for name, of in values.items()}
            for values in (parameters, starts)
        ]
        run = simulation.run(0.6, parameters=one[0], starts=one[1], **given)
        rows = np.searchsorted(run.t, runs.t, "right") - 1
        assert np.array_equal(run.t[rows], runs.t)
        for name in signals:
            assert np.array_equal(runs[name][i], run[name][rows])
            assert np.array_equal(alone[name], runs[name])
        again = runs[i]
        assert np.array_equal(again.q, run.q) and np.array_equal(again.v, run.v)
        assert str(again.outcome) == str(run.outcome) == str(runs.outcome(i))
        assert runs.t_last[i] == run.t[-1] and runs.steps[i] == run.cost.steps
    assert f"{N} finished" in str(runs)


@pytest.mark.parametrize("kind", ["numbers", "signal of all", "signals", "formula"])
def test_runs_have_inputs_of_their_own(kind: str) -> None:
    simulation = sf.Simulation(lagging())
    t, rng = np.linspace(0.0, 0.4, 9), np.random.default_rng(3)
    goals: Any = {
        "numbers": rng.standard_normal((N, 2)),
        "signal of all": sf.Signal(t, rng.standard_normal((9, 2))),
        "signals": sf.Signal(t, rng.standard_normal((N, 9, 2)), "hold"),
        "formula": ["sin(7*t)", "t"],
    }[kind]
    ones = np.linspace(-1.0, 1.0, N)
    runs = simulation.run_batch(0.4, inputs={"goal": goals, "one": ones}, output=0.1)
    assert runs.shape == (N,)
    for i in range(N):
        goal = goals
        if kind == "numbers":
            goal = goals[i]
        elif kind == "signals":
            goal = sf.Signal(t, goals.values[i], "hold")
        run = simulation.run(0.4, inputs={"goal": goal, "one": ones[i]}, output=0.1)
        for name in ("filter.y", "lag.y", "goal"):
            assert np.array_equal(runs[name][i], run[name])
            assert np.array_equal(runs[i][name], run[name])


def test_batch_dimensions_broadcast() -> None:
    simulation = sf.Simulation(lagging())
    goals, ones = np.zeros((3, 1, 2)), np.ones(4)
    runs = simulation.run_batch(0.1, inputs={"goal": goals, "one": ones}, output=0.1)
    assert runs.shape == (3, 4) and runs["lag.y"].shape == (3, 4, 2) and runs["goal"].shape == (3, 4, 2, 2)
    assert np.array_equal(runs[2, 1]["lag.y"], runs["lag.y"][2, 1])
    with pytest.raises(sf.ShapeError, match=r"index 2 is not that of one run" + FOUR_PARTS):
        runs[2]
    single = simulation.run_batch(0.1, inputs={"goal": 0.0, "one": 1.0}, output=0.1)
    assert single.shape == () and single.ok
    for none in ({"goal": 0.0, "one": np.zeros(0)}, {"goal": sf.Signal([0.0, 1.0], np.zeros((0, 2, 2))), "one": 0.0}):
        assert len(simulation.run_batch(0.1, inputs=none, output=0.1)) == 0


def test_a_run_that_ends_before_leaves_the_others_alone() -> None:
    simulation = sf.Simulation(arm(PENDULUM, None))
    kd = np.array([[5.0, 3.0], [-1e5, -1e5], [4.0, 2.0]])
    runs = simulation.run_batch(0.3, parameters={"pd.kd": kd}, output=0.1)
    good = simulation.run_batch(0.3, parameters={"pd.kd": kd[[0, 2]]}, output=0.1)
    assert runs.ok.tolist() == [True, False, True]
    assert np.array_equal(runs["plant.q"][[0, 2]], good["plant.q"])
    assert np.isnan(runs["plant.q"][1, -1]).all() and runs.t_last[1] < 0.3
    assert runs.kinds[1] == runs.outcome(1).kind == "diverged"
    assert "1 diverged, 2 finished" in repr(runs) and "first: [1]: diverged" in str(runs)


def test_starts_of_closed_loops_are_kept_or_end_their_own_run() -> None:
    simulation = sf.Simulation(moving(FOUR_BAR))
    on = simulation.run(0.01).q[0]
    model = sf.compile(FOUR_BAR)
    q = np.array([on, sf.assemble(model, on + 0.1 * np.arange(1, len(on) + 1)).q, on + 0.3])
    runs = simulation.run_batch(0.01, starts={"plant.q": q}, output=0.01)
    assert runs.kinds.tolist() == ["finished", "finished", "constraints lost"]
    assert np.abs(runs.q[:2, 0] - q[:2]).max() < 1e-8
    assert runs.outcome(2).kind == "constraints lost" and "does not meet the constraints" in str(runs)
    with pytest.raises(sf.AssemblyError):
        runs[2]


def test_an_interrupt_keeps_the_finished_part(monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = sf.Simulation(arm(PENDULUM, 1e-3))
    simulation.run(0.01)

    def ring(*_: object) -> None:
        raise KeyboardInterrupt

    def alarmed(shares: Any) -> None:
        signal.setitimer(signal.ITIMER_REAL, 0.5)
        run_batch_steppers(shares)

    monkeypatch.setattr(batch, "run_batch_steppers", alarmed)
    before = signal.signal(signal.SIGALRM, ring)
    try:
        runs = simulation.run_batch(100.0, starts={"plant.q1": np.zeros(64)}, output=50.0, threads=2, dt=1e-4)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert "interrupted" in runs.kinds and set(runs.kinds) <= {"interrupted", "finished"}
    assert runs.t_last.max() > 0.0 and runs.t_last.min() == 0.0


@pytest.mark.parametrize(
    ("given", "error", "message"),
    [
        ({"starts": {"plant.q3": 0.0}}, sf.UnknownNameError, "no state 'plant.q3'"),
        ({"starts": {"plant.q": np.zeros(3)}}, sf.ShapeError, "start 'plant.q' does not fit"),
        ({"parameters": {"pd.kp": np.zeros((4, 3))}}, sf.ShapeError, "parameter 'pd.kp' does not fit"),
        ({"parameters": {"pd.kq": 1.0}}, sf.UnknownNameError, "no run-time parameter 'pd.kq'"),
        ({"parameters": {"plant.m2": np.array([1.0, -1.0])}}, sf.ParameterError, r"run \[1\]: "),
        ({"starts": {"plant.q1": np.zeros(3), "plant.q2": np.zeros(2)}}, sf.ShapeError, "do not broadcast"),
        ({"realtime": True}, sf.SymofrosError, "an option of single runs"),
        ({"threads": 0}, sf.SymofrosError, "no thread"),
        ({"threads": 1.5}, sf.ArgumentError, "threads is not a whole number"),
        ({"method": "rodas4"}, sf.SymofrosError, "method 'rodas4'"),
        ({"rtol": 1e-3, "threads": 2, "starts": {"plant.q1": np.zeros(3)}}, sf.SymofrosError, "adaptive steps, 'rtol'"),
    ],
)
def test_invalid_arguments_are_refused(given: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message + FOUR_PARTS):
        sf.Simulation(arm(PENDULUM)).run_batch(0.01, **given)


def test_values_that_a_single_run_refuses_are_refused_with_the_run() -> None:
    with pytest.raises(sf.SymofrosError, match=r"run \[1\]: signal: not samples over time" + FOUR_PARTS):
        goals = np.array([[0.0, 0.0], [np.nan, 0.0]])
        sf.Simulation(lagging()).run_batch(0.1, inputs={"goal": goals, "one": 0.0})
    with pytest.raises(sf.ShapeError, match=r"run \[1\]: model 'heavy_top': start of 'plant'" + FOUR_PARTS):
        q = sf.compile(TOP).neutral()
        sf.Simulation(moving(TOP)).run_batch(0.1, starts={"plant.q": [q, 2.0 * q]})


def test_numbers_at_an_inlet_whose_shape_nothing_says_are_refused() -> None:
    """A single run takes its shape from what is given, which a batch cannot."""
    diagram = sf.Diagram("open")
    diagram.add_inlet("e", "sum.u")
    diagram.add(blocks.Integrator(name="sum"))
    simulation = sf.Simulation(diagram)
    assert simulation.run(0.1, inputs={"e": [1.0, 2.0]}, output=0.1)["sum.y"].shape == (2, 2)
    with pytest.raises(sf.DescriptionError, match="inlet 'e'[\\s\\S]*its shape is unknown"):
        simulation.run_batch(0.1, inputs={"e": [1.0, 2.0]}, output=0.1)
    assert simulation.run_batch(0.1, inputs={"e": 1.0}, output=0.1)["sum.y"].shape == (2,)


def test_blocks_of_python_are_refused_by_name() -> None:
    diagram = sf.Diagram("spoken")
    diagram.add(blocks.Constant(name="one", value=1.0))
    diagram.add(Spoken(name="echo", heard=[], period=1e-3), x="one")
    with pytest.raises(sf.SymofrosError, match="block 'echo' in a batch" + FOUR_PARTS):
        sf.Simulation(diagram).run_batch(0.01)


def test_single_runs_and_steppers_start_where_a_call_states() -> None:
    simulation, stated = sf.Simulation(arm(PENDULUM)), sf.Simulation(arm(PENDULUM, q1=0.4, q2=-0.2))
    starts = {"plant.q": [0.4, -0.2]}
    run, other = simulation.run(0.05, starts=starts), stated.run(0.05)
    assert np.array_equal(run.q, other.q) and str(run.outcome) == str(other.outcome)
    stepper = simulation.stepper(output=0.05)
    stepper.reset(starts=starts)
    stepper.step()
    assert np.array_equal(stepper["plant.q"], run["plant.q"][-1])
    assert np.array_equal(stepper.trajectory().q[-1], run.q[-1])
