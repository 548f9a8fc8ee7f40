"""Coordinates of the configuration manifold about a configuration, as the loop in C has them, for interpreted runs.

docs/theory/simulation.md, (1) to (3).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from symofros.runtime.kernel import Array
from symofros.runtime.manifold import quaternion_exp, quaternion_product, rotate
from symofros.runtime.record import Segment


def retract(segments: Sequence[Segment], q0: Array, theta: Array) -> Array:
    """The q (nq) at coordinates theta (nv) about q0 (nq)."""
    q = np.empty_like(q0)
    for kind, i, j, n in segments:
        if kind == "linear":
            q[i : i + n] = q0[i : i + n] + theta[j : j + n]
        elif kind == "quaternion":
            q[i : i + 4] = _turned(q0[i : i + 4], theta[j : j + 3])
        else:
            q[i : i + 3] = q0[i : i + 3] + rotate(q0[i + 3 : i + 7], theta[j : j + 3])
            q[i + 3 : i + 7] = _turned(q0[i + 3 : i + 7], theta[j + 3 : j + 6])
    return q


def chart_rate(segments: Sequence[Segment], theta: Array, v: Array) -> Array:
    """The rate of theta (nv) where the speeds are v (nv)."""
    rate = np.empty_like(v)
    for kind, _, j, n in segments:
        if kind == "linear":
            rate[j : j + n] = v[j : j + n]
        elif kind == "quaternion":
            rate[j : j + 3] = _vector_rate(theta[j : j + 3], v[j : j + 3])
        else:
            rate[j : j + 3] = rotate(quaternion_exp(theta[j + 3 : j + 6]), v[j : j + 3])
            rate[j + 3 : j + 6] = _vector_rate(theta[j + 3 : j + 6], v[j + 3 : j + 6])
    return rate


def _turned(quaternion: Array, w: Array) -> Array:
    product = quaternion_product(quaternion, quaternion_exp(w))
    unit: Array = product / np.linalg.norm(product)
    return unit


def _vector_rate(theta: Array, w: Array) -> Array:
    angle2 = float(theta @ theta)
    angle = np.sqrt(angle2)
    c = 1.0 / 12.0 + angle2 / 720.0 if angle < 1e-3 else (1.0 - 0.5 * angle / np.tan(0.5 * angle)) / angle2
    once = np.cross(theta, w)
    rate: Array = w + 0.5 * once + c * np.cross(theta, once)
    return rate
