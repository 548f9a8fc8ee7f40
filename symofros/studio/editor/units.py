"""Units of coordinates, for people."""

from __future__ import annotations

from symofros.mechanics.beams.deformation import deformation_of
from symofros.mechanics.topology.coordinates import angles, joint_sizes
from symofros.mechanics.topology.tree import SpanningTree


def coordinate_units(tree: SpanningTree) -> dict[str, str]:
    """Unit of each coordinate, where it is known: of a general joint it is not; a quaternion's parts have none."""
    found: dict[str, str] = {}
    for link in tree.links:
        start, size = link.q
        names = tree.coordinates.q[start : start + size]
        if link.tip_of is not None:
            units = ["m" if length else "rad" for length in deformation_of(link.tip_of).lengths]
        elif link.joint.kind in ("general", "ball"):
            units = [""] * size
        elif link.joint.kind == "free":
            units = ["m"] * 3 + [""] * 4
        else:
            units = ["rad" if angle else "m" for angle in angles(link.joint)[: joint_sizes(link.joint)[0]]]
        found |= dict(zip(names, units, strict=False))
    return found
