"""Solutions of drawn starts: the same posture, its angles turned by whole turns to where they are nearest."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import symofros as sf
from symofros.base.arrays import Array
from symofros.simulation.analysis.kinematics.restarts import default_start, start_again
from symofros.simulation.analysis.kinematics.targets import Task
from tests.simulation.mechanisms import links

LIMIT = 4.0  # Of the wrist, which has room for a little more than a turn.


@cache
def arm() -> sf.Model:
    bodies = links((1.0, 0.8, 0.6), "l", axis=(0, 1, 0), limits={2: sf.Limits(-LIMIT, LIMIT)})
    functions = ("frame_pose", "frame_jacobian")
    return sf.compile(sf.System("arm", (*bodies,)), sf.Options(functions, backend="interpreter"))


def turned(task: Task, q: Array, guess: Array) -> Array:
    """What a search makes of a solution."""
    solver = task.solver
    solver.round[0], solver.round_met[0] = q, 1.0
    assert solver.nearest(guess, guess, 1)
    return solver.end()


OFF = st.floats(-3.1, 3.1)  # Less than half a turn.


@given(
    guess=st.tuples(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0), st.floats(-LIMIT, LIMIT)),
    off=st.tuples(OFF, OFF),
    turns=st.tuples(st.integers(-3, 3), st.integers(-3, 3)),
    wrist=st.floats(-LIMIT, LIMIT),
)
def test_angles_end_within_half_a_turn_of_the_guess_where_limits_let_them(
    guess: tuple[float, float, float], off: tuple[float, float], turns: tuple[int, int], wrist: float
) -> None:
    """Whatever whole turns a solution has more."""
    m, near = arm(), np.add(guess[:2], off)
    q = np.array([*(near + 2.0 * np.pi * np.array(turns)), wrist])
    task = Task(m, {"l2.end": sf.Target(m.frame_pose("l2.end", q)[0])}, None, None)
    found = turned(task, q, np.array(guess))
    assert found[:2] == pytest.approx(near, abs=1e-12)
    assert -LIMIT <= found[2] <= LIMIT
    whole = (wrist - found[2]) / (2.0 * np.pi)
    assert whole == pytest.approx(round(whole), abs=1e-12)
    others = [x for k in (-1, 1) if abs(x := found[2] + 2.0 * np.pi * k) <= LIMIT]
    assert all(abs(found[2] - guess[2]) <= abs(x - guess[2]) + 1e-12 for x in others)


@pytest.mark.parametrize("side", [1.0, -1.0, None])
def test_refused_solutions_of_drawn_starts_do_not_count(side: float | None) -> None:
    """An arm with an elbow to either side; None: nothing is refused."""
    task = Task(arm(), {"l2.end": sf.Target([1.2, 0.0, 0.4])}, None, None)
    solver, guess = task.solver, np.array([0.1, 0.2, 0.3])
    solver.use(solver.everything, 1e-10, 1e-10)
    refused = (lambda q: False) if side is None else (lambda q: bool(side * np.sin(q[1]) < 0.0))
    assert start_again(solver, guess, guess, 60, 50, refused)
    found = solver.end()[:3]
    assert not refused(found) and np.abs(task.error(found)).max() < 1e-9
    assert not start_again(solver, guess, guess, 12, 50, lambda _: True)


def test_searches_start_within_limits() -> None:
    """Neutral where that is allowed, amid two limits, at the only one."""
    limits = {0: sf.Limits(1.0, 3.0), 1: sf.Limits(0.5), 2: sf.Limits(None, -0.25), 3: sf.Limits(-1.0, 2.0)}
    m = sf.compile(
        sf.System("arm", (*links((1.0,) * 4, limits=limits),)), sf.Options(("mass_matrix",), backend="interpreter")
    )
    np.testing.assert_array_equal(default_start(m), [2.0, 0.5, -0.25, 0.0])


OFFSET = st.floats(-5.0, 5.0)


@given(off=st.tuples(OFFSET, OFFSET, OFFSET))
def test_slides_without_limits_are_drawn_as_far_as_the_target_is_off(off: tuple[float, float, float]) -> None:
    """By its largest component, whatever its sign."""
    task = Task(gantry(), {"z.tool": sf.Target(off)}, None, None)
    solver = task.solver
    solver.use(solver.everything, 1e-10, 1e-10)
    solver.reserve_starts(8)
    assert solver.windows(np.zeros(3))
    low, high = (solver.memory.view(x, 3) for x in (solver.posture.low, solver.posture.high))
    np.testing.assert_allclose([-low, high], max(map(abs, off)), rtol=1e-12, atol=1e-15)


@cache
def gantry() -> sf.Model:
    axes, parents = np.eye(3).tolist(), ("world", "x", "y")
    bodies = [
        sf.RigidBody(name, sf.Joint(name, "prismatic", parent, axis=axis), sf.Inertia(1.0), (sf.Frame("tool"),))
        for name, parent, axis in zip("xyz", parents, axes, strict=True)
    ]
    functions = ("frame_pose", "frame_jacobian")
    return sf.compile(sf.System("gantry", (*bodies,)), sf.Options(functions, backend="interpreter"))


SIDE = st.one_of(st.just(np.inf), st.floats(0.0, 10.0))


@given(lower=SIDE, upper=SIDE)
def test_starts_are_drawn_from_as_much_room_beside_a_limit_as_far_from_it(lower: float, upper: float) -> None:
    """Within the limits, and nearer to the guess than what is left out: half a turn, or all that there is."""
    task = Task(arm(), {"l2.end": sf.Target([1.0, 0.0, 0.0])}, None, None)
    solver, guess = task.solver, np.array([0.1, 0.2, 0.3])
    solver.use(solver.everything, 1e-10, 1e-10)
    solver.reserve_starts(8)
    limits = [solver.memory.view(x, 3) for x in (solver.posture.lower, solver.posture.upper)]
    kept = [side.copy() for side in limits]
    try:
        limits[0][1], limits[1][1] = guess[1] - lower, guess[1] + upper
        assert solver.windows(guess)
        low, high = (float(solver.memory.view(x, 3)[1]) for x in (solver.posture.low, solver.posture.high))
    finally:
        for side, values in zip(limits, kept, strict=True):
            side[...] = values
    room = float(guess[1] - (guess[1] - lower)), float((guess[1] + upper) - guess[1])  # As rounding leaves it.
    assert -room[0] <= low <= 0.0 <= high <= room[1]
    assert high - low == pytest.approx(min(sum(room), 2.0 * np.pi), rel=1e-12)
    assert low in (-np.pi, -room[0]) or high == room[1]
