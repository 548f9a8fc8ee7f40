"""Hessians of the dynamics and of frames, weighted by cotangents (docs/theory/linear.md, section 8)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import chain

from symofros.expr.derivative import along
from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.packs.pack import WIDTH
from symofros.mechanics.dynamics.applied.forces import rates_per_speed
from symofros.mechanics.dynamics.derivatives.differentiation import weighted_derivatives
from symofros.mechanics.dynamics.mass_matrix import Matrix
from symofros.mechanics.kinematics.links import TreeKinematics


def hessian(
    kinematics: TreeKinematics, edges: Sequence[Edge], weights: Sequence[Edge], by: Sequence[str]
) -> dict[tuple[str, str], Matrix]:
    """Second derivatives of the sum of weights times edges: forward over reverse, one half of them formed (eq. 22).

    Args:
        kinematics: Kinematics of the tree.
        edges: Edges to differentiate.
        weights: Weight of each edge, held.
        by: Input groups x to differentiate by, as in `weighted_derivatives`; q, along its manifold, is the first.

    Returns:
        Block of each pair of groups: entry (i, k) is the change of the derivative by x_i as x_k moves.
    """
    gradient = weighted_derivatives(kinematics, edges, weights, by)
    slopes = [*chain.from_iterable(gradient[group] for group in by)]
    directions = [*chain.from_iterable(_directions(kinematics, group, len(gradient[group])) for group in by)]
    joints = commuting(kinematics, len(slopes))
    H = [[ZERO] * len(slopes) for _ in slopes]
    for first in range(0, len(slopes), WIDTH):
        columns, top = range(first, min(first + WIDTH, len(slopes))), joints[first]
        changes = along(kinematics.g, slopes[top:], [directions[k] for k in columns])
        for i, change in enumerate(changes, top):
            for k, edge in zip(columns, change, strict=True):
                if joints[i] >= joints[k]:
                    H[i][k] = edge
                if joints[i] > joints[k]:
                    H[k][i] = edge
    ends = dict(zip(by, _ends([len(gradient[group]) for group in by]), strict=True))
    return {(a, b): [row[slice(*ends[b])] for row in H[slice(*ends[a])]] for a in by for b in by}


def _directions(kinematics: TreeKinematics, group: str, count: int) -> Sequence[Mapping[Edge, Edge]]:
    """Rates of inputs as each entry of a group moves."""
    if group == "q":
        return rates_per_speed(kinematics)
    return [{kinematics.g.input(group, k): ONE} for k in range(count)]


def commuting(kinematics: TreeKinematics, count: int) -> list[int]:
    """Index of each derivative; those along motions of one joint that do not commute (eq. 12) share the first's."""
    first = list(range(count))
    for link in kinematics.tree.links:
        start, size = link.v
        if link.joint.traits.quasi_velocities and not link.joint.prescribed:
            first[start : start + size] = [start] * size
    return first


def _ends(sizes: Sequence[int]) -> list[tuple[int, int]]:
    """Begin and end of each part of a whole."""
    return [(sum(sizes[:i]), sum(sizes[: i + 1])) for i in range(len(sizes))]


def stacked(blocks: Mapping[tuple[str, str], Matrix], rows: Sequence[str], columns: Sequence[str]) -> Matrix:
    """Blocks side by side and one above the other."""
    return [
        [edge for b in columns for edge in blocks[a, b][i]] for a in rows for i in range(len(blocks[a, columns[0]]))
    ]
