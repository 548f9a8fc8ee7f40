"""Rotors behind reducers: the spin of a motor as seen from the joint it drives (docs/theory/rigid.md, section 9).

The carrier's inertia contains the rotor as if it were locked; what is added here is the spin alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from symofros.description.forces import Rotor
from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.vector import Vec3
from symofros.mechanics.kinematics.links import TreeKinematics
from symofros.mechanics.spatial.rotations import unit_vector
from symofros.mechanics.topology.tree import BASE


@dataclass(frozen=True)
class MovingRotor:
    """A rotor on its carrier.

    Attributes:
        link: Index of the link whose joint drives it.
        coordinate: Index of the driving speed within that joint.
        k: Index of that speed in v; None where the motion is prescribed.
        carrier: Index of the link it spins in, or BASE.
        axis: Unit spin axis in that link's frame.
        inertia: About the axis.
        ratio: Spin per joint speed.
    """

    link: int
    coordinate: int
    k: int | None
    carrier: int
    axis: Vec3
    inertia: Edge
    ratio: Edge

    def spin(self, kinematics: TreeKinematics) -> Edge:
        """Angular speed relative to the carrier."""
        return kinematics.g.mul(self.ratio, kinematics.links[self.link].speeds[self.coordinate])

    def rate(self, kinematics: TreeKinematics, v_rate: Sequence[Edge]) -> Edge:
        """Rate of the driving speed."""
        return kinematics.links[self.link].speed_rates(v_rate)[self.coordinate]


def is_on_turning_axes(kinematics: TreeKinematics, rotor: MovingRotor) -> bool:
    """Whether a ball or free joint drives a rotor, along axes that turn with its link.

    Its spin is that speed, as it is of a rotor on an axis of its own: it counts in M, and h has no term of it that
    turns with the axes.
    """
    return rotor.k is not None and kinematics.tree.links[rotor.link].joint.traits.quasi_velocities


def rotors_of(kinematics: TreeKinematics) -> list[MovingRotor]:
    """The rotors and armatures of a tree; an armature is a rotor whose carrier is taken to rest."""
    rotors = []
    for i, link in enumerate(kinematics.tree.links):
        speeds = len(kinematics.links[i].partial_velocities)
        free = kinematics.links[i].rates is None
        armature = kinematics.lowering.value(link.joint.armature)
        if armature != ZERO:
            still = Vec3.unit(kinematics.g, 2)
            rotors += [
                MovingRotor(i, c, link.v[0] + c if free else None, BASE, still, armature, ONE) for c in range(speeds)
            ]
        for rotor in link.joint.rotors:
            carrier, axis = _bearing(kinematics, i, rotor)
            k = link.v[0] + rotor.coordinate if free else None
            inertia, ratio = kinematics.lowering.value(rotor.inertia), kinematics.lowering.value(rotor.ratio)
            rotors.append(MovingRotor(i, rotor.coordinate, k, carrier, axis, inertia, ratio))
    return rotors


def _bearing(kinematics: TreeKinematics, index: int, rotor: Rotor) -> tuple[int, Vec3]:
    """The link that bears a rotor, and the spin axis in that link's frame."""
    link = kinematics.links[index]
    if rotor.axis is None:
        # A joint's own axis is the same vector in the parent, whatever the angle.
        return link.parent, unit_vector(link.R_AL.apply(link.partial_velocities[rotor.coordinate].w))
    stated = kinematics.lowering.vector(rotor.axis)
    name = rotor.carrier or kinematics.tree.links[index].joint.parent
    body = next((frame for frame in kinematics.tree.frames if frame.qualified == name), None)
    if body is None or body.link == BASE:
        return BASE, unit_vector(stated)  # What rests has no rotation to couple with.
    R_LB, _ = kinematics.lowering.placement(body.placement, kinematics.in_link(body.link))
    return body.link, unit_vector(R_LB.times(stated))
