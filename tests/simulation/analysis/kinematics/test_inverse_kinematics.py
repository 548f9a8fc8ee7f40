"""Inverse kinematics: targets are reached, limits kept, loops closed, what is out of reach is said."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from reference_models.closed.spatial import delta_guess
from tests.models import compiled as model
from tests.models import interpreted
from tests.simulation.mechanisms import links


def tip(name: str) -> str:
    return model(name).names.frames[-1]


@pytest.mark.parametrize("name", ["rx90", "space_arm", "mss"])
def test_a_pose_that_exists_is_found(name: str) -> None:
    m, frame, rng = model(name), tip(name), np.random.default_rng(1)
    for _ in range(5):
        wanted, _ = m.random_state(rng)
        # Near a singular posture convergence is slow, as two solutions meet there.
        while np.linalg.svd(m.frame_jacobian(frame, wanted), compute_uv=False)[-1] < 0.1:
            wanted, _ = m.random_state(rng)
        p, R = m.frame_pose(frame, wanted)
        start = m.integrate(wanted, 0.3 * rng.normal(size=m.nv))
        found = sf.inverse_kinematics(m, {frame: sf.Target(p, R)}, start)
        assert found.converged and found.error <= 1e-10
        reached = m.frame_pose(frame, found.q)
        assert np.abs(reached[0] - p).max() < 1e-9 and np.abs(reached[1] - R).max() < 1e-9


def test_a_loop_stays_closed() -> None:
    m = model("delta")
    start = sf.assemble(m, delta_guess()).q
    p, _ = m.frame_pose("platform", start)
    found = sf.inverse_kinematics(m, {"platform": sf.Target(p + [0.05, -0.03, 0.08])}, start)
    assert found.converged and np.abs(m.constraint(found.q)).max() < 1e-10


def test_a_path_in_space_becomes_a_motion_of_joints() -> None:
    """Along a circle: speeds and accelerations are the derivatives of the coordinates found."""
    m, t = model("rx90"), np.linspace(0.0, 0.2, 81)
    q0 = np.array([0.3, -0.4, 1.2, 0.2, 0.7, -0.1])
    frame = tip("rx90")
    p0, R0 = m.frame_pose(frame, q0)
    c, s, still = np.cos(5 * t), np.sin(5 * t), np.zeros((len(t), 4))
    p = p0 + 0.05 * np.stack([c - 1, s, 0 * t], axis=1)
    V = np.concatenate([0.25 * np.stack([-s, c], axis=1), still], axis=1)
    A = np.concatenate([-1.25 * np.stack([c, s], axis=1), still], axis=1)
    q, v, a = sf.joint_motion(m, frame, p, V, A, np.tile(R0, (len(t), 1, 1)), q=q0, tolerance=1e-11)
    h = t[1] - t[0]
    inner = slice(2, -2)
    rate = (8 * (q[3:-1] - q[1:-3]) - (q[4:] - q[:-4])) / (12 * h)
    assert np.abs(rate - v[inner]).max() < 1e-5 * np.abs(v).max()
    rate = (8 * (v[3:-1] - v[1:-3]) - (v[4:] - v[:-4])) / (12 * h)
    assert np.abs(rate - a[inner]).max() < 1e-5 * np.abs(a).max()


def test_rates_that_no_motion_of_the_joints_has_are_refused() -> None:
    """A planar arm that is to leave its plane, and one that is to stretch where it is stretched."""
    m, frame, q = interpreted(MODELS["double_pendulum"]), "tip", [0.3, 0.5]
    for at, V, A in ((q, (0, 1, 0), (0, 0, 0)), (q, (0, 0, 0), (0, 1, 0)), ([0.3, 0.0], None, (0, 0, 0))):
        p, R = m.frame_pose(frame, at)
        outwards = p / np.linalg.norm(p) if V is None else np.array(V, float)
        rates = "accelerations" if np.any(A) else "velocities"
        with pytest.raises(sf.AssemblyError, match=f"{rates} can't be followed"):
            sf.joint_motion(m, frame, [p], [outwards], [np.array(A, float)], q=at)


@pytest.mark.parametrize("L", [1e-6, 1e-3, 1.0, 1e3])
def test_a_motion_of_position_and_rotation_is_followed_by_arms_of_any_size(L: float) -> None:
    """Velocities in micrometres a second beside radians a second; the speeds were off by 1.6 rad/s."""
    bodies: list[sf.RigidBody] = []
    for i, axis in enumerate([(0, 0, 1), (0, 1, 0), (0, 1, 0), (1, 0, 0), (0, 1, 0), (1, 0, 0)]):
        joint = sf.Joint(f"q{i}", "revolute", *((f"b{i - 1}", "e") if i else ()), axis=axis)
        end = sf.Frame("e", (L * (0.5 if i < 3 else 0.1), 0.0, 0.1 * L))
        bodies.append(sf.RigidBody(f"b{i}", joint, sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)), (end,)))
    arm = sf.compile(sf.System("arm", bodies), sf.Options(backend="interpreter"))
    q, v = np.array([0.3, -0.5, 0.8, 0.4, 0.6, 0.2]), np.array([1.0, 2.0, -1.0, 0.5, 0.3, 0.7])
    p, R = arm.frame_pose("b5.e", q)
    V, A = arm.frame_velocity("b5.e", q, v), arm.frame_acceleration("b5.e", q, v, np.zeros(6))
    _, speeds, rates = sf.joint_motion(arm, "b5.e", [p], [V], [A], [R], q=q)
    np.testing.assert_allclose(speeds[0], v, atol=1e-9)
    np.testing.assert_allclose(rates[0], 0.0, atol=1e-9)


@pytest.mark.parametrize("elbow", [1.0, -1.0])
def test_of_two_postures_the_one_near_rest_is_taken(elbow: float) -> None:
    """Whichever the guess leads to."""
    options = sf.Options(("frame_pose", "frame_jacobian"), backend="interpreter")
    m = sf.compile(sf.System("arm", links((1.0, 0.8))), options)
    wanted = np.array([0.3, elbow * 1.1])
    target = {"b1.end": sf.Target(m.frame_pose("b1.end", wanted)[0])}
    across = np.array([0.3 + 2.0 * elbow * np.arctan2(0.8 * np.sin(1.1), 1.0 + 0.8 * np.cos(1.1)), -elbow * 1.1])
    assert sf.inverse_kinematics(m, target, across + 0.05).q == pytest.approx(across, abs=1e-6)
    assert sf.inverse_kinematics(m, target, across + 0.05, rest=wanted + 0.1).q == pytest.approx(wanted, abs=1e-6)
