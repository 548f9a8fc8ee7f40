"""Motions of a model by an integrator that is not ours, to compare with closed forms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import symofros as sf
from reference_models import MODELS

Array = np.ndarray
Rate = Callable[[Array, Array], Array]

# Of each step; the errors of some hundred steps add up to a few times this.
TOLERANCE = 1e-12


def reference(name: str) -> sf.Model:
    """A reference model with the interpreter, which needs no compiler."""
    return sf.compile(MODELS[name], sf.Options(backend="interpreter"))


def rotation(quaternion: Array) -> Array:
    """R of a unit quaternion x, y, z, w (3, 3)."""
    x, s = quaternion[:3], quaternion[3]
    K = np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])
    return np.eye(3) + 2 * s * K + 2 * K @ K


def turning(quaternion: Array, w: Array) -> Array:
    """The rate of a quaternion whose body turns with w, in the body."""
    x, s = quaternion[:3], quaternion[3]
    return 0.5 * np.append(s * w + np.cross(x, w), -x @ w)


def same(q: Array, v: Array) -> Array:
    """q' of joints whose speeds are the rates of their coordinates."""
    return v


def ball(q: Array, v: Array) -> Array:
    """q' of a ball joint."""
    return turning(q, v)


def free(q: Array, v: Array) -> Array:
    """q' of a free joint."""
    return np.concatenate([rotation(q[3:]) @ v[:3], turning(q[3:], v[3:])])


def move(
    model: sf.Model, q: Array, v: Array, times: Array, rate: Rate = same, u: Array | None = None, **options: Any
) -> Any:
    """The motion from q, v at time 0, at the times.

    Returns:
        scipy's result: y has q and v as rows; `options` are those of solve_ivp, such as events.
    """
    inputs = np.zeros(model.nu) if u is None else u

    def slope(t: float, y: Array) -> Array:
        at, speed = y[: model.nq], y[model.nq :]
        return np.concatenate([rate(at, speed), model.forward_dynamics(at, speed, inputs)])

    start = np.concatenate([q, v])
    result = solve_ivp(slope, (0.0, times[-1]), start, "DOP853", times, rtol=TOLERANCE, atol=TOLERANCE, **options)
    assert result.success, result.message
    return result
