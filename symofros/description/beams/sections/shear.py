"""Shear stress of rectangles, ellipses and tubes in closed form (docs/theory/beams.md, section 9)."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import comb, factorial
from typing import Literal

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.description.values import Term, Value
from symofros.errors import DescriptionError
from symofros.expr.expression import evaluate

Kind = Literal["rectangle", "ellipse", "tube"]

# The sum of 1/n^5 over odd n: 31/32 zeta(5).
ODD_FIFTHS = 31.0 / 32.0 * 1.0369277551433699
# What a series leaves out is smaller, relative to its first term.
_DIGITS = 38.0


@dataclass(frozen=True)
class ShearShape:
    """A shape of known shear stress, about its centroid.

    Attributes:
        kind: What it is.
        sizes: Sides along y and z of a rectangle, semi-axes of an ellipse, outer and inner radius of a tube [m].
        ratio: E/G.
        angle: Angle about x from the axes of the shape to those of the section [rad].
    """

    kind: Kind
    sizes: tuple[Value, Value]
    ratio: Value
    angle: float = 0.0

    def stresses(
        self,
        sizes: tuple[float, float],
        ratio: float,
        loads: Array,
        points: Array,
        center: tuple[float, float],
    ) -> npt.NDArray[np.float64]:
        """Shear stresses tau_xy, tau_xz (..., points, 2) [N/m^2], along the section's axes.

        Args:
            sizes: Numbers of the sizes [m].
            ratio: Number of E/G.
            loads: Forces along y and z at the shear centre and torque about it (..., 3) [N, N m].
            points: Points (y, z) of the section (points, 2) [m].
            center: The shape's centroid (y, z) [m].

        Raises:
            DescriptionError: A point is not on the section.
        """
        a, b = sizes
        c, s = float(np.cos(self.angle)), float(np.sin(self.angle))
        R = np.array([[c, -s], [s, c]])  # From the section's axes to those of the shape.
        y, z = R @ (points - center).T
        outside = ~is_inside(self.kind, sizes, y, z)
        if outside.any():
            first = points[int(np.argmax(outside))]
            raise DescriptionError(
                "section: shear stress outside of it",
                f"the point ({first[0]:g}, {first[1]:g}) m",
                f"points lie on the {self.kind} of {a:g} and {b:g} m",
                "state points on the section",
            )
        along_y, along_z, torque = loads.reshape(-1, 3).T
        of_shape = np.stack([*(R @ np.stack([along_y, along_z])), torque])
        units = np.stack(unit_stresses(self.kind, sizes, ratio, y, z))
        stresses = np.einsum("kl,kip,ij->lpj", of_shape, units, R)
        return np.asarray(stresses.reshape(*loads.shape[:-1], len(points), 2))


def lateral_ratio(ratio: Term) -> Term:
    """nu/(1 + nu), where ratio = E/G = 2 (1 + nu)."""
    return Term(1.0) - Term(2.0) / ratio


def flexure_coefficients(lateral: Term, k: Term) -> tuple[Term, Term]:
    """P and s of the shear stress of an ellipse under a force (eq. 28a), k = 1 for a circle and a tube."""
    s = (Term(3.0) * lateral - Term(1.0)) / (Term(6.0) + Term(2.0) * k)
    return (k * s - Term(1.0)) / Term(3.0), s


def rectangle_torsion(y: Term, z: Term) -> Term:
    """Torsion constant J of a rectangle (eq. 27); the sum of 1/n^5 is exact, the rest of the series ends at n = 7."""
    a = y.maximum(z)
    b = y * z / a
    rest = Term(0.0)
    for n in (1, 3, 5, 7):
        rest = rest + (Term(1.0) - (Term(n * np.pi / 2.0) * a / b).tanh()) / Term(float(n**5))
    series = Term(192.0 / np.pi**5) * (Term(ODD_FIFTHS) - rest)
    return a * b * b * b / Term(3.0) * (Term(1.0) - series * b / a)


def _number(term: Term) -> float:
    """Numerical value of a term that was made of numbers."""
    return float(evaluate(term.value, {}))


def is_inside(kind: Kind, sizes: tuple[float, float], y: Array, z: Array, slack: float = 1e-9) -> npt.NDArray[np.bool_]:
    """Whether points are on the section, or on its outline but for rounding."""
    a, b = sizes
    if kind == "rectangle":
        return np.maximum(np.abs(y) / a, np.abs(z) / b) <= 0.5 * (1.0 + slack)
    if kind == "ellipse":
        return np.hypot(y / a, z / b) <= 1.0 + slack
    radius = np.hypot(y, z)
    return (radius <= a * (1.0 + slack)) & (radius >= b * (1.0 - slack))


def unit_stresses(kind: Kind, sizes: tuple[float, float], ratio: float, y: Array, z: Array) -> tuple[Array, ...]:
    """(tau_xy, tau_xz) of unit forces along y and z through the centroid, and of a unit torque, each (2, points).

    Args:
        kind: The shape.
        sizes: Its sizes.
        ratio: E/G = 2 (1 + nu).
        y: Places of points inside (points) [m].
        z: Places of points inside (points) [m].
    """
    a, b = sizes
    lateral = _number(lateral_ratio(Term(ratio)))
    force, torque = {
        "rectangle": (_force_on_rectangle, _torque_on_rectangle),
        "ellipse": (_force_on_ellipse, _torque_on_ellipse),
        "tube": (_force_on_tube, _torque_on_tube),
    }[kind]
    along_y = force(a, b, lateral, y, z)
    # A force along z is one along y of the shape with its axes exchanged; a tube has no axes.
    exchanged = force(a, b, lateral, z, y) if kind == "tube" else force(b, a, lateral, z, y)
    return along_y, exchanged[::-1], torque(a, b, y, z)


def _force_on_ellipse(a: float, b: float, lateral: float, y: Array, z: Array) -> Array:
    """Shear stress (2, points) of a unit force along y on an ellipse of semi-axes a and b (eq. 28a)."""
    k = (b / a) ** 2
    p, s = map(_number, flexure_coefficients(Term(lateral), Term(k)))
    moment = 0.25 * np.pi * a**3 * b
    return np.stack([p * (y * y - a * a) + s * z * z, (-1.0 - 2.0 * p) * y * z]) / moment


def _torque_on_ellipse(a: float, b: float, y: Array, z: Array) -> Array:
    """Shear stress (2, points) of a unit torque on an ellipse of semi-axes a and b (eq. 32a)."""
    return np.stack([-z / b**2, y / a**2]) * (2.0 / (np.pi * a * b))


def _force_on_tube(a: float, b: float, lateral: float, y: Array, z: Array) -> Array:
    """Shear stress (2, points) of a unit force along y on a round tube of radii a and b < a (eq. 28c)."""
    p, s = map(_number, flexure_coefficients(Term(lateral), Term(1.0)))
    square = np.maximum(y * y + z * z, np.finfo(float).tiny)
    cosine, sine = y / np.sqrt(square), z / np.sqrt(square)
    from_hole = (a * b) ** 2 / square
    radial = p * cosine * (square - a * a - b * b + from_hole)
    around = -sine * (s * square - p * (a * a + b * b) - p * from_hole)
    moment = 0.25 * np.pi * (a**4 - b**4)
    return np.stack([radial * cosine - around * sine, radial * sine + around * cosine]) / moment


def _torque_on_tube(a: float, b: float, y: Array, z: Array) -> Array:
    """Shear stress (2, points) of a unit torque on a round tube of radii a and b < a (eq. 32a, by J)."""
    return np.stack([-z, y]) * (2.0 / (np.pi * (a**4 - b**4)))


def _force_on_rectangle(h: float, b: float, lateral: float, y: Array, z: Array) -> Array:
    """Shear stress of a unit force along y on a rectangle (eqs. 32b, 32c): phi of (28) in sines of 2 m pi z/b."""
    moment = b * h**3 / 12.0
    curl = lateral / moment
    rate = 2.0 * np.pi / b
    depth = rate * (0.5 * h - np.abs(y))
    angle = rate * z
    slow = -_dilogarithm(-np.exp(-depth + 1j * angle))
    cosines, sines = slow.real, slow.imag
    # Of y and of the other side: smaller by exp(-m rate (h/2 + |y|)) than the first term of all.
    for m in range(1, 2 + int(_DIGITS / (0.5 * rate * h))):
        both = np.exp(-m * rate * h)
        near, far = np.exp(-m * (depth + 2.0 * rate * np.abs(y))), np.exp(-m * (depth + rate * h))
        factor = (1.0 if m % 2 else -1.0) / (m * m * (1.0 + both))
        cosines = cosines + factor * (near - far) * np.cos(m * angle)
        sines = sines - factor * (near + far) * np.sin(m * angle)
    scale = curl * b * b / (2.0 * np.pi**2)
    along = (h * h / 4.0 - y * y) / (2.0 * moment) - curl * (b * b / 24.0 - z * z / 2.0) + scale * cosines
    return np.stack([along, -scale * np.sign(y) * sines])


def _torque_on_rectangle(h: float, b: float, y: Array, z: Array) -> Array:
    """Shear stress of a unit torque on a rectangle (eqs. 32d, 32e): Prandtl's function in cosines of n pi y/h."""
    if h > b:  # The series are the shorter, the shorter the side along which they go.
        return -_torque_on_rectangle(b, h, z, y)[::-1]
    rate = np.pi / h
    depth = rate * (0.5 * b - np.abs(z))
    angle = rate * y
    inside = 1j * np.exp(-depth + 1j * angle)
    slow = -0.5j * (_dilogarithm(inside) - _dilogarithm(-inside))
    cosines, sines = slow.real, slow.imag
    for n in range(1, 2 + 2 * int(_DIGITS / (0.5 * rate * b)), 2):
        both = np.exp(-n * rate * b)
        near, far = np.exp(-n * (depth + 2.0 * rate * np.abs(z))), np.exp(-n * (depth + rate * b))
        factor = (1.0 if n % 4 == 1 else -1.0) / (n * n * (1.0 + both))
        cosines = cosines - factor * (near + far) * np.cos(n * angle)
        sines = sines + factor * (near - far) * np.sin(n * angle)
    J = _number(rectangle_torsion(Term(h), Term(b)))
    scale = 4.0 * h / np.pi**2
    return np.stack([-scale * np.sign(z) * cosines, y - scale * sines]) * (2.0 / J)


def _dilogarithm(w: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
    """Li_2 in the unit disc: by u = -log(1 - w) and the numbers of Bernoulli, where |u| is small; else by 1 - w."""
    reflected = w.real > 0.5
    near = np.where(reflected, 1.0 - w, w)
    u = -np.log(1.0 - near)
    square = u * u
    series = np.zeros_like(u)
    for coefficient in reversed(_bernoulli()):
        series = series * square + coefficient
    value = u - 0.25 * square + u * square * series
    at_one = w == 1.0
    safe = np.where(at_one | ~reflected, 0.75, w)
    mirrored = np.pi**2 / 6.0 - np.where(at_one, 0.0, np.log(safe) * np.log(1.0 - safe)) - value
    return np.asarray(np.where(reflected, mirrored, value))


@cache
def _bernoulli() -> tuple[float, ...]:
    """B_2k/(2k + 1)!, k from 1 on: |u| is below 1.1, so that the 14th term is below 1e-17."""
    numbers = [Fraction(1)]
    for n in range(1, 29):
        numbers.append(-sum((comb(n + 1, k) * number for k, number in enumerate(numbers)), Fraction(0)) / (n + 1))
    return tuple(float(numbers[n] / factorial(n + 1)) for n in range(2, 29, 2))
