"""The exponential of a matrix, beside SciPy's and closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from symofros.base.exponential import matrix_exponential


@pytest.mark.parametrize("size", [1e-6, 0.3, 4.0, 60.0])
def test_it_is_that_of_scipy(size: float) -> None:
    rng = np.random.default_rng(1)
    A = size * rng.standard_normal((6, 6))
    A -= 2.0 * size * np.eye(6)  # So that large ones decay for the most part.
    expected = pytest.importorskip("scipy.linalg").expm(A)  # The base installation has no SciPy.
    assert np.abs(matrix_exponential(A) - expected).max() < 1e-12 * max(1.0, size) * np.abs(expected).max()


def test_closed_forms() -> None:
    turn = matrix_exponential(np.array([[0.0, -9.0], [9.0, 0.0]]))
    assert np.abs(turn - [[np.cos(9.0), -np.sin(9.0)], [np.sin(9.0), np.cos(9.0)]]).max() < 1e-13
    assert np.array_equal(matrix_exponential(np.array([[0.0, 3.0], [0.0, 0.0]])), [[1.0, 3.0], [0.0, 1.0]])
    assert abs(matrix_exponential(np.array([[-200.0]]))[0, 0] / np.exp(-200.0) - 1.0) < 1e-12
    assert matrix_exponential(np.zeros((0, 0))).shape == (0, 0)
