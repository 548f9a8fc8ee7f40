"""Inertia of homogeneous solids from size and density: box, cylinder and tube, sphere and shell, ellipsoid.

Sizes and densities are numbers or formulas, so that an inertia follows its parameters. The body frame is along the
solid's axes; `center` is the position of the solid's middle in it.
"""

from __future__ import annotations

import math
from typing import Any, Literal

from symofros.base.arguments import checked
from symofros.description.system import Inertia
from symofros.description.values import Term, Vector, as_value
from symofros.errors import DescriptionError

_AXES = "xyz"


@checked
def box(density: Any, x: Any, y: Any, z: Any, center: Any = (0.0, 0.0, 0.0)) -> Inertia:
    """A box.

    Args:
        density: Density [kg/m^3].
        x: Size along x [m].
        y: Size along y [m].
        z: Size along z [m].
        center: Position of its middle in the body frame [m].

    Raises:
        DescriptionError: A number is not positive.
    """
    rho, a, b, c = _terms("box", density=density, x=x, y=y, z=z)
    mass = rho * a * b * c
    squares = [mass * size * size / Term(12.0) for size in (a, b, c)]
    return _inertia(mass, _from_squares(squares), center)


@checked
def cylinder(
    density: Any,
    radius: Any,
    length: Any,
    hole: Any = 0.0,
    axis: Literal["x", "y", "z"] = "z",
    center: Any = (0.0, 0.0, 0.0),
) -> Inertia:
    """A circular cylinder; a tube where it has a hole.

    Args:
        density: Density [kg/m^3].
        radius: Outer radius [m].
        length: Length along its axis [m].
        hole: Radius of a concentric hole [m].
        axis: Axis of the body frame that it lies along.
        center: Position of its middle in the body frame [m].

    Raises:
        DescriptionError: A number is not positive, or the hole is as large as the cylinder.
    """
    rho, r, size = _terms("cylinder", density=density, radius=radius, length=length)
    h = _hole("cylinder", hole, radius)
    mass = rho * Term(math.pi) * (r - h) * (r + h) * size
    across = mass * (r * r + h * h) / Term(4.0)
    along = mass * size * size / Term(12.0)
    return _inertia(mass, _from_squares([along if name == axis else across for name in _AXES]), center)


@checked
def sphere(density: Any, radius: Any, hole: Any = 0.0, center: Any = (0.0, 0.0, 0.0)) -> Inertia:
    """A sphere; a shell where it has a hole.

    Args:
        density: Density [kg/m^3].
        radius: Outer radius [m].
        hole: Radius of a concentric hole [m].
        center: Position of its middle in the body frame [m].

    Raises:
        DescriptionError: A number is not positive, or the hole is as large as the sphere.
    """
    rho, r = _terms("sphere", density=density, radius=radius)
    h = _hole("sphere", hole, radius)
    # r^3 - h^3 and r^5 - h^5 without what thin shells lose to cancellation.
    wall, r2, h2 = r - h, r * r, h * h
    cubes = wall * (r2 + r * h + h2)
    fifths = wall * (r2 * r2 + r2 * r * h + r2 * h2 + r * h * h2 + h2 * h2)
    factor = rho * Term(4.0 * math.pi / 3.0)
    square = factor * fifths / Term(5.0)
    return _inertia(factor * cubes, _from_squares([square] * 3), center)


@checked
def ellipsoid(density: Any, x: Any, y: Any, z: Any, center: Any = (0.0, 0.0, 0.0)) -> Inertia:
    """An ellipsoid.

    Args:
        density: Density [kg/m^3].
        x: Semi-axis along x [m].
        y: Semi-axis along y [m].
        z: Semi-axis along z [m].
        center: Position of its middle in the body frame [m].

    Raises:
        DescriptionError: A number is not positive.
    """
    rho, a, b, c = _terms("ellipsoid", density=density, x=x, y=y, z=z)
    mass = rho * Term(4.0 * math.pi / 3.0) * a * b * c
    return _inertia(mass, _from_squares([mass * size * size / Term(5.0) for size in (a, b, c)]), center)


def _terms(solid: str, **stated: Any) -> list[Term]:
    """Values that are positive, where they are numbers."""
    values = {name: as_value(given, f"{solid}: {name}") for name, given in stated.items()}
    for name, value in values.items():
        if isinstance(value, float) and not (math.isfinite(value) and value > 0.0):
            rule = "densities and sizes are finite and positive"
            raise DescriptionError(f"{solid}: {name} is not positive", f"{value:g}", rule, "state its size")
    return [Term(value) for value in values.values()]


def _hole(solid: str, hole: Any, radius: Any) -> Term:
    inner, outer = as_value(hole, f"{solid}: hole"), as_value(radius, f"{solid}: radius")
    if isinstance(inner, float) and not (inner >= 0.0 and (not isinstance(outer, float) or inner < outer)):
        rule = "the radius of a hole is from zero to below that of the solid"
        stated = f"hole {inner}, radius {outer}"
        raise DescriptionError(f"{solid}: no such hole", stated, rule, "make it smaller")
    return Term(inner)


def _from_squares(squares: list[Term]) -> list[Term]:
    """Moments of inertia from the integrals of rho x^2, rho y^2, rho z^2 about the middle: two of them each."""
    x, y, z = squares
    return [y + z, z + x, x + y]


def _inertia(mass: Term, moments: list[Term], center: Vector) -> Inertia:
    return Inertia(mass.value, center, tuple(term.value for term in moments))
