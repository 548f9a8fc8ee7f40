"""Derivatives of the equations of motion with respect to coordinates, speeds and inputs (docs/theory/linear.md).

Columns are directional derivatives along the manifold of q: along the motion of one speed at a time, q' = N v. They
are taken on the graph by forward differentiation, so they are exact, and share what they have in common.
"""

from __future__ import annotations

from collections.abc import Sequence

from symofros.dynamics.applied.forces import rates_per_speed
from symofros.expr.derivative import directional
from symofros.expr.graph import ONE, Edge
from symofros.kinematics.links import Motion

Matrix = list[list[Edge]]


def by_configuration(motion: Motion, edges: Sequence[Edge]) -> Matrix:
    """One row an edge, one column a speed: the change of the edge as q moves with that speed alone."""
    return _columns([directional(motion.g, edges, seeds) for seeds in rates_per_speed(motion)], len(edges))


def by_inputs(motion: Motion, edges: Sequence[Edge], group: str, count: int) -> Matrix:
    """One row an edge, one column an input of a group such as "v" or "u"."""
    g = motion.g
    return _columns([directional(g, edges, {g.input(group, k): ONE}) for k in range(count)], len(edges))


def _columns(columns: list[list[Edge]], rows: int) -> Matrix:
    return [[column[i] for column in columns] for i in range(rows)]
