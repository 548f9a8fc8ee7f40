"""Mass properties of solids by formulas, in many digits: mass, mass centre, moments about a point (10).

Sizes are x = |v| + 1/2, directions those of v2 + (8, 4, 4); densities are DENSITY.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from decimal import Decimal
from itertools import combinations

import numpy as np

from ..arithmetic import Exact, arc, exact, eye, normalised, skew, zeros
from ..derived import TruthOf
from ..dynamics import Point, Truth
from .poses import ASIDE, CENTRE, MASS, MOMENTS
from .shapes import ball_moments, box_moments, capsule_moments, cylinder_moments, ellipsoid_moments, shell_moments
from .turns import turn

DENSITY = 0.75
# Corners of a body with one dent, as multiples of the sizes along x, y, z, and its triangles: the last corner is within
# the tetrahedron of the others, which is its hull.
CORNERS = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.125, 0.125, 0.125))
DENTED = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 4), (2, 3, 4), (3, 1, 4))
HULL = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))


def sizes(s: Point) -> Exact:
    """Sizes (3)."""
    return abs(s.v) + Decimal("0.5")


def _pi() -> Decimal:
    return Decimal(arc(Decimal(-1), Decimal(0)))


def _flat(mass: Exact, centre: Exact, second: Exact) -> Exact:
    """Mass, mass centre, moments xx, yy, zz, xy, xz, yz (10)."""
    places = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    return np.array([mass, *centre, *(second[i, j] for i, j in places)], dtype=object)


def _about_z(moments: Callable[[Exact], Exact], s: Point) -> Exact:
    """Inertia (3, 3), of unit mass, of a body about z once it is along u: across + (along - across) u u^T."""
    across, _, along = moments(sizes(s))
    u = direction(s)
    return across * eye(3) + (along - across) * np.outer(u, u)


def direction(s: Point) -> Exact:
    """A direction (3) of unit length."""
    return normalised(s.v2 + exact(ASIDE))


def volume(name: str, x: Exact) -> Decimal:
    """Volume of a solid by its sizes; of a shell its surface."""
    r, length = x[0], x[1]
    volumes: dict[str, Callable[[], Decimal]] = {
        "box": lambda: x[0] * x[1] * x[2],
        "cube": lambda: r**3,
        "ellipsoid": lambda: _pi() * 4 / 3 * x[0] * x[1] * x[2],
        "ball": lambda: _pi() * 4 / 3 * r**3,
        "shell": lambda: _pi() * 4 * r**2,
        "cylinder": lambda: _pi() * r**2 * length,
        "capsule": lambda: _pi() * r**2 * (length + 4 * r / 3),
    }
    return volumes[name]()


def _cube_moments(x: Exact) -> Exact:
    return box_moments(np.array([x[0]] * 3))


_LONG: dict[str, Callable[[Exact], Exact]] = {"cylinder": cylinder_moments, "capsule": capsule_moments}
_ROUND: dict[str, Callable[[Exact], Exact]] = {
    "box": box_moments,
    "cube": _cube_moments,
    "ellipsoid": ellipsoid_moments,
    "ball": ball_moments,
    "shell": shell_moments,
}
SOLIDS = (*_ROUND, *_LONG)


def solid(name: str, has_density: bool, is_turned: bool = True) -> TruthOf:
    """A solid about its mass centre: of DENSITY or of MASS, along the direction, or along z."""

    def function(t: Truth, s: Point) -> Exact:
        x = sizes(s)
        if name in _LONG and is_turned:
            unit = _about_z(_LONG[name], s)
        else:
            unit = np.diag((_ROUND | _LONG)[name](x)) + zeros(3, 3)
        mass = Decimal(DENSITY) * volume(name, x) if has_density else Decimal(MASS)
        return _flat(mass, zeros(3), mass * unit)

    return function


def volumes(name: str) -> TruthOf:
    """Volume (1) of a solid."""
    return lambda t, s: np.array([volume(name, sizes(s))])


def _from_end(inertia: Exact, mass: Exact, arm: Exact) -> Exact:
    """Mass properties about a point that the mass centre is an arm away from."""
    return _flat(mass, arm, inertia - mass * (skew(arm) @ skew(arm)))


def cylinder_about_end(has_density: bool) -> TruthOf:
    """A cylinder about the end that its direction leads away from."""

    def function(t: Truth, s: Point) -> Exact:
        x = sizes(s)
        mass = Decimal(DENSITY) * volume("cylinder", x) if has_density else Decimal(MASS)
        return _from_end(mass * _about_z(cylinder_moments, s), mass, direction(s) * x[1] / 2)

    return function


def _rod(x: Exact) -> Exact:
    return np.array([x[0] ** 2 / 12, x[0] ** 2 / 12, Decimal(0)])


def rod(t: Truth, s: Point) -> Exact:
    """A rod of MASS along the direction, of the length x[0] (10)."""
    return _flat(Decimal(MASS), zeros(3), Decimal(MASS) * _about_z(_rod, s))


def rod_about_end(t: Truth, s: Point) -> Exact:
    """The same about its beginning (10)."""
    return _from_end(Decimal(MASS) * _about_z(_rod, s), Decimal(MASS), direction(s) * sizes(s)[0] / 2)


def point(t: Truth, s: Point) -> Exact:
    """A point of MASS at v (10)."""
    return _from_end(zeros(3, 3), Decimal(MASS), s.v)


def _of_triangles(corners: Exact, triangles: Sequence[tuple[int, ...]]) -> Exact:
    """A body of DENSITY within triangles (10), about the origin: the sum of tetrahedra from there.

    Of one with the edges a, b, c from the origin, of the volume V = a . (b x c) / 6, points have the mean
    (a + b + c) / 4, and the mean square (sum over pairs, each edge with itself, too, of their products) / 10, pairs
    of different edges half.
    """
    mass, first, square = Decimal(0), zeros(3), zeros(3, 3)
    for triangle in triangles:
        edges = [corners[k] for k in triangle]
        a, b, c = edges
        own = Decimal(DENSITY) * (a @ (skew(b) @ c)) / 6
        mass, first = mass + own, first + own * (a + b + c) / 4
        square = square + own * sum(np.outer(e, e) for e in edges) / 10
        for e, f in combinations(edges, 2):
            square = square + own * (np.outer(e, f) + np.outer(f, e)) / 20
    return _flat(mass, first / mass, np.trace(square) * eye(3) - square)


def mesh(triangles: Sequence[tuple[int, ...]], factors: Sequence[float] = (1.0, 1.0, 1.0)) -> TruthOf:
    """The body of CORNERS, scaled by the sizes and by factors, within triangles (10)."""

    def function(t: Truth, s: Point) -> Exact:
        return _of_triangles(exact(CORNERS) * sizes(s) * exact(factors), triangles)

    return function


def _matrix(t: Truth, s: Point) -> Exact:
    """The moments of the body of `poses`, about its mass centre, turned by R (3, 3)."""
    R = turn(t, s.q)
    return R @ exact(MOMENTS) @ R.T


def central(t: Truth, s: Point) -> Exact:
    """Moments and products about the mass centre, turned by R (6)."""
    return _flat(Decimal(0), zeros(3), _matrix(t, s))[4:]


def about_point(t: Truth, s: Point) -> Exact:
    """The same about a point at v from the mass centre (6)."""
    return _from_end(_matrix(t, s), Decimal(MASS), s.v)[4:]


def about_other_point(t: Truth, s: Point) -> Exact:
    """The same about a point at v2 from the mass centre, of those about the point at v (6)."""
    return _from_end(_matrix(t, s), Decimal(MASS), s.v2)[4:]


def first_moment(t: Truth, s: Point) -> Exact:
    """Mass times mass centre (3) of the body of `poses`."""
    return Decimal(MASS) * exact(CENTRE)


def trace(t: Truth, s: Point) -> Exact:
    """The sum of the moments about the mass centre, and the largest that one of them can be, half of that (2)."""
    total = np.trace(exact(MOMENTS))
    return np.array([total, total / 2])
