"""Sections of any outline: boxes, I and L sections, polygons; by finite elements (extra "sections")."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

from symofros.description.beams.sections.material import Material, refuse_sizes
from symofros.description.beams.sections.section import Section, number_of
from symofros.errors import DescriptionError, Problem

Point = tuple[float, float]
# Elements over the area: torsion errs by 1e-5 for convex outlines, by some 1e-3 beside corners that point inwards.
_ELEMENTS = 1000
_MAX_POINTS = 1000


class _Geometry(NamedTuple):
    """A homogeneous section about its centroid: area, moments, torsion constant, shear areas and centre, centroid."""

    area: float
    I_y: float
    I_z: float
    I_yz: float
    torsion: float
    shear_y: float
    shear_z: float
    shear_center: Point
    centroid: Point


def polygon(material: Material, outline: Sequence[Point], holes: Sequence[Sequence[Point]] = ()) -> Section:
    """A section of any outline; the axis is put through its centroid.

    Args:
        material: Material, of numbers.
        outline: Corners (y, z) in order [m].
        holes: Outlines of holes [m].

    Raises:
        DescriptionError: The outline crosses itself or encloses no area, or a hole is not inside.
        ImportError: The extra "sections" is not installed.
    """
    E, G, rho = (number_of(getattr(material, label), label, {}) for label in ("E", "G", "rho"))
    rings = tuple(tuple((float(y), float(z)) for y, z in ring) for ring in (outline, *holes))
    _refuse_unusable(rings)
    part = _geometry(rings, E / (2.0 * G) - 1.0)
    return Section(
        EA=E * part.area,
        GJ=G * part.torsion,
        EI_y=E * part.I_y,
        EI_z=E * part.I_z,
        EI_yz=E * part.I_yz,
        rhoA=rho * part.area,
        rhoI_y=rho * part.I_y,
        rhoI_z=rho * part.I_z,
        rhoI_yz=rho * part.I_yz,
        GA_y=G * part.shear_y,
        GA_z=G * part.shear_z,
        shear_center=part.shear_center,
        E=E,
        corners=tuple((y - part.centroid[0], z - part.centroid[1]) for y, z in rings[0]),
    )


def box(material: Material, y: float, z: float, thickness: float) -> Section:
    """A hollow rectangle.

    Args:
        material: Material, of numbers.
        y: Outer size along y [m].
        z: Outer size along z [m].
        thickness: Thickness of the walls [m].
    """
    refuse_sizes("box", {"y": y, "z": z, "thickness": thickness}, ("thickness", min(y, z) / 2.0))
    return polygon(material, _rectangle(y, z), (_rectangle(y - 2.0 * thickness, z - 2.0 * thickness),))


def i_section(material: Material, y: float, z: float, web: float, flange: float) -> Section:
    """An I section with its web along y.

    Args:
        material: Material, of numbers.
        y: Height, over both flanges [m].
        z: Width of the flanges [m].
        web: Thickness of the web [m].
        flange: Thickness of the flanges [m].
    """
    refuse_sizes("I section", {"y": y, "z": z, "web": web, "flange": flange}, ("flange", y / 2.0))
    refuse_sizes("I section", {"web": web}, ("web", z))
    a, b, w, f = y / 2.0, z / 2.0, web / 2.0, y / 2.0 - flange
    quarter = [(a, b), (f, b), (f, w)]
    below = [(-y, z) for y, z in reversed(quarter)]
    half = quarter + below
    return polygon(material, half + [(y, -z) for y, z in reversed(half)])


def l_section(material: Material, y: float, z: float, thickness: float) -> Section:
    """An L section, its corner towards negative y and z.

    Args:
        material: Material, of numbers.
        y: Outer length of the leg along y [m].
        z: Outer length of the leg along z [m].
        thickness: Thickness of both legs [m].
    """
    t = thickness
    refuse_sizes("L section", {"y": y, "z": z, "thickness": t}, ("thickness", min(y, z)))
    return polygon(material, [(0.0, 0.0), (y, 0.0), (y, t), (t, t), (t, z), (0.0, z)])


def _rectangle(y: float, z: float) -> tuple[Point, ...]:
    a, b = y / 2.0, z / 2.0
    return (-a, -b), (a, -b), (a, b), (-a, b)


def _refuse_unusable(rings: Sequence[Sequence[Point]]) -> None:
    """Refuse a wrong number of corners and coordinates that are not finite; shapely finds other faults."""
    count = sum(map(len, rings))
    if any(len(ring) < 3 for ring in rings) or count > _MAX_POINTS:
        raise DescriptionError(_unusable(f"{count} corners", f"3 corners or more an outline, {_MAX_POINTS} in all"))
    if not all(math.isfinite(x) for ring in rings for point in ring for x in point):
        raise DescriptionError(_unusable("a coordinate is not finite", "coordinates are finite numbers"))


def _unusable(stated: str, rule: str) -> Problem:
    return Problem("section: unusable outline", stated, rule, "give the corners in order, holes inside the outline")


@lru_cache(maxsize=64)
def _geometry(rings: tuple[tuple[Point, ...], ...], poisson: float) -> _Geometry:
    """A section by finite elements, scaled to unit area first, since meshes have absolute tolerances."""
    try:
        from sectionproperties.analysis import Section as Elements  # An extra.
        from sectionproperties.pre import Geometry  # Of the same extra.
        from sectionproperties.pre import Material as Elastic  # Of the same extra.
        from shapely import Polygon  # Of the same extra.
    except ImportError:
        found, rule = "no module sectionproperties", "sections of this outline are meshed"
        raise DescriptionError.of_extra("section: no mesher is installed", found, rule, "sections") from None
    region = Polygon(rings[0], rings[1:])
    if not region.is_valid or not region.area > 0.0:
        raise DescriptionError(_unusable(f"area {region.area:g}", "outlines enclose an area and do not cross"))
    scale = 1.0 / math.sqrt(region.area)
    outline, *holes = ([(scale * y, scale * z) for y, z in ring] for ring in rings)
    geometry = Geometry(Polygon(outline, holes), material=Elastic("", 1.0, poisson, 1.0, 1.0, ""))
    elements = Elements(geometry.create_mesh(mesh_sizes=[1.0 / _ELEMENTS]))
    elements.calculate_geometric_properties()
    elements.calculate_warping_properties()
    # The library's x and y are our y and z.
    (cy, cz), (sy, sz) = elements.get_c(), elements.get_sc()
    about_y, about_z, product = elements.get_eic()
    shear_y, shear_z = (float(value) for value in elements.get_eas())
    square = scale**-2
    return _Geometry(
        float(region.area),
        float(about_y) * square**2,
        float(about_z) * square**2,
        float(product) * square**2,
        float(elements.get_ej()) * square**2,
        shear_y * square,
        shear_z * square,
        (float(sy - cy) / scale, float(sz - cz) / scale),
        (float(cy) / scale, float(cz) / scale),
    )
