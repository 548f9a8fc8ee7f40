"""Finite elements of Exudyn's along one of our beams (github.com/jgerstm/EXUDYN), as functions of nodal coordinates.

Cables (ObjectANCFCable: cubic in positions and slopes) carry mass and weight. Geometrically exact elements
(ObjectBeamGeometricallyExact: a rotation at each node, inertia lumped there, curvature from relative rotations) carry
what turns, in one system, and strain, in another. Cables that bend are a further system, where a beam bends in one
plane: they have one stiffness for both planes and none against twist.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface as items

from ...mechanics.elastic import POINTS, ElasticBeam
from ...mechanics.geometry import Array
from ...mechanics.quadrature import gauss_stations
from ...mechanics.rod import StrainRod
from .system import ExudynSystem, assembled, new_system, weigh

_NO_TURN = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Mesh:
    """A beam's mesh.

    Attributes:
        x: Stations of the nodes (K,), from 0 to the beam's length [m].
        M: Mass matrix of the cables, for positions and slopes of node after node (6 K, 6 K); it is constant.
        weight: Forces of the weight on the same coordinates (6 K,).
        turning: Elements with the sections' rotary inertia; None where they have none.
        strained: Elements with the sections' stiffness.
        bent: Cables with the stiffness of the only plane that the beam bends in; None where there are two, or twist.
    """

    x: Array
    M: Array
    weight: Array
    turning: ExudynSystem | None
    strained: ExudynSystem
    bent: ExudynSystem | None


def stations(beam: ElasticBeam | StrainRod, elements: int) -> Array:
    """Nodes (K,) of so many equal elements on each interval on which shape functions are smooth."""
    ends = [np.linspace(a, b, elements + 1)[:-1] for a, b in pairwise(beam.knots)]
    return np.concatenate([*ends, [beam.length]])


def mesh(beam: ElasticBeam | StrainRod, elements: int, gravity: Array) -> Mesh:
    """Exudyn's elements of a beam.

    Args:
        beam: The beam.
        elements: Number of elements on each interval between the beam's knots.
        gravity: Acceleration of gravity in the world (3,) [m/s^2].
    """
    x = stations(beam, elements)
    cables = _cables(beam, x, 0.0 * x, gravity)
    none = np.zeros(6 * len(x))
    M, weight = cables.at(none, none)
    inertia = [_averages(beam, name, x) for name in ("rhoJ", "rhoI_y", "rhoI_z")]
    if not beam.beam.rotary_inertia:
        inertia[1:] = [0.0 * inertia[0]] * 2
    stiffness = [_averages(beam, name, x) for name in ("EA", "GA_y", "GA_z", "GJ", "EI_y", "EI_z")]
    still = [0.0 * stiffness[0]] * 6
    turning = _rotating(x, inertia, still) if np.any(inertia) else None
    planes = [stiffness[k] for k, count in ((5, beam.beam.bend_y), (4, beam.beam.bend_z)) if count]
    planar = len(planes) == 1 and sum(beam.beam.counts) == max(beam.beam.bend_y, beam.beam.bend_z)
    bent = _cables(beam, x, planes[0], np.zeros(3)) if planar else None
    return Mesh(x, M, weight, turning, _rotating(x, still[:3], stiffness), bent)


def _averages(beam: ElasticBeam | StrainRod, name: str, x: Array) -> Array:
    """Averages (K - 1,) of a property of the section over each element."""
    if not np.any(np.diff(beam.section(name, x))):
        return beam.section(name, x[:-1])
    return np.array([_average(beam, name, a, b) for a, b in pairwise(x.tolist())])


def _average(beam: ElasticBeam | StrainRod, name: str, a: float, b: float) -> float:
    inner, weights = gauss_stations((a, b), POINTS)
    return float(weights @ beam.section(name, inner) / (b - a))


def _cables(beam: ElasticBeam | StrainRod, x: Array, EI: Array, gravity: Array) -> ExudynSystem:
    container, system = new_system()
    nodes = [system.AddNode(items.NodePointSlope1(referenceCoordinates=[at, 0, 0, 1, 0, 0])) for at in x]
    for k, rhoA in enumerate(_averages(beam, "rhoA", x)):
        cable = items.ObjectANCFCable(
            length=x[k + 1] - x[k],
            massPerLength=rhoA,
            bendingStiffness=EI[k],
            axialStiffness=0.0,
            nodeNumbers=nodes[k : k + 2],
        )
        weigh(system, system.AddObject(cable), gravity)
    return assembled(container, system)


def _rotating(x: Array, inertia: Sequence[Array], stiffness: Sequence[Array]) -> ExudynSystem:
    """Geometrically exact elements with moments of inertia per length about the section's axes and six stiffnesses.

    Args:
        x: Stations of the nodes (K,) [m].
        inertia: About x, y, z, of each element.
        stiffness: Against stretch, shear along y and z, twist, bending about y and z, of each element.
    """
    container, system = new_system()
    nodes = [system.AddNode(items.NodeRigidBodyEP(referenceCoordinates=[at, 0, 0, *_NO_TURN])) for at in x]
    for k in range(len(x) - 1):
        section: Any = exudyn.BeamSection()
        section.massPerLength = 0.0
        section.inertia = np.diag([values[k] for values in inertia])
        section.stiffnessMatrix = np.diag([values[k] for values in stiffness])
        element = items.ObjectBeamGeometricallyExact(
            nodeNumbers=nodes[k : k + 2], length=x[k + 1] - x[k], sectionData=section
        )
        system.AddObject(element)
    return assembled(container, system)
