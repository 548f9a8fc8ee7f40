"""How far the coordinates of a mechanism reach, by which forces and moments, lengths and angles are compared."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.base.measures import LENGTH, ROTATION, TRANSLATION, Measures
from symofros.runtime.constrained import natural_sizes
from symofros.runtime.model import ArrayLike, Model


class Reach(NamedTuple):
    """Sizes of a change of order one (docs/theory/linear.md, section 3), whatever the units.

    Attributes:
        speeds: Of each speed's coordinate (nv): a radian, the length of the mechanism, what bends a beam by a radian.
        steps: The same, by which steps of a search are bounded: a body that no loop holds may be far off for its size.
        conditions: Of each residual of a constraint (nc): the length of the mechanism, or 1.
    """

    speeds: Array
    steps: Array
    conditions: Array


def reach_of(model: Model, G: Array, M: Array, par: ArrayLike | None) -> Reach:
    """How far a mechanism reaches: by the constraints on lengths where it turns, or else by its radius of gyration.

    Args:
        model: Model.
        G: Constraint Jacobian (nc, nv).
        M: Mass matrix (nv, nv).
        par: Run-time parameters.
    """
    measures = model.record.measures
    kinds = np.array(measures.kinds(model.nv))
    shifts, turns = kinds == TRANSLATION, kinds == ROTATION
    length = farthest = length_by_constraints(G, measures)
    if not length:
        mass, inertia = (float(np.diag(M)[which].max(initial=0.0)) for which in (shifts, turns))
        length = float(np.sqrt(inertia / mass)) if mass > 0.0 and inertia > 0.0 else 1.0
        farthest = max(length, 1.0)
    speeds = np.where(shifts, length, 1.0)
    for beam in model.beams(par):
        speeds[beam.in_v] = 1.0 / beam.scale
    return Reach(speeds, np.where(shifts, farthest, speeds), np.where(np.equal(measures.unit, LENGTH), length, 1.0))


def length_by_constraints(G: Array, measures: Measures) -> float:
    """The largest lever by which a rotation moves what constraints (nc, nv) keep in place [m]; zero where none does."""
    lengths = np.array(measures.unit, dtype=np.intp) == LENGTH
    turns = np.equal(measures.kinds(G.shape[1]), ROTATION)
    return float(natural_sizes(G, measures)[np.ix_(lengths, turns)].max(initial=0.0)) if len(lengths) else 0.0
