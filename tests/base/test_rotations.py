"""Rotations of numbers against SciPy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from symofros.base.rotations import matrix_quaternion, quaternion_matrix

# No turn, half turns about each axis and about oblique ones, and beside them: each entry is the largest somewhere.
TURNS = [np.zeros(3), *(np.pi * np.eye(3)), *((np.pi - 1e-9) * np.eye(3)), np.pi * np.array([0.6, 0.0, -0.8])]
TURNS += [np.random.default_rng(k).uniform(-2.0, 2.0, 3) for k in range(8)]


@pytest.mark.parametrize("turn", TURNS, ids=str)
def test_quaternions_and_matrices_are_of_the_same_rotation(turn: np.ndarray) -> None:
    R = Rotation.from_rotvec(turn)
    quaternion = matrix_quaternion(R.as_matrix())
    assert abs(quaternion @ R.as_quat()) == pytest.approx(1.0, abs=1e-15)
    np.testing.assert_allclose(quaternion_matrix(quaternion), R.as_matrix(), atol=5e-16)
