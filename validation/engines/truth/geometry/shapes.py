"""Solids in many digits: their moments, where rays meet them, how far they are apart or overlap.

The first solid stands at X = (R, a) of the coordinates q, the second at (Q, tau + BEYOND) of q2. Balls, capsules,
cylinders, boxes and ellipsoids are about the origins of their frames; capsules and cylinders are along z. The signed
distance of solids that overlap is minus the least way by which one of them must move for them to touch from outside.
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from itertools import product
from typing import NamedTuple

import numpy as np

from ..arithmetic import Exact, exact, root
from ..derived import TruthOf
from ..dynamics import Point, Truth
from .poses import MASS
from .turns import turn

RADIUS, HALF = 0.375, 0.5
# Half the sides of boxes, and the semi-axes of ellipsoids.
SIDES = (0.25, 0.5, 0.75)
# Where the second solid is from the first, and what rays go through: a point of the solid's own.
BEYOND, WITHIN = (2.0, -4.0, 4.0), (0.0625, -0.125, 0.1875)
# Pairs that overlap -> where the first stands in the frame of the second, turned as this is: a point of a box that is
# the nearest to its face along x; 1/4 from the axes of round ones, nearer to their mantles than to their ends.
_NEAR_FACE, _NEAR_AXIS = (0.125, 0.25, 0.25), (0.15, 0.2, 0.25)
INSIDE = {
    ("ball", "ball"): (0.125, 0.25, 0.25),
    ("ball", "capsule"): _NEAR_AXIS,
    ("ball", "cylinder"): _NEAR_AXIS,
    ("ball", "box"): _NEAR_FACE,
    ("capsule", "capsule"): _NEAR_AXIS,
    ("capsule", "box"): _NEAR_FACE,
    ("box", "box"): (0.375, 0.25, 0.25),
}
# Height of a solid's origin above a floor, less than what each solid reaches down from it.
HEIGHT = 0.125
_HALF = Decimal("0.5")


class _Placed(NamedTuple):
    """A solid's frame: its rotation R (3, 3) and its origin p (3)."""

    R: Exact
    p: Exact

    def seen(self, x: Exact) -> Exact:
        """A point in this frame."""
        return self.R.T @ (x - self.p)

    def at(self, x: Exact) -> Exact:
        """A point of this frame."""
        return self.p + self.R @ x


def _first(t: Truth, s: Point) -> _Placed:
    return _Placed(turn(t, s.q), s.a)


def _second(t: Truth, s: Point) -> _Placed:
    return _Placed(turn(t, s.q2), s.tau + exact(BEYOND))


# What stands in for a solid: the points or the segments that its surface is a distance away from.
_Segment = tuple[Exact, Exact]


def _axis(frame: _Placed) -> _Segment:
    end = exact((0.0, 0.0, HALF))
    return frame.at(-end), frame.at(end)


def _length(x: Exact) -> Exact:
    return root(x @ x)


def _clamped(x: Exact, least: Exact, greatest: Exact) -> Exact:
    return min(max(x, least), greatest)


def _to_segment(x: Exact, segment: _Segment) -> Exact:
    """Distance of a point."""
    start, end = segment
    along = end - start
    return _length(x - start - along * _clamped((x - start) @ along / (along @ along), Decimal(0), Decimal(1)))


def _between_segments(first: _Segment, second: _Segment) -> Exact:
    """Distance of two segments: that of an end of one, unless the lines' nearest points are within both."""
    (p, q), (r, s) = first, second
    u, w, apart = q - p, s - r, r - p
    least = min(_to_segment(p, second), _to_segment(q, second), _to_segment(r, first), _to_segment(s, first))
    slope = (u @ u) * (w @ w) - (u @ w) ** 2
    if not slope:
        return least
    x = ((apart @ u) * (w @ w) - (apart @ w) * (u @ w)) / slope
    y = ((apart @ u) * (u @ w) - (apart @ w) * (u @ u)) / slope
    inside = 0 <= x <= 1 and 0 <= y <= 1
    return min(least, _length(apart + w * y - u * x)) if inside else least


def _to_box(x: Exact, frame: _Placed) -> Exact:
    """Distance of a point outside of a box."""
    beyond = [max(abs(own) - side, Decimal(0)) for own, side in zip(frame.seen(x), exact(SIDES), strict=True)]
    return _length(np.array(beyond))


def _to_cylinder(x: Exact, frame: _Placed) -> Exact:
    """Distance of a point outside of a cylinder."""
    own = frame.seen(x)
    aside = root(own[0] ** 2 + own[1] ** 2) - Decimal(RADIUS)
    return _length(np.array([max(aside, Decimal(0)), max(abs(own[2]) - Decimal(HALF), Decimal(0))]))


def _corners(frame: _Placed) -> dict[tuple[int, ...], Exact]:
    return {signs: frame.at(exact(SIDES) * np.array(signs)) for signs in product((-1, 1), repeat=3)}


def _edges(frame: _Placed) -> list[_Segment]:
    """Pairs of corners that differ along one axis."""
    corners = _corners(frame)
    pairs = [(one, two) for one in corners for two in corners if one < two]
    return [(corners[one], corners[two]) for one, two in pairs if np.count_nonzero(np.subtract(one, two)) == 1]


def _segment_to_box(segment: _Segment, frame: _Placed) -> Exact:
    """Distance of a segment outside of a box: that of an end, or of an edge."""
    return min(*(_to_box(x, frame) for x in segment), *(_between_segments(segment, edge) for edge in _edges(frame)))


def _between_boxes(first: _Placed, second: _Placed) -> Exact:
    """Distance of two boxes: that of a corner, or of two edges."""
    corners = [*(_to_box(x, second) for x in _corners(first).values())]
    corners += [_to_box(x, first) for x in _corners(second).values()]
    edges = product(_edges(first), _edges(second))
    return min(*corners, *(_between_segments(one, other) for one, other in edges))


def _apart(of: Callable[[_Placed, _Placed], Exact], rounds: int) -> TruthOf:
    """Distance (1) of solids that are rounded by RADIUS, both of them or one."""
    return lambda t, s: np.array([of(_first(t, s), _second(t, s)) - rounds * Decimal(RADIUS)])


DISTANCES: dict[tuple[str, str], TruthOf] = {
    ("ball", "ball"): _apart(lambda one, other: _length(other.p - one.p), 2),
    ("ball", "capsule"): _apart(lambda one, other: _to_segment(one.p, _axis(other)), 2),
    ("ball", "cylinder"): _apart(lambda one, other: _to_cylinder(one.p, other), 1),
    ("ball", "box"): _apart(lambda one, other: _to_box(one.p, other), 1),
    ("capsule", "capsule"): _apart(lambda one, other: _between_segments(_axis(one), _axis(other)), 2),
    ("capsule", "box"): _apart(lambda one, other: _segment_to_box(_axis(one), other), 1),
    ("box", "box"): _apart(_between_boxes, 0),
}


def overlap(one: str, other: str) -> TruthOf:
    """Signed distance (1) of a solid that stands at INSIDE of another."""
    place = exact(INSIDE[one, other])
    if other == "box":  # Of the faces across x the first reaches 2 SIDES[0], RADIUS or as far along x.
        apart = place[0] - Decimal(SIDES[0]) - Decimal(SIDES[0] if one == "box" else RADIUS)
    else:
        apart = _length(place if other == "ball" else place[:2]) - 2 * Decimal(RADIUS)
    return lambda t, s: np.array([apart])


def _support(solid: str, down: Exact) -> Exact:
    """How far a solid reaches from its origin in the unit direction `down` of its frame."""
    if solid in ("box", "ellipsoid"):
        reach = abs(down) * exact(SIDES)
        return sum(reach) if solid == "box" else _length(reach)
    aside = root(down[0] ** 2 + down[1] ** 2) if solid == "cylinder" else Decimal(1)
    return Decimal(RADIUS) * aside + (Decimal(0) if solid == "ball" else abs(down[2]) * Decimal(HALF))


def to_floor(solid: str) -> TruthOf:
    """Signed distance (1) of the solid that is turned by R, at HEIGHT, and of the half space below z = 0."""
    return lambda t, s: np.array([Decimal(HEIGHT) - _support(solid, -turn(t, s.q)[2])])


def _ray(t: Truth, s: Point) -> tuple[Exact, Exact]:
    """Origin and unit direction, in the first solid's frame, of the ray from tau + BEYOND through WITHIN."""
    origin, target = _first(t, s).seen(s.tau + exact(BEYOND)), exact(WITHIN)
    return origin, (target - origin) / _length(target - origin)


def _roots(x: Exact, d: Exact, weights: Exact, size: Exact) -> list[Exact]:
    """Both k with sum of weights (x + k d)^2 = size."""
    a, b, c = weights @ (d * d), weights @ (x * d), weights @ (x * x) - size
    square = b * b - a * c
    return [(-b + sign * root(square)) / a for sign in (-1, 1)] if square >= 0 and a else []


def _ball(x: Exact, d: Exact) -> list[Exact]:
    return _roots(x, d, exact((1.0, 1.0, 1.0)), Decimal(RADIUS) ** 2)


def _ellipsoid(x: Exact, d: Exact) -> list[Exact]:
    return _roots(x, d, 1 / exact(SIDES) ** 2, Decimal(1))


def _box(x: Exact, d: Exact) -> list[Exact]:
    found = []
    for k, side in product(range(3), (-1, 1)):
        if d[k]:
            far = (side * exact(SIDES)[k] - x[k]) / d[k]
            rest = abs(np.delete(x + far * d, k)) <= np.delete(exact(SIDES), k)
            found += [far] if all(rest) else []
    return found


def _mantle(x: Exact, d: Exact) -> list[Exact]:
    """Where a line meets the round side of a cylinder."""
    found = _roots(x, d, exact((1.0, 1.0, 0.0)), Decimal(RADIUS) ** 2)
    return [far for far in found if abs((x + far * d)[2]) <= Decimal(HALF)]


def _cylinder(x: Exact, d: Exact) -> list[Exact]:
    found = _mantle(x, d)
    for side in (-1, 1):
        if d[2]:
            far = (side * Decimal(HALF) - x[2]) / d[2]
            own = x + far * d
            found += [far] if own[0] ** 2 + own[1] ** 2 <= Decimal(RADIUS) ** 2 else []
    return found


def _capsule(x: Exact, d: Exact) -> list[Exact]:
    found = _mantle(x, d)
    for side in (-1, 1):
        middle = exact((0.0, 0.0, side * HALF))
        found += [far for far in _ball(x - middle, d) if side * (x + far * d)[2] >= Decimal(HALF)]
    return found


_MEETING = {"ball": _ball, "box": _box, "capsule": _capsule, "cylinder": _cylinder, "ellipsoid": _ellipsoid}
MET = tuple(_MEETING)


def ray(solid: str) -> TruthOf:
    """Distance (1) from the ray's origin to where it enters a solid."""

    def function(t: Truth, s: Point) -> Exact:
        return np.array([min(_MEETING[solid](*_ray(t, s)))])

    return function


def ray_from_within(solid: str) -> TruthOf:
    """Distance (1) from WITHIN, on the same ray, to where it leaves a solid."""

    def function(t: Truth, s: Point) -> Exact:
        _, d = _ray(t, s)
        return np.array([max(_MEETING[solid](exact(WITHIN), d))])

    return function


def ray_normal(solid: str) -> TruthOf:
    """Unit normal (3), outwards, where the ray enters a solid with a smooth surface of second order."""
    weights = {"ball": exact((1.0, 1.0, 1.0)), "ellipsoid": 1 / exact(SIDES) ** 2}[solid]

    def function(t: Truth, s: Point) -> Exact:
        x, d = _ray(t, s)
        own = weights * (x + min(_MEETING[solid](x, d)) * d)
        return _first(t, s).R @ own / _length(own)

    return function


def _sizes(s: Point) -> Exact:
    """Sizes of solids (3): |v| + 1/2."""
    return abs(s.v) + _HALF


def moments(of: Callable[[Exact], Exact]) -> TruthOf:
    """Moments (3) about the mass centre of a solid of MASS and of the sizes |v| + 1/2."""
    return lambda t, s: Decimal(MASS) * np.array(of(_sizes(s)))


def _of_squares(x: Exact) -> Exact:
    """Moments of a body with the mean squares x of its points along the axes."""
    return sum(x) - x


def box_moments(sides: Exact) -> Exact:
    """Moments of a box by its sides, of unit mass."""
    return _of_squares(sides**2 / 12)


def ellipsoid_moments(axes: Exact) -> Exact:
    """Moments of an ellipsoid by its semi-axes, of unit mass."""
    return _of_squares(axes**2 / 5)


def ball_moments(sizes: Exact) -> Exact:
    """Moments of a ball of radius sizes[0], of unit mass."""
    return ellipsoid_moments(np.array([sizes[0]] * 3))


def shell_moments(sizes: Exact) -> Exact:
    """Moments of the surface of a ball of radius sizes[0], of unit mass."""
    return _of_squares(np.array([sizes[0] ** 2 / 3] * 3))


def cylinder_moments(sizes: Exact) -> Exact:
    """Moments of a cylinder along z of radius sizes[0] and length sizes[1], of unit mass."""
    across = sizes[0] ** 2 / 4
    return _of_squares(np.array([across, across, sizes[1] ** 2 / 12]))


def capsule_moments(sizes: Exact) -> Exact:
    """Moments of a capsule along z, of unit mass; its cylinder has radius sizes[0] and length sizes[1].

    Its halves of a ball have the mean square r^2 / 5 about their flat faces, and mass centres 3 r / 8 from these.
    """
    r, length = sizes[:2]
    middle, ends = length, 4 * r / 3  # Volumes in units of pi r^2.
    across = (middle * r**2 / 4 + ends * r**2 / 5) / (middle + ends)
    along = middle * length**2 / 12 + ends * (r**2 / 5 + 3 * r * length / 8 + length**2 / 4)
    return _of_squares(np.array([across, across, along / (middle + ends)]))


def principal_moments(t: Truth, s: Point) -> Exact:
    """Eigenvalues (3), the least first, of R diag(1 + v^2 / (1 + v^2)) R^T."""
    return np.array(sorted(1 + s.v**2 / (1 + s.v**2)))


# Factors of meshes that are scaled, and that are mirrored.
SCALES = {"": (1.0, 1.0, 1.0), "_scaled": (2.0, 0.5, 4.0), "_mirrored": (-2.0, 0.5, 4.0)}


def tetrahedron_volume(factors: tuple[float, ...]) -> TruthOf:
    """Volume (1) of the tetrahedron of the origin and of points at the sizes on the axes, scaled."""
    return lambda t, s: np.array([np.prod(_sizes(s) * abs(exact(factors))) / 6])


def tetrahedron_centre(factors: tuple[float, ...]) -> TruthOf:
    """Its mass centre (3)."""
    return lambda t, s: _sizes(s) * exact(factors) / 4


def tetrahedron_face(factors: tuple[float, ...]) -> TruthOf:
    """Area of its face opposite the origin, along the normal outwards (3): (b - a) x (c - a) / 2 of its corners."""

    def function(t: Truth, s: Point) -> Exact:
        x = _sizes(s) * abs(exact(factors))
        return exact(np.sign(factors)) * np.prod(x) / x / 2

    return function


def scaled_normal(factors: tuple[float, ...]) -> TruthOf:
    """Unit normal (3) of a surface with the normal v + (4, 8, 8), scaled: at right angles to what is scaled with it."""

    def function(t: Truth, s: Point) -> Exact:
        normal = (s.v + exact((4.0, 8.0, 8.0))) / exact(factors)
        return normal / _length(normal)

    return function


def prism_volume(t: Truth, s: Point) -> Exact:
    """Volume (1) of a prism with four sides: its base has corners at sizes[0] from its middle."""
    return np.array([2 * _sizes(s)[0] ** 2 * _sizes(s)[1]])


def pyramid_volume(t: Truth, s: Point) -> Exact:
    """Volume (1) of a pyramid on that base."""
    return np.array([2 * _sizes(s)[0] ** 2 * _sizes(s)[1] / 3])


def ring_volume(t: Truth, s: Point) -> Exact:
    """Volume (1) of a frame of height sizes[2], from sizes[0] to the sum of the first two, of four sides."""
    x = _sizes(s)
    return np.array([2 * ((x[0] + x[1]) ** 2 - x[0] ** 2) * x[2]])


def bar_volume(t: Truth, s: Point) -> Exact:
    """Volume (1) of a box with these sides."""
    return np.array([np.prod(_sizes(s))])
