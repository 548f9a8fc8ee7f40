"""Exudyn's floating-frame body, ObjectFFRFreducedOrder, built from one of our beams (github.com/jgerstm/EXUDYN).

Exudyn gets a "mesh" of Gauss stations with lumped masses, and the harness' own shape functions at them as modes. Its
sums over nodes are then Gauss quadrature of our integrals, exact for the polynomials that shape functions are, and the
two models agree to rounding. What is Exudyn's own is the reduction to modal integrals, the mass matrix, the quadratic
velocity vector, and how strain and damping enter.

The weight comes from Exudyn's mass matrix, as an acceleration of the frame. Exudyn's own load, LoadMassProportional,
takes its moment about the root at the mass centre of the undeformed body: S(delta) x g is lost, so that the force on
the frame does not belong to the potential that the forces on the modes do. `build(subject, own_weight=True)` shows it.

It represents one beam on a free joint that bends in one or both planes, with tapered sections and damping, where its
displacement is linear in the modes: `foreshortening=False`, `retain="all"`. It can't represent foreshortening, other
orders, twist and rotary inertia (lumped masses have no rotations), bodies on the tip, and other joints.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import exudyn
import numpy as np
from exudyn.FEM import ObjectFFRFreducedOrderInterface

import symofros as sf

from ...contract.conventions import FREE_WXYZ, Chart, Slot
from ...contract.interface import SolvedEngine, States, Subject, Unsupported
from ...mechanics.geometry import Array
from ...mechanics.quadrature import STATION, gauss_stations
from ...mechanics.shape_functions import of_family
from .system import VERSION, ExudynSystem, assembled

NAME = "exudyn-frf"
# Gauss nodes of each piece of the shape functions: exact for products of two up to degree 15.
POINTS = 16
CAPABILITIES = frozenset(
    {"mass_matrix", "bias", "gravity", "generalized_force", "kinetic_energy", "inverse_dynamics", "forward_dynamics"}
)


@dataclass(frozen=True)
class FloatingFrameEngine(SolvedEngine):
    """Two Exudyn bodies behind the `Engine` protocol: the beam, and the same without strain energy and damping.

    Attributes:
        elastic: The beam.
        limp: The beam by its motion and weight alone, so that the difference is the elastic forces.
        chart: Their positions and quaternions against our free joint.
        gravity: Gravity as felt in the frame, its acceleration included (3,) [m/s^2].
    """

    elastic: ExudynSystem
    limp: ExudynSystem
    chart: Chart
    gravity: Array
    name: str = NAME
    capabilities: frozenset[str] = CAPABILITIES
    version: str = VERSION

    def _evaluated(self, states: States, system: ExudynSystem) -> tuple[Array, Array]:
        """M_e and h_e for speeds (linear in world axes; angular in body axes; elastic), from Euler parameters."""
        q = self.chart.coordinates(states.q)
        v = self.chart.speeds(states.q, states.v)
        reference = np.zeros(self.chart.nq)
        reference[3] = 1.0
        M_all, h_all = [], []
        for q_k, v_k in zip(q, v, strict=True):
            T = _euler_parameter_rates(q_k[3:7], self.chart.nv)
            M, force = system.at(q_k - reference, T @ v_k)
            # Where w is constant, e'' = -|w|^2/4 e: along e, where the mass matrix has nothing. Gravity remains.
            carried = np.zeros(self.chart.nq)
            carried[:3] = -self.gravity
            M_all.append(T.T @ M @ T)
            h_all.append(T.T @ (M @ carried - force))
        return np.array(M_all), np.array(h_all)

    def mass_matrix(self, states: States) -> Array:
        """M."""
        return self.chart.mass_matrix(states.q, self._evaluated(states, self.limp)[0])

    def bias(self, states: States) -> Array:
        """The quadratic velocity vector and the weight."""
        M, h = self._evaluated(states, self.limp)
        return self.chart.bias(states.q, states.v, h, M)

    def generalized_force(self, states: States) -> Array:
        """Generalised forces of strain and damping (N, nv)."""
        limp, elastic = (self._evaluated(states, system)[1] for system in (self.limp, self.elastic))
        return self.chart.our_forces(states.q, limp - elastic)

    def inverse_dynamics(self, states: States) -> Array:
        """M a + h - Q, with Exudyn's elastic forces."""
        return super().inverse_dynamics(replace(states, passive=self.generalized_force(states)))

    def forward_dynamics(self, states: States) -> Array:
        """M^-1 (Q - h), with Exudyn's elastic forces."""
        return super().forward_dynamics(replace(states, applied=self.generalized_force(states)))


def build(subject: Subject, own_weight: bool = False) -> FloatingFrameEngine | Unsupported:
    """Exudyn's body for the one beam of a description.

    Args:
        subject: Subject with its description.
        own_weight: Whether the weight is Exudyn's load, which errs, rather than an acceleration of the frame.
    """
    obstacle = _obstacle(subject.system)
    if obstacle is not None:
        return obstacle
    (beam,) = subject.system.bodies
    assert isinstance(beam, sf.Beam)
    assembly = subject.assembly
    free, elastic = assembly.movers
    chart = Chart((Slot(free, 0, 0, FREE_WXYZ, grounded=True), Slot(elastic, 7, 6)), assembly.nq, assembly.nv)
    mesh = _Mesh(beam, subject.system.parameter_values())
    load, felt = (assembly.gravity, np.zeros(3)) if own_weight else (np.zeros(3), assembly.gravity)
    elastic_body, limp_body = (_body(mesh, load, factor) for factor in (1.0, 0.0))
    return FloatingFrameEngine(elastic_body, limp_body, chart, felt)


def _obstacle(system: sf.System) -> Unsupported | None:
    if len(system.bodies) != 1 or not isinstance(beam := system.bodies[0], sf.Beam):
        return Unsupported(f"system '{system.name}': not one beam alone")
    if system.connections or system.potentials or system.constraints or system.virtual_power:
        return Unsupported(f"system '{system.name}': forces and constraints beside the beam's own")
    joint = beam.joint
    obstacles = {
        f"joint '{joint.name}': no {joint.kind} joint": joint.kind != "free",
        f"joint '{joint.name}': forces or inertia on it": bool(
            joint.prescribed
            or joint.actuated
            or joint.effort
            or joint.elements
            or joint.rotors
            or joint.armature != 0.0
        ),
        f"beam '{beam.name}': a geometrically exact rod": beam.elastic.is_exact,
        f"beam '{beam.name}': loads along it": bool(beam.loads),
        f"beam '{beam.name}': no bending": not beam.bend_y + beam.bend_z,
        f"beam '{beam.name}': shape functions of the user": beam.family == "user",
        f"beam '{beam.name}': twist; lumped masses have no rotations": bool(beam.twist),
        f"beam '{beam.name}': rotary inertia; lumped masses have no rotations": beam.rotary_inertia,
        f"beam '{beam.name}': foreshortening; displacement is linear in the modes": beam.foreshortening,
        f"beam '{beam.name}': terms of order '{beam.retain}'; all are kept": beam.retain != "all",
    }
    return next((Unsupported(reason) for reason, applies in obstacles.items() if applies), None)


class _Mesh:
    """A beam as numbers at Gauss stations, as Exudyn's interface to finite elements asks for it.

    Attributes:
        nodes: Positions (n, 3) [m].
        masses: Lumped (n,) [kg].
        modes: Modes of the displacements (3 n, nm): x, y, z of node after node.
        stiffness: Reduced (nm, nm).
        damping: Voigt-Kelvin retardation time [s].
        spin: Polar moment of inertia of the whole beam about its axis [kg m^2].
    """

    def __init__(self, beam: sf.Beam, parameters: dict[str, float]) -> None:
        L = float(sf.evaluate(beam.length, parameters))
        planes = [of_family(beam.family, count, L, bending=True) for count in (beam.bend_y, beam.bend_z)]
        knots = sorted({0.0, L, *(knot for _, breaks in planes for knot in breaks)})
        x, weights = gauss_stations(knots, POINTS)

        def section(value: sf.Expression | float) -> Array:
            return np.array([sf.evaluate(value, {**parameters, STATION: station}) for station in x.tolist()])

        self.nodes = np.zeros((len(x), 3))
        self.nodes[:, 0] = x
        self.masses = weights * section(beam.rhoA)
        self.spin = float(weights @ section(beam.rhoJ))
        self.damping = float(sf.evaluate(beam.damping, parameters))
        displacement = np.zeros((len(x), 3, beam.modes))
        curvature = np.zeros((2, len(x), beam.modes))
        modes = [(plane, shape) for plane, (shapes, _) in enumerate(planes) for shape in shapes]
        for i, (plane, shape) in enumerate(modes):
            displacement[:, 1 + plane, i] = shape.value(x)
            curvature[plane, :, i] = shape.curvature(x)
        self.modes = displacement.reshape(-1, beam.modes)
        EI = np.stack([section(beam.EI_z), section(beam.EI_y)]) * weights
        self.stiffness = np.einsum("px,pxi,pxj->ij", EI, curvature, curvature)

    def interface(self) -> Any:
        """What Exudyn's reduction reads of a finite-element model."""
        mass = np.diag(np.repeat(self.masses, 3))
        return SimpleNamespace(
            modeBasis={"matrix": self.modes},
            postProcessingModes={},
            GetNodePositionsAsArray=lambda: self.nodes,
            GetSurfaceTriangles6=lambda: [],
            GetSurfaceTriangles=lambda: [],
            GetMassMatrix=lambda sparse: mass,
            GetStiffnessMatrix=lambda sparse: mass * 0.0,
        )


def _body(mesh: _Mesh, gravity: Array, factor: float) -> ExudynSystem:
    """Exudyn's system of the body, with its stiffness and damping times a factor."""
    body = ObjectFFRFreducedOrderInterface(mesh.interface(), roundMassMatrix=0.0, roundStiffnessMatrix=0.0)
    # Exudyn would project a stiffness of the nodes, which a beam's reduced stiffness does not come from.
    body.stiffnessMatrixReduced = factor * mesh.stiffness
    body.inertiaLocal = body.inertiaLocal + np.diag([mesh.spin, 0.0, 0.0])
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    body.AddObjectFFRFreducedOrder(system, stiffnessProportionalDamping=mesh.damping, gravity=list(gravity))
    return assembled(container, system)


def _euler_parameter_rates(e: Array, nv: int) -> Array:
    """T (nv + 1, nv): rates of Euler parameters e = (w, x, y, z) are e (0, w) / 2, w in body axes."""
    w, x, y, z = e
    T = np.zeros((nv + 1, nv))
    T[:3, :3], T[7:, 6:] = np.eye(3), np.eye(nv - 6)
    T[3:7, 3:6] = 0.5 * np.array([[-x, -y, -z], [w, -z, y], [z, w, -x], [-y, x, w]])
    return T
