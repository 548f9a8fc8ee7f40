"""Closed forms of the pendulum, J psi'' = -V sin psi with psi from the lowest position, by elliptic functions."""

from __future__ import annotations

import numpy as np
from scipy.special import ellipj, ellipkm1

from ...mechanics.geometry import Array


def swinging(amplitude: float, V_over_J: float, times: Array) -> Array:
    """The angle of a swing from rest at an amplitude (n) [rad]: 2 asin(k cd(w t)), k the sine of half the amplitude."""
    k, w = np.sin(amplitude / 2.0), np.sqrt(V_over_J)
    _, cn, dn, _ = ellipj(w * times, k * k)
    return np.asarray(2.0 * np.arcsin(k * cn / dn))


def turning(speed: float, V_over_J: float, times: Array) -> Array:
    """The same of full turns from upright, at pi, with a speed > 0 (n) [rad]: 2 am(K + w t/2), w that at the bottom."""
    w = np.sqrt(speed**2 + 4.0 * V_over_J)
    # 1 - k^2, which is small: K needs it without cancellation.
    rest = (speed / w) ** 2
    _, _, _, amplitude = ellipj(ellipkm1(rest) + w * times / 2.0, 1.0 - rest)
    return np.asarray(2.0 * amplitude)
