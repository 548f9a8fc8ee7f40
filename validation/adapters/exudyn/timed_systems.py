"""Exudyn's systems of the benchmark problems in which speed is compared with accuracy."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface as items
from exudyn.advancedUtilities import CreateSymbolicUserFunction

import symofros as sf

from ...mechanics.assembly import BASE, anchor_name, assemble
from ...mechanics.geometry import Array
from .ancf import SlenderBeam, clamp_first, hold, node_sensor, straight_beam
from .motion import Link, add_bars
from .planar import Cable, populate
from .steps import Timed
from .system import weigh

# What its stubs state wrongly, or not at all.
_ENGINE: Any = exudyn
_HINGES = {
    (1.0, 0.0, 0.0): exudyn.JointType.RevoluteX,
    (0.0, 1.0, 0.0): exudyn.JointType.RevoluteY,
    (0.0, 0.0, 1.0): exudyn.JointType.RevoluteZ,
}
# The ground is object 0.
_FIRST_BAR = 1


def spinning(rod: SlenderBeam, elements: int) -> Timed:
    """The rod of ANCFCable2D elements on a driven hub, with the position of its tip as sensor.

    The hub's angle is one of Exudyn's symbolic functions, evaluated in its C++: a Python function in its place makes
    a run of four elements a fifth slower. Its joints with such offsets have no form of index 2.
    """

    def build(system: Any) -> Sequence[Any]:
        nodes = straight_beam(system, rod.length, rod.EI, rod.EA, rod.rhoA, elements)
        joint = clamp_first(system)
        k, share = 2.0 * math.pi / rod.duration, rod.rate / rod.duration
        symbolic = _ENGINE.symbolic

        def offset(mbs: Any, t: Any, itemNumber: Any, offsets: Any) -> list[Any]:  # noqa: N803 - Exudyn's own names.
            return [0.0, 0.0, 0.0, 0.0, 0.0, share * (t * t * 0.5 + (symbolic.cos(k * t) - 1.0) * (1.0 / k**2))]

        made = CreateSymbolicUserFunction(system, offset, "offsetUserFunction", joint)
        system.SetObjectParameter(joint, "offsetUserFunction", made)
        return [node_sensor(system, nodes[-1], "Position")]

    return Timed(build)


def swinging_rod(rod: SlenderBeam, gravity: float, damping: float, elements: int) -> Timed:
    """A rod of ANCFCable2D elements, along x at first, that swings about its root under its weight; its tip.

    Args:
        rod: The rod.
        gravity: Acceleration of gravity along -y [m/s^2].
        damping: Damping against bending over its stiffness [s].
        elements: Number of elements.
    """

    def build(system: Any) -> Sequence[Any]:
        nodes = straight_beam(system, rod.length, rod.EI, rod.EA, rod.rhoA, elements, damping * rod.EI)
        hold(system, nodes[0], (0, 1))
        for element in range(elements):
            weigh(system, element, (0.0, -gravity, 0.0))
        return [node_sensor(system, nodes[-1], "Position")]

    return Timed(build)


def _position_sensor(made: Any, body: Any, place: Any) -> Any:
    """A sensor of the position of a point that is fixed to a body, at a place in the body's frame."""
    return made.AddSensor(
        items.SensorBody(
            bodyNumber=body,
            localPosition=place,
            writeToFile=False,
            storeInternal=True,
            outputVariableType=exudyn.OutputVariableType.Position,
        )
    )


def planar(
    system: sf.System, angles: Mapping[str, float], cables: Mapping[str, Cable], place: tuple[float, float]
) -> Timed:
    """A planar tree at rest in its reference configuration, with the position of a point of its last body as sensor.

    Args:
        system: The description, of what `validation.adapters.exudyn.planar` takes.
        angles: Angles of its hinges in the reference configuration, by joint [rad].
        cables: Cable elements of its beams, by body.
        place: Place of the point in the frame of the last joint [m].
    """

    def build(made: Any) -> Sequence[Any]:
        last = populate(made, system, angles, cables)[-1].displaced(np.array(place))
        return [_position_sensor(made, last.body, last.place())]

    return Timed(build)


def pendulum(gravity: float) -> Timed:
    """A point of 1 kg at 1 m on a hinge about y, from the horizontal, in one coordinate: Exudyn's kinematic tree."""

    def build(made: Any) -> Sequence[Any]:
        links = [(-1, np.eye(3), np.zeros(3), 1.0, np.array([1.0, 0.0, 0.0]), np.zeros((3, 3)))]
        return [_kinematic_tree(made, [exudyn.JointType.RevoluteY], links, [0.0], [0, 0, -gravity])]

    return Timed(build)


def _kinematic_tree(
    made: Any,
    axes: Sequence[Any],
    links: Sequence[tuple[int, Array, Array, float, Array, Array]],
    start: Sequence[float],
    gravity: Sequence[float],
    **control: Any,
) -> Any:
    """Add a tree that is at rest at the start; the sensor of its coordinates.

    Args:
        made: The system.
        axes: Exudyn's types of its joints.
        links: Parent, R and p of the joint in it, mass, its centre and moments about that, of each link.
        start: Coordinates.
        gravity: Acceleration of gravity (3).
        control: What else the object is given.
    """
    n, (parents, R, p, masses, centres, moments) = len(axes), zip(*links, strict=True)
    given = {"referenceCoordinates": [0.0] * n, "initialCoordinates": start, "initialCoordinates_t": [0.0] * n}
    node = made.AddNode(items.NodeGenericODE2(**given, numberOfODE2Coordinates=n))
    made.AddObject(
        items.ObjectKinematicTree(
            nodeNumber=node,
            jointTypes=axes,
            linkParents=list(parents),
            jointTransformations=_ENGINE.Matrix3DList(list(R)),
            jointOffsets=_ENGINE.Vector3DList(list(p)),
            linkInertiasCOM=_ENGINE.Matrix3DList(list(moments)),
            linkCOMs=_ENGINE.Vector3DList(list(centres)),
            linkMasses=list(masses),
            baseOffset=[0, 0, 0],
            gravity=gravity,
            **control,
        )
    )
    return node_sensor(made, node, "Coordinates")


def bars(links: Sequence[Link], hinges: Sequence[tuple[int, float, int, float]], grounded: Sequence[int]) -> Timed:
    """Bars joined by hinges, as in `validation.adapters.exudyn.motion`, with the first bar's end as sensor."""

    def build(made: Any) -> Sequence[Any]:
        add_bars(made, links, hinges, grounded)
        return [_position_sensor(made, _FIRST_BAR, [0.5, 0, 0])]

    return Timed(build)


def looped(system: sf.System, angles: Mapping[str, float], torque: float) -> Timed:
    """A planar mechanism of rigid bodies at rest, its loops closed by hinges; the angles of its hinges as sensors.

    Args:
        system: Hinges about z, closures of two translations, springs between frames.
        angles: Angles of the hinges, with which its loops are closed [rad].
        torque: Torque on the first body, about z [N m].
    """
    assembly = assemble(system)
    numbers = system.parameter_values()
    closures = [constraint for constraint in system.constraints if isinstance(constraint, sf.Closure)]

    def build(made: Any) -> Sequence[Any]:
        carriers = populate(made, system, angles, {})
        ground = made.AddObject(items.ObjectGround())

        def marker(anchor: Any) -> Any:
            site = assembly.frames[anchor_name(assembly, anchor)]
            if site.mover == BASE:
                return made.AddMarker(items.MarkerBodyPosition(bodyNumber=ground, localPosition=list(site.X_BF.p)))
            at = carriers[site.mover].displaced(site.X_BF.p[:2])
            return made.AddMarker(items.MarkerBodyPosition(bodyNumber=at.body, localPosition=at.place()))

        for closure in closures:
            made.AddObject(items.RevoluteJoint2D(markerNumbers=[marker(closure.first), marker(closure.second)]))
        for spring in system.springs:
            made.AddObject(
                items.SpringDamper(
                    markerNumbers=[marker(spring.first), marker(spring.second)],
                    stiffness=float(sf.evaluate(spring.stiffness, numbers)),
                    damping=0.0,
                    referenceLength=float(sf.evaluate(spring.length, numbers)),
                )
            )
        driven = made.AddMarker(items.MarkerBodyRigid(bodyNumber=carriers[0].body))
        made.AddLoad(items.LoadTorqueVector(markerNumber=driven, loadVector=[0.0, 0.0, torque]))
        sensors = [node_sensor(made, carrier.node, "Coordinates") for carrier in carriers]
        return sensors

    return Timed(build)


def joint_angles(system: sf.System, angles: Mapping[str, float], values: Array) -> Array:
    """The sensors' values of `looped` (n, 3 k) -> angles of the hinges (n, k) [rad]."""
    turned = values[:, 2::3]
    movers = assemble(system).movers
    start = np.array([angles[mover.joint.name] for mover in movers])
    base = np.zeros((len(values), 1))
    parents = np.hstack([turned, base])[:, [mover.parent if mover.parent != BASE else -1 for mover in movers]]
    return np.asarray(start + turned - parents)


def held(system: sf.System, start: Array, targets: Array, stiffness: float, damping: float) -> Timed:
    """A tree of hinges as Exudyn's kinematic tree, which has no constraints; its joints' angles as sensor.

    Args:
        system: Hinges about x, y or z of their frames.
        start: Angles at the start, at rest (n) [rad].
        targets: Angles at which the springs on the joints rest (n) [rad].
        stiffness: Stiffness of each [N m/rad].
        damping: Damping of each [N m s/rad].
    """
    assembly = assemble(system)
    n = len(assembly.movers)
    masses = [(mover, mover.merged()) for mover in assembly.movers]
    links = [(one.parent, one.X_AP.R, one.X_AP.p, mass.mass, mass.p_BC, mass.J_BC) for one, mass in masses]
    axes = [_HINGES[tuple(np.round(mover.axis, 12).tolist())] for mover in assembly.movers]

    def build(made: Any) -> Sequence[Any]:
        control = {
            "jointPControlVector": [stiffness] * n,
            "jointDControlVector": [damping] * n,
            "jointPositionOffsetVector": targets.tolist(),
            "jointVelocityOffsetVector": [0.0] * n,
        }
        return [_kinematic_tree(made, axes, links, start.tolist(), assembly.gravity.tolist(), **control)]

    return Timed(build)


def between_walls(stiffness: float, gap: float, speed: float) -> Timed:
    """A mass of 1 kg on one coordinate between springs at a distance on either side, that begins in the middle [SI].

    The springs are one of Exudyn's symbolic functions, evaluated in its C++: its stops change once a step.
    """

    def build(system: Any) -> Sequence[Any]:
        ground = system.AddNode(items.NodePointGround())
        node = system.AddNode(items.Node1D(referenceCoordinates=[0.0], initialVelocities=[speed]))
        system.AddObject(items.Mass1D(mass=1.0, nodeNumber=node))
        markers = [
            system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=number, coordinate=0)) for number in (ground, node)
        ]
        larger = _ENGINE.symbolic.max

        def push(mbs: Any, t: Any, item: Any, u: Any, v: Any, k: Any, d: Any, offset: Any) -> Any:
            return k * (larger(u - gap, 0.0) - larger(-gap - u, 0.0))

        spring = items.CoordinateSpringDamper(markerNumbers=markers, stiffness=stiffness)
        made = CreateSymbolicUserFunction(system, push, "springForceUserFunction", number := system.AddObject(spring))
        system.SetObjectParameter(number, "springForceUserFunction", made)
        return [node_sensor(system, node, "Coordinates")]

    return Timed(build)
