"""SUNDIALS' CVODE and IDA behind `sf.simulate`."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.base.measures import FORMULA, OTHER, Measures
from symofros.simulation.stepping.sundials import combinations
from tests.models import compiled
from tests.overconstrained import Bennett
from tests.simulation.mechanisms import slide


def moving(name: str) -> tuple[sf.Model, np.ndarray, np.ndarray]:
    model = compiled(name)
    q, v = model.random_state(np.random.default_rng(3))
    return model, q, 0.3 * v


@pytest.mark.parametrize("method", ["cvode", "cvode_adams", "ida"])
@pytest.mark.parametrize("name", ["double_pendulum", "heavy_top", "joint_zoo"])
def test_errors_follow_the_tolerance(name: str, method: str) -> None:
    model, q, v = moving(name)
    exact = sf.simulate(model, q, v, 1.0, method="dop853", rtol=1e-12, atol=1e-13)
    for tolerance in (1e-6, 1e-9):
        run = sf.simulate(model, q, v, 1.0, method=method, rtol=tolerance, atol=tolerance)
        assert run.outcome.kind == "finished" and run.t[-1] == 1.0
        # Errors add up over some hundred steps, and grow with the motion.
        assert np.abs(model.difference(exact.q[-1], run.q[-1])).max() < 3e3 * tolerance


@pytest.mark.parametrize("method", ["cvode", "ida"])
def test_every_step_of_sundials_is_recorded_once(method: str) -> None:
    """At its end, where its state is: times increase, and there is one more of them than steps."""
    model, q, v = moving("double_pendulum")
    run = sf.simulate(model, q, v, 0.5, method=method, rtol=1e-9, atol=1e-9)
    exact = sf.simulate(model, q, v, 0.5, method="dop853", rtol=1e-12, atol=1e-13, output=run.t)
    assert (np.diff(run.t) > 0.0).all() and len(run) == run.statistics.steps + 1
    assert np.abs(run.q - exact.q).max() < 1e-5


def test_output_events_and_laws_work_with_sundials() -> None:
    model, law = compiled("pendulum"), {"q": "0.1*sin(t)"}
    events = {"down": sf.Event("q", "falling"), "up": sf.Event("q", "rising", terminal=True)}
    tight = {"method": "cvode_adams", "rtol": 1e-9, "atol": 1e-10, "output": 0.1}
    run = sf.simulate(model, [1.0], t_end=2.0, u=law, events=events, **tight)
    same = sf.simulate(model, [1.0], t_end=2.0, u=law, events=events, method="dop853", rtol=1e-11, atol=1e-12)
    assert [event.name for event in run.events] == ["down", "up"]
    assert run.outcome.kind == "event" and run.outcome.t == pytest.approx(same.outcome.t, abs=1e-7)
    np.testing.assert_allclose(run.t[:-1], 0.1 * np.arange(len(run) - 1), atol=1e-12)
    np.testing.assert_allclose(run["q"], np.interp(run.t, same.t, same["q"]), atol=2e-2)
    np.testing.assert_allclose(run.u[:, 0], 0.1 * np.sin(run.t), atol=1e-15)


def test_cvode_keeps_constraints_by_gains_only() -> None:
    model = compiled("slider_crank")
    closed = sf.assemble(model, [0.3, -0.1, -0.2], [10.0, 0.0, 0.0])
    with pytest.raises(sf.SymofrosError, match="stabilisation='baumgarte'"):
        sf.simulate(model, closed.q, closed.v, method="cvode")
    run = sf.simulate(model, closed.q, closed.v, 1.0, method="cvode", stabilisation="baumgarte", rtol=1e-9, atol=1e-10)
    assert np.abs(model.constraint(run.q)).max() < 1e-6


def test_runs_of_sundials_end_with_the_right_status() -> None:
    model = compiled("pendulum")

    def call(t, q, v):
        if t > 0.2:
            raise RuntimeError("no more")
        return [0.0]

    run = sf.simulate(model, [1.0], t_end=1.0, u=call, method="cvode_adams")
    assert run.outcome.kind == "input failed" and 0 < run.t[-1] < 0.3
    assert sf.simulate(model, [1.0], t_end=100.0, method="cvode", max_steps=20).outcome.kind == "interrupted"


@pytest.mark.parametrize(("method", "module"), [("cvode", "cvode"), ("ida", "ida")])
def test_a_missing_package_is_named(monkeypatch: pytest.MonkeyPatch, method: str, module: str) -> None:
    monkeypatch.setitem(sys.modules, f"sksundae.{module}", None)
    with pytest.raises(sf.SymofrosError, match=r"pip install 'symofros\[sundials\]'"):
        sf.simulate(compiled("pendulum"), method=method)


def with_redundant_conditions(system: sf.System) -> sf.System:
    """A planar loop closed in space: that its ends meet out of the plane is implied."""
    (loop,) = system.constraints
    return replace(system, constraints=(replace(loop, translations=("x", "y", "z")),))


LOOPS = {"slider_crank": ([0.3, -0.1, -0.2], [10.0, 0, 0]), "four_bar": ([1.2, -1.0, 1.3], [2.0, 0, 0])}


@pytest.mark.parametrize("name", LOOPS)
def test_ida_keeps_loops_closed_and_follows_projected_steps(name: str) -> None:
    model = sf.compile(with_redundant_conditions(MODELS[name]))
    closed = sf.assemble(model, *LOOPS[name])
    assert closed.rank < model.nc
    exact = sf.simulate(model, closed.q, closed.v, 0.5, method="dop853", rtol=1e-12, atol=1e-13)
    errors = []
    for tolerance in (1e-6, 1e-9):
        run = sf.simulate(model, closed.q, closed.v, 0.5, method="ida", rtol=tolerance, atol=tolerance, output=0.05)
        assert run.outcome.kind == "finished" and len(run) == 11
        assert np.abs(model.constraint(run.q)).max() < 1e2 * tolerance
        assert np.abs(model.constraint_rate(run.q, run.v)).max() < 1e3 * tolerance
        errors.append(np.abs(run.q[-1] - exact.q[-1]).max())
    assert errors[1] < 1e-7 and errors[1] < errors[0] / 20


def test_ida_integrates_a_rolling_disc() -> None:
    """Conditions on speeds have no condition on positions beside them."""
    model = compiled("rolling_disc")
    q, v = model.random_state(np.random.default_rng(4))
    closed = sf.assemble(model, q, v)
    exact = sf.simulate(model, closed.q, closed.v, 0.5, method="dop853", rtol=1e-12, atol=1e-13)
    run = sf.simulate(model, closed.q, closed.v, 0.5, method="ida", rtol=1e-9, atol=1e-9)
    assert run.outcome.kind == exact.outcome.kind == "finished"
    assert np.abs(model.difference(exact.q[-1], run.q[-1])).max() < 1e-6


@pytest.mark.parametrize("method", ["cvode", "dopri5"])
def test_of_events_that_are_not_followed_the_first_is_named(method: str) -> None:
    """Waves that come near zero and do not reach it; the second begins later."""
    wave = "1.001 + sin(1e6*{})"
    events = {"first": sf.Event(wave.format("t")), "second": sf.Event(wave.format("max(0, t - 0.2)"))}
    run = sf.simulate(sf.compile(slide(sf.Spring(4.0))), [0.1], [0.0], 0.4, events=events, method=method)
    (note,) = run.outcome.notes
    assert note.startswith("event 'first' changes too often in the step from t = ")
    assert float(note.split("t = ")[1].split()[0]) < 1e-3


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
def test_combinations_are_judged_by_the_rows_own_sizes(scale: float) -> None:
    """A row that repeats another takes part with it, and a row of zeros does not."""
    G = np.array([[1.0, 2.0, 0.0], [scale, 2 * scale, 0.0], [0.0, 0.0, scale], [0.0, 0.0, 0.0]])
    measures = Measures((0, 1, 2, 3), (FORMULA,) * 4, (OTHER,) * 3)
    kept = combinations(G, measures, np.ones(4, dtype=bool))
    left = kept @ G
    assert left.shape == (2, 3)
    assert np.linalg.matrix_rank(left / np.linalg.norm(left, axis=1)[:, None]) == 2
    assert not kept[:, 3].any()
    alone = combinations(G, measures, np.array([True, False, True, False]))
    assert np.array_equal(alone, np.eye(4)[[0, 2]])


@pytest.mark.parametrize(("seed", "rtol"), [(0, 1e-4), (1, 1e-6), (2, 1e-8)])
def test_ida_integrates_redundant_loops_accurately(rtol: float, seed: int) -> None:
    """Which combinations are independent changes along the motion."""
    bennett = Bennett.drawn(np.random.default_rng(seed))
    model = sf.compile(bennett.system())
    run = sf.simulate(
        model, bennett.posture(0.5), bennett.speeds(0.5, 1.5), 2.9, method="ida", rtol=rtol, atol=1e-2 * rtol
    )
    assert run.outcome.kind == "finished"
    assert abs(bennett.late(model, 0.5, 1.5, float(run.q[-1, 0]), 2.9)) < 1e2 * rtol
