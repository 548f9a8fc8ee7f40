"""Recursive dynamics of rigid trees in CasADi's scalars: what one would write by hand to have CasADi generate good C.

Newton-Euler, composite rigid bodies and articulated bodies (Featherstone, Rigid Body Dynamics Algorithms, 5 to 7), in
body axes about body origins. Accelerations are those of points rather than spatial ones: their rates need no linear
velocities. Constants are folded as the graph is built; nothing here knows Pinocchio's or our code.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

import symofros as sf
from validation.adapters.casadi_algebra import (
    ZERO,
    Matrix,
    Scalar,
    Vector,
    about,
    add,
    cross,
    dot,
    exact,
    of_quaternion,
    plus,
    product,
    scale,
    skew,
    solve,
    sub,
    symmetric,
    times,
    transposed,
    turned,
)
from validation.adapters.reach import armature, unrepresented
from validation.assembly import BASE, Mover, assemble
from validation.interface import Unsupported

_JOINTS = frozenset({"revolute", "prismatic", "free"})
_UNIT: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Link:
    """One moving body.

    Attributes:
        parent: Index, or BASE.
        R, p: R_AB(q), p_AB(q) from the parent's frame.
        mass, mc, J: Mass, first moments, inertia about the body's origin.
        axis: Of its joint; None for a free one.
        slides: Whether the joint is prismatic.
        v: Where its speeds are.
        armature: On the diagonal of M.
        axes: Along which a free joint's speeds are.
    """

    parent: int
    R: Matrix
    p: Vector
    mass: float
    mc: Vector
    J: Matrix
    axis: Vector | None
    slides: bool
    v: slice
    armature: float
    axes: Matrix = _UNIT

    def columns(self) -> list[tuple[Vector, Vector]]:
        """The joint's motions with unit speeds: (angular, linear)."""
        if self.axis is None:
            return [(ZERO, e) for e in self.axes] + [(e, ZERO) for e in self.axes]
        return [(ZERO, self.axis) if self.slides else (self.axis, ZERO)]


Motion = tuple[Vector, Vector]


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
        self.links = [self._link(mover, armature(system, mover)) for mover in assembly.movers]
        if any(link.axis is None and link.parent != BASE for link in self.links):
            raise ValueError("a free joint on a moving body")
        self._up = exact(-assembly.gravity)

    def _link(self, mover: Mover, armature: float) -> Link:
        R_AP, p_AP = exact(mover.X_AP.R), exact(mover.X_AP.p)
        q = [self.q[i] for i in range(mover.q.start, mover.q.stop)]
        merged = mover.merged()
        K = skew(exact(merged.p_BC))
        J = merged.J_BC - merged.mass * np.array(product(K, K))
        inertia = merged.mass, exact(merged.mass * merged.p_BC), exact(J)
        if mover.kind == "free":
            R, p = product(R_AP, of_quaternion(q[3:])), add(p_AP, times(R_AP, q[:3]))
            return Link(mover.parent, R, p, *inertia, None, False, mover.v, armature)
        axis = exact(mover.axis)
        if mover.kind == "prismatic":
            p = add(p_AP, scale(q[0], times(R_AP, axis)))
            return Link(mover.parent, R_AP, p, *inertia, axis, True, mover.v, armature)
        R = product(R_AP, about(axis, ca.sin(q[0]), ca.cos(q[0])))
        return Link(mover.parent, R, p_AP, *inertia, axis, False, mover.v, armature)

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
        found: list[tuple[Vector, Vector, Vector]] = []
        for link in self.links:
            w_A, turning_A, a_A = found[link.parent] if link.parent != BASE else (ZERO, ZERO, self._up)
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
            found.append((w, turning, a))
        return found

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
                n, f = _shifted(link, n, f)
                forces[link.parent] = add(on_n, n), add(on_f, f)
        return tau

    def _mass_matrix(self) -> list[list[Scalar]]:
        """In body axes, or, where that takes fewer operations, in world axes, as for long chains."""
        candidates = [self._composite(links) for links in (self.links, self._in_world())]
        return min(candidates, key=lambda M: ca.Function("M", [self.q], [_rows(M)]).n_instructions())

    def _in_world(self) -> list[Link]:
        """The same bodies along world axes, so that wrenches pass from body to body without a rotation."""
        found: list[Link] = []
        rotations: list[Matrix] = []
        for link in self.links:
            R_A = rotations[link.parent] if link.parent != BASE else _UNIT
            R = product(R_A, link.R)
            rotations.append(R)
            axis = None if link.axis is None else times(R, link.axis)
            found.append(replace(link, R=_UNIT, p=times(R_A, link.p), mc=times(R, link.mc), J=turned(R, link.J),
                                 axis=axis, axes=transposed(R)))  # fmt: skip
        return found

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
                bodies[link.parent] = _composed(bodies[link.parent], link, (m, mc, J))
        return M

    def _articulated(self) -> Vector:
        """Accelerations by articulated bodies."""
        links, still = self.links, [self._bias(*motion) for motion in self._velocity_terms()]
        inertia: list[tuple[Matrix, Matrix, Matrix]] = [
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
            n, f = _shifted(link, n, f)
            on_n, on_f = bias[link.parent]
            bias[link.parent] = add(on_n, n), add(on_f, f)
            inertia[link.parent] = _joined(inertia[link.parent], _moved(link, J, H, K))
        return self._accelerated(steps, [terms[1] for terms in still])

    def _velocity_terms(self) -> list[tuple[Link, Vector, Motion]]:
        """Of each body: w, and what accelerates it without its joint and its parent's acceleration."""
        found: list[tuple[Link, Vector, Motion]] = []
        for link in self.links:
            w_A = found[link.parent][1] if link.parent != BASE else ZERO
            w_in = times(transposed(link.R), w_A)
            w_J, v_J = self._joint(link, self.v)
            w = add(w_in, w_J)
            _, a = self._carried(link, w_A, ZERO, ZERO)
            a = add(a, cross(add(w_in, w_in) if link.axis is not None else add(w_in, w), v_J))
            found.append((link, w, (cross(w_in, w_J), a)))
        return found

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
        """Of a body's origin, (linear; angular) in world axes."""
        support = [body]
        while self.links[support[-1]].parent != BASE:
            support.append(self.links[support[-1]].parent)
        R: Matrix = _UNIT
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
        """A CasADi function of q, v, a, tau with results row by row.

        Args:
            name: As of our generated functions.
            body: Whose Jacobian.

        Raises:
            KeyError: No such function.
        """
        results = {
            "mass_matrix": lambda: [_rows(self._mass_matrix())],
            "bias": lambda: [ca.vertcat(*self._newton_euler(None))],
            "dynamics": lambda: [_rows(self._mass_matrix()), ca.vertcat(*self._newton_euler(None))],
            "inverse_dynamics": lambda: [ca.vertcat(*self._newton_euler(self.a))],
            "forward_dynamics": lambda: [ca.vertcat(*self._articulated())],
            "frame_jacobian": lambda: [_rows(self._jacobian(body))],
            "inverse_dynamics_derivatives": lambda: [ca.vec(slope.T) for slope in self._inverse_slopes(self.a)],
            "forward_dynamics_derivatives": self._forward_slopes,
        }  # fmt: skip
        found = ca.cse([ca.densify(result) for result in results[name]()])
        return ca.Function(name, [self.q, self.v, self.a, self.tau], found)

    def _inverse_slopes(self, rates: Any) -> list[Any]:
        tau = ca.vertcat(*self._newton_euler(self.a))
        slopes = [ca.jacobian(tau, x) for x in (self.q, self.v)]
        return list(ca.substitute(slopes, [self.a], [rates]))

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
        n, f = _shifted(link, n, f)
        i = link.parent


def _rows(A: Matrix) -> Any:
    return ca.vertcat(*(entry for row in A for entry in row))


def _shifted(link: Link, n: Vector, f: Vector) -> Motion:
    """A wrench about the body's origin, about the parent's, in its axes."""
    f = times(link.R, f)
    return add(times(link.R, n), cross(link.p, f)), f


def _composed(onto: tuple[Scalar, Vector, Matrix], link: Link, body: tuple[Scalar, Vector, Matrix]) -> Any:
    """A parent's composite body with a child's added."""
    m, mc, J = body
    h, p = times(link.R, mc), link.p
    J = turned(link.R, J)
    far = 2.0 * dot(p, h) + m * dot(p, p)
    J = plus(J, symmetric(lambda i, j: (far if i == j else 0.0) - p[i] * h[j] - h[i] * p[j] - m * p[i] * p[j]))
    return onto[0] + m, add(onto[1], h, scale(m, p)), plus(onto[2], J)


def _moved(link: Link, J: Matrix, H: Matrix, K: Matrix) -> tuple[Matrix, Matrix, Matrix]:
    """An articulated inertia (n = J w' + H a, f = H^T w' + K a) about the parent's origin, in its axes."""
    R, P = link.R, skew(link.p)
    J, H, K = turned(R, J), product(product(R, H), transposed(R)), turned(R, K)
    shifted = plus(H, product(P, K))
    HP, PH = product(H, P), product(P, transposed(shifted))
    return symmetric(lambda i, j: J[i][j] - HP[i][j] + PH[i][j]), shifted, K


def _joined(a: tuple[Matrix, Matrix, Matrix], b: tuple[Matrix, Matrix, Matrix]) -> tuple[Matrix, Matrix, Matrix]:
    return plus(a[0], b[0]), plus(a[1], b[1]), plus(a[2], b[2])


def operations(function: Any) -> Mapping[str, int]:
    """How many operations of each kind one evaluation of a CasADi function takes."""
    kinds = {ca.OP_ADD: "add", ca.OP_SUB: "add", ca.OP_TWICE: "add", ca.OP_MUL: "mul", ca.OP_SQ: "mul",
             ca.OP_DIV: "div", ca.OP_INV: "div", ca.OP_SIN: "call", ca.OP_COS: "call"}  # fmt: skip
    found = dict.fromkeys(("mul", "add", "div", "call"), 0)
    for k in range(function.n_instructions()):
        kind = kinds.get(function.instruction_id(k))
        if kind is not None:
            found[kind] += 1
    return found


def c_text(function: Any) -> str:
    """CasADi's C of a function."""
    generator = ca.CodeGenerator(f"{function.name()}.c", {"with_header": False})
    generator.add(function)
    return str(generator.dump())


def work_sizes(function: Any) -> tuple[int, int]:
    """Of the integers and of the doubles that its C works with."""
    return int(function.sz_iw()), int(function.sz_w())
