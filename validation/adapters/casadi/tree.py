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
from .algebra import (
    ZERO,
    Matrix,
    Scalar,
    Vector,
    add,
    cross,
    dot,
    exact,
    product,
    scale,
    skew,
    solve,
    sub,
    symmetric,
    times,
    transposed,
)
from .links import (
    UNIT,
    Articulated,
    Link,
    Motion,
    composed,
    in_world,
    joined,
    links_of,
    shifted,
    shifted_to_parent,
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

    def _joint(self, link: Link, group: Any) -> Motion:
        """The joint's own part of a motion with these speeds or their rates."""
        values = [group[i] for i in range(link.v.start, link.v.stop)]
        if link.axis is None:
            return values[3:], values[:3]
        along = scale(values[0], link.axis)
        return (ZERO, along) if link.slides else (along, ZERO)

    def _carried(self, link: Link, w: Vector, turning: Vector, a: Vector) -> Motion:
        """Of a parent with velocity w and acceleration (turning, a): the same at the child's origin, in its axes."""
        back = transposed(link.R)
        moved = add(a, cross(turning, link.p), cross(w, cross(w, link.p)))
        return times(back, turning), times(back, moved)

    def _motions(self, rates: Any | None) -> list[tuple[Vector, Vector, Vector]]:
        """Of each body: w, its rate, and the acceleration of its origin less gravity, in body axes."""
        motions: list[tuple[Vector, Vector, Vector]] = []
        for link in self.links:
            w_A, turning_A, a_A = motions[link.parent] if link.parent != BASE else (ZERO, ZERO, self._up)
            w_in = times(transposed(link.R), w_A)
            turning, a = self._carried(link, w_A, turning_A, a_A)
            w_J, v_J = self._joint(link, self.v)
            w = add(w_in, w_J)
            turning = add(turning, cross(w_in, w_J))
            # Half of Coriolis' term is of a free joint's body axes, which turn with it.
            a = add(a, cross(add(w_in, w_in) if link.axis is not None else add(w_in, w), v_J))
            if rates is not None:
                more = self._joint(link, rates)
                turning, a = add(turning, more[0]), add(a, more[1])
            motions.append((w, turning, a))
        return motions

    def _newton_euler(self, rates: Any | None) -> Vector:
        forces = []
        for link, (w, turning, a) in zip(self.links, self._motions(rates), strict=True):
            f = add(scale(link.mass, a), cross(turning, link.mc), cross(w, cross(w, link.mc)))
            n = add(times(link.J, turning), cross(w, times(link.J, w)), cross(link.mc, a))
            forces.append((n, f))
        tau: list[Scalar] = [0.0] * self.assembly.nv
        for i in range(len(self.links) - 1, -1, -1):
            link, (n, f) = self.links[i], forces[i]
            for k, (angular, linear) in enumerate(link.columns()):
                at = link.v.start + k
                own = 0.0 if rates is None else link.armature * rates[at]
                tau[at] = dot(angular, n) + dot(linear, f) + own
            if link.parent != BASE:
                on_n, on_f = forces[link.parent]
                n, f = shifted(link, n, f)
                forces[link.parent] = add(on_n, n), add(on_f, f)
        return tau

    def _mass_matrix(self) -> list[list[Scalar]]:
        """In body axes, or, where that takes fewer operations, in world axes, as for long chains."""
        candidates = [self._composite(links) for links in (self.links, in_world(self.links))]
        return min(candidates, key=lambda M: ca.Function("M", [self.q], [_rows(M)]).n_instructions())

    def _composite(self, links: Sequence[Link]) -> list[list[Scalar]]:
        nv = self.assembly.nv
        M: list[list[Scalar]] = [[0.0] * nv for _ in range(nv)]
        bodies = [(link.mass, link.mc, link.J) for link in links]
        for i in range(len(links) - 1, -1, -1):
            link, (m, mc, J) = links[i], bodies[i]
            for k, (angular, linear) in enumerate(link.columns()):
                at = link.v.start + k
                n = add(times(J, angular), cross(mc, linear))
                f = add(scale(m, linear), cross(angular, mc))
                _column(M, links, i, at, n, f)
                M[at][at] = M[at][at] + link.armature
            if link.parent != BASE:
                bodies[link.parent] = composed(bodies[link.parent], link, (m, mc, J))
        return M

    def _articulated(self) -> Vector:
        """Accelerations by articulated bodies."""
        links, still = self.links, [self._bias(*motion) for motion in self._velocity_terms()]
        inertia: list[Articulated] = [
            (link.J, skew(link.mc), symmetric(lambda i, j, m=link.mass: m if i == j else 0.0)) for link in links
        ]
        bias = [terms[0] for terms in still]
        steps: list[Any] = [None] * len(links)
        for i in range(len(links) - 1, -1, -1):
            link, (J, H, K) = links[i], inertia[i]
            n, f = bias[i]
            c_n, c_f = still[i][1]
            if link.axis is None:
                steps[i] = J, H, K, n, f
                continue
            if link.slides:
                U_n, U_f = times(H, link.axis), times(K, link.axis)
            else:
                U_n, U_f = times(J, link.axis), times(transposed(H), link.axis)
            S_n, S_f = link.columns()[0]
            inverse = 1.0 / (dot(S_n, U_n) + dot(S_f, U_f) + link.armature)
            u = self.tau[link.v.start] - dot(S_n, n) - dot(S_f, f)
            steps[i] = U_n, U_f, inverse, u
            if link.parent == BASE:
                continue
            V_n, V_f = scale(inverse, U_n), scale(inverse, U_f)
            J = symmetric(lambda a, b, J=J, U=U_n, V=V_n: J[a][b] - U[a] * V[b])
            H = [[H[a][b] - U_n[a] * V_f[b] for b in range(3)] for a in range(3)]
            K = symmetric(lambda a, b, K=K, U=U_f, V=V_f: K[a][b] - U[a] * V[b])
            n = add(n, times(J, c_n), times(H, c_f), scale(u, V_n))
            f = add(f, times(transposed(H), c_n), times(K, c_f), scale(u, V_f))
            n, f = shifted(link, n, f)
            on_n, on_f = bias[link.parent]
            bias[link.parent] = add(on_n, n), add(on_f, f)
            inertia[link.parent] = joined(inertia[link.parent], shifted_to_parent(link, J, H, K))
        return self._accelerated(steps, [terms[1] for terms in still])

    def _velocity_terms(self) -> list[tuple[Link, Vector, Motion]]:
        """Of each body: w, and what accelerates it without its joint and its parent's acceleration."""
        terms: list[tuple[Link, Vector, Motion]] = []
        for link in self.links:
            w_A = terms[link.parent][1] if link.parent != BASE else ZERO
            w_in = times(transposed(link.R), w_A)
            w_J, v_J = self._joint(link, self.v)
            w = add(w_in, w_J)
            _, a = self._carried(link, w_A, ZERO, ZERO)
            a = add(a, cross(add(w_in, w_in) if link.axis is not None else add(w_in, w), v_J))
            terms.append((link, w, (cross(w_in, w_J), a)))
        return terms

    @staticmethod
    def _bias(link: Link, w: Vector, terms: Motion) -> tuple[Motion, Motion]:
        return (cross(w, times(link.J, w)), cross(w, cross(w, link.mc))), terms

    def _accelerated(self, steps: Sequence[Any], terms: Sequence[Motion]) -> Vector:
        result: list[Scalar] = [0.0] * self.assembly.nv
        motions: list[Motion] = []
        for link, step, (c_n, c_f) in zip(self.links, steps, terms, strict=True):
            turning, a = motions[link.parent] if link.parent != BASE else (ZERO, self._up)
            turning, a = self._carried(link, ZERO, turning, a)
            turning, a = add(turning, c_n), add(a, c_f)
            if link.axis is None:
                own = self._free(link, step, turning, a)
            else:
                U_n, U_f, inverse, u = step
                own = [inverse * (u - dot(U_n, turning) - dot(U_f, a))]
            result[link.v] = own
            for value, (angular, linear) in zip(own, link.columns(), strict=True):
                turning, a = add(turning, scale(value, angular)), add(a, scale(value, linear))
            motions.append((turning, a))
        return result

    def _free(self, link: Link, step: Any, turning: Vector, a: Vector) -> Vector:
        """A free base: its whole inertia is solved; speeds are linear, then angular."""
        J, H, K, n, f = step
        whole = [[*K[i], *(H[j][i] for j in range(3))] for i in range(3)] + [[*H[i], *J[i]] for i in range(3)]
        for i in range(6):
            whole[i][i] = whole[i][i] + link.armature
        given = [self.tau[i] for i in range(link.v.start, link.v.stop)]
        linear = add(times(K, a), times(transposed(H), turning), f)
        angular = add(times(H, a), times(J, turning), n)
        return solve(whole, [sub(given, [*linear, *angular])])[0]

    def _jacobian(self, body: int) -> list[list[Scalar]]:
        """Jacobian of a body's origin (6, nv), (linear; angular) in world axes."""
        support = [body]
        while self.links[support[-1]].parent != BASE:
            support.append(self.links[support[-1]].parent)
        R: Matrix = UNIT
        p: Vector = ZERO
        places = []
        for i in reversed(support):
            p, R = add(p, times(R, self.links[i].p)), product(R, self.links[i].R)
            places.append((self.links[i], R, p))
        J: list[list[Scalar]] = [[0.0] * self.assembly.nv for _ in range(6)]
        for link, R_W, p_W in places:
            for k, (angular, linear) in enumerate(link.columns()):
                w = times(R_W, angular)
                column = [*add(times(R_W, linear), cross(w, sub(p, p_W))), *w]
                for row in range(6):
                    J[row][link.v.start + k] = column[row]
        return J

    def function(self, name: str, body: int) -> Any:
        """A CasADi function of q, v, a, tau with results row by row; gradients take what is left of them as cotangents.

        Args:
            name: Name as of our generated functions.
            body: Body whose Jacobian is meant.

        Raises:
            KeyError: No such function.
        """
        results: dict[str, Callable[[], list[Any]]] = {
            "mass_matrix": lambda: [_rows(self._mass_matrix())],
            "bias": lambda: [ca.vertcat(*self._newton_euler(None))],
            "dynamics": lambda: [_rows(self._mass_matrix()), ca.vertcat(*self._newton_euler(None))],
            "inverse_dynamics": lambda: [ca.vertcat(*self._newton_euler(self.a))],
            "forward_dynamics": lambda: [ca.vertcat(*self._articulated())],
            "frame_jacobian": lambda: [_rows(self._jacobian(body))],
            "inverse_dynamics_derivatives": lambda: [ca.vec(slope.T) for slope in self._inverse_slopes(self.a)],
            "forward_dynamics_derivatives": self._forward_slopes,
            "inverse_dynamics_second_derivatives": self._inverse_curvatures,
            "inverse_dynamics_vjp": lambda: self._gradients(self._newton_euler(self.a), self.tau),
            "forward_dynamics_vjp": lambda: self._gradients(self._articulated(), self.a),
        }
        outputs = ca.cse([ca.densify(result) for result in results[name]()])
        return ca.Function(name, [self.q, self.v, self.a, self.tau], outputs)

    def _inverse_slopes(self, rates: Any) -> list[Any]:
        tau = ca.vertcat(*self._newton_euler(self.a))
        slopes = [ca.jacobian(tau, x) for x in (self.q, self.v)]
        return list(ca.substitute(slopes, [self.a], [rates]))

    def _inverse_curvatures(self) -> list[Any]:
        """Second derivatives of tau by q and q, v and v, q and v, a and q."""
        tau, q, v, a = ca.vertcat(*self._newton_euler(self.a)), self.q, self.v, self.a
        slopes = {name: ca.vec(ca.jacobian(tau, x).T) for name, x in (("q", q), ("v", v), ("a", a))}
        pairs = (slopes["q"], q), (slopes["v"], v), (slopes["q"], v), (slopes["a"], q)
        return [ca.vec(ca.jacobian(slope, x).T) for slope, x in pairs]

    def _gradients(self, outputs: Sequence[Scalar], cotangents: Any) -> list[Any]:
        """Of cotangents . outputs by q and v, in reverse mode; the cotangents are what the outputs don't read."""
        return [ca.jtimes(ca.vertcat(*outputs), x, cotangents, True) for x in (self.q, self.v)]

    def _forward_slopes(self) -> list[Any]:
        """-M^-1 times the slopes of inverse dynamics at the acceleration that forward dynamics gives."""
        nv = self.assembly.nv
        slopes = self._inverse_slopes(ca.vertcat(*self._articulated()))
        columns = [[-slope[i, j] for i in range(nv)] for slope in slopes for j in range(nv)]
        solved = solve(self._mass_matrix(), columns)
        return [_rows(transposed(solved[:nv])), _rows(transposed(solved[nv:]))]


def _column(M: list[list[Scalar]], links: Sequence[Link], i: int, at: int, n: Vector, f: Vector) -> None:
    """A body's momentum (n, f) by one speed, felt by all joints that carry it."""
    while True:
        link = links[i]
        for k, (angular, linear) in enumerate(link.columns()):
            on = link.v.start + k
            M[on][at] = M[at][on] = dot(angular, n) + dot(linear, f)
        if link.parent == BASE:
            return
        n, f = shifted(link, n, f)
        i = link.parent


def _rows(A: Matrix) -> Any:
    return ca.vertcat(*(entry for row in A for entry in row))
