"""Inverse kinematics of redundant arms ends at the solution nearest to rest: to first order, limits included."""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import nnls

import symofros as sf
from reference_models import MODELS
from symofros.runtime.calls.kernel import Array
from symofros.simulation.analysis.kinematics.nearest_posture import FromTargets, _nonnegative
from tests.simulation.mechanisms import links

FUNCTIONS = sf.Options(functions=("frame_pose", "frame_jacobian"))


@cache
def arm(limit: float = np.inf) -> sf.Model:
    """Three links of 1 m in the plane."""
    limits = dict.fromkeys(range(3), sf.Limits(-limit, limit)) if np.isfinite(limit) else {}
    return sf.compile(sf.System("arm", links((1.0, 1.0, 1.0), limits=limits)), FUNCTIONS)


def solutions(p: Array, limit: float) -> Array:
    """Postures (n, 3) of the arm that reach p, on a fine grid of the last link's direction, by the law of cosines."""
    last = np.linspace(-np.pi, np.pi, 20001)
    elbow = p[:2] - np.stack([np.cos(last), np.sin(last)], axis=1)
    reach = np.hypot(*elbow.T)
    last, elbow, reach = last[reach < 2], elbow[reach < 2], reach[reach < 2]
    postures = []
    for sign in (1.0, -1.0):
        q1 = sign * np.arccos(reach**2 / 2 - 1)
        q0 = np.arctan2(elbow[:, 1], elbow[:, 0]) - q1 / 2
        postures.append(np.stack([q0, q1, last - q0 - q1], axis=1))
    q = (np.concatenate(postures) + np.pi) % (2 * np.pi) - np.pi
    return q[np.all(np.abs(q) <= limit, axis=1)]


@pytest.mark.parametrize("limit", [np.inf, 0.8])
@pytest.mark.parametrize("seed", range(3))
def test_no_posture_nearby_that_reaches_the_target_is_nearer_to_rest(limit: float, seed: int) -> None:
    """All solutions of an arm with one freedom, enumerated; with limits as without."""
    rng, m = np.random.default_rng(seed), arm(limit)
    wanted, rest, start = rng.uniform(-0.8, 0.8, (3, 3))
    p, _ = m.frame_pose("b2.end", wanted)
    reached = sf.inverse_kinematics(m, {"b2.end": sf.Target(p)}, start, rest=rest)
    assert reached.converged and np.all(np.abs(reached.q) <= limit)
    assert reached.distance == pytest.approx(float(np.linalg.norm(reached.q - rest)), rel=1e-12)
    others = solutions(p, limit)
    others = others[np.abs(others - reached.q).max(axis=1) < 0.2]
    assert len(others) > 50 and np.linalg.norm(others - rest, axis=1).min() >= reached.distance - 1e-9


@pytest.mark.parametrize("far", [0.01, 1.0])
@pytest.mark.parametrize("name", ["rx90", "space_arm"])
def test_the_remaining_distance_is_orthogonal_to_the_solutions(name: str, far: float) -> None:
    """Spatial arms, one on a base that floats: every small motion that keeps the target leads away from rest."""
    m, rng = sf.compile(MODELS[name], FUNCTIONS), np.random.default_rng(4)
    frame = m.names.frames[-1]
    rest = m.integrate(m.neutral(), rng.uniform(0.3, 0.6, m.nv))
    start = m.integrate(rest, far * rng.normal(size=m.nv))
    target = {frame: sf.Target(m.frame_pose(frame, start)[0])}
    reached = sf.inverse_kinematics(m, target, start, rest=rest)
    assert reached.converged and reached.gradient <= 1e-8 * (1.0 + reached.distance)
    for _ in range(6):
        moved = m.integrate(reached.q, 1e-2 * rng.normal(size=m.nv))
        other = sf.inverse_kinematics(m, target, moved)
        assert other.converged
        further = distance(m, rest, other.q) - reached.distance
        assert further >= -1e-9


def distance(m: sf.Model, rest: Array, q: Array) -> float:
    """Positions by their distance, rotations by their angle."""
    total = 0.0
    for segment in m.record.segments:
        a, b = (x[segment.q : segment.q + segment.size] for x in (rest, q))
        if segment.kind == "linear":
            total += float((a - b) @ (a - b))
            continue
        position, quaternion = slice(segment.q, segment.q + segment.translations), segment.q + segment.translations
        total += float(np.sum((rest[position] - q[position]) ** 2))
        cosine = abs(float(rest[quaternion : quaternion + 4] @ q[quaternion : quaternion + 4]))
        total += (2.0 * np.arccos(min(cosine, 1.0))) ** 2
    return float(np.sqrt(total))


def test_limits_push_inwards_where_they_hold() -> None:
    """The multipliers of limits that hold have the sign of a push inwards (Karush, Kuhn and Tucker)."""
    m, rest = arm(0.8), np.array([0.7, -0.7, 0.75])
    p, _ = m.frame_pose("b2.end", np.array([0.2, 0.6, 0.3]))
    reached = sf.inverse_kinematics(m, {"b2.end": sf.Target(p)}, [0.1, 0.5, 0.5], rest=rest)
    held = np.flatnonzero(np.abs(reached.q) >= 0.8 - 1e-12)
    assert reached.converged and held.size
    J = m.frame_jacobian("b2.end", reached.q)[:2]
    inwards = -np.sign(reached.q[held])
    columns = np.concatenate([J.T, np.eye(3)[:, held] * inwards], axis=1)
    multipliers, *_ = np.linalg.lstsq(columns, reached.q - rest, rcond=None)
    assert np.abs(columns @ multipliers - (reached.q - rest)).max() < 1e-8
    assert np.all(multipliers[2:] > 0.0)


def test_a_farthest_posture_is_not_returned() -> None:
    """A link of 2 m on two slides, its tip held: d^2 = 5 + 4 cos c + c^2.

    It has a maximum at c = 0, where both starts lead, and minima where sin c = c/2.
    """
    slides = [
        sf.RigidBody(n, sf.Joint(n, "prismatic", p, axis=x), sf.Inertia(1.0))
        for n, p, x in (("x", "world", (1, 0, 0)), ("y", "x", (0, 1, 0)))
    ]
    link = sf.RigidBody("link", sf.Joint("c", "revolute", "y"), sf.Inertia(1.0), (sf.Frame("tip", (2.0, 0, 0)),))
    m = sf.compile(sf.System("gantry", (*slides, link)), FUNCTIONS)
    reached = sf.inverse_kinematics(m, {"tip": sf.Target([0.0, 0, 0])}, [-2.0, 0, 0], rest=[1.0, 0, 0])
    assert reached.converged
    assert abs(reached.q[2]) == pytest.approx(1.895494267, abs=1e-8)


@pytest.mark.parametrize("seed", range(8))
def test_least_squares_of_no_negative_entry_are_those_of_scipy(seed: int) -> None:
    """Where entries that were above zero come down to it again, too."""
    rng = np.random.default_rng(seed)
    A = np.abs(rng.standard_normal((15, 10))) @ np.diag(10.0 ** rng.uniform(-2, 2, 10))
    b = rng.standard_normal(15) + 1.0
    found, (wanted, left) = _nonnegative(A, b), nnls(A, b)
    assert found.min() >= 0.0 and np.linalg.norm(A @ found - b) == pytest.approx(left, rel=1e-12)
    np.testing.assert_allclose(found, wanted, atol=1e-10 * np.abs(wanted).max(initial=1.0))


@pytest.mark.parametrize("q", [(0.0, 0.0, 0.0), (0.3, -0.7, 1.1)])
@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_curvature_of_targets_is_the_largest_squared_column_of_their_jacobian(
    q: tuple[float, ...], scale: float
) -> None:
    """Joints that do not move the targets add nothing; without any the curvature is one."""
    J = scale * arm().frame_jacobian("b2.end", np.array(q))[:3]
    for jacobian, largest in ((J, np.linalg.norm(J, axis=0).max() ** 2), (0.0 * J, 1.0)):
        task: Any = SimpleNamespace(jacobian=lambda _, rows=jacobian: np.vstack([rows, 1e9 * rows]), wishes=3)
        assert FromTargets(task, np.array(q)).curvature == pytest.approx(largest, rel=1e-14)
