"""What ends a run is named: the input, the function and its line, the step; nothing else is blamed."""

from __future__ import annotations

import math
import traceback
from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.results.examination.run import ExaminedRun
from symofros.simulation.stepping.status import Status
from tests.models import compiled
from tests.simulation.mechanisms import turned
from tests.simulation.oscillator import oscillator

BAD = (np.nan, np.inf, -np.inf)
METHODS = ("rk4", "dopri5", "implicit_euler", "rodas4", "generalized_alpha")


@pytest.mark.parametrize(("method", "bad"), list(zip(("rk4", "dopri5", "cvode"), BAD, strict=True)))
def test_a_function_that_returns_no_finite_number_is_named_with_its_line(method: str, bad: float) -> None:
    def push(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.array([bad if t > 0.1 else 1.0])

    run = sf.simulate(oscillator(), t_end=0.3, u=push, method=method, dt=1e-2)
    line = push.__code__.co_firstlineno
    assert run.outcome.kind == "input failed" and 0.05 < run.outcome.t <= 0.11
    assert f"input 'x' is {bad} at t = 0.1" in run.outcome.reason
    assert f"push (test_diagnosis.py:{line})" in run.outcome.reason
    assert "smaller dt" not in run.outcome.advice


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("formula", "bad"), [("sqrt(0.1 - t)", "nan"), ("log(t - 0.1)", "nan"), ("exp(1e300*(t - 0.1))", "inf")]
)
def test_a_formula_without_a_value_is_named(formula: str, bad: str, method: str) -> None:
    run = sf.simulate(oscillator(), t_end=0.3, u={"x": formula}, method=method, dt=1e-2)
    assert run.outcome.kind == "input failed", run.outcome
    assert f"input 'x' is {bad}" in run.outcome.reason or f"input 'x' is -{bad}" in run.outcome.reason
    assert formula in run.outcome.reason


@pytest.mark.parametrize(("given", "bad"), [("array", np.nan), ("number", np.inf)])
def test_non_finite_constants_are_refused_by_name(given: str, bad: float) -> None:
    u: Any = [bad] if given == "array" else {"x": bad}
    with pytest.raises(sf.ShapeError, match="input 'x' is not a finite number"):
        sf.simulate(oscillator(), u=u)


@pytest.mark.parametrize(("given", "bad"), [("rows", np.nan), ("named", -np.inf)])
def test_a_non_finite_constant_ends_only_its_own_trajectory(given: str, bad: float) -> None:
    for which in (0, 2):
        values = np.ones(4)
        values[which] = bad
        u: Any = values[:, np.newaxis] if given == "rows" else {"x": values}
        many = sf.simulate_batch(oscillator(), np.zeros((4, 1)), t_end=0.1, u=u, dt=1e-2)
        assert np.flatnonzero(~many.ok).tolist() == [which]
        assert many.outcome(which).kind == "input failed" and "input 'x' is" in many.outcome(which).reason


@pytest.mark.parametrize("root", ["sqrt(0.6 - x)", "sqrt(0.05 - t)"])
def test_an_undefined_formula_in_a_batch_is_named(root: str) -> None:
    many = sf.simulate_batch(oscillator(), [[0.0], [0.5]], [1.0], 0.1, u={"x": f"10 + {root}"}, dt=1e-3, output=0.01)
    assert not many.ok[1]
    assert "input 'x' is nan" in many.outcome(1).reason and root in many.outcome(1).reason


@pytest.mark.parametrize("method", ["rk4", "dopri5", "cvode"])
def test_an_exception_of_a_function_keeps_its_traceback(method: str) -> None:
    def inner() -> float:
        raise LookupError("no such gain")

    def push(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.array([inner() if t > 0.1 else 0.0])

    outcome = sf.simulate(oscillator(), t_end=0.3, u=push, method=method, dt=1e-2).outcome
    assert outcome.kind == "input failed" and isinstance(outcome.failure, LookupError)
    assert "LookupError('no such gain') at test_diagnosis.py:" in outcome.reason and "in push" in outcome.reason
    names = [frame.name for frame in traceback.extract_tb(outcome.failure.__traceback__)]
    assert names[-2:] == ["push", "inner"]


@pytest.mark.parametrize("method", ["rk4", "semi_implicit_euler", "euler", "dop853"])
@pytest.mark.parametrize("name", ["double_pendulum", "cart_pole", "chain7", "gyroscope"])
def test_a_step_that_is_too_long_is_not_called_a_singular_mass_matrix(name: str, method: str) -> None:
    model = compiled(name)
    q, v = model.random_state(np.random.default_rng(2))
    for dt in (0.05, 0.2, 1.0):
        run = sf.simulate(model, q, 3.0 * v, 20.0, method=method, dt=dt, adaptive=False if method == "dop853" else None)
        assert run.outcome.kind in ("finished", "diverged"), (dt, run.outcome)


@pytest.mark.parametrize("length", [1.0, 0.9, np.nan])
def test_analyses_take_rotations_alone_for_inputs(length: float) -> None:
    model = sf.compile(turned())
    u = np.array([0, 0, 0, length, *[0.0] * 6])
    analyses = (
        lambda: sf.equilibrium(model, [1.5], u=u),
        lambda: sf.modes(model, [0.5 * np.pi], u=u),
        lambda: sf.state_space(model, [0.5 * np.pi], u=u),
        lambda: sf.actuator_efforts(model, [0.1], [0.0], [0.0], ["q"], u=u),
        lambda: sf.assemble(model, [0.1], u=u),
    )
    for analysis in analyses:
        if length == 1.0:
            analysis()
        else:
            with pytest.raises(sf.SymofrosError, match="no rotation(.|\n)*p.qx, p.qy, p.qz, p.qw|finite"):
                analysis()


@pytest.mark.parametrize("kind", ["number", "formula", "samples", "function"])
@pytest.mark.parametrize("method", METHODS)
def test_quaternions_that_prescribe_a_motion_are_of_unit_length(method: str, kind: str) -> None:
    """Of another length they would turn and stretch what they carry, without a word."""
    model = sf.compile(turned())
    array = np.array([0, 0, 0, 1.5, *[0.0] * 6])
    samples = sf.Signal([0.0, 0.1, 0.2], [1.0, 1.0, 0.0])  # Turned by 2 pi: the chord between q and -q is no rotation.
    u = {
        "number": {"p.qw": 0.9},
        "formula": {"p.qw": "1 + t^2"},
        "samples": {"p.qw": samples},
        "function": lambda t, q, v: array,
    }[kind]
    if kind == "function" and method not in ("rk4", "dopri5"):
        return
    run = sf.simulate(model, [0.3], u=u, t_end=0.3, dt=0.01, method=method)
    assert run.outcome.kind == "input failed" and run.outcome.t < 0.15
    assert "p.qx, p.qy, p.qz, p.qw are a quaternion of length" in run.outcome.reason
    if kind == "number" and method in ("rk4", "dopri5"):
        many = sf.simulate_batch(model, [[0.3], [0.2]], u=u, t_end=0.3, dt=0.01, method=method)
        assert [many.outcome(i).reason for i in range(2)] == [run.outcome.reason] * 2
    assert sf.simulate(model, [0.3], u={"p.qw": -1.0}, t_end=0.03, dt=0.01, method=method).outcome.ok


def test_vanishing_steps_are_noted_where_a_run_is_cut() -> None:
    """A fall to the centre of a force without bound, cut early and beside the centre; advice for the latter alone."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), effort=("-1/x^2",))
    system = sf.System("s", (sf.RigidBody("b", joint, sf.Inertia(1.0)),), gravity=(0, 0, 0))
    model = sf.compile(system, sf.Options(backend="tape"))
    given: dict[str, Any] = {"t_end": 2.0, "method": "dopri5", "rtol": 1e-10, "atol": 1e-12}
    last = sf.simulate(model, [1.0], **given)
    assert last.outcome.kind == "step too small"
    for steps, noted in ((20, False), (last.statistics.steps - 3, True)):
        end = sf.simulate(model, [1.0], max_steps=steps, **given).outcome
        assert end.kind == "interrupted" and end.reason.startswith(f"max_steps: {steps} steps are done")
        assert ("and the next would be" in end.reason) == ("force that has no bound" in end.advice) == noted


@cache
def hopper() -> sf.Model:
    """A beam whose foot falls on a stiff floor, below a slide with dry friction."""
    slide = sf.Joint("z", "prismatic", axis=(0, 0, 1), elements=(sf.Friction(1.0, sticks=True),))
    hinge = sf.Joint("q", "revolute", "base", axis=(0, 1, 0))
    bending: dict[str, Any] = {"EI_z": 10.0, "EI_y": 10.0, "bend_y": 1, "bend_z": 1}
    leg = sf.Beam("leg", hinge, 1.0, 1.0, frames=(sf.Frame("foot", at=1.0),), **bending)
    floor = sf.Contact("floor", ("leg", "foot"), ("world", None), 1e5, exponent=1.0, radius=0.05)
    return sf.compile(sf.System("hopper", (sf.RigidBody("base", slide, sf.Inertia(1.0)), leg), connections=(floor,)))


@pytest.mark.parametrize(
    ("method", "dt", "events"),
    [("rk4", 0.05, 0), ("rk4", 0.03373327929362365, 1), ("generalized_alpha", 0.022758682638032345, 1)],
)
def test_steps_that_are_too_long_are_no_singular_posture(method: str, dt: float, events: int) -> None:
    """What bends a beam until its second-order mass matrix is singular, over events as well; shorter steps go on."""
    model, start = hopper(), [1.0, 0.8, 0.0, 0.0]
    run = sf.simulate(model, start, method=method, dt=dt, beam_limit=math.inf)
    words = (
        f"the step of {dt:.4g} s is too long: an eighth of that goes on past t = {run.outcome.t:.6g} s, where the mass"
    )
    assert run.outcome.kind == "diverged" and run.outcome.reason.startswith(words), run.outcome
    assert "a smaller dt" in run.outcome.advice and len(run.events) == events
    assert sf.simulate(model, start, t_end=run.outcome.t + dt, dt=dt / 8, beam_limit=math.inf).outcome.ok


def test_postures_that_shorter_steps_do_not_pass_stay_singular(monkeypatch: pytest.MonkeyPatch) -> None:
    """They have to go on for two steps beyond where the run ends."""
    asked = list[tuple[float, float]]()

    def repeated(run: ExaminedRun, start: Any, t_end: float, dt: float, **options: Any) -> tuple[int, list[np.ndarray]]:
        asked.append((t_end, dt))
        return Status.SINGULAR, []

    monkeypatch.setattr(ExaminedRun, "repeated", repeated)
    run = sf.simulate(hopper(), [1.0, 0.8, 0.0, 0.0], dt=0.05, beam_limit=math.inf)
    assert run.outcome.kind == "singular" and run.outcome.reason.startswith("the mass matrix is singular")
    assert np.array(asked[-2:]) == pytest.approx(
        np.array([(run.outcome.t + 0.1, 0.05 / 8), (run.outcome.t + 0.1, 0.05 / 64)])
    )
