"""Curves through samples in many digits: polynomials in pieces, of Bernstein and of B-splines, turns, placements.

Samples are v, a, tau, v2 at BREAKS; t = 3/2 + 5/4 w0 / (1 + |w0|) with w = v2 is where a curve is asked for. A piece
from x0 to x1 in the time h, with the slopes s0, s1 at its ends, is at the part z of it

    x = x0 (1 + 2 z) (1 - z)^2 + x1 z^2 (3 - 2 z) + h s0 z (1 - z)^2 - h s1 z^2 (1 - z)                           (1)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from decimal import Decimal

import numpy as np

from ..arithmetic import Exact, exact, rate, solve, zeros
from ..derived import TruthOf
from ..dynamics import Point, Truth
from .turns import rotation_vector, turn, turned_by

BREAKS = (0.0, 1.0, 2.25, 3.0)
# Knots of B-splines of order 3 with four control points; those of the ends are not all equal.
ORDER, KNOTS = 3, (-0.5, 0.0, 0.25, 1.25, 3.0, 3.5, 4.0)
_HALF = Decimal("0.5")
Curve = Callable[[Exact, Decimal], Exact]


def time(s: Point) -> Decimal:
    """Time (1) within the breaks."""
    return Decimal(Decimal(3) / 2 + Decimal("1.25") * s.v2[0] / (1 + abs(s.v2[0])))


def samples(s: Point) -> Exact:
    """Samples (4, 3)."""
    return np.array([s.v, s.a, s.tau, s.v2])


def _breaks() -> Exact:
    return exact(BREAKS)


def _piece(t: Decimal) -> int:
    """The piece that a time is in."""
    return int(sum(t >= one for one in _breaks()[1:-1]))


def hermite(x: Exact, slopes: Exact, t: Decimal) -> Exact:
    """The curve (1) at a time (3)."""
    k, breaks = _piece(t), _breaks()
    h = breaks[k + 1] - breaks[k]
    z = (t - breaks[k]) / h
    ends = x[k] * (1 + 2 * z) * (1 - z) ** 2 + x[k + 1] * z**2 * (3 - 2 * z)
    return ends + h * (slopes[k] * z * (1 - z) ** 2 - slopes[k + 1] * z**2 * (1 - z))


def _held(x: Exact, t: Decimal) -> Exact:
    return x[_piece(t)]


def _straight(x: Exact, t: Decimal) -> Exact:
    k, breaks = _piece(t), _breaks()
    return x[k] + (x[k + 1] - x[k]) * (t - breaks[k]) / (breaks[k + 1] - breaks[k])


def _lagrange(x: Exact, t: Decimal) -> Exact:
    total, breaks = zeros(3), _breaks()
    for k, one in enumerate(breaks):
        others = [other for other in breaks if other != one]
        weight = Decimal(1)
        for other in others:
            weight *= (t - other) / (one - other)
        total = total + weight * x[k]
    return total


def _smooth(x: Exact, first: Sequence[Exact], last: Sequence[Exact]) -> Exact:
    """Slopes (4, 3) with which (1) has second derivatives that are continuous, and a first and a last condition.

    Args:
        x: Samples.
        first: Row (4) of the unknown slopes, and its right-hand side (3).
        last: The same of the last condition.
    """
    h = np.diff(_breaks())
    rows, right = zeros(4, 4), zeros(4, 3)
    rows[0], right[0] = first
    rows[3], right[3] = last
    for k in (1, 2):
        rows[k, k - 1 : k + 2] = [1 / h[k - 1], 2 / h[k - 1] + 2 / h[k], 1 / h[k]]
        right[k] = 3 * ((x[k] - x[k - 1]) / h[k - 1] ** 2 + (x[k + 1] - x[k]) / h[k] ** 2)
    return solve(rows, right)


def _unit(k: int) -> Exact:
    row = zeros(4)
    row[k] = Decimal(1)
    return row


def _third(x: Exact, k: int) -> tuple[Exact, Exact]:
    """Row of the slopes and right-hand side of: third derivatives of the pieces k and k + 1 are equal.

    Of (1) it is 6 (2 (x0 - x1) / h + s0 + s1) / h^2.
    """
    h, row = np.diff(_breaks()), zeros(4)
    row[k : k + 3] = [1 / h[k] ** 2, 1 / h[k] ** 2 - 1 / h[k + 1] ** 2, -1 / h[k + 1] ** 2]
    return row, 2 * ((x[k + 1] - x[k]) / h[k] ** 3 - (x[k + 2] - x[k + 1]) / h[k + 1] ** 3)


def _of_end_speeds(x: Exact, t: Decimal) -> Exact:
    """The speeds at the ends are those samples that are at the other end."""
    return hermite(x, _smooth(x, (_unit(0), x[3]), (_unit(3), x[0])), t)


def _of_no_knots(x: Exact, t: Decimal) -> Exact:
    """The third derivatives of the first two pieces are equal, and those of the last two."""
    return hermite(x, _smooth(x, _third(x, 0), _third(x, 1)), t)


def _of_slopes(x: Exact, t: Decimal) -> Exact:
    """The slopes are the samples in reverse."""
    return hermite(x, x[::-1], t)


def _bernstein(x: Exact, t: Decimal) -> Exact:
    """A curve with these control points from BREAKS[0] to BREAKS[-1]: straight lines between, again and again."""
    z = (t - _breaks()[0]) / (_breaks()[-1] - _breaks()[0])
    rows = list(x)
    while len(rows) > 1:
        rows = [one + z * (other - one) for one, other in zip(rows[:-1], rows[1:], strict=True)]
    return rows[0]


def _weight(k: int, order: int, t: Decimal) -> Decimal:
    """Basis function of a B-spline (Cox and de Boor)."""
    knots = exact(KNOTS)
    if order == 1:
        return Decimal(int(knots[k] <= t < knots[k + 1]))
    rising = (t - knots[k]) / (knots[k + order - 1] - knots[k])
    falling = (knots[k + order] - t) / (knots[k + order] - knots[k + 1])
    return Decimal(rising * _weight(k, order - 1, t) + falling * _weight(k + 1, order - 1, t))


def _span(t: Decimal) -> Decimal:
    """The time within the knots that all basis functions are there between."""
    low, high = exact(KNOTS)[[ORDER - 1, -ORDER]]
    return Decimal(low + (high - low) * t / 3)


def _spline(x: Exact, t: Decimal) -> Exact:
    return sum(_weight(k, ORDER, _span(t)) * x[k] for k in range(4))


CURVES: dict[str, Curve] = {
    "held": _held,
    "straight": _straight,
    "lagrange": _lagrange,
    "hermite": _of_slopes,
    "of_end_speeds": _of_end_speeds,
    "without_knots": _of_no_knots,
    "bernstein": _bernstein,
    "spline": _spline,
}


def value(name: str) -> TruthOf:
    """A curve at t (3)."""
    return lambda t, s: CURVES[name](samples(s), time(s))


def _rate(of: Curve, x: Exact, t: Decimal) -> Exact:
    return rate(lambda z: of(x, z[0]), np.array([t]), np.array([Decimal(1)]))


def speed(name: str) -> TruthOf:
    """First derivative of a curve at t (3)."""
    return lambda t, s: _rate(CURVES[name], samples(s), time(s))


def bend(name: str) -> TruthOf:
    """Second derivative of a curve at t (3)."""
    return lambda t, s: _rate(lambda x, z: _rate(CURVES[name], x, z), samples(s), time(s))


def _between(x: Exact, k: int, t: Decimal) -> Exact:
    breaks = _breaks()
    return x[k] + (x[k + 1] - x[k]) * (t - breaks[k]) / (breaks[k + 1] - breaks[k])


def backwards(t: Truth, s: Point) -> Exact:
    """The curve `hermite` at BREAKS[-1] - t / 2 (3)."""
    return _of_slopes(samples(s), _breaks()[-1] - time(s) / 2)


def _turning(t: Truth, s: Point) -> tuple[Exact, Exact]:
    """The rotation at t on the way from R at BREAKS[0] by Q at BREAKS[1] to R Q at BREAKS[2], its angular velocity."""
    R, Q = turn(t, s.q), turn(t, s.q2)
    stops, breaks, now = (R, Q, R @ Q), _breaks(), min(time(s), _breaks()[2])
    k = int(now >= breaks[1])
    vector, h = rotation_vector(stops[k].T @ stops[k + 1]), breaks[k + 1] - breaks[k]
    return stops[k] @ turned_by(vector * (now - breaks[k]) / h), stops[k] @ vector / h


def orientation(t: Truth, s: Point) -> Exact:
    """Rows of that rotation (9)."""
    return _turning(t, s)[0].reshape(9)


def turning(t: Truth, s: Point) -> Exact:
    """Angular velocity of the orientation at t (3)."""
    return _turning(t, s)[1]


def _place(s: Point) -> Exact:
    x, breaks, now = samples(s), _breaks(), min(time(s), _breaks()[2])
    k = int(now >= breaks[1])
    return np.array([_between(x, k, now), (x[k + 1] - x[k]) / (breaks[k + 1] - breaks[k])])


def pose(t: Truth, s: Point) -> Exact:
    """Position on straight pieces and that rotation (12)."""
    return np.concatenate([_place(s)[0], orientation(t, s)])


def twist(t: Truth, s: Point) -> Exact:
    """Velocity and angular velocity of the pose at t (6)."""
    return np.concatenate([_place(s)[1], turning(t, s)])


def along_path(t: Truth, s: Point) -> Exact:
    """Rate of `hermite` at the time that itself runs as z = BREAKS[-1] (t / BREAKS[-1])^2 (3)."""
    end, now = _breaks()[-1], time(s)
    return _rate(_of_slopes, samples(s), now**2 / end) * 2 * now / end


def growing(t: Truth, s: Point) -> Exact:
    """exp(t / 4) of v + the straight pieces (3): K exp(A t) alpha with K = 1, A = 1/4."""
    return (time(s) / 4).exp() * s.v + _straight(samples(s), time(s))
