"""Rotations of numbers against Rodrigues's formula."""

from __future__ import annotations

import numpy as np
import pytest

from symofros.base.rotations import matrix_product, matrix_quaternion, quaternion_matrix

# No turn, half turns about each axis and about oblique ones, and beside them: each entry is the largest somewhere.
TURNS = [np.zeros(3), *(np.pi * np.eye(3)), *((np.pi - 1e-9) * np.eye(3)), np.pi * np.array([0.6, 0.0, -0.8])]
TURNS += [np.random.default_rng(k).uniform(-2.0, 2.0, 3) for k in range(8)]


@pytest.mark.parametrize("turn", TURNS, ids=str)
def test_quaternions_and_matrices_are_of_the_same_rotation(turn: np.ndarray) -> None:
    angle = float(np.linalg.norm(turn))
    n = turn / angle if angle else np.array([1.0, 0.0, 0.0])
    K = np.array([[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]])
    R = np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K)
    known = np.append(np.sin(0.5 * angle) * n, np.cos(0.5 * angle))
    assert abs(matrix_quaternion(R) @ known) == pytest.approx(1.0, abs=1e-15)
    np.testing.assert_allclose(quaternion_matrix(known), R, atol=5e-16)


@pytest.mark.parametrize("shape", [(3,), (3, 3)])
def test_products_of_matrices_are_those_of_numpy(shape: tuple[int, ...], rng: np.random.Generator) -> None:
    R, x = rng.standard_normal((3, 3)), rng.standard_normal(shape)
    np.testing.assert_allclose(matrix_product(R, x), R @ x, rtol=1e-14, atol=1e-14)
