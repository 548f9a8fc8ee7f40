"""Signals of a motion over time, to be plotted beside it: coordinates in units for people, inputs, energies, others."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from symofros.base.arrays import Array, numeric
from symofros.errors import ShapeError, SymofrosError
from symofros.mechanics.beams import theory_of
from symofros.mechanics.topology import SpanningTree, joint_units
from symofros.runtime.model import ArrayLike
from symofros.simulation.results.trajectory import Trajectory
from symofros.studio.viewer.playing.motion import PlayedMotion


def coordinate_units(tree: SpanningTree) -> dict[str, str]:
    """Unit of each coordinate, where it is known: of a general joint it is not; a quaternion's parts have none."""
    unit_of: dict[str, str] = {}
    for link in tree.links:
        start, size = link.q
        names = tree.coordinates.q[start : start + size]
        if link.tip_of is not None:
            units = theory_of(link.tip_of).units
        else:
            units = joint_units(link.joint)
        unit_of |= dict(zip(names, units, strict=False))  # A prescribed joint has none among q.
    return unit_of


@dataclass(frozen=True)
class Signal:
    """Curves that are plotted together.

    Attributes:
        name: What they are, with the unit where there is one, as it is chosen.
        curves: Names of the curves (k).
        t: Times (n) [s].
        values: Their values (n, k).
    """

    name: str
    curves: tuple[str, ...]
    t: Array
    values: Array

    def at(self, times: Array) -> Array:
        """Values at times (m), interpolated linearly (m, k)."""
        return np.stack([np.interp(times, self.t, column) for column in self.values.T], axis=1)


def signals_of(
    motion: PlayedMotion, units: Mapping[str, str], run: Trajectory | None, stated: Mapping[str, ArrayLike] | None
) -> tuple[Signal, ...]:
    """The signals of a motion.

    Args:
        motion: Motion that is played.
        units: Units of its coordinates by name.
        run: Trajectory that it is of, if it is of one: then there are energies.
        stated: More of them by name, at the times of the motion (n) or (n, k).

    Raises:
        ShapeError: What is stated has not as many values as the motion has times.
    """
    names, found = motion.model.names, []
    for unit in sorted({units.get(name, "") for name in names.q}, key=len, reverse=True):
        chosen = [i for i, name in enumerate(names.q) if units.get(name, "") == unit]
        label = f"coordinates [{unit}]" if unit else "coordinates without a unit"
        found.append(Signal(label, tuple(names.q[i] for i in chosen), motion.t, motion.q[:, chosen]))
    if names.u:
        found.append(Signal("inputs", names.u, motion.t, motion.u))
    if run is not None:
        found += _energies(run, len(motion.t))
    for name, values in (stated or {}).items():
        found.append(_stated(name, numeric(f"signal '{name}'", np.asarray(values)), motion))
    if len(names.q) > 1:
        for i, name in enumerate(names.q):
            label = f"{name} [{units[name]}]" if units.get(name) else name
            found.append(Signal(label, (name,), motion.t, motion.q[:, [i]]))
    return tuple(found)


def _energies(run: Trajectory, count: int) -> list[Signal]:
    try:
        kinetic, potential = run.kinetic_energy[:count], run.potential_energy[:count]
    except SymofrosError:  # A model may be compiled without them.
        return []
    values = np.stack([kinetic, potential, kinetic + potential], axis=1)
    return [Signal("energies [J]", ("kinetic", "potential", "total"), run.t[:count], values)]


def _stated(name: str, values: Array, motion: PlayedMotion) -> Signal:
    n = len(motion.t)
    if values.ndim not in (1, 2) or len(values) < n or not np.isfinite(values[:n]).all():
        found = (
            f"shape {values.shape}" if values.ndim not in (1, 2) or len(values) < n else "values that are not finite"
        )
        rule, remedy = f"a value, or k of them, at each of the motion's {n} times", "such as run.q[:, 0]"
        raise ShapeError(f"view: signal '{name}' does not fit the motion", found, rule, remedy)
    columns = values[:n].reshape(n, -1)
    curves = (name,) if columns.shape[1] == 1 else tuple(f"{name}[{i}]" for i in range(columns.shape[1]))
    return Signal(name, curves, motion.t, columns)
