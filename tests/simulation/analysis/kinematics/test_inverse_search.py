"""The search in C: its Jacobian is that of its residual, batches are searches one by one, Python is called back."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.base.arrays import Array
from symofros.simulation.analysis.kinematics.targets import Task
from tests.models import compiled, sampled
from tests.simulation.mechanisms import links

FUNCTIONS = sf.Options(functions=("frame_pose", "frame_jacobian"))
TREES = ("joint_zoo", "random_tree70", "random_tree4", "space_arm", "delta")


def pose_target(m: sf.Model, frame: str, q: Array) -> dict[str, sf.Target]:
    return {frame: sf.Target(*m.frame_pose(frame, q))}


@pytest.mark.parametrize("name", sampled(TREES, ["joint_zoo", "delta"]))
def test_the_jacobian_is_how_the_residual_falls_however_far_the_target_is(name: str, rng: np.random.Generator) -> None:
    """Positions, rotation vectors of any angle, and conditions of loops, by differences along every speed."""
    m, h = compiled(name), 1e-6
    frames = m.names.frames[-1], m.names.frames[0]
    for _ in range(3):
        far, q = (m.random_state(rng)[0] for _ in range(2))
        targets = pose_target(m, frames[0], far) | {frames[1]: sf.Target(rotation=m.frame_pose(frames[1], far)[1])}
        task = Task(m, targets, None, None)
        if np.abs(task.error(q)).max() > 3.0:  # Near half a turn the vector changes its sign.
            continue
        steps = h * np.eye(m.nv)
        rows = [(task.error(m.integrate(q, -step)) - task.error(m.integrate(q, step))) / (2 * h) for step in steps]
        np.testing.assert_allclose(task.jacobian(q), np.array(rows).T, atol=2e-8 * (1.0 + np.abs(rows).max()))


@cache
def arm() -> sf.Model:
    return sf.compile(MODELS["rx90"], FUNCTIONS)


def same(batch: Any, ones: list[Any]) -> None:
    for name in ("q", "error", "converged", "iterations", "gap", "starts", "notes"):
        np.testing.assert_array_equal(getattr(batch, name), [getattr(one, name) for one in ones])


@pytest.mark.parametrize("threads", [1, 3])
def test_a_batch_is_its_poses_one_by_one_whatever_the_threads(threads: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """To the last bit: poses within reach and beyond it, given exactly and to seven digits."""
    monkeypatch.setattr("symofros.simulation.analysis.kinematics.inverse_batch._AT_ONCE", 4)
    m, rng = arm(), np.random.default_rng(3)
    p, R = m.frame_pose("tool", np.array([m.random_state(rng)[0] for _ in range(24)]))
    p[5], R[7] = [9.0, 0.0, 0.0], R[7].round(7)
    batch = sf.inverse_kinematics_batch(m, {"tool": sf.Target(p, R)}, threads=threads, starts=9)
    ones = [sf.inverse_kinematics(m, {"tool": sf.Target(*pose)}, starts=9) for pose in zip(p, R, strict=True)]
    same(batch, ones)
    assert batch.converged[:5].all() and not batch.converged[5] and batch.starts.max() > 1
    assert np.all(batch.q >= m.record.q_lower) and np.all(batch.q <= m.record.q_upper)


def test_batches_take_one_of_either_for_all() -> None:
    """One orientation for many positions; one pose from many guesses."""
    m, rng = arm(), np.random.default_rng(1)
    guesses = np.array([m.random_state(rng)[0] for _ in range(3)])
    p, R = m.frame_pose("tool", guesses[0])
    near = p + 0.01 * rng.normal(size=(4, 3))
    batch = sf.inverse_kinematics_batch(m, {"tool": sf.Target(near, R)}, guesses[0])
    same(batch, [sf.inverse_kinematics(m, {"tool": sf.Target(x, R)}, guesses[0]) for x in near])
    batch = sf.inverse_kinematics_batch(m, {"tool": sf.Target(p, R)}, guesses, rest=guesses[1])
    ones = [sf.inverse_kinematics(m, {"tool": sf.Target(p, R)}, guess, rest=guesses[1]) for guess in guesses]
    same(batch, ones)
    np.testing.assert_array_equal(batch.distance, [one.distance for one in ones])


@pytest.mark.parametrize(
    ("targets", "q", "says"),
    [
        ({"tool": sf.Target(np.zeros(3))}, None, "no batch"),
        ({"tool": sf.Target(np.zeros((4, 2)))}, None, r"shape \(4, 2\)"),
        ({"tool": sf.Target(np.zeros((4, 3)))}, np.zeros((3, 6)), r"shape \(3, 6\)"),
        ({"tool": sf.Target(rotation=np.array([np.eye(3), 2 * np.eye(3)]))}, None, "target 1 of frame 'tool'"),
        ({"tool": sf.Target(np.array([[0, 0, 0.0], [0, np.inf, 0]]))}, None, "inf among its numbers"),
        ({"tooth": sf.Target(np.zeros((4, 3)))}, None, "no frame 'tooth'"),
    ],
)
def test_arrays_that_are_no_batch_are_refused(targets: Any, q: Any, says: str) -> None:
    with pytest.raises(sf.SymofrosError, match=says):
        sf.inverse_kinematics_batch(arm(), targets, q)


def test_loops_stay_closed_in_batches() -> None:
    """A loop of positions, and one of rotations, whose postures are looked at in Python."""
    for name in ("delta", "parallelogram"):
        m, frame = compiled(name), compiled(name).names.frames[-1]
        start = sf.assemble(m).q
        q = [sf.assemble(m, m.integrate(start, 0.05 * np.sin(k + np.arange(m.nv)))).q for k in range(3)]
        targets = {frame: sf.Target(m.frame_pose(frame, np.array(q))[0])}
        batch = sf.inverse_kinematics_batch(m, targets, start)
        assert batch.converged.all() and np.abs(m.constraint(batch.q)).max() <= 1e-10
        same(batch, [sf.inverse_kinematics(m, {frame: sf.Target(p)}, start) for p in targets[frame].position])  # type: ignore[union-attr]


@pytest.mark.parametrize("seed", range(3))
def test_singular_postures_are_reached(seed: int) -> None:
    """Stretched arms, where two solutions meet and a step takes half of what is missing."""
    rng = np.random.default_rng(seed)
    m = sf.compile(sf.System("arm", (*links((1.0, 0.8, 0.6)),)), FUNCTIONS)
    q = np.array([rng.uniform(-3.0, 3.0), 0.0, 0.0])
    found = sf.inverse_kinematics(m, {"b2.end": sf.Target(m.frame_pose("b2.end", q)[0])}, q + [0.3, -0.4, 0.5])
    assert found.converged and np.abs(np.sin(found.q[1:])).max() < 1e-4


def test_parameters_and_inputs_are_those_of_the_call() -> None:
    """A search is bound once, and serves other values after others."""
    length: Any = "L"
    system = sf.System(
        "arm",
        (
            sf.RigidBody("a", sf.Joint("a", "revolute"), sf.Inertia(1.0), (sf.Frame("e", (length, 0, 0)),)),
            sf.RigidBody("b", sf.Joint("b", "revolute", "a", "e"), sf.Inertia(1.0), (sf.Frame("tip", (length, 0, 0)),)),
        ),
        parameters=(sf.Parameter("L", 1.0),),
    )
    m = sf.compile(system, FUNCTIONS)
    for L in (1.0, 0.5, 1.0, 0.7):
        p = np.array([1.2 * L, 0.3 * L, 0.0])
        found = sf.inverse_kinematics(m, {"tip": sf.Target(p)}, [0.2, 0.3], par=[L], starts=1)
        assert found.converged and np.abs(m.frame_pose("tip", found.q, par=[L])[0] - p).max() < 1e-9
        of_copy = sf.inverse_kinematics(m.with_parameters(L=L), {"tip": sf.Target(p)}, [0.2, 0.3], starts=1)
        np.testing.assert_array_equal(found.q, of_copy.q)


def test_interpreted_models_are_searched_by_the_same_steps() -> None:
    """C calls back: the same answer as of compiled functions, but for their rounding."""
    system = sf.System("arm", (*links((1.0, 0.8, 0.6)),))
    models = [sf.compile(system, sf.Options(FUNCTIONS.functions, backend=b)) for b in ("c", "interpreter")]
    target = {"b2.end": sf.Target([0.3, -1.4, 0.0])}
    one, other = (sf.inverse_kinematics(m, target, [0.2, -0.4, 1.0]) for m in models)
    assert one.converged and one.iterations == other.iterations
    np.testing.assert_allclose(one.q, other.q, atol=1e-12)
    same(sf.inverse_kinematics_batch(models[1], target, [[0.2, -0.4, 1.0]] * 2, threads=2), [other] * 2)


def test_exceptions_of_interpreted_functions_end_the_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C among them."""
    m = sf.compile(sf.System("arm", (*links((1.0, 0.8)),)), sf.Options(FUNCTIONS.functions, backend="interpreter"))
    target, kind = {"b1.end": sf.Target([0.3, -1.4, 0.0])}, type(m.kernel("frame_jacobian", "b1.end"))

    def stopped(*_: Any, **__: Any) -> Any:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(kind, "run", stopped)
        with pytest.raises(KeyboardInterrupt):
            sf.inverse_kinematics(m, target, [0.2, -0.4])
    assert sf.inverse_kinematics(m, target, [0.2, -0.4]).converged


@pytest.mark.parametrize(("side", "ends"), [(-2.0, [-0.5, -0.6, -0.2]), (2.0, [0.3, 0.8, 1.2])])
def test_each_coordinate_stops_at_its_own_limit(side: float, ends: list[float]) -> None:
    """Of a start beyond all limits, and of steps that would lead there."""
    limits = {i: sf.Limits(*pair) for i, pair in enumerate([(-0.5, 0.3), (-0.6, 0.8), (-0.2, 1.2)])}
    m = sf.compile(sf.System("arm", (*links((1.0, 0.8, 0.6), limits=limits),)), FUNCTIONS)
    curled = m.frame_pose("b2.end", np.full(3, side) * [1.0, 0.5, 0.5])[0]
    solver = Task(m, {"b2.end": sf.Target(curled)}, None, None).solver
    solver.use(solver.everything, 1e-10, 1e-10)
    np.testing.assert_array_equal(solver.descend(np.full(3, side), 0), ends)
    q = solver.descend(np.zeros(3), 60)
    assert np.all(q >= m.record.q_lower) and np.all(q <= m.record.q_upper)


@pytest.mark.parametrize("tolerance", [0.0, -1e-6, np.inf])
def test_tolerances_that_nothing_or_everything_meets_are_refused(tolerance: float) -> None:
    model = compiled("open_chain_5r")
    for search, targets in ((sf.inverse_kinematics, 1), (sf.inverse_kinematics_batch, 2)):
        wanted = {model.names.frames[-1]: sf.Target(np.zeros((targets, 3)) if targets > 1 else np.zeros(3))}
        with pytest.raises(sf.SymofrosError, match="tolerance is out of range"):
            search(model, wanted, tolerance=tolerance)
        with pytest.raises(sf.SymofrosError, match="iterations is out of range"):
            search(model, wanted, iterations=0)
    for search in (sf.assemble, sf.equilibrium):
        with pytest.raises(sf.SymofrosError, match="tolerance is out of range"):
            search(model, tolerance=tolerance)
        with pytest.raises(sf.SymofrosError, match="iterations is out of range"):
            search(model, iterations=0)
