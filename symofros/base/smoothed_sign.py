"""The sign of a speed, smoothed through zero: that of friction (docs/theory/rigid.md, (56))."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array

# It is xi (TERMS[0] + TERMS[1] xi^2 + TERMS[2] xi^4) of xi = v / max(|v|, peak), the peak at PEAK minimum velocities.
PEAK = 15.0 / 8.0
TERMS = (15.0 / 8.0, -10.0 / 8.0, 3.0 / 8.0)


def smoothed_sign(v: Array, minimum_velocity: npt.ArrayLike) -> Array:
    """The sign of speeds, exactly 1 or -1 from 15/8 minimum velocities on, with the slope 1/minimum_velocity at zero.

    Args:
        v: Speeds (..., n) [rad/s or m/s].
        minimum_velocity: Above zero; one, or one for each speed (n) [rad/s or m/s].
    """
    xi = v / np.maximum(np.abs(v), PEAK * np.asarray(minimum_velocity))
    square = xi * xi
    return np.asarray(xi * (TERMS[0] + square * (TERMS[1] + square * TERMS[2])))
