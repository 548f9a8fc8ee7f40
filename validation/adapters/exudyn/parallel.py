"""Rods of geometrically exact elements in Exudyn: a parallel robot of two, one alone, one that flies.

Both rods lie along x at first. The tip of the first bears a rigid platform, on which the tip of the second is hinged by
a ball; both rods are straight then, and nothing is strained. Elements have two nodes, and everything that errs in them
falls with the square of their length, as the generalised-alpha method does with the square of its step: `extrapolated`
removes both at once by halving them together.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import exudyn
import numpy as np
from exudyn import itemInterface as items

from ...mechanics.geometry import Array
from .ancf import exact_beam, motion_at, motion_of_node
from .system import new_system

# Absolute tolerance of Newton's method.
_TOLERANCE = 1e-9


class Robot(NamedTuple):
    """Two equal rods of unit length and their platform.

    Attributes:
        stiffness: EA, GA_y, GA_z, GJ, EI_y, EI_z.
        inertia: rhoA, rhoJ, rhoI_y, rhoI_z.
        foot: The second rod's root (3), where the first's is the origin.
        mass: Of the platform, at the first tip.
        moment: Its moment of inertia about every axis.
        push: Largest force on the first tip, in the world (3).
        turn: Angle about x of the axes that stiffness and inertia are along [rad].
        center: The sections' centres (y, z), where the first tip is pushed on the axis.
        duration: The force grows from nothing and falls to it again: push sin^2(pi t/duration) up to the duration.
    """

    stiffness: tuple[float, float, float, float, float, float] = (200.0, 120.0, 100.0, 0.8, 1.0, 1.5)
    inertia: tuple[float, float, float, float] = (1.0, 0.02, 0.008, 0.012)
    foot: tuple[float, float, float] = (0.0, 0.3, 0.1)
    mass: float = 0.5
    moment: float = 0.02
    push: tuple[float, float, float] = (-1.0, 4.0, 3.0)
    duration: float = 1.0
    turn: float = 0.0
    center: tuple[float, float] = (0.0, 0.0)

    def share(self, t: float) -> float:
        """Share of the push at an instant."""
        return float(np.sin(np.pi * min(t, self.duration) / self.duration) ** 2)


def motion(robot: Robot, elements: int, step: float, end: float) -> tuple[Array, Array]:
    """The platform, pushed from rest.

    Args:
        robot: The robot.
        elements: ObjectBeamGeometricallyExact in each rod.
        step: Step of the generalised-alpha method [s].
        end: End time [s].

    Returns:
        Times (n,) [s] and displacement of the first tip (n, 3) [m].

    Raises:
        RuntimeError: Exudyn's solver gave up.
    """
    container, system = new_system()
    first, second = (_rod(system, robot, root, elements) for root in ((0.0, 0.0, 0.0), robot.foot))
    moments = [robot.moment] * 3 + [0.0] * 3
    platform = system.AddObject(items.ObjectRigidBody(mass=robot.mass, inertia=moments, nodeNumber=first))
    seat = system.AddMarker(items.MarkerBodyPosition(bodyNumber=platform, localPosition=list(robot.foot)))
    ball = system.AddMarker(items.MarkerNodePosition(nodeNumber=second))
    system.AddObject(items.SphericalJoint(markerNumbers=[seat, ball]))
    return _pushed(system, first, robot, step, end)


def cantilever(robot: Robot, elements: int, step: float, end: float) -> tuple[Array, Array]:
    """The first rod alone, without platform, pushed from rest; arguments and what is returned as of `motion`."""
    container, system = new_system()
    return _pushed(system, _rod(system, robot, (0.0, 0.0, 0.0), elements), robot, step, end)


def flying(robot: Robot, elements: int, step: float, end: float) -> tuple[Array, Array]:
    """The first rod alone, held nowhere, pushed at its tip from rest; arguments and what is returned as of `motion`."""
    container, system = new_system()
    return _pushed(system, _elements(system, robot, (0.0, 0.0, 0.0), elements)[-1], robot, step, end)


def extrapolated(
    robot: Robot,
    elements: int,
    step: float,
    end: float,
    moved: Callable[[Robot, int, float, float], tuple[Array, Array]] = motion,
) -> tuple[Array, Array]:
    """A motion without errors of second order, from `elements` and `step`, and from twice and half of them."""
    t, coarse = moved(robot, elements, step, end)
    _, fine = moved(robot, 2 * elements, step / 2, end)
    return t, (4.0 * fine[::2] - coarse) / 3.0


def _pushed(system: Any, node: Any, robot: Robot, step: float, end: float) -> tuple[Array, Array]:
    """Displacement of a node that is pushed, or of the place beside it that is."""
    push = np.array(robot.push)

    def force(_: Any, t: float, __: Any) -> list[float]:
        return list(robot.share(t) * push)

    if robot.center == (0.0, 0.0):
        _push(system, system.AddMarker(items.MarkerNodePosition(nodeNumber=node)), force)
        return motion_of_node(system, node, "Displacement", _TOLERANCE, end, step)
    (y, z), c, s = robot.center, np.cos(robot.turn), np.sin(robot.turn)
    place = [0.0, -c * y - s * z, s * y - c * z]  # The axis, along the axes of the node.
    arm = system.AddObject(items.ObjectRigidBody(mass=0.0, inertia=[0.0] * 6, nodeNumber=node))
    _push(system, system.AddMarker(items.MarkerBodyPosition(bodyNumber=arm, localPosition=place)), force)
    quantity = exudyn.OutputVariableType.Displacement
    sensor = items.SensorBody(bodyNumber=arm, localPosition=place, storeInternal=True, outputVariableType=quantity)
    return motion_at(system, system.AddSensor(sensor), _TOLERANCE, end, step)


def _rod(system: Any, robot: Robot, root: tuple[float, float, float], elements: int) -> Any:
    """Add a rod along x, held at its root; its last node."""
    nodes = _elements(system, robot, root, elements)
    (x, y, z), (c_y, c_z), c, s = root, robot.center, np.cos(robot.turn), np.sin(robot.turn)
    R = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    ground = system.AddObject(items.ObjectGround(referencePosition=[x, y + c_y, z + c_z], referenceRotation=R))
    held = [
        system.AddMarker(items.MarkerBodyRigid(bodyNumber=ground)),
        system.AddMarker(items.MarkerNodeRigid(nodeNumber=nodes[0])),
    ]
    system.AddObject(items.GenericJoint(markerNumbers=held))
    return nodes[-1]


def _elements(system: Any, robot: Robot, root: tuple[float, float, float], elements: int) -> list[Any]:
    """Add a rod along x; its nodes."""
    rhoA, rhoJ, rhoI_y, rhoI_z = robot.inertia
    section: Any = exudyn.BeamSection()
    section.massPerLength = rhoA
    section.inertia = np.diag([rhoJ, rhoI_y, rhoI_z])
    section.stiffnessMatrix = np.diag(robot.stiffness)
    h, (x, y, z), (c_y, c_z) = 1.0 / elements, root, robot.center
    turned = np.cos(robot.turn / 2), np.sin(robot.turn / 2), 0.0, 0.0
    return exact_beam(system, [[x + h * k, y + c_y, z + c_z, *turned] for k in range(elements + 1)], h, section)


def _push(system: Any, marker: Any, force: Callable[[Any, float, Any], list[float]]) -> None:
    system.AddLoad(items.LoadForceVector(markerNumber=marker, loadVectorUserFunction=force))
