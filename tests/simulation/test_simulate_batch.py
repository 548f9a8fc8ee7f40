"""sf.simulate_batch: each trajectory is that of sf.simulate, whatever becomes of the others."""

from __future__ import annotations

import signal
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.models import bounds
from tests.models import compiled as model
from tests.simulation.mechanisms import slide

# Steps are the same and so are the formulas; only fused multiply-adds may fall on other pairs (docs/theory/code.md).
ALIKE = 1e-11
GRID = (0.0, 0.013, 0.1, 0.2371, 0.3)


def starts(m: sf.Model, n: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Random states, on the constraints where there are any."""
    rng = np.random.default_rng(seed)
    states = [m.random_state(rng) for _ in range(n)]
    if m.nc:
        found = [sf.assemble(m, q, 0.3 * v) for q, v in states]
        states = [(one.q, one.v) for one in found]
    return np.array([q for q, _ in states]), np.array([v for _, v in states])


def assert_same(one: sf.Trajectory, other: sf.Trajectory) -> None:
    assert one.outcome.kind == other.outcome.kind and np.array_equal(one.t, other.t)
    for name in ("q", "v", "u"):
        expected = getattr(other, name)
        scale = np.abs(expected).max(initial=1.0)
        assert np.abs(getattr(one, name) - expected).max(initial=0.0) <= ALIKE * scale, name
    assert one.statistics.steps == other.statistics.steps and one.statistics.rejected == other.statistics.rejected


# Linear coordinates, a ball, a free base, closed loops, a nonholonomic condition.
@pytest.mark.parametrize("name", ["cart_pole", "gyroscope", "space_arm", "four_bar", "sleigh"])
@pytest.mark.parametrize("method", ["rk4", "semi_implicit_euler", "dopri5", "dop853"])
def test_batches_match_simulate(name: str, method: str) -> None:
    m = model(name)
    q, v = starts(m, 37)  # More than are in hand at once, and no multiple of a vector's lanes.
    many = sf.simulate_batch(m, q, v, 0.3, method=method, dt=7e-3, output=GRID)
    assert many.q.shape == (37, 5, m.nq) and many.ok.all()
    for i in (0, 8, 31, 36):
        assert_same(many[i], sf.simulate(m, q[i], v[i], 0.3, method=method, dt=7e-3, output=GRID))
        assert np.array_equal(many.q_last[i], many.q[i, -1]) and np.array_equal(many.v_last[i], many.v[i, -1])


def bits(run: sf.Trajectories) -> list[np.ndarray]:
    return [run.q, run.v, run.u, run.q_last, run.v_last, run.t_last, run.steps, run.rejected, run.status]


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_batch_size_and_threads_change_no_bit(method: str) -> None:
    m = model("space_arm")
    q, v = starts(m, 50)
    whole = sf.simulate_batch(m, q, v, 0.2, method=method, dt=1e-2)
    for threads in (2, 3):
        shared = sf.simulate_batch(m, q, v, 0.2, method=method, dt=1e-2, threads=threads)
        assert all(map(np.array_equal, bits(whole), bits(shared)))
    order = np.random.default_rng(1).permutation(50)[:41]
    some = sf.simulate_batch(m, q[order], v[order], 0.2, method=method, dt=1e-2)
    assert all(np.array_equal(a[order], b) for a, b in zip(bits(whole), bits(some), strict=True))
    alone = sf.simulate_batch(m.with_threads(2), q[7], v[7], 0.2, method=method, dt=1e-2)
    assert alone.shape == () and all(np.array_equal(a[7], b) for a, b in zip(bits(whole), bits(alone), strict=True))


def inputs(m: sf.Model, kind: str, n: int) -> tuple[Any, Any]:
    """Inputs of a batch, and of trajectory i alone."""
    rng = np.random.default_rng(5)
    t, (u,) = np.linspace(0.0, 0.2, 9), m.names.u
    rows, shared, own = rng.normal(size=(n, m.nu)), rng.normal(size=9), rng.normal(size=(n, 9, m.nu))
    law = f"3*cos(t) - {m.names.q[0]}"
    one = sf.Signal(t, shared, kind="hold")
    return {
        "rows": (rows, lambda i: rows[i]),
        "one for all": (rows[0], lambda i: rows[0]),
        "mapping": ({u: rows[:, 0]}, lambda i: rows[i]),
        "signal": (one, lambda i: one),
        "signals": (sf.Signal(t, own), lambda i: sf.Signal(t, own[i])),
        "named signals": ({u: sf.Signal(t, own)}, lambda i: {u: sf.Signal(t, own[i, :, 0])}),
        "formula": ({u: law}, lambda i: {u: law}),
    }[kind]


KINDS = ("rows", "one for all", "mapping", "signal", "signals", "named signals", "formula")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_inputs_of_batches_match_simulate(kind: str, method: str) -> None:
    m, n = model("cart_pole"), 35
    q, v = starts(m, n)
    u, alone = inputs(m, kind, n)
    many = sf.simulate_batch(m, q, v, 0.2, u=u, method=method, dt=1e-2, output=0.05)
    for i in (0, 17, 34):
        assert_same(many[i], sf.simulate(m, q[i], v[i], 0.2, u=alone(i), method=method, dt=1e-2, output=0.05))


def test_each_trajectory_may_have_its_own_parameters() -> None:
    system, n = MODELS["cart_pole"], 34
    free = tuple(sf.Parameter(one.name, one.value) for one in system.parameters)
    m = sf.compile(replace(system, parameters=free))
    q, v = starts(m, n)
    par = m.parameter_values * (1.0 + 0.1 * np.random.default_rng(2).random((n, m.npar)))
    law = {m.names.u[0]: f"2 - {m.names.par[0]}*{m.names.q[0]}"}
    many = sf.simulate_batch(m, q, v, 0.1, par=par, u=law, dt=5e-3)
    assert many.par.shape == (n, m.npar)
    for i in (0, 16, 33):
        assert_same(many[i], sf.simulate(m, q[i], v[i], 0.1, par=par[i], u=law, dt=5e-3, output=[0.1]))


def test_one_start_on_constraints_serves_many_parameters() -> None:
    """Masses leave a start on the constraints, a length takes it off them."""
    m = sf.compile(MODELS["slider_crank"])
    on = sf.assemble(m, [0.7, -0.5, 0.3], np.ones(3))
    par = np.tile(m.parameter_values, (3, 1))
    par[:, m.names.par.index("m3")] *= [0.5, 1.0, 2.0]
    par[1, m.names.par.index("L1")] *= 1.1
    many = sf.simulate_batch(m, on.q, on.v, 0.1, par=par, dt=5e-3)
    assert list(many.ok) == [True, False, True]
    for i in (0, 2):
        assert_same(many[i], sf.simulate(m, on.q, on.v, 0.1, par=par[i], dt=5e-3, output=[0.1]))


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_a_bad_trajectory_affects_no_other(method: str) -> None:
    m = model("cart_pole")
    q, v = starts(m, 40)
    good = sf.simulate_batch(m, q, v, 0.2, method=method, dt=1e-2, output=0.1)
    v_bad = v.copy()
    v_bad[3, 0], v_bad[20, 1] = np.nan, 1e200  # No motion in any unit: its square overflows.
    found = sf.simulate_batch(m, q, v_bad, 0.2, method=method, dt=1e-2, output=0.1)
    wrong = ~found.ok
    assert np.flatnonzero(wrong).tolist() == [3, 20]
    assert set(found.kinds[wrong]) <= {"diverged", "step too small"} and set(found.kinds[~wrong]) == {"finished"}
    assert np.isnan(found.q[3, 1:]).all() and found.t_last[3] == 0.0 and len(found[20]) == 0
    assert all(np.array_equal(a[~wrong], b[~wrong]) for a, b in zip(bits(good), bits(found), strict=True))
    assert "38 finished" in str(found) and "first: [3]: diverged" in str(found) and "smaller dt" in str(found)


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_trajectories_may_end_at_different_times(method: str) -> None:
    """Where a law has no value, runs end at different times; places they leave are filled in the middle of a step."""
    m = model("cart_pole")
    q, v = starts(m, 30)
    v[:, 0] = np.random.default_rng(4).permutation(np.linspace(-2.0, 4.0, 30))
    law = {m.names.u[0]: f"sqrt(1 - {m.names.q[0]})"}
    way: dict[str, Any] = {"u": law, "method": method, "dt": 1e-2} | bounds(method, 1e-12, 1e-12)
    found = sf.simulate_batch(m, q, v, 0.7, **way)
    assert 5 < found.ok.sum() < 25 and len(np.unique(found.t_last[~found.ok])) > 5
    assert set(found.kinds) == {"finished", "diverged" if method == "rk4" else "step too small"}
    for i in range(30):
        alone = sf.simulate_batch(m, q[i], v[i], 0.7, **way)
        assert all(np.array_equal(a[i], b, equal_nan=True) for a, b in zip(bits(found), bits(alone), strict=True)), i


def test_a_start_off_the_constraints_ends_only_its_own_trajectory() -> None:
    m = model("four_bar")
    q, v = starts(m, 4)
    good = sf.simulate_batch(m, q, v, 0.05)
    q_off = q.copy()
    q_off[2, 0] += 1e-3
    found = sf.simulate_batch(m, q_off, v, 0.05)
    assert found.kinds.tolist() == ["finished", "finished", "constraints lost", "finished"]
    assert np.array_equal(found.q_last[[0, 1, 3]], good.q_last[[0, 1, 3]]) and np.array_equal(found.q_last[2], q_off[2])


def test_an_interrupt_keeps_the_finished_part() -> None:
    m = model("space_arm")
    q, v = starts(m, 200)

    def ring(*_: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, ring)
    try:
        m.kernel("forward_dynamics").in_lanes()  # type: ignore[attr-defined]  # Compiled before the clock runs.
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        run = sf.simulate_batch(m, q, v, 50.0, dt=1e-4, output=[0.0], threads=2)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert set(run.kinds) == {"interrupted"} and run.t_last.max() > 0.0 and run.t_last.min() == 0.0
    assert np.array_equal(run.q_last[run.t_last == 0.0], q[run.t_last == 0.0])


def test_results_have_batch_shapes() -> None:
    m = model("cart_pole")
    run = sf.simulate_batch(m, np.zeros((2, 1, m.nq)), np.ones((3, m.nv)), 0.1, u=np.zeros((2, 3, m.nu)), output=0.05)
    assert run.shape == (2, 3) and len(run) == 6 and run.q.shape == (2, 3, 3, m.nq) and run.v_last.shape == (2, 3, m.nv)
    assert run[1, 2].q.shape == (3, m.nq) and len(list(run)) == 6
    assert len(sf.simulate_batch(m, np.zeros((0, m.nq)), t_end=0.1)) == 0
    assert sf.simulate_batch(m, t_end=0.0).ok


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"q0": np.zeros((4, 7))}, r"q0 has shape \(\.\.\., 2\)"),
        ({"q0": np.zeros((4, 2)), "v0": np.zeros((3, 2))}, r"do not broadcast\n  found:  q0 \(4, 2\), v0 \(3, 2\)"),
        ({"u": np.zeros((4, 5))}, r"constant inputs have shape \(\.\.\., 1\)"),
        ({"u": lambda t, q, v: [0.0]}, "inputs by a Python function"),
        ({"method": "rodas4"}, "'rodas4' is no explicit method"),
        ({"threads": 0}, "no thread to work"),
    ],
)
def test_invalid_arguments_of_batches_are_refused(given: dict[str, Any], message: str) -> None:
    with pytest.raises(sf.SymofrosError, match=message):
        sf.simulate_batch(model("cart_pole"), **given)


@pytest.mark.parametrize(
    ("method", "dt"), [("euler", 0.05), ("semi_implicit_euler", 0.1), ("rk4", 0.1), ("rk4", 0.01), ("dopri5", None)]
)
def test_notes_of_a_batch_that_records_only_its_end_match_a_single_run(method: str, dt: float | None) -> None:
    """A hill turns a cart back, if steps see it: what they pass over does not depend on the samples."""
    hill = sf.Potential("hill", "max(0, 1 - ((x - 5)/0.03)^2)^2")
    model, options = sf.compile(slide(potentials=(hill,))), {} if dt is None else {"dt": dt}
    single = sf.simulate(model, [0.0], [1.0], 10.0, method=method, **options)
    many = sf.simulate_batch(model, np.zeros((2, 1)), np.ones((2, 1)), 10.0, method=method, **options)
    assert many.q.shape == (2, 1, 1) and many.outcome(0).notes == single.outcome.notes
    assert bool(single.outcome.notes) == (abs(float(single.v[-1, 0]) + 1.0) > 0.1)


@pytest.mark.parametrize("method", ["rk4", "dopri5", "dop853"])
@pytest.mark.parametrize("when", [0.35, 0.3, 1.0])
@pytest.mark.parametrize("more", [0.0, 0.25])
@pytest.mark.parametrize("terminal", [False, True])
def test_a_sample_at_the_instant_of_an_action_is_the_state_after_it(
    method: str, when: float, more: float, terminal: bool
) -> None:
    """Whether the run ends there or goes on, alone or of a batch, at times stated or not; parameters as well."""
    system = replace(slide(), parameters=(*slide().parameters, sf.Parameter("mark", 0.0)))
    action = {"dx": "2*dx", "mark": 1}
    kick = {"kick": sf.Event(f"t - {when}", "rising", terminal=terminal, action=action)}
    model, options = sf.compile(system), {"events": kick, "method": method}
    times = [when / 2, when, when + more] if more and not terminal else [when / 2, when]
    runs = sf.simulate_batch(model, [0.0], [[1.0], [3.0]], when + more, output=times, **options)
    alone = sf.simulate(model, [0.0], [1.0], when + more, output=times, **options)
    stepwise = sf.simulate(model, [0.0], [1.0], when + more, **options)
    after = [1.0, 2.0, 2.0][: len(times)]
    for run in (alone, runs[0]):
        assert list(run.t[: len(times)]) == times
        assert run.v[: len(times), 0] == pytest.approx(after, abs=1e-12)
        assert list(run.par_over_time[: len(times), -1]) == [0.0, 1.0, 1.0][: len(times)]
    assert runs.v[1, : len(times), 0] == pytest.approx(3.0 * np.array(after), abs=1e-12)
    both = np.abs(stepwise.t - when) <= 1e-14
    assert list(stepwise.v[both, 0]) == pytest.approx([1.0, 2.0], abs=1e-12)
    if not more:
        ends = sf.simulate_batch(model, [0.0], [[1.0], [3.0]], when, **options)
        assert ends.v[:, -1, 0] == pytest.approx([2.0, 6.0], abs=1e-12)
        assert ends.q[0, -1] == pytest.approx(stepwise.q[-1], abs=1e-12)


@pytest.mark.parametrize("rows", [(), (3,)])
@pytest.mark.parametrize("start", [(), (3,)])
def test_a_batch_keeps_what_it_was_given(rows: tuple[int, ...], start: tuple[int, ...]) -> None:
    """A caller fills its arrays anew for the next batch."""
    m = model("cart_pole")
    q, v, par = np.full((*start, m.nq), 0.3), np.ones((*start, m.nv)), np.tile(m.parameter_values, (*rows, 1))
    u, times = np.ones(m.nu), np.array([0.0, 0.05, 0.1])
    runs = sf.simulate_batch(m, q, v, 0.1, par=par, u=u, output=times)
    i = (1,) if runs.shape else ()
    before = [np.array(x) for x in (runs.par, runs.t, runs.q, runs[i].energy, runs[i].u, runs[i].par)]
    for given in (q, v, par, u, times):
        given[...] = 9.0
    after = [np.array(x) for x in (runs.par, runs.t, runs.q, runs[i].energy, runs[i].u, runs[i].par)]
    assert all(map(np.array_equal, before, after)) and runs.outcome(i).kind == "finished"
