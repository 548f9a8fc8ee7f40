"""The motion within the steps of a run: states between its ends, by the cubics through these (18a)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.runtime.manifold import chart_coordinates, chart_rate, retract
from symofros.simulation.stepping.stepper import Stepper

Numbers = npt.NDArray[np.integer[Any]]


@dataclass(frozen=True)
class Path:
    """States within intervals, in the order of time; all of an interval's are equally far apart.

    Attributes:
        interval: Number of each state's interval (m).
        x: Share of the interval that lies before it (m).
        states: t (m), q (m, nq), v (m, nv), u (m, nu).
        a: Accelerations there by the equations of motion (m, nv).
        path_a: Accelerations of the path (m, nv): those that the steps have made the motion follow.
    """

    interval: Numbers
    x: Array
    states: list[Array]
    a: Array
    path_a: Array


def path_within(stepper: Stepper, states: Sequence[Array], counts: Numbers) -> Path | None:
    """States within the intervals between recorded ones, at the midpoints of equal parts of each.

    Args:
        stepper: Stepper of the run; its state stays.
        states: Recorded states: t (n), q, v, u.
        counts: Number of states within each interval (n - 1); 0 of those that are left out.

    Returns:
        None where a function of the user's fails.
    """
    t, q, v, _ = states
    segments = stepper.model.record.segments
    chosen = np.flatnonzero(counts)
    number = counts[chosen]
    at = np.repeat(np.arange(len(chosen)), number)  # Which of the chosen intervals each state lies in.
    x = (np.arange(len(at)) - np.repeat(np.cumsum(number) - number, number) + 0.5) / number[at]
    (t0, t1), (q0, q1), (v0, v1) = ((y[chosen], y[chosen + 1]) for y in (t, q, v))
    h = (t1 - t0)[at, np.newaxis]
    with stepper.preserved(), np.errstate(all="ignore"):  # What has exploded overflows.
        ends = [stepper.accelerations(*state) for state in ((t0, q0, v0), (t1, q1, v1))]
        if ends[0] is None or ends[1] is None:
            return None
        a0, a1 = ends[0][0], ends[1][0]
        theta = chart_coordinates(segments, q0, q1)
        along, _ = _cubic(x, h, (0.0 * theta[at], v0[at]), (theta[at], chart_rate(segments, theta, v1)[at]))
        v_x, path_a = _cubic(x, h, (v0[at], a0[at]), (v1[at], a1[at]))
        t_x, q_x = t0[at] + x * h[:, 0], retract(segments, q0[at], along)
        inside = stepper.accelerations(t_x, q_x, v_x)
    if inside is None:
        return None
    return Path(chosen[at], x, [t_x, q_x, v_x, inside[1]], inside[0], path_a)


def _cubic(x: Array, h: Array, begin: tuple[Array, Array], end: tuple[Array, Array]) -> tuple[Array, Array]:
    """Values and rates (m, n) at shares x (m) of intervals h (m, 1) [s] of cubics, given both at the ends."""
    x = x[:, np.newaxis]
    (y0, r0), (y1, r1) = begin, end
    change = y1 - y0 - h * r0
    bend = h * (r1 - r0)
    value = y0 + x * (h * r0 + x * (3.0 * change - bend + x * (bend - 2.0 * change)))
    rate = r0 + x * (2.0 * (3.0 * change - bend) + 3.0 * x * (bend - 2.0 * change)) / h
    return value, rate
