"""Coordinates in the arrays of frameworks: quaternions of any length, rates, motions along the manifold.

Written once over a framework's operations, so that the framework differentiates them. docs/theory/linear.md, section 9.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from symofros.runtime.record import Segment

# Components of vectors (3) and of quaternions (4: x, y, z, w); numbers, arrays or expressions.
Components = Sequence[Any]


class Operations(NamedTuple):
    """Operations of an array framework that the formulas need.

    Attributes:
        entries: The entries of an array (..., n), each an array (...).
        joined: The array (..., n) of entries, broadcast.
        sqrt: Square root.
        sin: Sine.
        cos: Cosine.
        arctan2: Angle of (y, x).
        where: One of two values, by a condition.
    """

    entries: Callable[[Any], Sequence[Any]]
    joined: Callable[[Sequence[Any]], Any]
    sqrt: Callable[[Any], Any]
    sin: Callable[[Any], Any]
    cos: Callable[[Any], Any]
    arctan2: Callable[[Any, Any], Any]
    where: Callable[[Any, Any, Any], Any]


class Coordinates:
    """The configuration manifold of a model in a framework.

    Args:
        segments: The manifold.
        operations: Those of the framework.
    """

    def __init__(self, segments: Sequence[Segment], operations: Operations) -> None:
        self._segments, self._f = tuple(segments), operations
        self.curved = any(segment.kind != "linear" for segment in self._segments)

    def unit(self, q: Any) -> Any:
        """The coordinates (..., nq) with quaternions divided by their length (eq. 24)."""
        if not self.curved:
            return q
        given, result = self._f.entries(q), list[Any]()
        for segment in self._segments:
            place, quaternion = _parts(segment, given)
            result += [*place, *self._unit(quaternion)]
        return self._f.joined(result)

    def rates(self, q: Any, v: Any) -> Any:
        """Rates of the coordinates N(q) v (..., nq), which keep the lengths of quaternions (eq. 25)."""
        return self._moved(q, v, lambda p, w: [0.5 * x for x in _product(p, (*w, 0.0))])

    def by_coordinates(self, q: Any, by_speeds: Any) -> Any:
        """Derivatives by the coordinates (..., nq) of those along the motions of the speeds (..., nv), (eq. 26)."""

        def of_quaternion(p: Components, w: Components) -> Components:
            factor = 2.0 / _dot(p, p)
            return [factor * x for x in _product(p, (*w, 0.0))]

        return self._moved(q, by_speeds, of_quaternion)

    def _moved(self, q: Any, v: Any, of_quaternion: Callable[[Components, Components], Components]) -> Any:
        """One entry a coordinate of one a speed: linear ones as they are, those of places turned into the world."""
        if not self.curved:
            return v
        given, speeds, result = self._f.entries(q), self._f.entries(v), list[Any]()
        for segment in self._segments:
            _, quaternion = _parts(segment, given)
            linear, angular = _speeds(segment, speeds)
            turned = _rotate(self._unit(quaternion), linear) if segment.kind == "pose" else linear
            result += [*turned, *(of_quaternion(quaternion, angular) if quaternion else ())]
        return self._f.joined(result)

    def integrate(self, q: Any, dq: Any) -> Any:
        """Configuration q (..., nq) after unit time with constant speeds dq (..., nv): `Model.integrate`."""
        if not self.curved:
            return q + dq
        given, steps, result = self._f.entries(q), self._f.entries(dq), list[Any]()
        for segment in self._segments:
            place, quaternion = _parts(segment, given)
            linear, angular = _speeds(segment, steps)
            if segment.kind == "linear":
                result += [x + dx for x, dx in zip(place, linear, strict=True)]
                continue
            p = self._unit(quaternion)
            if segment.kind == "pose":
                shift = _rotate(p, self._displacement(angular, linear))
                result += [x + dx for x, dx in zip(place, shift, strict=True)]
            result += _product(p, self._exponential(angular))
        return self._f.joined(result)

    def difference(self, q0: Any, q1: Any) -> Any:
        """The speeds (..., nv) that lead from q0 to q1 (..., nq) in unit time, by smallest turns."""
        if not self.curved:
            return q1 - q0
        first, second, result = self._f.entries(q0), self._f.entries(q1), list[Any]()
        for segment in self._segments:
            (place, quaternion), (there, turned) = _parts(segment, first), _parts(segment, second)
            shift = [x1 - x0 for x0, x1 in zip(place, there, strict=True)]
            if segment.kind == "linear":
                result += shift
                continue
            x, y, z, w = self._unit(quaternion)
            back = (-x, -y, -z, w)
            turn = self._rotation_vector(_product(back, self._unit(turned)))
            result += [*(self._twist(turn, _rotate(back, shift)) if shift else ()), *turn]
        return self._f.joined(result)

    def _unit(self, quaternion: Components) -> Components:
        if not quaternion:
            return quaternion
        length = self._f.sqrt(_dot(quaternion, quaternion))
        return [x / length for x in quaternion]

    def _near_zero(self, square: Any, below: float, closed: Callable[[Any], Any], coefficients: Sequence[float]) -> Any:
        """A function of a square by its closed form, and below a bound by its series: smooth at zero."""
        small = square < below
        series = coefficients[-1]
        for coefficient in reversed(coefficients[:-1]):
            series = coefficient + square * series
        # The form that is not chosen must have finite derivatives as well.
        return self._f.where(small, series, closed(self._f.where(small, 1.0, square)))

    def _exponential(self, w: Components) -> Components:
        """Quaternion of a rotation vector."""
        f, square = self._f, _dot(w, w)
        cosine = self._near_zero(
            square, _SQUARE, lambda s: f.cos(f.sqrt(s) / 2.0), (1.0, -1 / 8, 1 / 384, -1 / 46080, 1 / 10321920)
        )
        half = self._half_sine(square)
        return [*(half * x for x in w), cosine]

    def _half_sine(self, square: Any) -> Any:
        """sin(a/2)/a of a^2."""
        f = self._f
        return self._near_zero(
            square,
            _SQUARE,
            lambda s: f.sin(f.sqrt(s) / 2.0) / f.sqrt(s),
            (1 / 2, -1 / 48, 1 / 3840, -1 / 645120, 1 / 185794560),
        )

    def _displacement(self, w: Components, v: Components) -> Components:
        """J(w) v, as `rotations.screw_displacement`."""
        f, square = self._f, _dot(w, w)
        A = 2.0 * self._half_sine(square) ** 2
        B = self._near_zero(
            square,
            _SQUARE,
            lambda s: (f.sqrt(s) - f.sin(f.sqrt(s))) / (s * f.sqrt(s)),
            (1 / 6, -1 / 120, 1 / 5040, -1 / 362880, 1 / 39916800),
        )
        wv = _cross(w, v)
        return [x + A * y + B * z for x, y, z in zip(v, wv, _cross(w, wv), strict=True)]

    def _twist(self, w: Components, p: Components) -> Components:
        """The v with J(w) v = p, as `rotations.screw_twist`."""
        f, square = self._f, _dot(w, w)

        def closed(s: Any) -> Any:
            half = f.sqrt(s) / 2.0
            return (1.0 - half * f.cos(half) / f.sin(half)) / s

        C = self._near_zero(square, _SQUARE, closed, (1 / 12, 1 / 720, 1 / 30240, 1 / 1209600, 1 / 47900160))
        wp = _cross(w, p)
        return [x - 0.5 * y + C * z for x, y, z in zip(p, wp, _cross(w, wp), strict=True)]

    def _rotation_vector(self, quaternion: Components) -> Components:
        """Rotation vector, of at most pi, of a unit quaternion."""
        f = self._f
        sign = f.where(quaternion[3] < 0.0, -1.0, 1.0)
        x, y, z, w = (sign * each for each in quaternion)
        square = _dot((x, y, z), (x, y, z))
        # 2 arcsin(n)/n, on the unit sphere.
        factor = self._near_zero(
            square,
            1e-4,
            lambda s: 2.0 * f.arctan2(f.sqrt(s), f.where(square < 1e-4, 1.0, w)) / f.sqrt(s),
            (2.0, 1 / 3, 3 / 20, 5 / 56, 35 / 576),
        )
        return [factor * x, factor * y, factor * z]


# Square of the angle [rad^2] below which five terms of the series are exact to rounding, and closed forms lose digits.
_SQUARE = 1e-2


def _parts(segment: Segment, q: Sequence[Any]) -> tuple[Components, Components]:
    """Linear coordinates or the place, and the quaternion."""
    middle, end = segment.q + segment.translations, segment.q + segment.size
    return q[segment.q : middle], q[middle:end]


def _speeds(segment: Segment, v: Sequence[Any]) -> tuple[Components, Components]:
    """Linear speeds, and the angular velocity."""
    middle, end = segment.v + segment.translations, segment.v + segment.speeds
    return v[segment.v : middle], v[middle:end]


def _dot(a: Components, b: Components) -> Any:
    return sum(x * y for x, y in zip(a[1:], b[1:], strict=True)) + a[0] * b[0]


def _cross(a: Components, b: Components) -> Components:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _product(a: Components, b: Components) -> Components:
    """Quaternion of the rotation R_a R_b."""
    x, y, z = (a[3] * p + b[3] * q + r for p, q, r in zip(b[:3], a[:3], _cross(a, b), strict=True))
    return (x, y, z, a[3] * b[3] - _dot(a[:3], b[:3]))


def _rotate(quaternion: Components, x: Components) -> Components:
    """R x of a unit quaternion."""
    t = [2.0 * y for y in _cross(quaternion, x)]
    return [a + quaternion[3] * b + c for a, b, c in zip(x, t, _cross(quaternion, t), strict=True)]
