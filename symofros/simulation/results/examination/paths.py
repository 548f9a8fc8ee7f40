"""The motion within the steps of a run: states between its ends, by the cubics through these (18a)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.runtime.manifold import chart_coordinates, chart_rate, retract
from symofros.runtime.record import Segment
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


@dataclass(frozen=True)
class Cubics:
    """The cubics through the ends of intervals, with their rates there.

    Attributes:
        segments: Segments of the configuration.
        begins: Times (k) [s], configurations (k, nq), speeds (k, nv) and accelerations (k, nv) where intervals begin.
        ends: The same where they end.
    """

    segments: Sequence[Segment]
    begins: tuple[Array, Array, Array, Array]
    ends: tuple[Array, Array, Array, Array]

    @cached_property
    def _chart(self) -> tuple[Array, Array]:
        """Displacements over the intervals (k, nv), and their rates at the ends."""
        (_, q0, _, _), (_, q1, v1, _) = self.begins, self.ends
        theta = chart_coordinates(self.segments, q0, q1)
        return theta, chart_rate(self.segments, theta, v1)

    @classmethod
    def of(cls, stepper: Stepper, states: Sequence[Array], chosen: Numbers) -> Cubics | None:
        """Cubics of intervals between recorded t (n), q, v; None where a user's function fails. In `preserved`."""
        places, both = states[:3], list[tuple[Array, Array, Array, Array]]()
        for numbers in (chosen, chosen + 1):
            t, q, v = (y[numbers] for y in places)
            found = stepper.accelerations(t, q, v)
            if found is None:
                return None
            both.append((t, q, v, found[0]))
        return cls(stepper.model.record.segments, *both)

    def at(self, which: Numbers, x: Array) -> tuple[Array, Array, Array, Array]:
        """Time (m), q (m, nq), v and a (m, nv) of the path at shares x (m) of intervals, by their numbers (m)."""
        (t0, q0, v0, a0), (t1, _, v1, a1), (theta, rate), i = self.begins, self.ends, self._chart, which
        h = (t1 - t0)[i]
        along, _ = _cubic(x, h[:, np.newaxis], (0.0 * theta[i], v0[i]), (theta[i], rate[i]))
        v_x, path_a = _cubic(x, h[:, np.newaxis], (v0[i], a0[i]), (v1[i], a1[i]))
        return t0[i] + x * h, retract(self.segments, q0[i], along), v_x, path_a


def path_within(stepper: Stepper, states: Sequence[Array], counts: Numbers) -> Path | None:
    """States within the intervals between recorded ones, at the midpoints of equal parts of each.

    Args:
        stepper: Stepper of the run; its state stays.
        states: Recorded states: t (n), q, v, u.
        counts: Number of states within each interval (n - 1); 0 of those that are left out.

    Returns:
        None where a function of the user's fails.
    """
    chosen = np.flatnonzero(counts)
    number = counts[chosen]
    at = np.repeat(np.arange(len(chosen)), number)  # Which of the chosen intervals each state lies in.
    x = (np.arange(len(at)) - np.repeat(np.cumsum(number) - number, number) + 0.5) / number[at]
    with stepper.preserved(), np.errstate(all="ignore"):  # What has exploded overflows.
        cubics = Cubics.of(stepper, states, chosen)
        if cubics is None:
            return None
        t_x, q_x, v_x, path_a = cubics.at(at, x)
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
