"""Lines, planes and screws in many digits: X = (R, a) of the coordinates q, Y = (Q, tau) of q2, twists (v; v2).

Lines are of unit direction d and of moment c = x cross d, x any point on them. The twist (u; w) turns about a line of
moment (u - h w) / |w| with the pitch h = u.w / w.w.
"""

from __future__ import annotations

from decimal import Decimal

import numpy as np

from ..arithmetic import Exact, cross, exact, normalised, root, solve
from ..dynamics import Point, Truth
from .poses import ASIDE, AWAY, BESIDE
from .turns import turn


def _line(s: Point) -> tuple[Exact, Exact]:
    """Point and direction of the line through a along v + AWAY."""
    return s.a, normalised(s.v + exact(AWAY))


def line(t: Truth, s: Point) -> Exact:
    """Moment and direction of the line through a along u = v + AWAY (6)."""
    x, d = _line(s)
    return np.concatenate([cross(x, d), d])


def line_placed(t: Truth, s: Point) -> Exact:
    """The same of that line, given in Y, in the frame that Y is in (6)."""
    Q, (x, d) = turn(t, s.q2), _line(s)
    return np.concatenate([cross(s.tau + Q @ x, Q @ d), Q @ d])


def line_nearest(t: Truth, s: Point) -> Exact:
    """Point of that line that is the nearest to tau (3)."""
    x, d = _line(s)
    return x + d * (d @ (s.tau - x))


def line_nearest_to_origin(t: Truth, s: Point) -> Exact:
    """Point of that line that is the nearest to the origin (3)."""
    x, d = _line(s)
    return x - d * (d @ x)


def lines_apart(t: Truth, s: Point) -> Exact:
    """Distance of that line from the one through tau along v2 + ASIDE (1)."""
    (x, d), e = _line(s), s.v2 + exact(ASIDE)
    return np.array([abs((s.tau - x) @ normalised(cross(d, e)))])


def common_perpendicular(t: Truth, s: Point) -> Exact:
    """Moment and direction, that of the product of both directions, of the line that meets both at right angles (6)."""
    (x, d), e = _line(s), normalised(s.v2 + exact(ASIDE))
    n = cross(d, e)
    # Where the nearest point of the first line is: (y - x) x e . n = k n . n.
    nearest = x + d * (cross(s.tau - x, e) @ n) / (n @ n)
    return np.concatenate([cross(nearest, normalised(n)), normalised(n)])


def plane_of_points(t: Truth, s: Point) -> Exact:
    """Distance of the plane through a, a + v + AWAY and tau from the origin (1)."""
    n = cross(s.v + exact(AWAY), s.tau - s.a)
    return np.array([abs(n @ s.a) / root(n @ n)])


def plane_of_lines(t: Truth, s: Point) -> Exact:
    """Distance of the plane through a along v + AWAY and v2 + ASIDE from the origin (1)."""
    n = cross(s.v + exact(AWAY), s.v2 + exact(ASIDE))
    return np.array([abs(n @ s.a) / root(n @ n)])


def planes_meet(t: Truth, s: Point) -> Exact:
    """The point of three planes: through a, tau and v2, normal to AWAY, ASIDE and BESIDE (3)."""
    normals = exact(np.array([AWAY, ASIDE, BESIDE]))
    return solve(normals, np.array([n @ x for n, x in zip(normals, (s.a, s.tau, s.v2), strict=True)]))


def line_of_planes(t: Truth, s: Point) -> Exact:
    """Moment and direction of the line of the first two of these planes (6)."""
    first, second = exact(AWAY), exact(ASIDE)
    d = cross(first, second)
    x = cross((first @ s.a) * second - (second @ s.tau) * first, d) / (d @ d)
    return np.concatenate([cross(x, d), d]) / root(d @ d)


def line_of_plane(t: Truth, s: Point) -> Exact:
    """Where that line meets the plane through tau, normal to v2 + BESIDE (3)."""
    (x, d), n = _line(s), s.v2 + exact(BESIDE)
    return x + d * (n @ (s.tau - x)) / (n @ d)


def _screw(s: Point) -> tuple[Exact, Exact]:
    """A twist that turns: linear part a, angular part v + AWAY."""
    return s.a, s.v + exact(AWAY)


def screw_pitch(t: Truth, s: Point) -> Exact:
    """Advance of the twist (a; v + AWAY) for a radian (1)."""
    u, w = _screw(s)
    return np.array([u @ w / (w @ w)])


def screw_unit(t: Truth, s: Point) -> Exact:
    """The twist (a; v + AWAY) for a radian (6)."""
    u, w = _screw(s)
    return np.concatenate([u, w]) / root(w @ w)


def screw_unit_sliding(t: Truth, s: Point) -> Exact:
    """The twist (v + AWAY; 0) for a metre (6)."""
    _, w = _screw(s)
    return np.concatenate([normalised(w), 0 * w])


def screw_line(t: Truth, s: Point) -> Exact:
    """Moment and direction of the line that it turns about (6)."""
    u, w = _screw(s)
    size = root(w @ w)
    return np.concatenate([(u - w * (u @ w) / (w @ w)) / size, w / size])


def screw_of_line(t: Truth, s: Point) -> Exact:
    """The twist of unit angular part about that line, with the pitch 0.375 (6)."""
    x, d = _line(s)
    return np.concatenate([cross(x, d) + Decimal("0.375") * d, d])


def screw_pole(t: Truth, s: Point) -> Exact:
    """The point of that line that is the nearest to the origin (3)."""
    u, w = _screw(s)
    return cross(w, u) / (w @ w)
