"""Exudyn's general contact, penalties with friction over a speed: bodies whose balls touch a plane."""

from __future__ import annotations

import math
from typing import Any

import exudyn
import exudyn.itemInterface as items
import numpy as np
from exudyn.utilities import RigidBodyInertia

from ...mechanics.touching_body import GRAVITY, Pose, TouchingBody
from .system import new_system, silent_settings

# Half the length of the plane's two triangles [m].
_FAR = 1e3
# Penalty of a rigid contact times h^2/m: its steps do not converge when it is much stiffer.
_STIFF = 0.01


def slid(
    friction: float,
    radius: float,
    stiffness: float,
    gravity: tuple[float, float],
    h: float,
    times: tuple[float, ...],
) -> list[tuple[float, float]]:
    """Place and speed along x at some times [m, m/s], of 1 kg let go from rest on the plane z = 0.

    Friction grows over Exudyn's default zone of speeds, 1 mm/s; the contact is damped critically.

    Args:
        friction: Coefficient.
        radius: Radius of the sphere that touches [m].
        stiffness: Of the contact [N/m].
        gravity: Its parts along x and z [m/s^2].
        h: Step [s].
        times: Times, ascending [s].
    """
    container, system = new_system()
    node = system.AddNode(items.NodePoint(referenceCoordinates=[0.0, 0.0, radius]))
    system.AddObject(items.ObjectMassPoint(mass=1.0, nodeNumber=node))
    middle = system.AddMarker(items.MarkerNodePosition(nodeNumber=node))
    system.AddLoad(items.LoadForceVector(markerNumber=middle, loadVector=[gravity[0], 0.0, gravity[1]]))
    _touch(system, [middle], radius, friction, stiffness, 2.0 * math.sqrt(stiffness))
    exudyn.config.suppressWarnings = True  # A point can't turn: there is no moment to be lost.
    system.Assemble()
    exudyn.config.suppressWarnings = False
    found, begun = [], 0.0
    for time in times:
        _move(system, begun, time, h)
        data = system.systemData
        found.append((float(data.GetODE2Coordinates()[0]), float(data.GetODE2Coordinates_t()[0])))
        begun = time
    return found


def moved(body: TouchingBody, h: float) -> Pose:
    """Pose of a body of balls at the end, by steps of h: rigid ones by penalties that they just resolve."""
    container, system = new_system()
    number = system.CreateRigidBody(
        inertia=RigidBodyInertia(mass=body.mass, inertiaTensor=np.diag(body.moments)),
        referencePosition=list(body.p),
        referenceRotationMatrix=body.R,
        initialVelocity=list(body.v),
        initialAngularVelocity=list(body.w),
        gravity=[0.0, 0.0, -GRAVITY],
    )
    balls = [
        system.AddMarker(items.MarkerBodyRigid(bodyNumber=number, localPosition=list(point))) for point in body.points
    ]
    stiffness = body.stiffness or _STIFF * body.mass / h**2
    damping = 0.0 if body.stiffness else 2.0 * math.sqrt(stiffness * body.mass)
    _touch(system, balls, body.radius, body.friction, stiffness, damping)
    system.Assemble()
    _move(system, 0.0, body.end, h)
    place, turn = exudyn.OutputVariableType.Position, exudyn.OutputVariableType.RotationMatrix
    p, R = (np.array(system.GetObjectOutputBody(number, which)) for which in (place, turn))
    return Pose(p, R.reshape(3, 3))


def _touch(system: Any, balls: list[Any], radius: float, friction: float, stiffness: float, damping: float) -> None:
    """Contact of balls about markers with the plane z = 0."""
    ground = system.AddMarker(items.MarkerBodyRigid(bodyNumber=system.AddObject(items.ObjectGround())))
    contact = system.AddGeneralContact()
    contact.SetFrictionPairings([[friction]])
    contact.SetSearchTreeCellSize([1, 1, 1])
    # Two surfaces in series, each twice as stiff and as damped.
    own = {"contactStiffness": 2.0 * stiffness, "contactDamping": 2.0 * damping, "frictionMaterialIndex": 0}
    for ball in balls:
        contact.AddSphereWithMarker(ball, radius=radius, **own)
    corners = [[-_FAR, -_FAR, 0], [_FAR, -_FAR, 0], [_FAR, _FAR, 0], [-_FAR, _FAR, 0]]
    contact.AddTrianglesRigidBodyBased(ground, pointList=corners, triangleList=[[0, 1, 2], [0, 2, 3]], **own)


def _move(system: Any, begun: float, end: float, h: float) -> None:
    """Generalised-alpha from the current state, which becomes the initial one, to a time."""
    data, initial = system.systemData, exudyn.ConfigurationType.Initial
    if begun > 0.0:
        data.SetODE2Coordinates(data.GetODE2Coordinates(), configuration=initial)
        data.SetODE2Coordinates_t(data.GetODE2Coordinates_t(), configuration=initial)
    settings = silent_settings()
    settings.timeIntegration.startTime, settings.timeIntegration.endTime = begun, end
    settings.timeIntegration.numberOfSteps = round((end - begun) / h)
    system.SolveDynamic(settings)
