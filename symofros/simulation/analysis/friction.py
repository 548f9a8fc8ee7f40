"""What friction carries in motion: it is smooth through zero speed and holds nothing (docs/theory/rigid.md, 10.1)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.errors import SymofrosError
from symofros.runtime.model import ArrayLike, Model

# Share of the slope at rest below which friction is taken to have reached what it gives.
_FLAT = 0.1
# Its peak is 1.21 times as fast as where the slope has fallen to that share, and at most twice.
_PEAK = 2.0


class FrictionCurve(NamedTuple):
    """Forces against the motion of one speed.

    Attributes:
        carried: Force at each speed looked at, less that at the first (n) [N m or N].
        flat: Index of the first speed from which on the force hardly grows.
        reached: Largest force about there [N m or N].
    """

    carried: Array
    flat: int
    reached: float


def friction_curve(
    model: Model, i: int, speeds: Array, state: tuple[Array, Array, Array], par: ArrayLike | None, t: float
) -> FrictionCurve | None:
    """Friction force on a speed as this speed changes; None if the force does not level off, or `dynamics` is left out.

    Args:
        model: The model.
        i: Index of the speed.
        speeds: What it changes to (n), from the present one on, whose distances from it grow by a ratio [rad/s or m/s].
        state: q (nq), v (nv), u (nu); entry i of v does not count.
        par: Run-time parameters.
        t: Time [s].
    """
    q, v, u = state
    v_all = np.tile(v, (len(speeds), 1))
    v_all[:, i] = speeds
    try:
        _, _, Q = model.dynamics(np.tile(q, (len(speeds), 1)), v_all, np.tile(u, (len(speeds), 1)), par=par, t=t)
    except SymofrosError:  # Options.functions left it out.
        return None
    carried = np.abs(Q[:, i] - Q[0, i])
    slopes = np.diff(carried) / np.abs(np.diff(speeds))
    found = np.flatnonzero(slopes < _FLAT * slopes[0])
    if not len(found):
        return None
    flat = int(found[0])
    change = np.abs(speeds - speeds[0])
    near = change <= _PEAK * change[flat]
    return FrictionCurve(carried, flat, float(carried[near].max()))
