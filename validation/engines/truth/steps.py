"""One step of integrators, in many digits: coordinates and speeds after a step from q and v, under constant tau.

With h the step, q (+) u the configuration where q' = N(q) u leads in unit time, f = tau + Q - (bias) and D = -dQ/dv,
K = -dQ/dq (`forces`):

    semi-implicit       v+ = v + h (M + h D)^-1 f,            q+ = q (+) h v+
    implicit            the same with D = -df/dv
    stiffness implicit  v+ = v + h (M + h D + h^2 K)^-1 (f - h K v)
    trapezoidal         q+ = q + h (v + v+) / 2, v+ = v + h (a + a+) / 2 with the accelerations at both ends
    Runge-Kutta         stages of (N v, M^-1 f) in coordinates; or, on the manifold (Munthe-Kaas), of the displacement u
                        with q = q0 (+) u, whose rate is that which makes the velocity v
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Literal

import numpy as np

from ..interface import STEP
from . import displacements
from .arithmetic import Exact, eye, rate, root, solve, stack, zeros
from .derived import TruthOf
from .displacements import to_tangent
from .dynamics import Point, Truth

_H = Decimal(STEP)
# What short displacements take for 25 digits.
_ROWS, _SHORT = 5, Decimal("0.05")
# Newton's steps, of which each doubles the digits.
_ITERATIONS, _SETTLED = 12, Decimal(10) ** -25
Implicit = Literal["nothing", "dampers", "forces", "velocities", "stiffness", "discrete"]


def single(implicit: Implicit, move: Callable[[Truth, Exact, Exact], Exact] | None = None) -> TruthOf:
    """A step of Euler's kind (nq + nv): speeds first, then coordinates by the new speeds.

    Args:
        implicit: What is taken at the end of the step, to first order: "nothing"; "dampers" of joints; "forces", Q by
            v; "velocities", Q and the bias by v; "stiffness", Q by v and by lengths; "discrete" is that and,
            as is "forces", the bias by v of free bodies that carry nothing.
        move: Configuration that a displacement leads to, where it is not q (+) u.
    """

    def function(t: Truth, s: Point) -> Exact:
        f = s.tau + t.own.applied(s.q, s.v) - t.h(s.q, s.v)
        D, K = _metrics(t, s, implicit)
        v = s.v + _H * solve(t.M(s.q) + _H * D + _H * _H * K, f - _H * K @ s.v)
        return np.concatenate([(move or along)(t, s.q, _H * v), v])

    return function


def derivative(step: TruthOf) -> TruthOf:
    """The derivative (2 nv, 2 nv) of where a step leads by where it begins, both along speeds."""

    def function(t: Truth, s: Point) -> Exact:
        by_q = t.kinematics.tangent(lambda q: step(t, s._replace(q=q)), s.q)
        by_v = t.along_speeds(lambda v: step(t, s._replace(v=v)), s.v)
        return _along_speeds(t, step(t, s), np.concatenate([by_q, by_v], axis=1))

    return function


def by_controls(step: TruthOf) -> TruthOf:
    """The derivative (2 nv, nu) of where a step leads, along speeds, by the actuators' controls."""
    forces = by_forces(step)
    return lambda t, s: forces(t, s) @ t.own.by_controls(s.q, s.v)


def by_forces(step: TruthOf) -> TruthOf:
    """The derivative (2 nv, nv) of where a step leads, along speeds, by constant forces along the speeds."""

    def function(t: Truth, s: Point) -> Exact:
        return _along_speeds(t, step(t, s), t.along_speeds(lambda tau: step(t, s._replace(tau=tau)), s.tau))

    return function


def _along_speeds(t: Truth, end: Exact, columns: Exact) -> Exact:
    """Derivatives of the coordinates and speeds after a step, with coordinates along speeds (2 nv, n)."""
    nq = len(end) - t.nv
    return np.concatenate([to_tangent(t, end[:nq], columns[:nq]), columns[nq:]])


def along(t: Truth, q: Exact, u: Exact) -> Exact:
    """The configuration q (+) u."""
    return displacements.integrated(t, q, u, _ROWS if max(map(abs, u)) < _SHORT else displacements.ROWS)


def straight(t: Truth, q: Exact, u: Exact) -> Exact:
    """Coordinates q + N(q) u, which leave the manifold of quaternions."""
    return q + t.kinematics.rates(q) @ u


def normalized(t: Truth, q: Exact, u: Exact) -> Exact:
    """Coordinates q + N(q) u, of which the quaternions of balls are brought back to their manifold."""
    end = straight(t, q, u)
    for slot in (slot for own in t.kinematics.slots for slot in own):
        if "quaternion" in slot.chart and len(slot.q) == 4:
            places = list(slot.q)
            end[places] = end[places] / root(end[places] @ end[places])
    return end


def _metrics(t: Truth, s: Point, implicit: Implicit) -> tuple[Exact, Exact]:
    """D and K (nv, nv) of a step."""
    if implicit in ("nothing", "dampers"):
        return np.diag((implicit == "dampers") * t.own.damping), zeros(t.nv, t.nv)
    D, K = t.own.metrics(s.q, s.v)
    if implicit == "velocities":
        D = D + _turning(t, s)
    elif implicit != "stiffness" and (lone := _lone_bodies(t)):
        D[lone] = D[lone] + _turning(t, s)[lone]
    return D, K if implicit in ("stiffness", "discrete") else 0 * K


def _turning(t: Truth, s: Point) -> Exact:
    """The derivative by v of the links' part of the bias (nv, nv)."""
    return t.along_speeds(lambda v: t.of_links(s.q, v, zeros(t.nv)), s.v)


def _lone_bodies(t: Truth) -> list[int]:
    """Speeds of bodies that are free in the world and carry nothing that moves."""
    slots, links = t.kinematics.slots, t.tree.links
    carrying = {link.parent for link, own in zip(links, slots, strict=True) if own}
    for k in reversed(range(len(links))):
        if k in carrying:
            carrying.add(links[k].parent)
    free = [
        k
        for k, link in enumerate(links)
        if link.parent < 0 and k not in carrying and [joint.kind for joint in link.joints] == ["free"]
    ]
    return [place for k in free for place in slots[k][0].v]


@dataclass(frozen=True)
class Tableau:
    """Coefficients of an explicit Runge-Kutta method.

    Attributes:
        stages: For each stage but the first, the weights of the rates before it.
        last: Weights of all rates in the step.
    """

    stages: tuple[tuple[Fraction, ...], ...]
    last: tuple[Fraction, ...]


def _tableau(text: str) -> Tableau:
    """Rows of fractions, the last of which is that of the step."""
    *stages, last = (tuple(map(Fraction, row.split())) for row in text.split(";"))
    return Tableau(tuple(stages), last)


EULER = _tableau("1")
MIDPOINT = _tableau("1/2; 0 1")
HEUN = _tableau("1; 1/2 1/2")
THIRD = _tableau("1/2; -1 2; 1/6 4/6 1/6")
CLASSICAL = _tableau("1/2; 0 1/2; 0 0 1; 1/6 2/6 2/6 1/6")


def runge_kutta(tableau: Tableau, on_manifold: bool = False) -> TruthOf:
    """A step of a Runge-Kutta method (nq + nv), in coordinates or of displacements on their manifold."""

    def function(t: Truth, s: Point) -> Exact:
        moves: list[Exact] = []
        accelerations: list[Exact] = []
        for weights in ((), *tableau.stages):
            u, v = _sum(weights, moves, t.nv if on_manifold else len(s.q)), s.v + _sum(weights, accelerations, t.nv)
            q = along(t, s.q, u) if on_manifold else s.q + u
            moves.append(_displacement_rate(t, s.q, u, q, v) if on_manifold else t.kinematics.rates(q) @ v)
            accelerations.append(t.FD(q, v, s.tau))
        u = _sum(tableau.last, moves, len(moves[0]))
        end = along(t, s.q, u) if on_manifold else s.q + u
        return np.concatenate([end, s.v + _sum(tableau.last, accelerations, t.nv)])

    return function


def trapezoidal(t: Truth, s: Point) -> Exact:
    """A step (nq + nv) of the trapezoidal rule, by Newton's method; speeds are the rates of coordinates.

    Raises:
        ZeroDivisionError: Accelerations change so much in a step that its equation may have several roots.
    """
    before, v = t.FD(s.q, s.v, s.tau), s.v

    def end(v: Exact) -> Exact:
        return s.q + _H / 2 * (s.v + v)

    def excess(v: Exact) -> Exact:
        return v - s.v - _H / 2 * (before + t.FD(end(v), v, s.tau))

    for _ in range(_ITERATIONS):
        derivative = t.along_speeds(excess, v)
        # The equation is v = F(v): with |dF/dv| < 1/2 there is one root.
        if np.max(np.abs(derivative - eye(t.nv)).sum(axis=1)) > Decimal("0.5"):
            raise ZeroDivisionError("the step is too long for its equation to have one root")
        change = solve(derivative, excess(v))
        v = v - change
        if max(map(abs, change)) < _SETTLED:
            break
    return np.concatenate([end(v), v])


def _displacement_rate(t: Truth, q: Exact, u: Exact, end: Exact, v: Exact) -> Exact:
    """Rate of u (nv) as q (+) u, which is `end`, moves with speeds v."""
    curved, moved = t.kinematics.curved, np.array(v)
    if curved and any(u):
        columns = stack([rate(lambda one: along(t, q, one), u, eye(t.nv)[k]) for k in curved])
        moved[curved] = solve(to_tangent(t, end, columns)[curved], v[curved])
    return moved


def _sum(weights: Sequence[Fraction], rates: Sequence[Exact], size: int) -> Exact:
    """The step times a sum of rates."""
    total = zeros(size)
    for weight, one in zip(weights, rates, strict=False):
        total = total + _H * weight.numerator / weight.denominator * one
    return total
