"""Derivatives of the equations of motion with respect to coordinates, speeds and inputs (docs/theory/linear.md).

Columns are directional derivatives along the manifold of q: along the motion of one speed at a time, q' = N v. They
are taken on the graph by forward differentiation, so they are exact, and share what they have in common.
Vector-Jacobian products take one reverse sweep each (section 5 there).
"""

from __future__ import annotations

from collections.abc import Sequence

from symofros.expr.derivative import adjoint, along, partials
from symofros.expr.edges import Edge
from symofros.mechanics.dynamics.applied.forces import rates_per_speed
from symofros.mechanics.kinematics.links import TreeKinematics, speeds_by_path

Matrix = list[list[Edge]]


def by_configuration(kinematics: TreeKinematics, edges: Sequence[Edge]) -> Matrix:
    """One row an edge, one column a speed: the change of the edge as q moves with that speed alone."""
    return along(kinematics.g, edges, rates_per_speed(kinematics), _together(kinematics))


def by_inputs(kinematics: TreeKinematics, edges: Sequence[Edge], group: str, count: int) -> Matrix:
    """One row an edge, one column an input of a group such as "v" or "u"."""
    inputs = [kinematics.g.input(group, k) for k in range(count)]
    return partials(kinematics.g, edges, inputs, _together(kinematics) if group == "v" else None)


def _together(kinematics: TreeKinematics) -> list[list[int]]:
    """Speeds that move the same links, in ascending order, as they stand in a row."""
    groups = [sorted(path) for path in speeds_by_path(kinematics)]
    return [*groups, [*kinematics.states]] if kinematics.states else groups


def weighted_derivatives(
    kinematics: TreeKinematics, edges: Sequence[Edge], weights: Sequence[Edge], by: Sequence[str]
) -> dict[str, list[Edge]]:
    """Derivatives of the sum of weights times edges, as if the weights were constants (eq. 8, 9).

    Args:
        kinematics: Kinematics of the tree.
        edges: Edges to differentiate.
        weights: Weight of each edge.
        by: Input groups to differentiate by: q, along its manifold with one entry a speed, v, a, u, lam or par.
    """
    g, names = kinematics.g, kinematics.tree.coordinates
    sizes = {"q": len(names.q), "v": kinematics.nv, "a": kinematics.nv, "u": len(names.u), "par": len(names.par)}
    nc = sum(len(constraint.conditions) for constraint in kinematics.tree.system.constraints)
    inputs = [g.input(group, k) for group in by for k in range(sizes.get(group, nc))]
    bars = dict(zip(inputs, adjoint(g, edges, weights, inputs), strict=True))
    gradient = {group: [bars[g.input(group, k)] for k in range(sizes.get(group, nc))] for group in by if group != "q"}
    if "q" in by:
        columns = rates_per_speed(kinematics)
        gradient["q"] = [g.sum(g.mul(rate, bars[edge]) for edge, rate in column.items()) for column in columns]
    return gradient
