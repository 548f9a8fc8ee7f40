"""Constraint dynamics in many digits: M a + h = tau + J^T f and J a + J' v = 0, impacts, and what derives from them.

Jacobians and forces stand along the axes of a constraint's first frame: J v is the velocity of the first frame against
the second, linear, then angular; f acts on the link of the first.
"""

from __future__ import annotations

import math
from decimal import Decimal
from typing import NamedTuple

import numpy as np

from ..interface import STEP, Array, Constraint, HasLayout, State, Tree, Unsupported
from .arithmetic import Exact, exact, eye, many_digits, root, skew, solve, zeros
from .dynamics import Point, Truth, digits, random_state
from .kinematics import Kinematics

# Rows whose part that is free of the others is smaller than this, as part of the largest, are taken for redundant:
# what roundings of a tree's numbers leave of the zeros of a plane mechanism is smaller by far, what counts larger.
_REDUNDANT = Decimal(10) ** -20
_STEPS = 40
_CLOSED = 1e-14


class Rows(NamedTuple):
    """One constraint at a configuration.

    Attributes:
        residual: What is to be zero.
        R: Rotation whose columns are the axes that the rows stand along; None where there are none.
        J: Jacobian along world axes.
    """

    residual: Exact
    R: Exact | None
    J: Exact


def _rows(kinematics: Kinematics, q: Exact, constraint: Constraint) -> Rows:
    if constraint.kind not in ("point", "weld"):
        length, derivative = kinematics.line(q, constraint)
        return Rows(np.array([length], dtype=object), None, derivative[np.newaxis])
    first, second = (kinematics.held(q, end) for end in constraint.ends)
    apart = first.p - second.p
    if constraint.kind == "point":
        return Rows(apart, first.R, first.J[:3] - second.J[:3])
    turned = first.R.T @ second.R
    angle = np.array([turned[1, 2] - turned[2, 1], turned[2, 0] - turned[0, 2], turned[0, 1] - turned[1, 0]])
    # The second link's point is the one that now stands at the first frame: the relative motion of the two links is one
    # spatial vector, which the frames' distance has no part in.
    moved = np.concatenate([second.J[:3] - skew(apart) @ second.J[3:], second.J[3:]])
    scale = exact(constraint.torque_scale)[()]
    J = first.J - moved
    return Rows(np.concatenate([apart, scale * (first.R @ angle) / 2]), first.R, np.concatenate([J[:3], scale * J[3:]]))


def _along(R: Exact | None, rows: Exact) -> Exact:
    """Rows along world axes, three by three along those of a rotation."""
    if R is None:
        return rows
    parts = [R.T @ rows[k : k + 3] for k in range(0, len(rows), 3)]
    return np.concatenate(parts)


def residuals(t: Truth, q: Exact) -> Exact:
    """What constraints are off by (m).

    The first frame's point less the second's, along world axes; of a weld, times its scale, the vector part of the
    quaternion that turns the second frame into the first, too; lengths less those at zero.
    """
    parts = []
    for one in t.tree.constraints:
        residual = _rows(t.kinematics, q, one).residual
        if one.kind == "weld":
            first, second = (t.kinematics.held(q, end).R for end in one.ends)
            turned = second.T @ first
            spin = np.array([turned[2, 1] - turned[1, 2], turned[0, 2] - turned[2, 0], turned[1, 0] - turned[0, 1]])
            half = exact(one.torque_scale)[()] * spin / (2 * root(1 + np.trace(turned)))
            residual = np.concatenate([residual[:3], half])
        elif one.kind == "path":
            residual = residual - _at_zero(t.kinematics, one)
        parts.append(residual)
    return np.concatenate(parts)


def residual_products(t: Truth, q: Exact, v: Exact) -> Exact:
    """Second time derivative of the residuals (m), with the speeds kept: closed or not."""

    def first(at: Exact) -> Exact:
        return t.kinematics.along(lambda point: residuals(t, point), at, v)

    return t.kinematics.along(first, q, v)


def jacobian(t: Truth, q: Exact) -> Exact:
    """J (m, nv)."""
    rows = [_rows(t.kinematics, q, one) for one in t.tree.constraints]
    return np.concatenate([_along(one.R, one.J) for one in rows])


def _responses(t: Truth, q: Exact) -> Exact:
    """J, below it (M^-1 J^T)^T (2 m, nv)."""

    def both() -> Exact:
        J = jacobian(t, q)
        return np.concatenate([J, solve(t.M(q), J.T).T])

    return t.once(("responses", *q), both)


def products(t: Truth, q: Exact, v: Exact) -> Exact:
    """What is left of the constraints' accelerations at a = 0 (m), along the same axes.

    With J v = 0 there is one answer, J' v. Derivatives look beyond: there points have the difference of their
    accelerations, welds the rate of the components of J v, as Pinocchio has them in LOCAL frames.
    """
    parts = []
    for one in t.tree.constraints:
        R = _rows(t.kinematics, q, one).R if one.kind == "point" else None

        def velocity(point: Exact, one: Constraint = one) -> Exact:
            rows = _rows(t.kinematics, point, one)
            return _along(rows.R if one.kind == "weld" else None, rows.J) @ v

        parts.append(_along(R, t.kinematics.along(velocity, q, v)))
    return np.concatenate(parts)


def delassus_inverse(t: Truth, q: Exact, damping: float = 0.0) -> Exact:
    """(J M^-1 J^T + damping)^-1 (m, m)."""
    A = delassus(t, q)
    return solve(A + exact(damping)[()] * eye(len(A)), eye(len(A)))


def delassus(t: Truth, q: Exact) -> Exact:
    """J M^-1 J^T (m, m)."""
    J, response = np.split(_responses(t, q), 2)
    return J @ response.T


def _independent(matrix: Exact) -> list[int]:
    """Rows of a symmetric matrix that the others don't imply, by elimination with the largest pivot first."""
    rest = np.array(matrix)
    largest = max(abs(rest[k, k]) for k in range(len(rest)))
    chosen: list[int] = []
    while len(chosen) < len(rest):
        pivot = max((k for k in range(len(rest)) if k not in chosen), key=lambda k: abs(rest[k, k]))
        if abs(rest[pivot, pivot]) <= _REDUNDANT * largest:
            break
        chosen.append(pivot)
        rest = rest - np.outer(rest[:, pivot], rest[pivot]) / rest[pivot, pivot]
    return sorted(chosen)


def _bound(t: Truth, q: Exact, free: Exact, wanted: Exact) -> tuple[Exact, Exact | None]:
    """Rates a with J a = wanted that are nearest to free ones in the metric of M, and the forces that make them so.

    Forces are None where rows are redundant: many do the same.
    """
    J, response = np.split(_responses(t, q), 2)
    A = J @ response.T
    rows = _independent(A)
    f = solve(A[np.ix_(rows, rows)], wanted[rows] - J[rows] @ free)
    return free + f @ response[rows], f if len(rows) == len(A) else None


def motion(t: Truth, q: Exact, v: Exact, tau: Exact) -> tuple[Exact, Exact | None]:
    """Accelerations and forces of constraint dynamics."""
    wanted = t.once(("products", *q, *v), lambda: -products(t, q, v))
    return _bound(t, q, t.FD(q, v, tau), wanted)


def acceleration(t: Truth, q: Exact, v: Exact, tau: Exact) -> Exact:
    """Accelerations (nv)."""
    return motion(t, q, v, tau)[0]


def forces(t: Truth, q: Exact, v: Exact, tau: Exact) -> Exact:
    """Forces (m).

    Raises:
        ZeroDivisionError: Rows are redundant.
    """
    return _unique(motion(t, q, v, tau)[1])


def _unique(f: Exact | None) -> Exact:
    if f is None:
        raise ZeroDivisionError("the constraints are redundant: their forces are not determined")
    return f


def after_impact(t: Truth, q: Exact, v: Exact, restitution: Exact) -> Exact:
    """Speeds after the constraints have struck: J v+ = -e J v."""
    return _bound(t, q, v, -restitution * (jacobian(t, q) @ v))[0]


def after_step(t: Truth, s: Point) -> Exact:
    """Speeds after a step of `STEP` from q and v2 under tau, at whose end J(q) v+ = 0 (docs/engines.md, (5))."""
    free = s.v2 + exact(STEP)[()] * t.FD(s.q, s.v2, s.tau)
    return after_impact(t, s.q, free, exact(0.0)[()])


def impulses(t: Truth, q: Exact, v: Exact) -> Exact:
    """Impulses (m) of a strike without rebound.

    Raises:
        ZeroDivisionError: Rows are redundant.
    """
    return _unique(_bound(t, q, v, 0 * (jacobian(t, q) @ v))[1])


def kkt_inverse(t: Truth, s: Point) -> Exact:
    """The inverse of [[M, J^T], [J, 0]] (nv + m, nv + m)."""
    J = jacobian(t, s.q)
    whole = np.block([[t.M(s.q), J.T], [J, zeros(len(J), len(J))]])
    return solve(whole, eye(len(whole)))


def closed(tree: Tree, model: HasLayout, state: State, restarts: int = 20) -> State | Unsupported:
    """A state near a given one, or another random one, that satisfies the constraints: by Gauss' and Newton's steps.

    What is left of a residual is rounding, as in an engine's own state.

    Args:
        tree: The tree.
        model: Says how an engine keeps its joints.
        state: State to begin at.
        restarts: Random states to begin at where that one leads nowhere.
    """
    kinematics = Kinematics(tree, model)
    for seed in range(-1, restarts):
        q = _closed_from(kinematics, np.array(state.q if seed < 0 else random_state(tree, model, seed).q))
        if q is not None:
            _, J = _linear(kinematics, q)
            v = state.v - np.linalg.pinv(J, rcond=1e-9) @ J @ state.v
            return State(q, v, state.a, state.tau, state.v2, state.q2)
    return Unsupported("the loops can't be closed", offered=False)


def _closed_from(kinematics: Kinematics, q: Array) -> Array | None:
    best = np.inf
    for step_number in range(_STEPS):
        residual, J = _linear(kinematics, q)
        error = float(np.max(np.abs(residual)))
        if error < _CLOSED:
            return q
        if step_number % 5 == 4:
            if error > best / 2:
                return None
            best = error
        step = -np.linalg.pinv(J, rcond=1e-6) @ residual
        longest = float(np.max(np.abs(step)))
        if not longest:
            return None
        step *= min(1.0, 0.5 / longest)
        with many_digits():
            q = _on_manifold(kinematics, digits(exact(q) + kinematics.rates(exact(q)) @ exact(step)))
    return None


def _linear(kinematics: Kinematics, q: Array) -> tuple[Array, Array]:
    with many_digits():
        rows = [_rows(kinematics, exact(q), one) for one in kinematics.tree.constraints]
        start = [_at_zero(kinematics, one) for one in kinematics.tree.constraints]
    residual = np.concatenate([digits(one.residual - at) for one, at in zip(rows, start, strict=True)])
    return residual, np.concatenate([digits(one.J) for one in rows])


def _at_zero(kinematics: Kinematics, constraint: Constraint) -> Exact:
    """What the residual is to be: the length of a path with all coordinates zero, nothing of others."""
    if constraint.kind != "path":
        return exact(0.0)
    return _rows(kinematics, zeros(kinematics.nq), constraint).residual


def _on_manifold(kinematics: Kinematics, q: Array) -> Array:
    """Unit quaternions, cosines and sines at unit length again."""
    for slots in kinematics.slots:
        for slot in slots:
            places = list(slot.q)
            if "cos sin" in slot.chart:
                unit = places[-2:]
            elif "quaternion first" in slot.chart:
                unit = places[:4]
            elif len(places) in (4, 7):
                unit = places[-4:]
            else:
                continue
            q[unit] /= math.hypot(*q[unit])
    return q
