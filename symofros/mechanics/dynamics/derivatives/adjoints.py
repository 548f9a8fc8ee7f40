"""Vector-Jacobian products of the model functions, by one reverse sweep each (docs/theory/linear.md, section 5)."""

from __future__ import annotations

from collections.abc import Sequence

from symofros.expr.adjoint import adjoint
from symofros.expr.edges import Edge
from symofros.mechanics.dynamics.applied.forces import rates_per_speed
from symofros.mechanics.kinematics.links import TreeKinematics


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
