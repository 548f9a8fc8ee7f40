import math

import numpy as np
import pytest

from validation.mechanics.geometry import (
    Placement,
    about_axis,
    matrix_quaternion,
    nearest_rotation,
    quaternion_matrix,
    quaternion_product,
    rotation_matrix,
    skew,
)


def unit_quaternions(rng: np.random.Generator) -> np.ndarray:
    q = rng.standard_normal((20, 4))
    # Half turns, and nearly no turn: where the choice of the largest component matters.
    special = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0.6, 0, 0.8, 0], [1e-9, 0, 0, 1], [0, 0, 0, -1]]
    q = np.concatenate([q, np.array(special, dtype=float)])
    return q / np.linalg.norm(q, axis=1, keepdims=True)


def test_quaternion_to_matrix_and_back(rng: np.random.Generator) -> None:
    for q in unit_quaternions(rng):
        R = quaternion_matrix(q)
        assert np.allclose(R @ R.T, np.eye(3), atol=1e-15) and np.linalg.det(R) > 0
        back = matrix_quaternion(R)
        assert min(np.abs(back - q).max(), np.abs(back + q).max()) < 1e-15


def test_product_of_quaternions_is_product_of_rotations(rng: np.random.Generator) -> None:
    a, b = unit_quaternions(rng), unit_quaternions(rng)[::-1]
    assert np.allclose(quaternion_matrix(quaternion_product(a, b)), quaternion_matrix(a) @ quaternion_matrix(b))


def test_quarter_turns_map_axes() -> None:
    x, y, z = np.eye(3)
    assert np.allclose(about_axis(z, math.pi / 2) @ x, y)
    assert np.allclose(quaternion_matrix(np.array([0, 0, math.sqrt(0.5), math.sqrt(0.5)])) @ x, y)
    assert np.allclose(rotation_matrix("rpy", np.array([0, 0, math.pi / 2])) @ x, y)
    assert np.allclose(skew(x) @ y, z)


def test_roll_pitch_yaw_turns_about_fixed_axes() -> None:
    # Roll about x first, then yaw about the fixed z: y goes to z, which yaw leaves alone.
    R = rotation_matrix("rpy", np.array([math.pi / 2, 0.0, math.pi / 2]))
    assert np.allclose(R @ [0, 1, 0], [0, 0, 1])


@pytest.mark.parametrize(
    ("kind", "values"),
    [("quaternion", [0, 0, 2, 2]), ("axis_angle", [0, 0, 5, math.pi / 2]), ("matrix", [0, -1, 0, 1, 0, 0, 0, 0, 1])],
)
def test_every_kind_of_rotation_gives_its_matrix(kind: str, values: list[float]) -> None:
    assert np.allclose(rotation_matrix(kind, np.array(values, dtype=float)), about_axis(np.eye(3)[2], math.pi / 2))


def test_typed_digits_become_a_rotation() -> None:
    R = about_axis(np.array([0.6, 0.0, 0.8]), 1.0)
    assert np.abs(nearest_rotation(np.round(R, 6)) - R).max() < 1e-6
    assert np.allclose(nearest_rotation(np.round(R, 6)) @ nearest_rotation(np.round(R, 6)).T, np.eye(3), atol=1e-15)


def test_placements_compose(rng: np.random.Generator) -> None:
    A = Placement(about_axis(np.eye(3)[0], 0.3), rng.standard_normal(3))
    B = Placement(about_axis(np.eye(3)[1], 0.4), rng.standard_normal(3))
    point = rng.standard_normal(3)
    assert np.allclose((A @ B).p + (A @ B).R @ point, A.p + A.R @ (B.p + B.R @ point))
    assert np.allclose((Placement.identity() @ A).p, A.p)
