"""The motion within the steps of a run: states between its ends, by the cubics through these (18a)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array, Mask
from symofros.simulation.stepping.stepper import Stepper

Numbers = npt.NDArray[np.intp]


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
    """The cubics through the ends of intervals.

    Attributes:
        stepper: Stepper of the run.
        ends: Ends of intervals, one after the other: t (n) [s], q (n, nq), v (n, nv), and accelerations (n, nv).
    """

    stepper: Stepper
    ends: tuple[Array, Array, Array, Array]

    @classmethod
    def of(cls, stepper: Stepper, states: Sequence[Array], chosen: Mask) -> Cubics | None:
        """Cubics of some intervals between recorded t (n), q, v: chosen (n - 1). None where a user's function fails."""
        t, q, v = map(np.ascontiguousarray, states[:3])
        if chosen.all():
            found = stepper.accelerations(t, q, v)
            return None if found is None else cls(stepper, (t, q, v, found[0]))
        a, rows = np.full(v.shape, np.nan), np.append(chosen, False)
        rows[1:] |= chosen
        found = stepper.accelerations(t[rows], q[rows], v[rows])
        if found is None:
            return None
        a[rows] = found[0]
        return cls(stepper, (t, q, v, a))

    def at(self, which: Numbers, x: Array) -> tuple[Array, Array, Array, Array]:
        """Time (m), q (m, nq), v and a (m, nv) of the path at shares x (m) of intervals, by their numbers (m)."""
        return self.stepper.path(self.ends, which, x)


def path_within(stepper: Stepper, states: Sequence[Array], counts: Numbers) -> Path | None:
    """States within the intervals between recorded ones, at the midpoints of equal parts of each.

    Args:
        stepper: Stepper of the run; its state stays.
        states: Recorded states: t (n), q, v, u.
        counts: Number of states within each interval (n - 1); 0 of those that are left out.

    Returns:
        None where a function of the user's fails.
    """
    interval = np.arange(len(counts)).repeat(counts)
    x = (np.arange(len(interval)) - (counts.cumsum() - counts)[interval] + 0.5) / counts[interval]
    cubics = Cubics.of(stepper, states, counts > 0)
    if cubics is None:
        return None
    t_x, q_x, v_x, path_a = cubics.at(interval, x)
    inside = stepper.accelerations(t_x, q_x, v_x)
    if inside is None:
        return None
    return Path(interval, x, [t_x, q_x, v_x, inside[1]], inside[0], path_a)
