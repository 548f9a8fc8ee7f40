"""Units of coordinates, for people."""

from __future__ import annotations

from symofros.mechanics.beams import theory_of
from symofros.mechanics.topology import SpanningTree, joint_units


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
