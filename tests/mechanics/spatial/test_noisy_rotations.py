"""Rotations and axes stated with noise of 1e-16 to 1e-6, near turns about coordinate axes and by right angles.

Decompositions of a rotation into elementary turns have places where angles are defined by noise alone. What is used of
them must be the rotation that was stated, whatever the noise.
"""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from reference_models.rigid.random_tree import MORE_KINDS, noisy_rotation, random_tree
from symofros.base.rotations import nearest_rotation
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3
from symofros.mechanics.spatial.rotations import Factor, constant_rotation, stated_rotation
from symofros.mechanics.topology.numbers import Numbers

# Products of three matrices of doubles, each entry a sum of three roundings, after snapping entries within 1e-15.
ROUNDING = 1e-14


def numbers(g: Graph, R: Mat3) -> np.ndarray:
    return np.array([g.number(edge) for edge in R.entries], dtype=float).reshape(3, 3)


def product(g: Graph, factors: tuple[Factor, ...]) -> np.ndarray:
    R = np.eye(3)
    for factor in factors:
        R = R @ numbers(g, factor.matrix(g))
    return R


@pytest.mark.parametrize("count", [2000, pytest.param(1_000_000, marks=pytest.mark.slow(minutes=10))])
def test_factors_of_noisy_rotations_multiply_to_the_rotation(count: int) -> None:
    rng = np.random.default_rng(20)
    checker = Numbers(sf.System("s"))
    largest = np.zeros(4)
    g = Graph()
    for i in range(count):
        g = g if i % 200 else Graph()
        stated = noisy_rotation(rng)
        R = stated_rotation(stated, g, {})
        rotation, expected = constant_rotation(R), numbers(g, R)
        errors = (
            expected @ expected.T - np.eye(3),
            product(g, rotation.factors) - expected,
            product(g, rotation.tensor_factors) - expected,
            expected - checker.rotation(stated),
        )
        largest = np.maximum(largest, [np.abs(error).max() for error in errors])
    print(f"\n{count} rotations: |R R^T - 1|, |factors - R|, |factors of tensors - R|, |R - checker's|:", largest)
    assert largest.max() < ROUNDING


@pytest.mark.filterwarnings("ignore::symofros.InconsistentModelWarning")
@pytest.mark.parametrize("count", [20, pytest.param(10_000, marks=pytest.mark.slow(minutes=15))])
def test_mass_matrices_of_noisy_trees_agree_with_their_inverse_dynamics(count: int) -> None:
    """M turns inertias as tensors; inverse dynamics turns vectors, which needs no decomposition."""
    largest = 0.0
    for seed in range(count):
        system = random_tree(seed, n=4, kinds=MORE_KINDS, noisy=True)
        model = sf.compile(system, sf.Options(("mass_matrix", "inverse_dynamics"), backend="interpreter"))
        q, v = model.random_state(np.random.default_rng(seed))
        M, forces = (
            model.mass_matrix(q),
            model.inverse_dynamics(q, v, np.vstack([np.zeros(model.nv), np.eye(model.nv)])),
        )
        columns = forces[1:] - forces[0]
        # Differences of inverse dynamics lose the digits of the bias.
        scale = max(np.abs(M).max(), np.abs(forces).max())
        largest = max(largest, float(np.abs(columns.T - M).max() / scale))
    print(f"\n{count} trees: |M - inverse dynamics| / scale:", largest)
    assert largest < 1e-13


@pytest.mark.parametrize("noise", [1e-7, 1e-9, 1e-12, 1e-15])
def test_the_nearest_rotation_is_the_polar_factor(noise: float) -> None:
    rng = np.random.default_rng(0)
    for _ in range(100):
        R = np.linalg.qr(rng.standard_normal((3, 3)))[0]
        R = R * np.sign(np.linalg.det(R)) + noise * rng.standard_normal((3, 3))
        U, _, Vt = np.linalg.svd(R)
        np.testing.assert_allclose(nearest_rotation(R), U @ Vt, rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("k", range(3))
@pytest.mark.parametrize("sign", [1.0, -2.0])
@pytest.mark.parametrize("noise", [1e-16, 1e-14, 1e-12, 1e-9, 1e-6])
def test_joints_turn_about_the_axes_stated(noise: float, sign: float, k: int) -> None:
    """An axis with an entry that rounds to 1 is a coordinate axis only if its other entries are rounding, too."""
    axis, second = sign * np.roll([1.0, noise, 0.0], k), np.roll([0.0, noise, 1.0], k)
    turn = sf.Rotation.axis_angle(tuple(axis), "a")
    joints = [
        sf.Joint("a", "revolute", axis=tuple(axis)),
        sf.Joint("a", "universal", axis=tuple(axis), axis2=tuple(second)),
        sf.Joint("a", "general", coordinates=("a",), moving_rotation=turn),
    ]
    checker = Numbers(sf.System("s"))
    for joint in joints:
        body = sf.RigidBody("b", joint, sf.Inertia(1.0, (0.1, 0.2, 0.3), (1, 1, 1)))
        model = sf.compile(sf.System("s", (body,)), sf.Options(backend="interpreter"))
        q = np.zeros(model.nq)
        q[0] = 0.7
        expected = checker.rotation(sf.Rotation.axis_angle(tuple(axis), 0.7))
        np.testing.assert_allclose(model.frame_pose("b", q)[1], expected, rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("size", [1e-300, 1e-160, 1.0, 1e160, 1e300])
def test_axes_and_quaternions_of_any_length_give_the_same_rotation(size: float) -> None:
    x = np.array([0.3, -0.7, 0.2, 0.5])
    for stated, one in (
        (sf.Rotation.quaternion(*(size * x)), sf.Rotation.quaternion(*x)),
        (sf.Rotation.axis_angle(size * x[:3], 0.7), sf.Rotation.axis_angle(x[:3], 0.7)),
    ):
        g = Graph()
        R, expected = numbers(g, stated_rotation(stated, g, {})), numbers(g, stated_rotation(one, g, {}))
        np.testing.assert_allclose(R, expected, rtol=0, atol=ROUNDING)
        np.testing.assert_allclose(Numbers(sf.System("s")).rotation(stated), expected, rtol=0, atol=ROUNDING)


MATRIX = [[0.9553365, -0.2955202, 0], [0.2955202, 0.9553365, 0], [0, 0, 1]]


def test_the_rounding_of_a_rotation_matrix_is_reported() -> None:
    body = sf.RigidBody("b", sf.Joint("q", "revolute", rotation=sf.Rotation.matrix(MATRIX)), sf.Inertia(1.0))
    with pytest.warns(sf.InconsistentModelWarning, match=r"joint 'q': rotation: \|R R\^T - 1\| = 2e-08 .* nearest"):
        model = sf.compile(sf.System("s", (body,)), sf.Options(backend="interpreter"))
    R = model.frame_pose("b", [0.0])[1]
    np.testing.assert_allclose(R @ R.T, np.eye(3), rtol=0, atol=1e-15)


def test_a_file_with_a_matrix_of_few_digits_has_a_note_in_place_of_the_warning(tmp_path, recwarn) -> None:
    body = sf.RigidBody("b", sf.Joint("q", "revolute", rotation=sf.Rotation.matrix(MATRIX)), sf.Inertia(1.0))
    sf.save(sf.System("s", (body,)), tmp_path / "s.yaml")
    system = sf.load(tmp_path / "s.yaml")
    assert any("nearest rotation" in note and "s.yaml:" in note for note in system.notes)
    sf.compile(system, sf.Options(backend="interpreter"))
    assert not [w for w in recwarn if "nearest rotation" in str(w.message)]
