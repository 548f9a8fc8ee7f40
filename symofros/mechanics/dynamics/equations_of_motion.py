"""The equations of motion of one tree: terms, constraints, forward and inverse dynamics, frames."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property
from typing import Self

from symofros.errors import DescriptionError
from symofros.expr.edges import ZERO, Edge
from symofros.expr.factors import Factors, SingularMatrixError
from symofros.expr.graph import Graph
from symofros.expr.substitute import substitute
from symofros.expr.vector import Vec3
from symofros.mechanics.dynamics.acceleration import base_to_tip
from symofros.mechanics.dynamics.applied.contacts import TouchingBall, touching_balls
from symofros.mechanics.dynamics.applied.forces import applied_wrenches, generalized_forces
from symofros.mechanics.dynamics.bodies.inertia import link_inertias
from symofros.mechanics.dynamics.bodies.rotors import MovingRotor, rotors_of
from symofros.mechanics.dynamics.constraints.rows import Constraints, Row
from symofros.mechanics.dynamics.constraints.wrenches import closure_wrenches, wrenches_on_links
from symofros.mechanics.dynamics.forward.articulated import articulated_acceleration, articulated_solution, is_local
from symofros.mechanics.dynamics.jourdain import inertia_forces
from symofros.mechanics.dynamics.mass_matrix import MassMatrix, Matrix, mass_matrix
from symofros.mechanics.dynamics.wrenches.reactions import (
    in_body_frames,
    prescribed_efforts,
    section_forces,
    transmitted_wrenches,
)
from symofros.mechanics.kinematics.frames import FrameKinematics
from symofros.mechanics.kinematics.links import TreeKinematics, tree_kinematics
from symofros.mechanics.spatial.inertia import LinkInertia
from symofros.mechanics.spatial.wrench import LinkMotion, Wrench
from symofros.mechanics.topology.physics import OTHER_FUNCTIONS
from symofros.mechanics.topology.tree import SpanningTree

_DIVIDES = "forward dynamics divides by the inertia that each speed moves"


class EquationsOfMotion:
    """The equations of motion of one tree: M v' + h = Q.

    Each property is formed when it is first needed, in one graph, so functions share what they have in common.
    """

    def __init__(self, tree: SpanningTree) -> None:
        self.tree = tree
        self.g = Graph()
        self.nv = len(tree.coordinates.v)
        self.nu = len(tree.coordinates.u)
        self.efforts = tree.coordinates.efforts
        # Prescribed motions are inputs that every function may depend on.
        self.implicit_inputs = ("u",) if self.nu > self.efforts else ()

    def fork(self) -> Self:
        """A copy with a graph of its own, in which the kinematics are formed; what else it forms, this one lacks."""
        assert self.kinematics.g is self.g  # Formed once, for all copies.
        kept = (self.tree, self.tree.coordinates)
        return copy.deepcopy(self, {id(item): item for item in kept})

    @cached_property
    def at_rest(self) -> Self:
        """The same in the same graph without speeds, except prescribed ones: what they would multiply is not formed."""
        still = type(self)(self.tree)
        still.g, still.kinematics = self.g, self._resting
        return still

    @cached_property
    def _resting(self) -> TreeKinematics:
        links = tuple(
            replace(link, speeds=(ZERO,) * len(link.speeds)) if link.rates is None else link
            for link in self.kinematics.links
        )
        return replace(self.kinematics, links=links)

    @cached_property
    def kinematics(self) -> TreeKinematics:
        """Kinematics of the tree."""
        return tree_kinematics(self.g, self.tree)

    @cached_property
    def _inertias(self) -> tuple[list[LinkInertia], LinkInertia]:
        return link_inertias(self.kinematics)

    @cached_property
    def rotors(self) -> list[MovingRotor]:
        """Rotors and armatures."""
        return rotors_of(self.kinematics)

    @cached_property
    def gravity(self) -> Vec3:
        """Acceleration of gravity in the world."""
        return self.kinematics.lowering.vector(self.tree.system.gravity)

    @cached_property
    def _mass_matrix(self) -> MassMatrix:
        return mass_matrix(self.kinematics, self._inertias[0], self.rotors)

    @property
    def M(self) -> Matrix:
        """Mass matrix (nv x nv)."""
        return self._mass_matrix.entries

    @cached_property
    def h(self) -> list[Edge]:
        """Coriolis, centrifugal and gravity terms (nv)."""
        return inertia_forces(self.kinematics, self._inertias[0], self.rotors, [ZERO] * self.nv, self.gravity)

    @cached_property
    def gravity_force(self) -> list[Edge]:
        """Bias at rest, h(q, 0) (nv)."""
        return inertia_forces(self._resting, self._inertias[0], self.rotors, [ZERO] * self.nv, self.gravity)

    @cached_property
    def Q(self) -> list[Edge]:
        """Generalized forces (nv)."""
        return generalized_forces(self.kinematics, self.frames)

    @cached_property
    def v_rate(self) -> list[Edge]:
        """The input a, as edges (nv)."""
        return [self.g.input("a", i) for i in range(self.nv)]

    @cached_property
    def acceleration(self) -> list[Edge]:
        """Acceleration v' = M^-1 (Q - h) (nv)."""
        return self.factors.solve(self.force_minus_bias)

    @property
    def route_figures(self) -> dict[str, float | Callable[[], float]]:
        """Figures by which methods of forward dynamics apply: rotors that tie more than neighbours."""
        return {"distant_rotors": sum(not is_local(self.kinematics, rotor) for rotor in self.rotors)}

    @cached_property
    def articulated(self) -> list[Edge]:
        """Acceleration v' by articulated bodies (nv).

        Raises:
            DescriptionError: As for `factors`; or a rotor ties more than neighbours.
        """
        if self.route_figures["distant_rotors"]:
            raise DescriptionError(
                f"system '{self.tree.system.name}': forward dynamics by articulated bodies",
                "a rotor that is borne by another body than the parent of the joint that drives it",
                "a joint's speeds move its link, and rotors on its parent or on the base, alone",
                "choose Options(forward_dynamics='factors'), or 'auto'",
            )
        with self._refusing_singular():
            return articulated_acceleration(self.kinematics, self._bare_inertias, self.rotors, self.gravity, self.Q)

    def articulated_solution(self, right: Sequence[Edge]) -> list[Edge]:
        """Solution x of M x = right by articulated bodies, where `articulated` is one (nv)."""
        return articulated_solution(self.kinematics, self._bare_inertias, self.rotors, right)

    @cached_property
    def _bare_inertias(self) -> list[LinkInertia]:
        """Inertia of each link, without that of what it carries."""
        return link_inertias(self.kinematics, regrouped=False)[0]

    @cached_property
    def factors(self) -> Factors:
        """Factors of M.

        Raises:
            DescriptionError: A speed moves no mass whatever the state, and so has no acceleration.
        """
        with self._refusing_singular():
            return Factors(self.g, self.M)

    @contextmanager
    def _refusing_singular(self) -> Iterator[None]:
        """Turns a mass matrix that is singular in every state into a DescriptionError that names the speed."""
        try:
            yield
        except SingularMatrixError as error:
            self.refuse_massless()
            name = self.tree.coordinates.v[error.row]
            raise DescriptionError(
                f"system '{self.tree.system.name}': speed '{name}' moves nothing that those after it do not move alike",
                "M is singular in every state",
                f"{_DIVIDES} alone",
                "give the bodies between mass, turn one of the axes, or bind it by a constraint",
            ) from None

    def refuse_massless(self) -> None:
        """Raise DescriptionError for a speed that moves no mass."""
        for k, name in enumerate(self.tree.coordinates.v):
            if self.M[k][k] == ZERO:
                raise DescriptionError(
                    f"system '{self.tree.system.name}': speed '{name}' moves no mass",
                    "its row of M is zero",
                    _DIVIDES,
                    f"give it an inertia, or bind it by a constraint{OTHER_FUNCTIONS}",
                )

    @cached_property
    def force_minus_bias(self) -> list[Edge]:
        """Force minus bias, Q - h (nv)."""
        return [self.g.sub(Q, h) for Q, h in zip(self.Q, self.h, strict=True)]

    @cached_property
    def constraints(self) -> list[Row]:
        """Constraint equations, one row a condition (nc)."""
        return Constraints(self.frames).rows()

    @property
    def phi(self) -> list[Edge]:
        """Residual phi of the position of each condition; zero for conditions on speeds (nc)."""
        return [row.phi for row in self.constraints]

    @property
    def constraint_rate(self) -> list[Edge]:
        """Rate G v - b of each condition (nc)."""
        return [row.rate for row in self.constraints]

    @property
    def G(self) -> Matrix:
        """Constraint Jacobian (nc x nv)."""
        return [list(row.G) for row in self.constraints]

    @property
    def facing(self) -> list[tuple[Edge, ...]]:
        """Cosines of the angles between axes that each condition keeps parallel (constraints.md, 5a)."""
        return [row.facing for row in self.constraints]

    @property
    def gamma(self) -> list[Edge]:
        """Right-hand side of G v' = gamma (nc)."""
        return [row.gamma for row in self.constraints]

    @cached_property
    def gamma_baumgarte(self) -> list[Edge]:
        """Right-hand side with Baumgarte's terms: gamma - 2 alpha (G v - b) - beta^2 phi (nc)."""
        g, nc = self.g, len(self.constraints)
        stabilised = []
        for i, row in enumerate(self.constraints):
            alpha, beta = g.input("gains", i), g.input("gains", nc + i)
            damped = g.mul(g.add(alpha, alpha), row.rate)
            stabilised.append(g.sub(g.sub(row.gamma, damped), g.mul(g.mul(beta, beta), row.phi)))
        return stabilised

    @cached_property
    def _wrenches(self) -> tuple[Matrix, Matrix]:
        on_second, on_first = closure_wrenches(self.frames, self.constraints)
        return [list(wrench) for wrench in on_second], [list(wrench) for wrench in on_first]

    @property
    def wrenches_on_second(self) -> Matrix:
        """Force and moment of each constraint on its second frame (nw x 6)."""
        return self._wrenches[0]

    @property
    def wrenches_on_first(self) -> Matrix:
        """Force and moment of each constraint on its first frame (nw x 6)."""
        return self._wrenches[1]

    @cached_property
    def _motions(self) -> list[LinkMotion]:
        return base_to_tip(self.kinematics, self.v_rate, self.gravity)

    @cached_property
    def _transmitted(self) -> list[Wrench]:
        acting, _ = applied_wrenches(self.kinematics, self.frames)
        by_constraints = wrenches_on_links(self.kinematics, self.frames, self.constraints)
        lists = [by_constraints] if acting is None else [acting, by_constraints]
        return transmitted_wrenches(self.kinematics, self.rotors, self._motions, self.v_rate, lists)

    @property
    def joint_wrenches(self) -> Matrix:
        """Wrench that each joint transmits to its body (nj x 6)."""
        return in_body_frames(self.kinematics, self._transmitted)

    @property
    def section_forces(self) -> Matrix:
        """Force and moment at the stations of the elastic beams, in the axes of the section (nf x 6)."""
        return list(section_forces(self.kinematics, self.frames, self._motions, self.v_rate, self._transmitted))

    @property
    def prescribed_efforts(self) -> list[Edge]:
        """Effort of the drive of each prescribed speed (ns)."""
        return prescribed_efforts(self.kinematics, self.rotors, self._motions, self.v_rate, self._transmitted)

    @cached_property
    def touching_balls(self) -> list[TouchingBall]:
        """The balls of all contacts, in order."""
        contacts = self.tree.system.contacts
        return [ball for contact in contacts for ball in touching_balls(self.kinematics, self.frames, contact)]

    @property
    def contact_gaps(self) -> list[Edge]:
        """Distance of each ball from the surface that it may touch (nk)."""
        return [ball.gap for ball in self.touching_balls]

    @property
    def contact_pushes(self) -> list[Edge]:
        """Normal force on each ball (nk)."""
        return [ball.push for ball in self.touching_balls]

    @property
    def contact_forces(self) -> Matrix:
        """Force on each ball, in world axes (nk x 3)."""
        return [list(ball.force) for ball in self.touching_balls]

    @property
    def contact_points(self) -> Matrix:
        """Point where it acts, in the world (nk x 3)."""
        return [list(ball.point) for ball in self.touching_balls]

    @property
    def contact_shares(self) -> list[Edge]:
        """Penetration over the radius of the ball, or of the surface (nk)."""
        return [ball.share for ball in self.touching_balls]

    def inertia_forces(self, a: Sequence[Edge]) -> list[Edge]:
        """Inertia forces and weight M a + h (nv)."""
        return inertia_forces(self.kinematics, self._inertias[0], self.rotors, a, self.gravity)

    @cached_property
    def inverse_dynamics(self) -> list[Edge]:
        """Inverse dynamics tau = M a + h - Q(q, v, 0): the inputs' share of the forces for an acceleration a (nv)."""
        return self._less_passive(self.inertia_forces(self.v_rate))

    @cached_property
    def residual(self) -> list[Edge]:
        """Residual M a + h - Q - G^T lam, then G a - gamma: zero for the motion that the inputs produce (nv + nc)."""
        return self._less_forces(self.inertia_forces(self.v_rate))

    @cached_property
    def rest_residual(self) -> list[Edge]:
        """Residual h - Q - G^T lam, at no accelerations (nv)."""
        return self._less_forces(self.h)[: self.nv]

    # Balances: inertia forces less other forces, and conditions below them.

    def _less_passive(self, inertial: Sequence[Edge]) -> list[Edge]:
        """Inertia forces less the generalized forces at no efforts (nv)."""
        passive = substitute(self.g, self.Q, {self.g.input("u", i): ZERO for i in range(self.efforts)})
        return [self.g.sub(force, applied) for force, applied in zip(inertial, passive, strict=True)]

    def _less_applied(self, inertial: Sequence[Edge]) -> list[Edge]:
        """Inertia forces less the generalized forces (nv)."""
        return [self.g.sub(force, applied) for force, applied in zip(inertial, self.Q, strict=True)]

    def _less_forces(self, inertial: Sequence[Edge]) -> list[Edge]:
        """Inertia forces less all others, then G a - gamma (nv + nc)."""
        g, a, forces = self.g, self.v_rate, self._less_applied(inertial)
        for i, row in enumerate(self.constraints):
            lam = g.input("lam", i)
            forces = [g.sub(force, g.mul(lam, entry)) for force, entry in zip(forces, row.G, strict=True)]
        conditions = [
            g.sub(g.sum(g.mul(x, y) for x, y in zip(row.G, a, strict=True)), row.gamma) for row in self.constraints
        ]
        return forces + conditions

    @property
    def dynamic_residual(self) -> list[Edge]:
        """Residual M a + h - Q - G^T lam (nv)."""
        return self.residual[: self.nv]

    @cached_property
    def frames(self) -> FrameKinematics:
        """Kinematics of the frames, at their deflected places."""
        is_deflected = all(beam.equations.order > 0 for beam in self.kinematics.beams)
        return FrameKinematics(
            self.kinematics if is_deflected else tree_kinematics(self.g, self.tree, deflected_tips=True)
        )
