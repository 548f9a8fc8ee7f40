"""Exudyn's nonlinear beams as references for the accuracy of ours (github.com/jgerstm/EXUDYN).

Absolute nodal coordinates (ANCFCable2D, ANCFCable) are geometrically exact in bending and stretch at any deflection,
without shear, twist and rotary inertia; their cubic elements converge fast. The strip of the Princeton experiment
twists, which they can't, and is made of geometrically exact elements with two nodes, which shear and converge with the
square of the element's length.

All of them stretch, and ours does not. With EA as a multiple of EI/L^2 the stretch is one over that multiple, but a
larger multiple is not better: it locks coarse meshes (at 1e7 more than twice the elements are needed that do at 1e5),
and forces round off at EA times 1e-16. Each function therefore asks Newton's method for what rounding leaves, not for
Exudyn's default of 1e-10 N: below the floor Exudyn bisects steps in silence, a thousand times slower.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import exudyn
import numpy as np
from exudyn import itemInterface as items

from ...mechanics.geometry import Array
from .system import assembled, new_system, silent_settings, weigh

# Of forces, as a multiple of the axial stiffness that makes them round off.
_ROUNDING = 1e-13
_METHOD = exudyn.DynamicSolverType.GeneralizedAlpha


class SlenderBeam(NamedTuple):
    """A cantilever on the axis of a hub that spins up, by default that of Kane, Ryan & Banerjee (1987).

    Attributes:
        length: Length [m].
        EI: Bending stiffness [N m^2].
        EA: Axial stiffness [N], where it is the beam's own.
        rhoA: Mass per length [kg/m].
        duration: Duration of the spin-up [s].
        rate: Rate at its end [rad/s].
    """

    length: float = 8.0
    EI: float = 566.7095928
    EA: float = math.nan
    rhoA: float = 0.20187837656
    duration: float = 15.0
    rate: float = 6.0

    def angle(self, t: Array | float) -> Array:
        """The hub's angle at times: its second rate is rate/duration (1 - cos(2 pi t/duration)) up to the duration."""
        k = 2.0 * np.pi / self.duration
        before = self.rate / self.duration * (np.square(t) / 2.0 + (np.cos(k * t) - 1.0) / k**2)
        return np.where(t >= self.duration, self.rate * (t - self.duration / 2.0), before)


class Strip(NamedTuple):
    """The aluminium strip of the Princeton beam experiment (Dowell & Traybar 1975; Bauchau et al. 2016).

    Attributes:
        length: Length [m].
        height: Height of the section, along y [m].
        thickness: Along z [m].
        E: Elastic modulus [Pa].
        G: Shear modulus [Pa].
    """

    length: float = 0.508
    height: float = 12.377e-3
    thickness: float = 3.2024e-3
    E: float = 71.7e9
    G: float = 71.7e9 / 2.62

    @property
    def EA(self) -> float:
        """Axial stiffness [N]."""
        return self.E * self.height * self.thickness

    @property
    def EI_z(self) -> float:
        """Stiffness against bending along y, the stiff way [N m^2]."""
        return self.E * self.thickness * self.height**3 / 12.0

    @property
    def EI_y(self) -> float:
        """Stiffness against bending along z, the soft way [N m^2]."""
        return self.E * self.height * self.thickness**3 / 12.0

    @property
    def GJ(self) -> float:
        """Stiffness against twist of a thin rectangle, with the first correction for its ends [N m^2]."""
        return self.G * self.height * self.thickness**3 / 3.0 * (1.0 - 0.630 * self.thickness / self.height)

    @property
    def GA(self) -> float:
        """Shear stiffness, 5/6 of the section's [N]."""
        return 5.0 / 6.0 * self.G * self.height * self.thickness


def node_sensor(system: Any, node: int, quantity: str) -> int:
    """A sensor that keeps a node's quantity over time in memory.

    Args:
        system: System of Exudyn's.
        node: Number of the node.
        quantity: Name in Exudyn's OutputVariableType: "Position", "Coordinates".

    Returns:
        Number of the sensor.
    """
    output = getattr(exudyn.OutputVariableType, quantity)
    sensor = items.SensorNode(nodeNumber=node, writeToFile=False, storeInternal=True, outputVariableType=output)
    return int(system.AddSensor(sensor))


def motion_of_node(
    system: Any, node: int, quantity: str, tolerance: float, end: float, step: float
) -> tuple[Array, Array]:
    """Times (n,) and a vector (n, 3) of a node of a system that moves from its start, by the generalised-alpha method.

    Args:
        system: System of Exudyn's, yet to be assembled.
        node: Number of the node.
        quantity: Name in Exudyn's OutputVariableType, of a vector.
        tolerance: Absolute tolerance of Newton's method.
        end: End time [s].
        step: Step [s].

    Raises:
        RuntimeError: Exudyn did not finish.
    """
    return motion_at(system, node_sensor(system, node, quantity), tolerance, end, step)


def motion_at(system: Any, sensor: int, tolerance: float, end: float, step: float) -> tuple[Array, Array]:
    """The same of a sensor; arguments and what is returned as of `motion_of_node`."""
    system.Assemble()
    settings = silent_settings()
    settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = round(end / step), end
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    settings.timeIntegration.newton.useModifiedNewton = True
    settings.timeIntegration.newton.absoluteTolerance = tolerance
    settings.solution.sensors.writePeriod = step
    if not system.SolveDynamic(settings, solverType=_METHOD):
        raise RuntimeError(f"Exudyn did not finish the motion with steps of {step} s")
    recorded = np.array(system.GetSensorStoredData(sensor))
    return recorded[:, 0], recorded[:, 1:4]


def static_tip(length: float, EI: float, EA: float, force: tuple[float, float], elements: int = 16) -> Array:
    """Position of the tip (2,) of a cantilever along x at rest under a dead load on its tip.

    Args:
        length: Length [m].
        EI: Bending stiffness [N m^2].
        EA: Axial stiffness [N].
        force: Along x and y [N].
        elements: ANCFCable2D.

    Raises:
        RuntimeError: Exudyn's solver gave up.
    """
    container, system = new_system()
    nodes = straight_beam(system, length, EI, EA, 1.0, elements)
    hold(system, nodes[0], (0, 1, 3))  # Not the slope along x: it stretches.
    marker = system.AddMarker(items.MarkerNodePosition(nodeNumber=nodes[-1]))
    system.AddLoad(items.Force(markerNumber=marker, loadVector=[*force, 0.0]))
    _solve_static(system, EA)
    return _position(system, nodes[-1])[:2]


def spinning_frequencies(
    EI: float, EA: float, rate: float, hub: float = 0.0, elements: int = 16, count: int = 3
) -> tuple[Array, Array]:
    """Circular frequencies of a spinning cantilever of unit length and mass per length, out of plane and in plane.

    The steady state is found by Newton's method; vibrations about it, seen from the hub, obey
    M x'' + 2 W M Z x' + (K - W^2 M P) x = 0 with Exudyn's M and tangent K, Z the quarter turn about the axis and P the
    projection to the plane. In the plane the gyroscopic term couples bending with stretching, and stretch lowers the
    first frequency by 1.4e-4 at rate^2 = 144 EI and EA = 1e6 EI, in proportion to 1/EA.

    Args:
        EI: Bending stiffness [N m^2].
        EA: Axial stiffness [N].
        rate: W, about z [rad/s].
        hub: Radius at the root [m].
        elements: ANCFCable.
        count: Number of frequencies.

    Returns:
        Flap and chord (count,) [rad/s].
    """
    container, system = new_system()
    h = 1.0 / elements
    reference = np.array([[hub + h * k, 0, 0, 1, 0, 0] for k in range(elements + 1)])
    nodes = [system.AddNode(items.NodePointSlope1(referenceCoordinates=list(row))) for row in reference]
    for ends in zip(nodes, nodes[1:], strict=False):
        system.AddObject(
            items.ObjectANCFCable(
                length=h, massPerLength=1.0, bendingStiffness=EI, axialStiffness=EA, nodeNumbers=list(ends)
            )
        )
    evaluated, total = assembled(container, system), reference.ravel()
    free = np.append(3, np.arange(6, total.size))  # At the root only the slope along x, which stretches.
    in_plane = np.tile([True, True, False], total.size // 3)
    q, still = np.zeros(total.size), np.zeros(total.size)
    M, _ = evaluated.at(q, still)
    softening = rate**2 * M * in_plane
    for _ in range(10):
        unbalanced = evaluated.at(q, still)[1] + softening @ (total + q)
        K = evaluated.stiffness(q) - softening
        q[free] += np.linalg.solve(K[np.ix_(free, free)], unbalanced[free])
    K = evaluated.stiffness(q) - softening
    turned = np.kron(np.eye(total.size // 3), [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    flap, plane = (np.ix_(free[chosen], free[chosen]) for chosen in (~in_plane[free], in_plane[free]))
    squares = 1.0 / _falling(M[flap], K[flap])
    chord = _gyroscopic(M[plane], 2.0 * rate * (M @ turned)[plane], K[plane])
    return np.sqrt(squares[:count]), chord[:count]


def spin_up(elements: int = 16, step: float = 2.5e-3, end: float = 20.0, stretch: float = 1e6) -> tuple[Array, Array]:
    """The tip of Kane, Ryan & Banerjee's beam, seen from the hub.

    Args:
        elements: ANCFCable2D.
        step: Step of the generalised-alpha method; the end of the spin-up must be a multiple, or its order drops to 1
            [s].
        end: End time [s].
        stretch: EA as a multiple of EI/L^2.

    Returns:
        Times (n,) [s] and displacement along and across the undeformed beam (n, 2) [m].

    Raises:
        RuntimeError: Exudyn's solver gave up.
    """
    hub = SlenderBeam()
    EA = stretch * hub.EI / hub.length**2
    container, system = new_system()
    nodes = straight_beam(system, hub.length, hub.EI, EA, hub.rhoA, elements)
    clamp_first(
        system, offsetUserFunction=lambda mbs, t, number, offsets: [0.0, 0.0, 0.0, 0.0, 0.0, float(hub.angle(t))]
    )
    try:
        t, tip = motion_of_node(system, nodes[-1], "Position", _ROUNDING * EA, end, step)
    except RuntimeError as error:
        raise RuntimeError(f"no spin-up with {elements} elements and steps of {step} s: {error}") from None
    x, y, _ = tip.T
    angle = hub.angle(t)
    along, across = np.cos(angle) * x + np.sin(angle) * y, np.cos(angle) * y - np.sin(angle) * x
    return t, np.stack([along - hub.length, across], axis=-1)


def swing(force: float, weight: float, end: float, elements: int = 12, step: float = 2e-3) -> tuple[Array, Array]:
    """The tip of a cantilever along x of unit length, stiffness and mass a length, under sudden loads along y.

    Args:
        force: Dead load on the tip.
        weight: Load a length.
        end: End time [s].
        elements: ANCFCable2D.
        step: Step of the generalised-alpha method [s].

    Returns:
        Times (n,) [s] and displacement of the tip (n, 2) [m].

    Raises:
        RuntimeError: Exudyn's solver gave up.
    """
    EA = 1e5
    container, system = new_system()
    nodes = straight_beam(system, 1.0, 1.0, EA, 1.0, elements)
    hold(system, nodes[0], (0, 1, 3))
    marker = system.AddMarker(items.MarkerNodePosition(nodeNumber=nodes[-1]))
    system.AddLoad(items.Force(markerNumber=marker, loadVector=[0.0, force, 0.0]))
    for element in range(elements):
        weigh(system, element, (0.0, weight, 0.0))
    t, tip = motion_of_node(system, nodes[-1], "Position", _ROUNDING * EA, end, step)
    return t, tip[:, :2] - (1.0, 0.0)


def princeton(load: float, angle: float, elements: int = 32, strip: Strip | None = None) -> tuple[Array, Array]:
    """The tip of the Princeton strip, along x, at rest under a dead load across it.

    Args:
        load: Load [N].
        angle: Angle of the load from y, the stiff direction, towards z, the soft one [rad].
        elements: ObjectBeamGeometricallyExact.
        strip: Another strip.

    Returns:
        Displacement of the tip (3,) [m] and the turn of its section (3, 3).

    Raises:
        RuntimeError: Exudyn's solver gave up.
    """
    strip = strip or Strip()
    container, system = new_system()
    h = strip.length / elements
    section = exudyn.BeamSection()
    section.stiffnessMatrix = np.diag([strip.EA, strip.GA, strip.GA, strip.GJ, strip.EI_y, strip.EI_z])
    nodes = exact_beam(system, [[h * k, 0, 0, 1, 0, 0, 0] for k in range(elements + 1)], h, section)
    # Three of the four Euler parameters: their norm holds the fourth.
    hold(system, nodes[0], (0, 1, 2, 4, 5, 6))
    marker = system.AddMarker(items.MarkerNodeRigid(nodeNumber=nodes[-1]))
    force = [0.0, load * float(np.cos(angle)), load * float(np.sin(angle))]
    system.AddLoad(items.Force(markerNumber=marker, loadVector=force))
    _solve_static(system, strip.EA)
    turn = np.array(system.GetNodeOutput(nodes[-1], exudyn.OutputVariableType.RotationMatrix)).reshape(3, 3)
    return _position(system, nodes[-1]) - (strip.length, 0.0, 0.0), turn


def clamp_first(system: Any, **given: Any) -> Any:
    """Add the joint that holds the beginning of body 0, of a planar beam, on the ground."""
    ground = system.AddMarker(items.MarkerBodyRigid(bodyNumber=system.AddObject(items.ObjectGround())))
    root = system.AddMarker(items.MarkerBodyRigid(bodyNumber=0))
    return system.AddObject(
        items.GenericJoint(markerNumbers=[ground, root], constrainedAxes=[1, 1, 0, 0, 0, 1], **given)
    )


def exact_beam(system: Any, references: Sequence[Sequence[float]], h: float, section: Any) -> list[Any]:
    """Add geometrically exact elements of length h between rigid nodes at reference coordinates; the nodes."""
    nodes = [system.AddNode(items.NodeRigidBodyEP(referenceCoordinates=list(one))) for one in references]
    for ends in zip(nodes, nodes[1:], strict=False):
        system.AddObject(items.ObjectBeamGeometricallyExact(nodeNumbers=list(ends), length=h, sectionData=section))
    return nodes


def straight_beam(
    system: Any, length: float, EI: float, EA: float, rhoA: float, elements: int, damping: float = 0.0
) -> list[Any]:
    """Add a straight beam of equal elements along x, made of ANCFCable2D, to an Exudyn system; its nodes.

    Damping is that against bending [N m^2 s].
    """
    h = length / elements
    nodes = [
        system.AddNode(items.NodePoint2DSlope1(referenceCoordinates=[h * k, 0, 1, 0])) for k in range(elements + 1)
    ]
    for ends in zip(nodes, nodes[1:], strict=False):
        system.AddObject(
            items.ObjectANCFCable2D(
                length=h,
                massPerLength=rhoA,
                bendingStiffness=EI,
                axialStiffness=EA,
                bendingDamping=damping,
                nodeNumbers=list(ends),
            )
        )
    return nodes


def hold(system: Any, node: Any, coordinates: Sequence[int]) -> None:
    """Hold coordinates of a node."""
    ground = system.AddNode(items.NodePointGround())
    fixed = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
    for coordinate in coordinates:
        marker = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
        system.AddObject(items.CoordinateConstraint(markerNumbers=[fixed, marker]))


def _solve_static(system: Any, EA: float) -> None:
    system.Assemble()
    settings = silent_settings()
    settings.staticSolver.numberOfLoadSteps = 10
    settings.staticSolver.newton.absoluteTolerance = _ROUNDING * EA
    if not system.SolveStatic(settings):
        raise RuntimeError("Exudyn found no state of rest")


def _position(system: Any, node: Any) -> Array:
    return np.array(system.GetNodeOutput(node, exudyn.OutputVariableType.Position))


def _gyroscopic(M: Array, G: Array, K: Array) -> Array:
    """Frequencies of M x'' + G x' + K x = 0 (n,), rising: those of (x, w x) are the inverses of a definite pair's."""
    none = np.zeros_like(M)
    A, B = np.block([[K, none], [none, M]]), np.block([[-1j * G, M], [M, none]])
    return 1.0 / _falling(B, A)[: len(M)]


def _falling(B: Array, A: Array) -> Array:
    """Eigenvalues of B x = mu A x with A positive definite; the largest are right to rounding."""
    inverse = np.linalg.inv(np.linalg.cholesky(A))
    return np.asarray(np.linalg.eigvalsh(inverse @ B @ inverse.conj().T))[::-1]
