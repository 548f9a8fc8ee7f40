"""Which transforms of prims turn, shift and scale alone."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from symofros.description.usd.placement import Affine


def test_turned_and_scaled_frames_are_rigid_and_sheared_or_mirrored_ones_are_not() -> None:
    rng = np.random.default_rng(0)
    for _ in range(20):
        R, p = Rotation.random(random_state=rng).as_matrix(), rng.normal(size=3)
        scaled = R * rng.uniform(0.1, 10.0, 3)
        placement = Affine(scaled, p)
        assert placement.is_rigid
        np.testing.assert_allclose(placement.pose.R, R, rtol=0, atol=1e-14)
        shear = np.eye(3)
        shear[0, 1] = 0.1
        assert not Affine(R @ shear, p).is_rigid and not Affine(-scaled, p).is_rigid
