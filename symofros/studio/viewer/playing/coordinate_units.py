"""Units of coordinates, for people."""

from __future__ import annotations

from symofros.mechanics.beams import deformation_of, strains_of
from symofros.mechanics.topology import SpanningTree, joint_units


def coordinate_units(tree: SpanningTree) -> dict[str, str]:
    """Unit of each coordinate, where it is known: of a general joint it is not; a quaternion's parts have none."""
    unit_of: dict[str, str] = {}
    for link in tree.links:
        start, size = link.q
        names = tree.coordinates.q[start : start + size]
        if link.tip_of is not None:
            if link.tip_of.theory == "strain":
                units = ["rad" if axis < 3 else "" for axis, _ in strains_of(link.tip_of).axes]
            else:
                units = ["m" if length else "rad" for length in deformation_of(link.tip_of).lengths]
        else:
            units = list(joint_units(link.joint))
        unit_of |= dict(zip(names, units, strict=False))  # A prescribed joint has none among q.
    return unit_of
