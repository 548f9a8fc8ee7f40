"""Rectangle, circle, tube, ellipse in closed form; sizes as formulas too (docs/theory/beams.md, section 8)."""

from __future__ import annotations

import math
from typing import Any

from symofros.description.beams.sections.material import Material, refuse_sizes
from symofros.description.beams.sections.section import Section
from symofros.description.beams.sections.shear import (
    ODD_FIFTHS,
    Kind,
    ShearShape,
    flexure_coefficients,
    lateral_ratio,
    rectangle_torsion,
)
from symofros.description.values import Term, as_value

_Points = tuple[tuple[Term, Term], ...]

_PI = math.pi


def rectangle(material: Material, y: Any, z: Any) -> Section:
    """A rectangle.

    Args:
        material: Material.
        y: Size along y [m]; a number or a formula.
        z: Size along z [m]; a number or a formula.
    """
    E, G, rho, a, b = _terms(material, y=y, z=z)
    area = a * b
    I_y, I_z = a * b * b * b / Term(12.0), b * a * a * a / Term(12.0)
    shear = tuple(G * area / _rectangle_compliance(E / G, *sizes) for sizes in ((a, b), (b, a)))
    halves = (Term(-0.5), Term(0.5))
    corners = tuple((sy * a, sz * b) for sy in halves for sz in halves)
    return _homogeneous(
        E, G, rho, area, I_y, I_z, G * rectangle_torsion(a, b), shear, ("rectangle", a, b), corners=corners
    )


def circle(material: Material, radius: Any) -> Section:
    """A full circle.

    Args:
        material: Material.
        radius: Radius [m]; a number or a formula.
    """
    E, G, rho, r = _terms(material, radius=radius)
    area = Term(_PI) * r * r
    moment = area * r * r / Term(4.0)
    shear = G * area / _round_compliance(E / G, Term(0.0))
    return _homogeneous(
        E, G, rho, area, moment, moment, Term(2.0) * G * moment, (shear,) * 2, ("ellipse", r, r), radii=_radii(r, r)
    )


def tube(material: Material, radius: Any, thickness: Any) -> Section:
    """A circle with a concentric hole.

    Args:
        material: Material.
        radius: Outer radius [m]; a number or a formula.
        thickness: Thickness of the wall [m]; a number or a formula.
    """
    E, G, rho, outer, wall = _terms(material, radius=radius, thickness=thickness)
    inner = outer - wall
    squares = outer * outer + inner * inner
    area = Term(_PI) * wall * (outer + inner)
    moment = area * squares / Term(4.0)
    shear = G * area / _round_compliance(E / G, (outer * inner / squares) * (outer * inner / squares))
    radii, GJ = _radii(outer, outer), Term(2.0) * G * moment
    return _homogeneous(E, G, rho, area, moment, moment, GJ, (shear,) * 2, ("tube", outer, inner), radii=radii)


def ellipse(material: Material, y: Any, z: Any) -> Section:
    """A full ellipse.

    Args:
        material: Material.
        y: Semi-axis along y [m]; a number or a formula.
        z: Semi-axis along z [m]; a number or a formula.
    """
    E, G, rho, a, b = _terms(material, y=y, z=z)
    area = Term(_PI) * a * b
    torsion = area * a * a * b * b / (a * a + b * b)
    I_y, I_z = area * b * b / Term(4.0), area * a * a / Term(4.0)
    shear = tuple(G * area / _ellipse_compliance(E / G, *axes) for axes in ((a, b), (b, a)))
    return _homogeneous(E, G, rho, area, I_y, I_z, G * torsion, shear, ("ellipse", a, b), radii=_radii(a, b))


def _terms(material: Material, **sizes: Any) -> list[Term]:
    stated = {name: as_value(size, f"section: {name}") for name, size in sizes.items()}
    radius = stated.get("radius")
    refuse_sizes(
        "section", stated, ("thickness", radius) if "thickness" in sizes and isinstance(radius, float) else None
    )
    return [Term(value) for value in (material.E, material.G, material.rho, *stated.values())]


def _homogeneous(
    E: Term,
    G: Term,
    rho: Term,
    area: Term,
    I_y: Term,
    I_z: Term,
    GJ: Term,
    shear: tuple[Term, ...],
    shape: tuple[Kind, Term, Term],
    corners: _Points = (),
    radii: _Points = (),
) -> Section:
    GA_y, GA_z = (term.value for term in shear)
    kind, *sizes = shape
    return Section(
        EA=(E * area).value,
        GJ=GJ.value,
        EI_y=(E * I_y).value,
        EI_z=(E * I_z).value,
        rhoA=(rho * area).value,
        rhoI_y=(rho * I_y).value,
        rhoI_z=(rho * I_z).value,
        GA_y=GA_y,
        GA_z=GA_z,
        E=E.value,
        corners=tuple((y.value, z.value) for y, z in corners),
        radii=tuple((y.value, z.value) for y, z in radii),
        shape=ShearShape(kind, (sizes[0].value, sizes[1].value), (E / G).value),
    )


def _radii(y: Term, z: Term) -> _Points:
    return (y, Term(0.0)), (Term(0.0), z)


def _rectangle_compliance(ratio: Term, h: Term, b: Term) -> Term:
    """A/A_s for a force along the side h of a rectangle of width b (eq. 28), where ratio = E/G = 2 (1 + nu)."""
    lateral = lateral_ratio(ratio)
    rest = Term(ODD_FIFTHS)
    for n in (1, 3, 5, 7, 9):
        rest = rest + (Term(1.0) / (Term(n * _PI / 2.0) * b / h).tanh() - Term(1.0)) / Term(float(n**5))
    slenderness = b / h
    warping = slenderness * slenderness / Term(144.0) + Term(1.0 / 120.0) - Term(4.0 / _PI**5) * slenderness * rest
    return Term(1.2) + Term(144.0) * lateral * lateral * warping


def _ellipse_compliance(ratio: Term, a: Term, b: Term) -> Term:
    """A/A_s for a force along the semi-axis a of an ellipse (eq. 28b), where ratio = E/G."""
    k = b * b / (a * a)
    along, across = flexure_coefficients(lateral_ratio(ratio), k)
    mixed = Term(1.0) + Term(2.0) * along
    squares = Term(10.0) * along * along + Term(2.0) * k * k * across * across
    return squares + k * (mixed * mixed - Term(10.0) * along * across) * Term(2.0 / 3.0)


def _round_compliance(ratio: Term, hollow: Term) -> Term:
    """A/A_s of a tube of radii a, b, where hollow = (a b/(a^2 + b^2))^2, zero of a circle; ratio = E/G (eq. 28d)."""
    p, s = flexure_coefficients(lateral_ratio(ratio), Term(1.0))
    full = p * p - p * s + (p * p + s * s) * (Term(1.0) - hollow) / Term(3.0)
    return Term(8.0) * (full + hollow * (Term(4.0) * p * p - Term(2.0) * p * s))
