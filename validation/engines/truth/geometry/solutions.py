"""Truth of what packages solve: with B of the rows v, a, v2, the positive definite A = B B^T + 1 and the vector tau."""

from __future__ import annotations

from decimal import Decimal
from itertools import product

import numpy as np

from ..arithmetic import Exact, eye, solve
from ..dynamics import Point, Truth

# Bound of each unknown, either way.
BOX = 0.125


def _matrix(s: Point) -> Exact:
    B = np.array([s.v, s.a, s.v2])
    return B @ B.T + eye(3)


def unbounded(truth: Truth, s: Point) -> Exact:
    """A x = tau (3)."""
    return solve(_matrix(s), s.tau)


def bounded(truth: Truth, s: Point) -> Exact:
    """The x within the box (3) at which x^T A x / 2 - tau^T x is least: no force of a bound pulls."""
    A, box = _matrix(s), Decimal(BOX)
    for sides in product((0, 1, -1), repeat=3):
        x = np.array([side * box for side in sides], dtype=object)
        free = [k for k, side in enumerate(sides) if not side]
        if free:
            x[free] = solve(A[np.ix_(free, free)], (s.tau - A @ x)[free])
        pull = A @ x - s.tau
        if all(abs(x[k]) <= box if not side else side * pull[k] <= 0 for k, side in enumerate(sides)):
            return x
    raise ZeroDivisionError("no minimum agrees")
