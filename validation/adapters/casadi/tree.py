"""Recursive dynamics of rigid trees in CasADi's scalars: what one would write by hand to have CasADi generate good C.

Newton-Euler, composite rigid bodies and articulated bodies (Featherstone, Rigid Body Dynamics Algorithms, 5 to 7), in
body axes about body origins. Accelerations are those of points rather than spatial ones: their rates need no linear
velocities. Constants are folded as the graph is built; nothing here knows Pinocchio's or our code.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca

import symofros as sf

from ...contract.interface import Unsupported
from ...mechanics.assembly import BASE, assemble
from ...mechanics.joint_kinds import PartKind
from ..reach import unrepresented
from .links import (
    SX,
    UNIT,
    ZERO,
    Articulated,
    Link,
    Motion,
    composed,
    exact,
    in_world,
    joined,
    links_of,
    shifted,
    shifted_to_parent,
    solve,
    symmetric,
)

# Kinds of simple joints that it has.
_JOINTS: frozenset[PartKind] = frozenset({"revolute", "prismatic", "free"})


class CasadiTree:
    """Symbolic dynamics of a description.

    Args:
        system: A rigid tree.

    Raises:
        ValueError: CasADi's recursions have no equations for something in it.

    Attributes:
        q, v, a, tau: CasADi's symbols.
    """

    def __init__(self, system: sf.System) -> None:
        assembly = assemble(system)
        obstacle = unrepresented(system, assembly, _JOINTS)
        if isinstance(obstacle, Unsupported):
            raise ValueError(obstacle.reason)
        self.assembly = assembly
        self.q, self.v, self.a, self.tau = (
            ca.SX.sym(name, n)
            for name, n in zip(("q", "v", "a", "tau"), (assembly.nq, *[assembly.nv] * 3), strict=True)
        )
        self.links = links_of(system, assembly, self.q)
        if any(link.axis is None and link.parent != BASE for link in self.links):
            raise ValueError("a free joint on a moving body")
        self._up = exact(-assembly.gravity)

    def _joint(self, link: Link, group: SX) -> Motion:
        """The joint's own part of a motion with these speeds or their rates."""
        values = group[link.v]
        if link.axis is None:
            return values[3:], values[:3]
        along = values * link.axis
        return (ZERO, along) if link.slides else (along, ZERO)

    def _carried(self, link: Link, w: SX, turning: SX, a: SX) -> Motion:
        """Acceleration (turning, a) of a parent with velocity w, taken to the child's origin, in its axes."""
        moved = a + ca.cross(turning, link.p) + ca.cross(w, ca.cross(w, link.p))
        return link.R.T @ turning, link.R.T @ moved

    def _motions(self, rates: SX | None) -> list[tuple[SX, SX, SX]]:
        """Motion of each body: w, its rate, and the acceleration of its origin less gravity, in body axes."""
        motions: list[tuple[SX, SX, SX]] = []
        for link in self.links:
            w_A, turning_A, a_A = motions[link.parent] if link.parent != BASE else (ZERO, ZERO, self._up)
            w_in = link.R.T @ w_A
            turning, a = self._carried(link, w_A, turning_A, a_A)
            w, turning_J, a_J = self._own_terms(link, w_in)
            turning, a = turning + turning_J, a + a_J
            if rates is not None:
                more = self._joint(link, rates)
                turning, a = turning + more[0], a + more[1]
            motions.append((w, turning, a))
        return motions

    def _own_terms(self, link: Link, w_in: SX) -> tuple[SX, SX, SX]:
        """W of a body, and what its joint's speeds add to its acceleration, from its parent's w in the body's axes."""
        w_J, v_J = self._joint(link, self.v)
        w = w_in + w_J
        # Half of Coriolis' term is of a free joint's body axes, which turn with it.
        return w, ca.cross(w_in, w_J), ca.cross(w_in + w_in if link.axis is not None else w_in + w, v_J)

    def _newton_euler(self, rates: SX | None) -> SX:
        forces = []
        for link, (w, turning, a) in zip(self.links, self._motions(rates), strict=True):
            f = link.mass * a + ca.cross(turning, link.mc) + ca.cross(w, ca.cross(w, link.mc))
            n = link.J @ turning + ca.cross(w, link.J @ w) + ca.cross(link.mc, a)
            forces.append((n, f))
        tau = ca.SX.zeros(self.assembly.nv)
        for i in range(len(self.links) - 1, -1, -1):
            link, (n, f) = self.links[i], forces[i]
            for at, (angular, linear) in enumerate(link.columns(), link.v.start):
                own = 0.0 if rates is None else link.armature * rates[at]
                tau[at] = ca.dot(angular, n) + ca.dot(linear, f) + own
            if link.parent != BASE:
                on_n, on_f = forces[link.parent]
                n, f = shifted(link, n, f)
                forces[link.parent] = on_n + n, on_f + f
        return tau

    def _mass_matrix(self) -> SX:
        """In body axes, or, where that takes fewer operations, in world axes, as for long chains."""
        candidates = [self._composite(links) for links in (self.links, in_world(self.links))]
        return min(candidates, key=lambda M: ca.Function("M", [self.q], [_rows(M)]).n_instructions())

    def _composite(self, links: Sequence[Link]) -> SX:
        M = ca.SX.zeros(self.assembly.nv, self.assembly.nv)
        bodies: list[tuple[SX, SX, SX]] = [(link.mass, link.mc, link.J) for link in links]
        for i in range(len(links) - 1, -1, -1):
            link, (m, mc, J) = links[i], bodies[i]
            for at, (angular, linear) in enumerate(link.columns(), link.v.start):
                n = J @ angular + ca.cross(mc, linear)
                f = m * linear + ca.cross(angular, mc)
                _column(M, links, i, at, n, f)
                M[at, at] = M[at, at] + link.armature
            if link.parent != BASE:
                bodies[link.parent] = composed(bodies[link.parent], link, (m, mc, J))
        return M

    def _articulated(self) -> SX:
        """Accelerations by articulated bodies."""
        links, terms = self.links, self._velocity_terms()
        inertia: list[Articulated] = [(link.J, ca.skew(link.mc), link.mass * UNIT) for link in links]
        bias = [
            (ca.cross(w, link.J @ w), ca.cross(w, ca.cross(w, link.mc)))
            for link, (w, _) in zip(links, terms, strict=True)
        ]
        steps: list[tuple[SX, ...]] = [()] * len(links)
        for i in range(len(links) - 1, -1, -1):
            link, (J, H, K), (n, f), (c_n, c_f) = links[i], inertia[i], bias[i], terms[i][1]
            if link.axis is None:
                steps[i] = J, H, K, n, f
                continue
            U_n, U_f = (H @ link.axis, K @ link.axis) if link.slides else (J @ link.axis, H.T @ link.axis)
            S_n, S_f = link.columns()[0]
            inverse = 1.0 / (ca.dot(S_n, U_n) + ca.dot(S_f, U_f) + link.armature)
            u = self.tau[link.v.start] - ca.dot(S_n, n) - ca.dot(S_f, f)
            steps[i] = U_n, U_f, inverse, u
            if link.parent == BASE:
                continue
            V_n, V_f = inverse * U_n, inverse * U_f
            J, H, K = symmetric(J - U_n @ V_n.T), H - U_n @ V_f.T, symmetric(K - U_f @ V_f.T)
            n = n + J @ c_n + H @ c_f + u * V_n
            f = f + H.T @ c_n + K @ c_f + u * V_f
            n, f = shifted(link, n, f)
            on_n, on_f = bias[link.parent]
            bias[link.parent] = on_n + n, on_f + f
            inertia[link.parent] = joined(inertia[link.parent], shifted_to_parent(link, J, H, K))
        return self._accelerated(steps, [own for _, own in terms])

    def _velocity_terms(self) -> list[tuple[SX, Motion]]:
        """Velocity terms of each body: w, and its acceleration without its joint's and its parent's."""
        terms: list[tuple[SX, Motion]] = []
        for link in self.links:
            w_A = terms[link.parent][0] if link.parent != BASE else ZERO
            _, a = self._carried(link, w_A, ZERO, ZERO)
            w, turning, a_J = self._own_terms(link, link.R.T @ w_A)
            terms.append((w, (turning, a + a_J)))
        return terms

    def _accelerated(self, steps: Sequence[tuple[SX, ...]], terms: Sequence[Motion]) -> SX:
        result = ca.SX.zeros(self.assembly.nv)
        motions: list[Motion] = []
        for link, step, (c_n, c_f) in zip(self.links, steps, terms, strict=True):
            turning, a = motions[link.parent] if link.parent != BASE else (ZERO, self._up)
            turning, a = self._carried(link, ZERO, turning, a)
            turning, a = turning + c_n, a + c_f
            if link.axis is None:
                own = self._free(link, step, turning, a)
            else:
                U_n, U_f, inverse, u = step
                own = inverse * (u - ca.dot(U_n, turning) - ca.dot(U_f, a))
            result[link.v] = own
            for value, (angular, linear) in zip(ca.vertsplit(own), link.columns(), strict=True):
                turning, a = turning + value * angular, a + value * linear
            motions.append((turning, a))
        return result

    def _free(self, link: Link, step: tuple[SX, ...], turning: SX, a: SX) -> SX:
        """A free base: its whole inertia is solved; speeds are linear, then angular."""
        J, H, K, n, f = step
        whole = ca.blockcat([[K, H.T], [H, J]]) + link.armature * ca.SX.eye(6)
        linear = K @ a + H.T @ turning + f
        angular = H @ a + J @ turning + n
        return solve(whole, [self.tau[link.v] - ca.vertcat(linear, angular)])

    def _jacobian(self, body: int) -> SX:
        """Jacobian of a body's origin (6, nv), (linear; angular) in world axes."""
        support = [body]
        while self.links[support[-1]].parent != BASE:
            support.append(self.links[support[-1]].parent)
        R, p, places = UNIT, ZERO, []
        for i in reversed(support):
            p, R = p + R @ self.links[i].p, R @ self.links[i].R
            places.append((self.links[i], R, p))
        J = ca.SX.zeros(6, self.assembly.nv)
        for link, R_W, p_W in places:
            for at, (angular, linear) in enumerate(link.columns(), link.v.start):
                w = R_W @ angular
                J[:, at] = ca.vertcat(R_W @ linear + ca.cross(w, p - p_W), w)
        return J

    def function(self, name: str, body: int) -> Any:
        """A CasADi function of q, v, a, tau with results row by row; gradients take what is left of them as cotangents.

        Args:
            name: Name as of our generated functions.
            body: Body whose Jacobian is meant.

        Raises:
            KeyError: No such function.
        """
        results: dict[str, Callable[[], list[SX]]] = {
            "mass_matrix": lambda: [_rows(self._mass_matrix())],
            "bias": lambda: [self._newton_euler(None)],
            "dynamics": lambda: [_rows(self._mass_matrix()), self._newton_euler(None)],
            "inverse_dynamics": lambda: [self._newton_euler(self.a)],
            "forward_dynamics": lambda: [self._articulated()],
            "frame_jacobian": lambda: [_rows(self._jacobian(body))],
            "inverse_dynamics_derivatives": lambda: [_rows(slope) for slope in self._inverse_slopes(self.a)],
            "forward_dynamics_derivatives": self._forward_slopes,
            "inverse_dynamics_second_derivatives": self._inverse_curvatures,
            "inverse_dynamics_vjp": lambda: self._gradients(self._newton_euler(self.a), self.tau),
            "forward_dynamics_vjp": lambda: self._gradients(self._articulated(), self.a),
        }
        outputs = ca.cse([ca.densify(result) for result in results[name]()])
        return ca.Function(name, [self.q, self.v, self.a, self.tau], outputs)

    def _inverse_slopes(self, rates: SX) -> list[SX]:
        tau = self._newton_euler(self.a)
        slopes = [ca.jacobian(tau, x) for x in (self.q, self.v)]
        return list(ca.substitute(slopes, [self.a], [rates]))

    def _inverse_curvatures(self) -> list[SX]:
        """Second derivatives of tau by q and q, v and v, q and v, a and q."""
        tau, q, v, a = self._newton_euler(self.a), self.q, self.v, self.a
        slopes = {name: _rows(ca.jacobian(tau, x)) for name, x in (("q", q), ("v", v), ("a", a))}
        pairs = (slopes["q"], q), (slopes["v"], v), (slopes["q"], v), (slopes["a"], q)
        return [_rows(ca.jacobian(slope, x)) for slope, x in pairs]

    def _gradients(self, outputs: SX, cotangents: SX) -> list[SX]:
        """Gradients of cotangents . outputs by q and v, in reverse mode."""
        return [ca.jtimes(outputs, x, cotangents, True) for x in (self.q, self.v)]

    def _forward_slopes(self) -> list[SX]:
        """-M^-1 times the slopes of inverse dynamics at the acceleration that forward dynamics gives."""
        M, slopes = self._mass_matrix(), self._inverse_slopes(self._articulated())
        return [_rows(solve(M, ca.horzsplit(-ca.densify(slope)))) for slope in slopes]


def _column(M: SX, links: Sequence[Link], i: int, at: int, n: SX, f: SX) -> None:
    """A body's momentum (n, f) by one speed, felt by all joints that carry it."""
    while True:
        link = links[i]
        for on, (angular, linear) in enumerate(link.columns(), link.v.start):
            M[on, at] = M[at, on] = ca.dot(angular, n) + ca.dot(linear, f)
        if link.parent == BASE:
            return
        n, f = shifted(link, n, f)
        i = link.parent


def _rows(A: SX) -> SX:
    return ca.vec(A.T)
