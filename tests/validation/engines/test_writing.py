"""Texts of models that engines read: angles of rotations."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from validation.engines.plugins.writing.urdf import rpy
from validation.mechanics.geometry import rotation_matrix


@pytest.mark.parametrize("noise", [0.0, 1e-16, 1e-12, 1e-9, 1e-8, 1e-7])
def test_angles_near_right_angles_give_the_written_rotation(noise: float) -> None:
    rng = np.random.default_rng(1)
    for quarters in product(range(4), repeat=3):
        R = rotation_matrix("rpy", np.array(quarters) * np.pi / 2 + noise * rng.standard_normal(3))
        np.testing.assert_allclose(rotation_matrix("rpy", np.array(rpy(R.tolist()))), R, rtol=0, atol=1e-14)
