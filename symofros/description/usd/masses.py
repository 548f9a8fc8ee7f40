"""Mass properties by the rules of UsdPhysics: what a body states comes first, its collision shapes give the rest."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.description.remarks import Remarks
from symofros.description.system import Inertia
from symofros.description.usd.placement import Affine, turn
from symofros.errors import Problem

# Density where nothing states one [kg/m^3].
DENSITY = 1000.0


@dataclass(frozen=True)
class Units:
    """Units of a stage.

    Attributes:
        meters: Metres in its unit of length.
        kilograms: Kilograms in its unit of mass.
    """

    meters: float
    kilograms: float

    @property
    def inertia(self) -> float:
        """Kg m^2 in its unit of moments of inertia."""
        return self.kilograms * self.meters**2

    @property
    def density(self) -> float:
        """kg/m^3 in its unit of density."""
        return self.kilograms / self.meters**3


@dataclass(frozen=True)
class Extent:
    """Integrals over the volume of a shape, or over its mass.

    Attributes:
        size: Volume [m^3], or mass [kg].
        center: Its centre (3,) in the body's frame [m].
        E: Integral of r r^T about the centre, along the body's axes (3, 3).
    """

    size: float
    center: Array
    E: Array

    def times(self, factor: float) -> Extent:
        """The integrals multiplied by a factor, such as a density."""
        return Extent(self.size * factor, self.center, self.E * factor)


class Masses:
    """Makes inertias.

    Args:
        units: Units of the stage.
        placements: Placement of each body and shape in the world, by path.
        remarks: Remarks on what is assumed.
        problems: Takes what is wrong.
    """

    def __init__(
        self, units: Units, placements: Mapping[str, Affine], remarks: Remarks, problems: list[Problem]
    ) -> None:
        self.units, self.placements, self.remarks, self.problems = units, placements, remarks, problems

    def of(self, body: Mapping[str, Any], name: str, shapes: Sequence[Mapping[str, Any]], where: str) -> Inertia | None:
        """The inertia of a body; None of one without mass.

        Args:
            body: What the stage states of it.
            name: Its name.
            shapes: Its collision shapes.
            where: Place in the file, for problems.
        """
        mass = _positive(body["mass"])
        moments, axes = self._moments(body)
        if mass is not None and moments is not None and (_stated(body["centerOfMass"]) or not shapes):
            center = self._center(body) if _stated(body["centerOfMass"]) else np.zeros(3)
            return _inertia(mass * self.units.kilograms, center, axes @ moments @ axes.T)
        parts = [part for shape in shapes if (part := self._part(body, shape)) is not None]
        if len(parts) < len(shapes) or not parts:
            if mass is None and not shapes:
                self.remarks.add("bodies without mass and without collision shapes are massless", "body", name)
                return None
            kinds = ", ".join(sorted({shape["kind"] for shape in shapes})) or "no collision shapes"
            self.problems.append(
                Problem(
                    f"body '{name}': its mass properties are not complete",
                    f"mass {body['mass']}, diagonalInertia {body['diagonalInertia']}, {kinds}",
                    "what a body leaves out follows from its collision shapes: Cube, Sphere, Cylinder, Capsule, Cone",
                    "state physics:mass, physics:centerOfMass, physics:diagonalInertia and physics:principalAxes",
                    where,
                )
            )
            return None
        self.remarks.add(
            "masses, centres or moments of inertia taken from collision shapes, as UsdPhysics has it", "body", name
        )
        whole = _together(parts)
        if mass is not None:
            whole = whole.times(mass * self.units.kilograms / whole.size)
        center = self._center(body) if _stated(body["centerOfMass"]) else whole.center
        if moments is not None:
            return _inertia(whole.size, center, axes @ moments @ axes.T)
        return _inertia(whole.size, center, np.trace(whole.E) * np.eye(3) - whole.E)

    def _part(self, body: Mapping[str, Any], shape: Mapping[str, Any]) -> Extent | None:
        """Integrals over a shape's mass, in the body's frame; None where they are not known."""
        mass, (moments, axes) = _positive(shape["mass"]), self._moments(shape)
        has_center = _stated(shape["centerOfMass"])
        volume = self._extent(body["path"], shape)
        if volume is not None:
            extent = volume.times(self._density(body, shape, volume))
        elif mass is not None and moments is not None and has_center:
            extent = Extent(mass * self.units.kilograms, np.zeros(3), np.zeros((3, 3)))
        else:
            return None
        pose, placed = self.placements[body["path"]].pose, self.placements[shape["path"]]
        if has_center:
            center = pose.R.T @ (placed.point(np.array(shape["centerOfMass"], dtype=float)) - pose.p)
            extent = replace(extent, center=center)
        if moments is not None:
            R = pose.R.T @ placed.pose.R @ axes
            turned = R @ moments @ R.T
            extent = replace(extent, E=0.5 * np.trace(turned) * np.eye(3) - turned)
        return extent

    def _center(self, body: Mapping[str, Any]) -> Array:
        """Centre of mass, which scales with the body."""
        return np.asarray(np.array(body["centerOfMass"], dtype=float) * self.placements[body["path"]].scale)

    def _moments(self, body: Mapping[str, Any]) -> tuple[Array | None, Array]:
        """Matrix of the moments of inertia about the centre of mass, and the rotation of its axes; None: not stated."""
        if body["inertia"]:
            xx, yy, zz, xy, xz, yz = np.array(body["inertia"], dtype=float) * self.units.inertia
            return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), np.eye(3)
        if body["diagonalInertia"] is None or not any(body["diagonalInertia"]):
            return None, np.eye(3)
        return np.diag(body["diagonalInertia"]) * self.units.inertia, turn(body["principalAxes"])

    def _density(self, body: Mapping[str, Any], shape: Mapping[str, Any], extent: Extent) -> float:
        """Density of a shape [kg/m^3]: of its mass, its own, the body's, its material's, or that of water."""
        mass = _positive(shape["mass"])
        if mass is not None:
            return mass * self.units.kilograms / extent.size
        for stated in (shape["density"], body["density"], shape["material density"]):
            density = _positive(stated)
            if density is not None:
                return density * self.units.density
        return DENSITY

    def _extent(self, body: str, shape: Mapping[str, Any]) -> Extent | None:
        """Integrals over a shape's volume, in the body's frame; None where they are not known."""
        unit = _unit_shape(shape["kind"], shape["sizes"])
        if unit is None:
            return None
        pose, placed = self.placements[body].pose, self.placements[shape["path"]]
        B = pose.R.T @ placed.A
        volume = abs(float(np.linalg.det(B)))
        if not volume * unit.size > 0.0:
            return None
        center = pose.R.T @ (placed.point(unit.center) - pose.p)
        return Extent(volume * unit.size, center, volume * B @ unit.E @ B.T)


def _unit_shape(kind: str, sizes: Mapping[str, Any]) -> Extent | None:
    """Integrals over a shape in its own coordinates and unit of length."""
    if kind == "Cube":
        a = float(sizes["size"])
        return Extent(a**3, np.zeros(3), np.eye(3) * a**5 / 12.0)
    r = float(sizes.get("radius", 0.0))
    if kind == "Sphere":
        volume = 4.0 / 3.0 * math.pi * r**3
        return Extent(volume, np.zeros(3), np.eye(3) * volume * r * r / 5.0)
    h = float(sizes.get("height", 0.0))
    if kind == "Cylinder":
        volume = math.pi * r * r * h
        return _along(sizes["axis"], volume, 0.0, volume * r * r / 4.0, volume * h * h / 12.0)
    if kind == "Capsule":
        middle, cap = math.pi * r * r * h, 2.0 / 3.0 * math.pi * r**3
        across = middle * r * r / 4.0 + 2.0 * cap * r * r / 5.0
        along = middle * h * h / 12.0 + 2.0 * cap * (h * h / 4.0 + 3.0 / 8.0 * h * r + r * r / 5.0)
        return _along(sizes["axis"], middle + 2.0 * cap, 0.0, across, along)
    if kind == "Cone":  # Its apex is at h/2.
        volume = math.pi * r * r * h / 3.0
        return _along(sizes["axis"], volume, -h / 4.0, volume * 3.0 / 20.0 * r * r, volume * 3.0 / 80.0 * h * h)
    return None


def _along(axis: str, volume: float, center: float, across: float, along: float) -> Extent:
    """Integrals over a body of revolution along an axis."""
    e = np.eye(3)["XYZ".index(axis)]
    return Extent(volume, center * e, across * np.eye(3) + (along - across) * np.outer(e, e))


def _together(parts: Sequence[Extent]) -> Extent:
    """Integrals over several parts, about their common centre."""
    size = math.fsum(part.size for part in parts)
    center = sum((part.size * part.center for part in parts), np.zeros(3)) / size
    E = sum(
        (part.E + part.size * np.outer(part.center - center, part.center - center) for part in parts), np.zeros((3, 3))
    )
    return Extent(size, center, E)


def _positive(value: Any) -> float | None:
    """A number that UsdPhysics takes as stated: zero stands for none."""
    return float(value) if isinstance(value, int | float) and value > 0.0 else None


def _stated(center: Any) -> bool:
    """Whether a centre of mass is stated: infinities stand for none."""
    return center is not None and all(isinstance(x, int | float) for x in center)


def _inertia(mass: float, center: Array, matrix: Array) -> Inertia:
    moments = tuple(float(matrix[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
    x, y, z = map(float, center)
    return Inertia(mass, (x, y, z), moments)
