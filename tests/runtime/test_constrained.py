"""Pseudo-inverses and null spaces of Jacobians: the same in all units, rounding left out."""

from __future__ import annotations

import numpy as np
import pytest

from symofros.base.measures import ANGLE, LENGTH, OTHER, ROTATION, TRANSLATION, Measures
from symofros.runtime.constrained import null_space, pseudo_inverse

PLANAR_LOOP = Measures((0, 0, 0), (LENGTH, LENGTH, LENGTH), (ROTATION, ROTATION, ROTATION))


@pytest.mark.parametrize("L", [1e-7, 1e-3, 1.0, 1e6])
def test_what_a_planar_loop_says_across_its_plane_is_no_condition(L: float) -> None:
    """Rounding in a row of G was brought to the size of the others: the inverse had entries of 1e16."""
    rng = np.random.default_rng(0)
    G = L * rng.normal(size=(3, 3))
    G[1] = 1e-17 * L * rng.normal(size=3)
    inverse, Z = pseudo_inverse(G, PLANAR_LOOP), null_space(G, PLANAR_LOOP)
    assert Z.shape == (3, 1) and np.abs(G @ Z).max() < 1e-15 * L
    np.testing.assert_allclose(G @ inverse @ G, G, rtol=0, atol=1e-13 * L)
    assert np.abs(inverse[:, 1]).max() <= 1e-3 * np.abs(inverse).max()


@pytest.mark.parametrize("L", 10.0 ** np.arange(-8.0, 9.0, 4.0))
def test_positions_and_rotations_of_a_frame_are_of_full_rank_at_all_sizes(L: float) -> None:
    rng = np.random.default_rng(1)
    measures = Measures((0, 0, 0, 3, 3, 3), (LENGTH,) * 3 + (ANGLE,) * 3, (ROTATION,) * 6 + (TRANSLATION, OTHER))
    size = np.array([L, L, L, 1.0, 1.0, 1.0])
    J = size[:, None] * rng.normal(size=(6, 8))
    J[:, 6] = [0.6, 0.0, 0.8, 0.0, 0.0, 0.0]
    np.testing.assert_allclose(
        J @ pseudo_inverse(J, measures) * size / size[:, None], np.eye(6), atol=1e-7
    )  # Condition 1e8.
    assert null_space(J, measures).shape == (8, 2)
