"""Inverse kinematics beyond the reach, and from far: loops stay closed, limits hold, reachable poses are found."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.runtime.calls.kernel import Array
from tests.models import compiled, sampled
from tests.simulation.mechanisms import links

FUNCTIONS = sf.Options(functions=("frame_pose", "frame_jacobian"))
CROSSED = 0.1
LINKS = 0.2, 0.25


@cache
def five_bar(limit: float = np.inf) -> sf.Model:
    """Two arms of two links in the plane, their tips joined; shoulders at x = -0.1 and 0.1."""
    limits = {0: sf.Limits(-limit, limit)} if np.isfinite(limit) else {}
    sides = [links(LINKS, n, f"q{n}", position=(x, 0, 0), limits=limits) for n, x in (("a", -CROSSED), ("b", CROSSED))]
    loop = sf.Closure("loop", ("a1", "end"), ("b1", "end"), translations=("x", "y"))
    return sf.compile(sf.System("five_bar", (*sides[0], *sides[1]), constraints=(loop,)))


GUESS = [2.2, -1.0, 0.9, 1.0]


def nearest_in_reach(p: Array) -> float:
    """Distance of a point from what both arms reach, on a fine grid of the borders of the two rings."""
    turns = np.linspace(0.0, 2 * np.pi, 20001)
    shoulders, radii = (np.array([-CROSSED, 0.0]), np.array([CROSSED, 0.0])), (sum(LINKS), LINKS[1] - LINKS[0])
    edge = np.concatenate([s + r * np.stack([np.cos(turns), np.sin(turns)], axis=1) for s in shoulders for r in radii])
    # Where both arms are straight.
    corner = np.sqrt(sum(LINKS) ** 2 - CROSSED**2)
    edge = np.concatenate([edge, [[0.0, corner], [0.0, -corner]]])
    far = [np.linalg.norm(edge - s, axis=1) for s in shoulders]
    within = np.all([(radii[1] - 1e-9 <= d) & (d <= radii[0] + 1e-9) for d in far], axis=0)
    return float(np.linalg.norm(edge[within] - p, axis=1).min())


@pytest.mark.parametrize("seed", range(3))
def test_beyond_its_reach_a_loop_stays_closed_and_comes_nearest(seed: int) -> None:
    m, rng = five_bar(), np.random.default_rng(seed)
    angle, far = rng.uniform(0.3, np.pi - 0.3), rng.uniform(0.5, 2.0)
    p = far * np.array([np.cos(angle), np.sin(angle), 0.0])
    found = sf.inverse_kinematics(m, {"a1.end": sf.Target(p)}, GUESS)
    assert not found.converged and found.gap <= 1e-10
    assert np.abs(m.constraint(found.q)).max() <= 1e-9
    miss = np.linalg.norm(m.frame_pose("a1.end", found.q)[0] - p)
    assert miss == pytest.approx(nearest_in_reach(p[:2]), abs=1e-8)
    assert found.error == pytest.approx(np.abs(m.frame_pose("a1.end", found.q)[0] - p).max(), abs=1e-15)


def test_limits_hold_in_closed_loops_beyond_their_reach() -> None:
    found = sf.inverse_kinematics(five_bar(2.0), {"a1.end": sf.Target([-0.9, 0.2, 0.0])}, [1.9, -1.0, 0.9, 1.0])
    assert not found.converged and found.gap <= 1e-10 and np.abs(found.q[[0, 2]]).max() <= 2.0


def test_beyond_the_reach_a_stretched_arm_is_found_to_all_digits() -> None:
    found = sf.inverse_kinematics(arm(), {"b2.end": sf.Target([4.0, 0.0, 0.0])}, [0.4, -0.3, 0.2])
    assert not found.converged and found.error == pytest.approx(1.0, abs=1e-12)


def test_a_coarse_tolerance_of_targets_leaves_loops_closed() -> None:
    found = sf.inverse_kinematics(five_bar(), {"a1.end": sf.Target([0.05, 0.3, 0.0])}, GUESS, tolerance=0.05)
    assert found.converged and found.error <= 0.05 and found.gap <= 1e-10


def test_loops_that_cannot_close_are_reported() -> None:
    """A rod of 1 m between points 3 m apart, whose one end turns."""
    body = sf.RigidBody("b", sf.Joint("q", "revolute"), sf.Inertia(1.0), (sf.Frame("tip", (1.0, 0, 0)),))
    away = sf.RigidBody("c", sf.Joint("r", "revolute", position=(3.0, 0, 0)), sf.Inertia(1.0))
    loop = sf.Closure("loop", ("b", "tip"), ("c", None), translations=("x", "y"))
    m = sf.compile(sf.System("torn", (body, away), constraints=(loop,)), sf.Options(backend="interpreter"))
    found = sf.inverse_kinematics(m, {"b.tip": sf.Target([0.0, 1.0, 0.0])}, [0.3, 0.1], starts=9)
    assert not found.converged and found.gap == pytest.approx(2.0, abs=1e-4)
    assert any("no start closes the loops" in note for note in found.notes)


@cache
def arm(limit: float = np.inf) -> sf.Model:
    limits = dict.fromkeys(range(3), sf.Limits(-limit, limit)) if np.isfinite(limit) else {}
    return sf.compile(sf.System("arm", links((1.0, 1.0, 1.0), limits=limits)), FUNCTIONS)


@pytest.mark.parametrize("seed", range(3))
def test_no_posture_on_a_grid_is_nearer_than_the_result(seed: int) -> None:
    """All postures of three limited joints on a grid of 0.02 rad: none misses the target by less."""
    limit, rng = 0.8, np.random.default_rng(seed)
    angles = np.linspace(-limit, limit, 81)
    a, b, c = np.meshgrid(angles, angles, angles, indexing="ij")
    x, y = (sum(f(s) for s in (a, a + b, a + b + c)) for f in (np.cos, np.sin))
    p = rng.uniform(-3.5, 3.5, 2)
    best = float(np.sqrt(((x - p[0]) ** 2 + (y - p[1]) ** 2).min()))
    found = sf.inverse_kinematics(arm(limit), {"b2.end": sf.Target([*p, 0.0])})
    miss = float(np.linalg.norm(arm(limit).frame_pose("b2.end", found.q)[0][:2] - p))
    assert np.abs(found.q).max() <= limit and miss <= best + 1e-9
    assert found.converged or miss >= best - 0.05


def within_limits(m: sf.Model, q: Array) -> bool:
    return bool(np.all((q >= np.array(m.record.q_lower) - 1e-12) & (q <= np.array(m.record.q_upper) + 1e-12)))


@pytest.mark.parametrize(
    "name", sampled(("joint_zoo", "random_tree70", "random_tree4", "space_arm", "stanford_arm", "delta"), ["joint_zoo"])
)
def test_every_pose_that_exists_is_found_whatever_the_joints(name: str) -> None:
    """Free, ball, planar, prismatic joints and loops, from the default start: postures drawn within their limits."""
    m, rng = compiled(name), np.random.default_rng(2)
    frame = m.names.frames[-1]
    for _ in range(8):
        q = m.random_state(rng)[0]
        if m.nc:
            q = sf.assemble(m, q).q
        p, R = m.frame_pose(frame, q)
        found = sf.inverse_kinematics(m, {frame: sf.Target(p, R)})
        assert found.converged and found.gap <= 1e-10 and within_limits(m, found.q)
        reached = m.frame_pose(frame, found.q)
        assert np.abs(reached[0] - p).max() < 1e-9 and np.abs(reached[1] - R).max() < 1e-9


@pytest.mark.parametrize("seed", range(2))
def test_a_guess_that_leads_to_the_target_is_not_left(seed: int) -> None:
    """The answer is that of the guess alone, to the last bit, and is stated to be of one start."""
    m, rng = sf.compile(MODELS["rx90"], FUNCTIONS), np.random.default_rng(seed)
    wanted = m.random_state(rng)[0]
    p, R = m.frame_pose("tool", wanted)
    start = m.integrate(wanted, 0.1 * rng.normal(size=m.nv))
    found, alone = (sf.inverse_kinematics(m, {"tool": sf.Target(p, R)}, start, starts=n) for n in (96, 1))
    assert found.starts == alone.starts == 1 and found.converged
    np.testing.assert_array_equal(found.q, alone.q)


def two_arms(*more: str) -> sf.Model:
    """Two arms of two links of 1 m in the plane; the first one's shoulder turns by 3 rad either way."""
    first, second = links((1.0, 1.0), "al", "a", limits={0: sf.Limits(-3.0, 3.0)}), links((1.0, 1.0), "bl", "b")
    functions = ("frame_pose", "frame_jacobian", *more)
    return sf.compile(sf.System("two", (*first, *second)), sf.Options(functions=functions))


# The shoulder would go on from 2.9 to 3.2 rad, or back to 3.2 - 2 pi: the limit lies between.
BEFORE, BEYOND = [2.9, 0.1, 0.3, 7.0], [3.2, 0.1]


def at_turn(q: list[float]) -> Array:
    return np.array([np.cos(q[0]) + np.cos(sum(q[:2])), np.sin(q[0]) + np.sin(sum(q[:2])), 0.0])


def test_further_starts_are_reproducible_and_keep_unrelated_coordinates() -> None:
    """The other arm's coordinates stay as they are guessed; no angle is a whole turn farther than it must be."""
    target = {"al1.end": sf.Target(at_turn(BEYOND))}
    answers = [sf.inverse_kinematics(two_arms(), target, BEFORE) for _ in range(2)]
    assert answers[0].converged and answers[0].starts > 1
    np.testing.assert_array_equal(answers[0].q, answers[1].q)
    np.testing.assert_array_equal(answers[0].q[2:], BEFORE[2:])
    assert -3.0 <= answers[0].q[0] <= 3.0 and abs(answers[0].q[1] - BEFORE[1]) <= np.pi


def test_held_coordinates_stay_in_every_start() -> None:
    m = five_bar()
    found = sf.inverse_kinematics(m, {"a1.end": sf.Target([0.0, 0.9, 0.0])}, [1.8, -1.0, 0.9, 1.0], held=["qa0"])
    assert found.q[0] == 1.8 and found.gap <= 1e-10 and not found.converged


def test_a_weld_closed_half_a_turn_off_is_not_a_solution() -> None:
    """Vector parts vanish there, too; the position alone is met at once."""
    body = sf.RigidBody("b", sf.Joint("ball", "ball"), sf.Inertia(1.0), (sf.Frame("tip", (1.0, 0, 0)),))
    weld = sf.Closure("weld", ("world", None), ("b", None), translations=(), rotations=("x", "y", "z"))
    m = sf.compile(sf.System("welded", (body,), constraints=(weld,)), sf.Options(backend="interpreter"))
    off: Any = [1.0, 0.0, 0.0, 0.0]
    alone = sf.inverse_kinematics(m, {"b.tip": sf.Target([1.0, 0, 0])}, off, starts=1)
    assert not alone.converged and any("wrong way round" in note for note in alone.notes)
    found = sf.inverse_kinematics(m, {"b.tip": sf.Target([1.0, 0, 0])}, off)
    assert found.converged and abs(found.q[3]) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_a_weld_that_is_closed_to_rounding_is_a_solution(seed: int, rng: np.random.Generator) -> None:
    """Of frames that are turned anyhow: cosines of axes that are parallel are one but for rounding, on either side."""
    turns = [sf.Rotation.rpy(*np.random.default_rng(seed).uniform(-3.0, 3.0, 3)) for _ in range(2)]
    bodies = (
        sf.RigidBody("a", sf.Joint("fixed", "fixed", rotation=turns[0]), sf.Inertia(1.0), (sf.Frame("f"),)),
        sf.RigidBody(
            "b",
            sf.Joint("ball", "ball", rotation=turns[1]),
            sf.Inertia(1.0),
            (sf.Frame("f"), sf.Frame("tip", (1, 0, 0))),
        ),
    )
    weld = sf.Closure("weld", ("a", "f"), ("b", "f"), translations=(), rotations=("x", "y", "z"))
    m = sf.compile(sf.System("welded", bodies, constraints=(weld,)), sf.Options(backend="interpreter"))
    closed = sf.assemble(m, m.neutral()).q
    target = {"b.tip": sf.Target(m.frame_pose("b.tip", closed)[0])}
    found = sf.inverse_kinematics(m, target, m.integrate(closed, 0.2 * rng.standard_normal(3)), starts=1)
    assert found.converged and not found.notes


def test_paths_do_not_change_branches() -> None:
    """A limit lies between two samples, which other starts reach: not without leaving the path."""
    m, still = two_arms("frame_jacobian_rate"), np.zeros((2, 3))
    with pytest.raises(sf.AssemblyError, match="sample 1"):
        sf.joint_motion(m, "al1.end", [at_turn(BEFORE[:2]), at_turn(BEYOND)], still, still, q=BEFORE)
