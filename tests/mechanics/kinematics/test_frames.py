"""Kinematics of frames: what is formed link by link equals what differentiating the pose gives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import symofros as sf
from reference_models.rigid.random_tree import MORE_KINDS, random_tree
from symofros.expr.derivative import directional, partials
from symofros.mechanics.kinematics.frames import FrameKinematics
from tests.mechanics.kinematics.trees import SEEDS, Case, case, every_third_prescribed

# Sums of some ten products of numbers of order one, along up to seven joints.
ROUNDING = 1e-12

CASES = [(seed, prescribed) for seed in SEEDS for prescribed in (False, True)]


def skew(w: np.ndarray) -> np.ndarray:
    """Matrices of the cross products with vectors (n, 3)."""
    x, y, z = w.T
    zero = np.zeros_like(x)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(-1, 3, 3)


@pytest.mark.parametrize(("seed", "prescribed"), CASES)
def test_velocity_is_the_rate_of_position(seed: int, prescribed: bool) -> None:
    at = case(seed, prescribed)
    p_rate = directional(at.g, list(at.frames.pose(at.tip).p_WF), at.q_rates)
    np.testing.assert_allclose(at.values(p_rate), at.values(at.frames.velocity(at.tip)[:3]), atol=ROUNDING)


@pytest.mark.parametrize(("seed", "prescribed"), CASES)
def test_angular_velocity_turns_the_axes_of_a_frame(seed: int, prescribed: bool) -> None:
    at = case(seed, prescribed)
    R_WF = at.frames.pose(at.tip).R_WF
    R, R_rate = (
        at.values(edges).reshape(-1, 3, 3)
        for edges in (R_WF.entries, directional(at.g, list(R_WF.entries), at.q_rates))
    )
    w = at.values(at.frames.velocity(at.tip)[3:])
    np.testing.assert_allclose(R_rate, skew(w) @ R, atol=ROUNDING)


@pytest.mark.parametrize(("seed", "prescribed"), CASES)
def test_acceleration_is_the_rate_of_velocity(seed: int, prescribed: bool) -> None:
    at = case(seed, prescribed)
    rate = directional(at.g, at.frames.velocity(at.tip), at.rates)
    acceleration = at.values(at.frames.acceleration(at.tip, at.v_rate))
    np.testing.assert_allclose(acceleration, at.values(rate), atol=10 * ROUNDING)


@pytest.mark.parametrize(("seed", "prescribed"), CASES)
def test_columns_of_the_jacobian_are_partial_velocities(seed: int, prescribed: bool) -> None:
    at = case(seed, prescribed)
    speeds = [at.g.input("v", k) for k in range(at.kinematics.nv)]
    rows = partials(at.g, at.frames.velocity(at.tip), speeds)
    for row, expected in zip(at.frames.jacobian(at.tip), rows, strict=True):
        np.testing.assert_allclose(at.values(row), at.values(expected), atol=ROUNDING)


@pytest.mark.parametrize(("seed", "prescribed"), CASES)
def test_the_rate_of_the_jacobian_is_its_derivative_along_the_motion(seed: int, prescribed: bool) -> None:
    at = case(seed, prescribed)
    for row, rate in zip(at.frames.jacobian(at.tip), at.frames.jacobian_rate(at.tip), strict=True):
        np.testing.assert_allclose(at.values(rate), at.values(directional(at.g, row, at.rates)), atol=10 * ROUNDING)


@pytest.mark.parametrize(("seed", "prescribed"), CASES)
def test_acceleration_is_affine_in_the_accelerations_of_the_joints(seed: int, prescribed: bool) -> None:
    at = case(seed, prescribed)
    rows = partials(at.g, at.frames.acceleration(at.tip, at.v_rate), at.v_rate)
    assert "a" not in at.groups([edge for row in rows for edge in row])
    for row, expected in zip(at.frames.jacobian(at.tip), rows, strict=True):
        np.testing.assert_allclose(at.values(row), at.values(expected), atol=ROUNDING)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_frame_moves_by_the_joints_between_it_and_the_base_alone(seed: int) -> None:
    at = case(seed)
    tree = at.tree
    for frame in tree.frames:
        between = {k for i in tree.ancestors(frame.link) for k in range(tree.links[i].v[0], sum(tree.links[i].v))}
        columns = zip(*at.frames.jacobian(frame), strict=True)
        assert {k for k, column in enumerate(columns) if any(column)} <= between


@pytest.mark.parametrize(("seed", "prescribed"), CASES)
def test_a_mechanism_on_a_turned_base_does_the_same_motion_turned(seed: int, prescribed: bool) -> None:
    """Every pose is displaced alike, whatever the joints; quantities in the frames of joints stay as they are."""
    at = case(seed, prescribed)
    system = random_tree(seed, kinds=MORE_KINDS)
    base = system.bodies[0]
    mounting = sf.Joint(
        "mounting", "fixed", "world", position=(0.3, -0.2, 0.5), rotation=sf.Rotation.rpy(0.4, -0.8, 1.1)
    )
    mounted = replace(system, bodies=(replace(base, joint=mounting), *system.bodies[1:]))
    turned = Case(every_third_prescribed(mounted) if prescribed else mounted)
    assert turned.tree.coordinates.q == at.tree.coordinates.q
    turned.inputs = at.inputs
    p_0, R_0 = placement_of(turned, base.name)

    def of(frames: FrameKinematics, which: Case) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        frame = which.tree.frame(at.tip.qualified)
        pose = frames.pose(frame)
        R_WF = which.values(pose.R_WF.entries).reshape(-1, 3, 3)
        return which.values(list(pose.p_WF)), R_WF, which.values(frames.acceleration(frame, which.v_rate))

    (p, R, a), (p_turned, R_turned, a_turned) = of(at.frames, at), of(turned.frames, turned)
    np.testing.assert_allclose(p_turned, p_0 + p @ R_0.T, atol=ROUNDING)
    np.testing.assert_allclose(R_turned, R_0 @ R, atol=ROUNDING)
    np.testing.assert_allclose(a_turned[:, :3], a[:, :3] @ R_0.T, atol=10 * ROUNDING)
    np.testing.assert_allclose(a_turned[:, 3:], a[:, 3:] @ R_0.T, atol=10 * ROUNDING)


def placement_of(at: Case, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Position and rotation of a frame that does not move."""
    pose = at.frames.pose(at.tree.frame(name))
    return at.values(list(pose.p_WF))[0], at.values(pose.R_WF.entries)[0].reshape(3, 3)
