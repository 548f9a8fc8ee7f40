"""A planar tree of rigid bodies and beams in Exudyn, beams by absolute nodal coordinates (github.com/jgerstm/EXUDYN).

Bodies fixed to each other are one rigid body of three coordinates about its mass centre, which makes its mass matrix
constant; a beam is a row of ANCFCable2D elements; joints and clamps are constraints, which Exudyn keeps apart from mass
matrix and forces. The spin of a rotor behind a reducer is a constant mass matrix on the two angles that it couples:
exact in the plane.

It represents hinges about z, springs and dampers on them, rotors borne by the parent, beams of uniform section that
bend in the plane, with Voigt-Kelvin damping. It can't represent friction (Exudyn's law has states of its own); what
acts across the plane, such as the weight here, does nothing. Beams stretch, which ours do not.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from exudyn import itemInterface as items

import symofros as sf

from ...mechanics.assembly import BASE, Mass, Mover, assemble
from ...mechanics.geometry import Array

# Coordinate of a planar rigid body that is its angle.
_ANGLE = 2


class Cable(NamedTuple):
    """What a beam is made of.

    Attributes:
        elements: Number of elements, of equal length.
        EA: Axial stiffness [N].
    """

    elements: int
    EA: float


class Carrier(NamedTuple):
    """A frame on one of Exudyn's bodies.

    Attributes:
        p: Position of its origin in the world (2,) [m].
        angle: Angle of its x axis in the world [rad].
        body: Exudyn's.
        local: The origin in that body (2,) [m].
        node: Node of a rigid body; None on the ground and on beams.
    """

    p: Array
    angle: float
    body: Any
    local: Array
    node: Any = None

    def displaced(self, offset: Array, angle: float = 0.0) -> Carrier:
        """Another frame on the same body, at an offset in this one and turned."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        p = self.p + np.array([[c, -s], [s, c]]) @ offset
        return self._replace(p=p, angle=self.angle + angle, local=self.local + offset)

    def place(self) -> list[float]:
        """The origin in its body, as Exudyn takes it."""
        return [*self.local, 0.0]


def populate(mbs: Any, system: sf.System, angles: Mapping[str, float], cables: Mapping[str, Cable]) -> list[Carrier]:
    """Put a planar tree into an Exudyn system that is not assembled yet.

    Args:
        mbs: Exudyn's system.
        system: The description.
        angles: Angles of its hinges in the reference configuration, by joint; 0 where none is given [rad].
        cables: Cable elements of its beams, by body.

    Returns:
        The body that carries each mover of the description, in its order.

    Raises:
        ValueError: A joint or a beam is beyond what this builds; with the reason.
    """
    builder = _PlanarBuilder(mbs, system)
    for mover in assemble(system).movers:
        builder.add(mover, angles.get(mover.joint.name, 0.0), cables)
    return builder.frames


class _PlanarBuilder:
    def __init__(self, mbs: Any, system: sf.System) -> None:
        self.mbs, self.system = mbs, system
        self.parameters = system.parameter_values()
        self.ground = Carrier(np.zeros(2), 0.0, mbs.AddObject(items.ObjectGround()), np.zeros(2))
        self.frames: list[Carrier] = []

    def number(self, value: Any) -> float:
        return float(sf.evaluate(value, self.parameters))

    def add(self, mover: Mover, angle: float, cables: Mapping[str, Cable]) -> None:
        parent = self.ground if mover.parent == BASE else self.frames[mover.parent]
        at = parent.displaced(mover.X_AP.p[:2], angle)
        if not np.array_equal(mover.X_AP.R, np.eye(3)):
            raise ValueError(f"joint '{mover.name}': turned against its parent")
        if mover.kind == "elastic":
            tip = self._cable(mover, at, cables[mover.body])
            self.frames.append(self._rigid(mover.merged(), tip))
            self._clamp(tip, self.frames[-1])
        elif mover.kind == "revolute" and np.array_equal(mover.axis, (0.0, 0.0, 1.0)):
            self.frames.append(self._rigid(mover.merged(), at))
            markers = [self._point(frame) for frame in (at, self.frames[-1])]
            self.mbs.AddObject(items.RevoluteJoint2D(markerNumbers=markers))
            self._elements(mover.joint, parent, self.frames[-1], angle)
            self._rotors(mover.joint, parent, self.frames[-1])
        else:
            raise ValueError(f"joint '{mover.name}': not a hinge about z")

    def _rigid(self, mass: Mass, at: Carrier) -> Carrier:
        """A rigid body; its frame coincides with the one given."""
        center = at.displaced(mass.p_BC[:2])
        node = self.mbs.AddNode(items.NodeRigidBody2D(referenceCoordinates=[*center.p, at.angle]))
        body = self.mbs.AddObject(items.ObjectRigidBody2D(mass=mass.mass, inertia=mass.J_BC[2, 2], nodeNumber=node))
        return Carrier(at.p, at.angle, body, -mass.p_BC[:2], node)

    def _cable(self, mover: Mover, at: Carrier, cable: Cable) -> Carrier:
        """A beam clamped to a frame; the frame at its tip."""
        beam = self.system.body(mover.body)
        assert isinstance(beam, sf.Beam)
        h = mover.length / cable.elements
        x = np.array([np.cos(at.angle), np.sin(at.angle)])
        nodes = [
            self.mbs.AddNode(items.NodePoint2DSlope1(referenceCoordinates=[*(at.p + h * k * x), *x]))
            for k in range(cable.elements + 1)
        ]
        EI = self.number(beam.EI_z)
        bodies = [
            self.mbs.AddObject(
                items.ObjectANCFCable2D(
                    length=h,
                    massPerLength=self.number(beam.rhoA),
                    bendingStiffness=EI,
                    axialStiffness=cable.EA,
                    bendingDamping=self.number(beam.damping) * EI,
                    nodeNumbers=list(ends),
                )
            )
            for ends in zip(nodes, nodes[1:], strict=False)
        ]
        self._clamp(at, Carrier(at.p, at.angle, bodies[0], np.zeros(2)))
        return Carrier(at.p + mover.length * x, at.angle, bodies[-1], np.array([h, 0.0]))

    def _clamp(self, one: Carrier, other: Carrier) -> None:
        markers = [
            self.mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=f.body, localPosition=f.place())) for f in (one, other)
        ]
        self.mbs.AddObject(items.GenericJoint(markerNumbers=markers, constrainedAxes=[1, 1, 0, 0, 0, 1]))

    def _point(self, frame: Carrier) -> Any:
        return self.mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=frame.body, localPosition=frame.place()))

    def _angle(self, frame: Carrier) -> Any:
        node = self.mbs.AddNode(items.NodePointGround()) if frame.node is None else frame.node
        coordinate = 0 if frame.node is None else _ANGLE
        return self.mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))

    def _elements(self, joint: sf.Joint, parent: Carrier, child: Carrier, angle: float) -> None:
        stated = [e for e in joint.elements if isinstance(e, sf.Spring)]
        springs = sum(self.number(e.stiffness) for e in stated)
        moment = sum(self.number(e.stiffness) * (self.number(e.rest) - angle) for e in stated)
        dampers = sum(self.number(e.coefficient) for e in joint.elements if isinstance(e, sf.Damper))
        if springs or dampers:
            self.mbs.AddObject(
                items.CoordinateSpringDamper(
                    markerNumbers=[self._angle(parent), self._angle(child)],
                    stiffness=springs,
                    damping=dampers,
                    offset=moment / springs if springs else 0.0,  # Exudyn counts from the reference configuration.
                )
            )

    def _rotors(self, joint: sf.Joint, parent: Carrier, child: Carrier) -> None:
        """J (w_A + n (w_B - w_A))^2 / 2, less the part J w_A^2 / 2 that the parent's inertia has."""
        for rotor in joint.rotors:
            J, n = self.number(rotor.inertia), self.number(rotor.ratio)
            spin = J * np.array([[n * n - 2 * n, n - n * n], [n - n * n, n * n]])
            nodes = [frame.node for frame in (parent, child) if frame.node is not None]
            M = np.zeros((3 * len(nodes), 3 * len(nodes)))
            M[_ANGLE::3, _ANGLE::3] = spin[-len(nodes) :, -len(nodes) :]
            self.mbs.AddObject(items.ObjectGenericODE2(nodeNumbers=nodes, massMatrix=M))
