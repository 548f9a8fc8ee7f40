"""Units of coordinates, for people."""

from __future__ import annotations

from symofros.mechanics.beams.deformation import deformation_of
from symofros.mechanics.topology.tree import SpanningTree


def coordinate_units(tree: SpanningTree) -> dict[str, str]:
    """Unit of each coordinate, where it is known: of a general joint it is not; a quaternion's parts have none."""
    unit_of: dict[str, str] = {}
    for link in tree.links:
        start, size = link.q
        names = tree.coordinates.q[start : start + size]
        if link.tip_of is not None:
            is_rod = link.tip_of.theory == "strain"
            lengths = (False,) * link.tip_of.modes if is_rod else deformation_of(link.tip_of).lengths
            units = ["m" if length else "rad" for length in lengths]
        elif link.joint.traits.user_defined:
            units = [""] * size
        else:
            units = [coordinate.unit for coordinate in link.joint.traits.coordinates]
        unit_of |= dict(zip(names, units, strict=False))  # A prescribed joint has none among q.
    return unit_of
