"""Exudyn's general contact, penalties with friction over a speed: a block that slides on a plane and can't turn."""

from __future__ import annotations

import math
from typing import Any

import exudyn
import exudyn.itemInterface as items

# Half the length of the plane's two triangles [m].
_FAR = 1e3


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
    container: Any = exudyn.SystemContainer()
    system: Any = container.AddSystem()
    node = system.AddNode(items.NodePoint(referenceCoordinates=[0.0, 0.0, radius]))
    system.AddObject(items.ObjectMassPoint(mass=1.0, nodeNumber=node))
    middle = system.AddMarker(items.MarkerNodePosition(nodeNumber=node))
    system.AddLoad(items.LoadForceVector(markerNumber=middle, loadVector=[gravity[0], 0.0, gravity[1]]))
    ground = system.AddMarker(items.MarkerBodyRigid(bodyNumber=system.AddObject(items.ObjectGround())))
    contact = system.AddGeneralContact()
    contact.SetFrictionPairings([[friction]])
    contact.SetSearchTreeCellSize([1, 1, 1])
    # Two surfaces in series, each twice as stiff and as damped.
    own = {
        "contactStiffness": 2.0 * stiffness,
        "contactDamping": 4.0 * math.sqrt(stiffness),
        "frictionMaterialIndex": 0,
    }
    contact.AddSphereWithMarker(middle, radius=radius, **own)
    corners = [[-_FAR, -_FAR, 0], [_FAR, -_FAR, 0], [_FAR, _FAR, 0], [-_FAR, _FAR, 0]]
    contact.AddTrianglesRigidBodyBased(ground, pointList=corners, triangleList=[[0, 1, 2], [0, 2, 3]], **own)
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


def _move(system: Any, begun: float, end: float, h: float) -> None:
    """Generalised-alpha from the current state, which becomes the initial one, to a time."""
    data, initial = system.systemData, exudyn.ConfigurationType.Initial
    if begun > 0.0:
        data.SetODE2Coordinates(data.GetODE2Coordinates(), configuration=initial)
        data.SetODE2Coordinates_t(data.GetODE2Coordinates_t(), configuration=initial)
    settings: Any = exudyn.SimulationSettings()
    settings.solution.file.write, settings.solution.file.name = False, ""
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.startTime, settings.timeIntegration.endTime = begun, end
    settings.timeIntegration.numberOfSteps = round((end - begun) / h)
    system.SolveDynamic(settings)
