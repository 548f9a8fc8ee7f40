"""Exudyn through time, with its own implicit solvers: planar bars joined by hinges."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import exudyn
import exudyn.itemInterface as items
import numpy as np

from ...mechanics.geometry import Array
from .system import new_system, silent_settings, weigh

Link = tuple[tuple[float, float], float, float]


def bars(
    links: Sequence[Link],
    hinges: Sequence[tuple[int, float, int, float]],
    grounded: Sequence[int],
    h: float,
    t_end: float,
    spectral_radius: float,
) -> Array | None:
    """Uniform bars of 1 m and 1 kg under gravity: positions of the ends of the bars at the end of the run.

    Args:
        links: (position of the start, angle, angular speed) of each.
        hinges: (bar, station, bar, station) that are joined; stations from 0 (start) to 1 (end).
        grounded: Bars whose start is a hinge on the ground.
        h: Step [s].
        t_end: Duration [s].
        spectral_radius: Spectral radius of generalised-alpha; 1 conserves.

    Returns:
        (n, 2) [m], or None where the solver gave up.
    """
    container, system = new_system()
    marked = add_bars(system, links, hinges, grounded)
    system.Assemble()
    settings = silent_settings()
    settings.timeIntegration.numberOfSteps = round(t_end / h)
    settings.timeIntegration.endTime = t_end
    settings.timeIntegration.generalizedAlpha.spectralRadius = spectral_radius
    # On positions: on speeds alone the row of four-bars drifts off, and takes up to 300 times longer.
    settings.timeIntegration.generalizedAlpha.useIndex2Constraints = False
    try:
        solved = system.SolveDynamic(settings)
    except ValueError:  # How its solver reports that Newton's method or the factorisation failed.
        return None
    del container  # Owns the system, and must outlive it.
    if solved is False:
        return None
    ends = [system.GetMarkerOutput(marked[i, 1.0], exudyn.OutputVariableType.Position) for i in range(len(links))]
    return np.array(ends)[:, :2]


def add_bars(
    system: Any, links: Sequence[Link], hinges: Sequence[tuple[int, float, int, float]], grounded: Sequence[int]
) -> dict[tuple[int, float], Any]:
    """Add the bars of `bars` to a system; the markers of their ends by (bar, station)."""
    ground = system.AddObject(items.ObjectGround())
    marked: dict[tuple[int, float], Any] = {}
    nodes = []
    for (x, z), angle, speed in links:
        half = np.array([np.cos(angle), np.sin(angle)]) / 2
        nodes.append(
            system.AddNode(
                items.Rigid2D(
                    referenceCoordinates=[x + half[0], z + half[1], angle],
                    initialVelocities=[*_velocity((x, z), half, angle, speed, links), speed],
                )
            )
        )
        body = system.AddObject(items.RigidBody2D(mass=1.0, inertia=1 / 12, nodeNumber=nodes[-1]))
        for station in (0.0, 1.0):
            marked[len(nodes) - 1, station] = system.AddMarker(
                items.MarkerBodyRigid(bodyNumber=body, localPosition=[station - 0.5, 0, 0])
            )
        weigh(system, body, (0, -9.81, 0))
    for i in grounded:
        (x, z), _, _ = links[i]
        pivot = system.AddMarker(items.MarkerBodyRigid(bodyNumber=ground, localPosition=[x, z, 0]))
        system.AddObject(items.RevoluteJoint2D(markerNumbers=[pivot, marked[i, 0.0]]))
    for one, at, other, there in hinges:
        system.AddObject(items.RevoluteJoint2D(markerNumbers=[marked[one, at], marked[other, there]]))
    return marked


def _velocity(at: tuple[float, float], half: Array, angle: float, speed: float, links: Sequence[Link]) -> Array:
    """Velocity of the bar's middle; a bar that starts on another's end moves along with it."""
    own = speed * np.array([-half[1], half[0]])
    for (x, z), other, spin in links:
        end = np.array([x + np.cos(other), z + np.sin(other)])
        if spin and angle != other and np.allclose(end, at):
            return np.asarray(own + spin * np.array([-np.sin(other), np.cos(other)]))
    return own
