"""Truth of MuJoCo's soft limits, dry friction and floors: rows J of one number ("Constraint model" of its manual).

With A the inverse of M where nothing has moved, a row has the reference acceleration and the regulariser

    aref = -b J v - k d r,    R = (1 - d) / d w,    w = J A J^T,    b = 2 / (d1 t),    k = 1 / (d1 t)^2           (1)

where t is 0.02 s and r what a limit is passed by, negative; of friction k is zero. By the defaults of solimp,

    d = d0 + (d1 - d0) y(|r| / 1 mm),    y = 2 x^2 up to x = 1/2, 1 - 2 (1 - x)^2 up to 1, then 1                 (2)

with d0 = 0.9 and d1 = 0.95. A floor without friction is a limit of a ball's height; its w is the mean of the three
entries on the diagonal of J A J^T, with the Jacobian of the mass centre of the ball's link.
Forces f = -(J a - aref) / R act along J: of limits none that pull, of friction none beyond its bound.
"""

from __future__ import annotations

from decimal import Decimal
from itertools import product
from typing import NamedTuple

import numpy as np

from ...interface import End
from ..arithmetic import Exact, exact, eye, solve, zeros
from ..dynamics import Point, Truth

_FIRST, _LAST, _TIME, _WIDTH = (exact(x)[()] for x in (0.9, 0.95, 0.02, 0.001))


class _Row(NamedTuple):
    """A row: its Jacobian (nv), weight w, what it is off by, bound of its force (0: none), number of its floor (-1)."""

    J: Exact
    weight: Exact
    off: Exact
    bound: Exact
    floor: int = -1


def _rows(truth: Truth, q: Exact) -> list[_Row]:
    """Friction of joints and of tendons, then limits that are passed, of joints and of tendons, then floors."""
    unit, start, none = eye(truth.nv), 0 * q, Decimal(0)
    A = truth.inverse(start)
    own, tendons = truth.own, truth.tree.tendons
    lines = list(zip(tendons, own.lines(q), own.lines(start), strict=True))
    rows = [_Row(unit[k], A[k, k], none, bound) for k, bound in enumerate(own.friction) if bound]
    rows += [_Row(J, J_0 @ A @ J_0, none, exact(one.friction)[()]) for one, (_, J), (_, J_0) in lines if one.friction]
    limited = [(q[k], unit[k], unit[k], limits) for k, limits in enumerate(own.ranges) if any(limits)]
    limited += [(length, J, J_0, exact(one.limits)) for one, (length, J), (_, J_0) in lines if one.limits]
    for place, J, J_0, (least, greatest) in limited:
        rows += [_Row(J, J_0 @ A @ J_0, place - least, none)] if place < least else []
        rows += [_Row(-J, J_0 @ A @ J_0, greatest - place, none)] if place > greatest else []
    links = {link.name: link for link in truth.tree.links}
    for number, one in enumerate(truth.tree.constraints):
        (end,), (radius, height) = one.ends, exact(one.coefficients)
        _, centre, J = truth.kinematics.held(q, end)
        middle = truth.kinematics.held(start, End(end.link, p=links[end.link].com)).J[:3]
        if centre[2] < radius + height:
            weight = np.trace(middle @ A @ middle.T) / 3
            rows.append(_Row(J[2], weight, centre[2] - radius - height, none, number))
    return rows


def _solved(truth: Truth, s: Point) -> tuple[Exact, Exact]:
    """Accelerations (nv) and forces of the rows (n) that (1) makes: the only ones whose signs and bounds agree.

    Raises:
        ZeroDivisionError: There are none.
    """

    def compute() -> Exact:
        rows = _rows(truth, s.q)
        free = s.tau + truth.own.applied(s.q, s.v) - truth.h(s.q, s.v)
        M = truth.M(s.q)
        softness, wanted = [], []
        for row in rows:
            x = min(abs(row.off) / _WIDTH, Decimal(1))
            shape = 2 * x * x if 2 * x <= 1 else 1 - 2 * (1 - x) * (1 - x)
            d = _FIRST + (_LAST - _FIRST) * shape
            softness.append((1 - d) / d * row.weight)
            wanted.append(-2 / (_LAST * _TIME) * (row.J @ s.v) - d * row.off / (_LAST * _TIME) ** 2)
        for ways in product((0, 1, -1), repeat=len(rows)):
            left, right = M, free
            for row, R, aref, way in zip(rows, softness, wanted, ways, strict=True):
                left = left + (np.outer(row.J, row.J) / R if not way else 0)
                right = right + row.J * (aref / R if not way else way * row.bound)
            a = solve(left, right)
            forces = zeros(len(rows))
            agreed = True
            for k, (row, R, aref, way) in enumerate(zip(rows, softness, wanted, ways, strict=True)):
                f = -(row.J @ a - aref) / R
                forces[k] = f if not way else way * row.bound
                inner = f >= 0 if not row.bound else abs(f) <= row.bound
                agreed &= inner if not way else f <= 0 if not row.bound else way * f >= row.bound
            if agreed:
                return np.concatenate([a, forces])
        raise ZeroDivisionError("no forces of rows agree")

    whole = truth.once(("soft", *s.q, *s.v, *s.tau), compute)
    return whole[: truth.nv], whole[truth.nv :]


def acceleration(truth: Truth, s: Point) -> Exact:
    """Accelerations (nv)."""
    return _solved(truth, s)[0]


def forces(truth: Truth, s: Point) -> Exact:
    """What the rows do along the speeds (nv)."""
    rows = _rows(truth, s.q)
    return sum((row.J * f for row, f in zip(rows, _solved(truth, s)[1], strict=True)), zeros(truth.nv))


def floor_forces(truth: Truth, s: Point) -> Exact:
    """What each floor does to its ball (n).

    Raises:
        ZeroDivisionError: There are none.
    """
    if not truth.tree.constraints:
        raise ZeroDivisionError("no floors")
    total = zeros(len(truth.tree.constraints))
    for row, f in zip(_rows(truth, s.q), _solved(truth, s)[1], strict=True):
        if row.floor >= 0:
            total[row.floor] = f
    return total
