"""All quantities of one tree that model functions return, each formed when it is first needed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property, partial

from symofros.base.routes import Choice
from symofros.expr.edges import ZERO, Edge
from symofros.expr.ops import STOP_GRADIENT
from symofros.mechanics.beams.theories import theory_of
from symofros.mechanics.dynamics.applied.forces import stored_energy
from symofros.mechanics.dynamics.bodies.inertia import inertia_inputs
from symofros.mechanics.dynamics.centroidal import central_mass, centroidal_momentum, centroidal_rate
from symofros.mechanics.dynamics.derivatives import recursion
from symofros.mechanics.dynamics.derivatives.differentiation import by_configuration, by_inputs
from symofros.mechanics.dynamics.derivatives.responses import DirectChange, Responses, responses
from symofros.mechanics.dynamics.equations_of_motion import EquationsOfMotion
from symofros.mechanics.dynamics.forward.articulated import (
    articulated_joints,
    articulated_response,
    balances_by_link,
)
from symofros.mechanics.dynamics.jourdain import inertia_forces
from symofros.mechanics.dynamics.mass_matrix import Matrix
from symofros.mechanics.dynamics.momentum import (
    coadjoint,
    coriolis_matrix,
    kinetic_energy,
    momentum_rate,
    potential_energy,
)
from symofros.mechanics.topology.tree import coupled_speeds


class Equations(EquationsOfMotion):
    """The equations of motion of one tree with their derivatives, momenta and energies."""

    # Derivatives, along the manifold of q where they are by q.

    def by_q(self, edges: Sequence[Edge]) -> Matrix:
        """Derivatives of some edges by the coordinates, one column a speed."""
        return by_configuration(self.kinematics, edges)

    def by_v(self, edges: Sequence[Edge]) -> Matrix:
        """Derivatives of some edges by the speeds."""
        return by_inputs(self.kinematics, edges, "v", self.nv)

    def by_u(self, edges: Sequence[Edge]) -> Matrix:
        """Derivatives of some edges by the inputs."""
        return by_inputs(self.kinematics, edges, "u", self.nu)

    def by_par(self, edges: Sequence[Edge]) -> Matrix:
        """Derivatives of some edges by the run-time parameters."""
        return by_inputs(self.kinematics, edges, "par", len(self.tree.coordinates.par))

    @cached_property
    def slopes_route(self) -> Choice:
        """Method of the derivatives of the inertia forces by q and v."""
        return recursion.route(self.kinematics, self.rotors)

    def _slopes(self, balance: Callable[[Sequence[Edge]], list[Edge]], a: Sequence[Edge]) -> tuple[Matrix, Matrix]:
        """Derivatives of a balance by q and by v at constant a, those of rigid trees' inertia forces by recursion.

        Args:
            balance: Gives the balance for the inertia forces, in whose first rows they are added.
            a: Acceleration (nv).
        """
        if self.slopes_route.method == "graph":
            edges = balance(self.inertia_forces(a))
            return self.by_q(edges), self.by_v(edges)
        inertial = recursion.inertia_force_derivatives(
            self.kinematics, self._mass_matrix, self._inertias[0], a, self.gravity
        )
        others = balance([ZERO] * self.nv)
        by_q, by_v = self.by_q(others), self.by_v(others)
        for slopes, rows in zip((by_q, by_v), inertial, strict=True):
            slopes[: self.nv] = [
                [self.g.add(x, y) for x, y in zip(row, other, strict=True)]
                for row, other in zip(rows, slopes[: self.nv], strict=True)
            ]
        return by_q, by_v

    @cached_property
    def _residual_slopes(self) -> tuple[Matrix, Matrix]:
        return self._slopes(self._less_forces, self.v_rate)

    @property
    def residual_by_q(self) -> Matrix:
        """Derivative of the residual by q (nv + nc x nv)."""
        return self._residual_slopes[0]

    @property
    def residual_by_v(self) -> Matrix:
        """Derivative of the residual by v (nv + nc x nv)."""
        return self._residual_slopes[1]

    def _held(self, edges: Sequence[Edge]) -> list[Edge]:
        """Edges that derivatives take for constants."""
        return [self.g.call(STOP_GRADIENT, edge) for edge in edges]

    @cached_property
    def _slopes_in_motion(self) -> tuple[Matrix, Matrix]:
        """Derivatives of M a + h - Q by q and v, with a the acceleration that the forces make."""
        return self._slopes(self._less_applied, self._held(self.acceleration))

    def slopes_in_motion(self, name: str) -> Matrix:
        """Derivative "by_q", "by_v", "by_u" or "by_par" of M a + h - Q at the acceleration that the forces make."""
        if name in ("by_q", "by_v"):
            return self._slopes_in_motion[name == "by_v"]
        edges = self.balance(self.acceleration)
        return self.by_u(edges) if name == "by_u" else self.by_par(edges)

    def balance(self, a: Sequence[Edge]) -> list[Edge]:
        """Balance M a + h - Q, whose derivatives take a for a constant (nv)."""
        return self._less_applied(self.inertia_forces(self._held(a)))

    @cached_property
    def balances_by_link(self) -> list[Edge]:
        """Balances of links and speeds in the motion that the forces make, for `articulated_response`."""
        a, links = self._held(self.articulated), self._bare_inertias
        return balances_by_link(self.kinematics, links, self.rotors, self.gravity, self.Q, a, self._held)

    def articulated_response(self, change: Sequence[Edge]) -> list[Edge]:
        """Change of the acceleration where `balances_by_link` changes by so much (nv)."""
        return articulated_response(self.kinematics, self._bare_inertias, self.rotors, change)

    def articulated_slopes(self, name: str) -> Matrix:
        """Derivative "by_q", "by_v", "by_u" or "by_par" of the acceleration, by articulated bodies (nv rows)."""
        slopes: Matrix = getattr(self, name)(self.balances_by_link)
        columns = [self.articulated_response(column) for column in zip(*slopes, strict=True)]
        return [list(row) for row in zip(*columns, strict=True)] if columns else [[] for _ in range(self.nv)]

    def response_figures(self, columns: int) -> dict[str, float | Callable[[], float]]:
        """Figures by which methods of so many columns of derivatives of the acceleration apply."""
        return {
            **self.route_figures,
            **recursion.figures_of(self.kinematics, self.rotors),
            "prescribed_speeds": self.nu - self.efforts,
            "coupled_speeds": partial(coupled_speeds, self.tree),
            "direct_changes": lambda: len(self.direct_changes),
            "elimination_steps": lambda: self.factors.entries * columns,
        }

    @cached_property
    def responses(self) -> Responses:
        """What the derivatives of the acceleration of a rigid tree by articulated bodies consist of."""
        joints = articulated_joints(self.kinematics, self._bare_inertias, self.rotors)
        a = self._held(self.articulated)
        return responses(self.kinematics, self._bare_inertias, joints, a, self.gravity)

    @cached_property
    def direct_changes(self) -> list[DirectChange]:
        """Changes of the balances by q, v and u at held motions of the links, where they are not always zero."""
        others = self._less_applied([ZERO] * self.nv)
        slopes = [self.by_q(others), self.by_v(others), self.by_u(others)]
        slopes[0] = [
            [self.g.add(x, y) for x, y in zip(*rows, strict=True)]
            for rows in zip(slopes[0], self.responses.turned, strict=True)
        ]
        return sorted(
            DirectChange(k, by, column, edge)
            for by, rows in enumerate(slopes)
            for k, row in enumerate(rows)
            for column, edge in enumerate(row)
            if edge != ZERO
        )

    @cached_property
    def residual_by_u(self) -> Matrix:
        """Derivative of the residual by u (nv + nc x nu)."""
        return self.by_u(self.residual)

    @cached_property
    def residual_by_par(self) -> Matrix:
        """Derivative of the residual by the run-time parameters (nv + nc x npar)."""
        return self.by_par(self.residual)

    @cached_property
    def constraint_rate_by_q(self) -> Matrix:
        """Derivative of G v - b by q (nc x nv)."""
        return self.by_q(self.constraint_rate)

    @cached_property
    def _inverse_slopes(self) -> tuple[Matrix, Matrix]:
        return self._slopes(self._less_passive, self.v_rate)

    @property
    def inverse_dynamics_by_q(self) -> Matrix:
        """Derivative of the inverse dynamics by q (nv x nv)."""
        return self._inverse_slopes[0]

    @property
    def inverse_dynamics_by_v(self) -> Matrix:
        """Derivative of the inverse dynamics by v (nv x nv)."""
        return self._inverse_slopes[1]

    @cached_property
    def passive_slopes(self) -> Matrix:
        """Derivative of -Q(q, v, 0), what inverse dynamics adds to the inertia forces, by v (nv x nv)."""
        return self.by_v(self._less_passive([ZERO] * self.nv))

    @cached_property
    def inverse_dynamics_by_par(self) -> Matrix:
        """Derivative of the inverse dynamics by the run-time parameters (nv x npar)."""
        return self.by_par(self.inverse_dynamics)

    @cached_property
    def momentum(self) -> list[Edge]:
        """Generalized momentum p = M v (nv)."""
        return [self.g.sum(self.g.mul(m, self.g.input("v", k)) for k, m in enumerate(row)) for row in self.M]

    @cached_property
    def momentum_force(self) -> list[Edge]:
        """Force F with p' = F + ad_v^T p: the equations of motion give F = dM/dt v + Q - h - ad_v^T p (nv)."""
        g, p = self.g, self.momentum
        parts = zip(momentum_rate(self.kinematics, p), self.Q, self.h, coadjoint(self.kinematics, p), strict=True)
        return [g.sub(g.add(rate, Q), g.add(h, turning)) for rate, Q, h, turning in parts]

    @cached_property
    def center_of_mass(self) -> list[Edge]:
        """Position of the mass centre in the world (3)."""
        return list(central_mass(self.kinematics).p_WScm)

    @cached_property
    def centroidal_momentum(self) -> list[Edge]:
        """Momentum about the mass centre, linear then angular (6)."""
        return centroidal_momentum(self.kinematics, self.rotors)

    @cached_property
    def centroidal_momentum_matrix(self) -> Matrix:
        """Matrix A_G of the momentum about the mass centre, which is linear in the speeds (6 x nv)."""
        return self.by_v(self.centroidal_momentum)

    @cached_property
    def centroidal_momentum_rate(self) -> list[Edge]:
        """Rate of the momentum about the mass centre (6)."""
        return centroidal_rate(self.kinematics, self.rotors, self.v_rate)

    @cached_property
    def coriolis_matrix(self) -> Matrix:
        """Coriolis matrix (nv x nv)."""
        return coriolis_matrix(self.kinematics, self._inertias[0], self.rotors, self.M)

    @cached_property
    def regressor(self) -> list[list[Edge]]:
        """Regressor Y with M a + h = Y pi: for rigid links, linear in their inertial parameters (nv x 10 links)."""
        own = inertia_inputs(self.kinematics)
        total = inertia_forces(self.kinematics, own, [], self.v_rate, self.gravity)
        return by_inputs(self.kinematics, total, "pi", 10 * len(own))

    @property
    def beam_stiffness(self) -> tuple[list[Edge], Matrix, Matrix]:
        """Lengths of the elastic beams, EI_z and EI_y of each, and the stiffness of their coordinates (nv x nv)."""
        lower, K = self.kinematics.lowering.value, [[ZERO] * self.nv for _ in range(self.nv)]
        lengths, stiffnesses = [], []
        for moving in self.kinematics.beams:
            if moving.tip is None:
                continue
            beam, first = moving.equations.beam, self.kinematics.links[moving.tip].first_speed
            lengths.append(lower(beam.length))
            judged = theory_of(beam).judged
            stiffnesses.append([lower(judged.EI_z), lower(judged.EI_y)])
            for i, stiffness in enumerate(moving.equations.strain_energy.second_derivatives(), first):
                K[i][first : first + beam.modes] = stiffness
        return lengths, stiffnesses, K

    @cached_property
    def T(self) -> Edge:
        """Kinetic energy."""
        return kinetic_energy(self.kinematics, self._inertias[0], self.rotors)

    @cached_property
    def V(self) -> Edge:
        """Potential energy: of the weight, and what forces store."""
        weight = potential_energy(self.frames.kinematics, *self._inertias, self.gravity)
        return self.g.add(weight, stored_energy(self.kinematics, self.frames))
