"""Section: stiffness and mass per length of a beam, of a material and a geometry (docs/theory/beams.md, section 8)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from symofros.description.beams.beam import SECTION
from symofros.description.beams.elastic import (
    CENTERS,
    ELASTIC,
    IN_MATRIX,
    PRODUCTS,
    STRAIN_STIFFNESSES,
    Theory,
    stiffness_rows,
)
from symofros.description.beams.sections.matrices import (
    CHECK,
    OF_SECTION,
    difference,
    matrices_about_x,
    properties_of_mass,
    properties_of_stiffness,
)
from symofros.description.beams.sections.shear import ShearShape
from symofros.description.entries import refuses_unknown_entries
from symofros.description.values import Term, Value, as_value, as_values, symbols
from symofros.errors import DescriptionError
from symofros.expr.expression import evaluate

# Relative to the section's size, what counts as on the axis: meshes of symmetric outlines are not symmetric, and their
# shear centres err by some 1e-5; bending twists a beam by as much.
_ON_AXIS = 1e-4


@refuses_unknown_entries
@dataclass(frozen=True)
class Section:
    """What a cross-section brings to a beam, per length; y and z are axes of the beam, x is along it.

    Entries are numbers or formulas of parameters and of the station x.

    Attributes:
        EA: Stiffness against stretching [N].
        GJ: Stiffness against twist [N m^2].
        EI_y: Stiffness against bending in the x-z plane, the integral of E z^2 about the tension centre [N m^2].
        EI_z: Stiffness against bending in the x-y plane, the integral of E y^2 about the tension centre [N m^2].
        rhoA: Mass [kg/m].
        rhoI_y: Moment of inertia about y through the mass centre [kg m].
        rhoI_z: Moment of inertia about z through the mass centre [kg m].
        GA_y: Stiffness against shear along y, by the energy of the shear stress [N]; None where it is not known.
        GA_z: Stiffness against shear along z, by the energy of the shear stress [N]; None where it is not known.
        EI_yz: Integral of E y z about the tension centre [N m^2].
        rhoI_yz: Integral of rho y z about the mass centre [kg m].
        tension_center: Point (y, z) where a force along x does not bend [m].
        shear_center: Point (y, z) where a force across does not twist [m].
        mass_center: Mass centre (y, z) [m].
        stiffness: Stiffness about the axis (6, 6) where it couples more strains than centres off the axis and products
            do, in the order of `stiffness_matrix`; the entries from EA to the shear centre then are what is about the
            centres, without the couplings.
        E: Young's modulus, for stresses [N/m^2]; None where it is not known, or not the same all over the section.
        corners: Points (y, z) whose convex hull has the section's extreme fibres [m].
        radii: Two conjugate radii (y, z) of an elliptic outline, in place of corners [m].
        shape: The shape about the tension centre, where its shear stress is known; None where it is not.
    """

    EA: Value
    GJ: Value
    EI_y: Value
    EI_z: Value
    rhoA: Value
    rhoI_y: Value
    rhoI_z: Value
    GA_y: Value | None = None
    GA_z: Value | None = None
    EI_yz: Value = 0.0
    rhoI_yz: Value = 0.0
    tension_center: tuple[Value, Value] = (0.0, 0.0)
    shear_center: tuple[Value, Value] = (0.0, 0.0)
    mass_center: tuple[Value, Value] = (0.0, 0.0)
    stiffness: tuple[tuple[Value, ...], ...] = ()
    E: Value | None = None
    corners: tuple[tuple[Value, Value], ...] = ()
    radii: tuple[tuple[Value, Value], ...] = ()
    shape: ShearShape | None = None

    def __post_init__(self) -> None:
        """Convert the numbers."""
        for item in fields(self):
            stated: Any = getattr(self, item.name)
            if item.name == "shape" or stated is None and item.name not in CENTERS:
                continue
            label = f"section: {item.name}"
            if item.name == "stiffness":
                stated = stiffness_rows(stated, label)
            elif item.name in CENTERS:
                stated = as_values(stated, 2, label)
            else:
                stated = _as_values(stated, label)
            object.__setattr__(self, item.name, stated)

    @staticmethod
    def of_matrices(stiffness: npt.ArrayLike, mass: npt.ArrayLike, axis: Literal["x", "z"] = "x") -> Section:
        """A section by its matrices, as programs for sections of composites write them.

        Args:
            stiffness: Force and moment per strain (6, 6), symmetric and positive definite [N, N m, N m^2].
            mass: Momentum and angular momentum per length, per velocity and angular velocity (6, 6) [kg/m, kg, kg m].
            axis: The axis of both that is along the beam: "x", with y and z across (VABS), or "z", with x and y across
                (BeamDyn), which become y and z of the beam.

        Raises:
            DescriptionError: A matrix is of another shape, or is none of a section.
        """
        K, M = matrices_about_x(stiffness, mass, axis)
        section = Section(**properties_of_stiffness(K), **properties_of_mass(M))
        unlike = difference(M, section.mass_matrix())
        if not unlike <= OF_SECTION:
            rule = "matter in one plane: m, m, m, and moments about x that are the sum of those about y and z"
            found = f"of a section's with the same m, centre and moments it is off by {unlike:.2g}"
            raise DescriptionError("section: M is no mass matrix of a section", found, rule, CHECK)
        if difference(K, section.stiffness_matrix()) > OF_SECTION:
            section = replace(section, stiffness=tuple(map(tuple, K.tolist())))
        return section

    @property
    def rhoJ(self) -> Value:
        """Polar moment of inertia, about x through the mass centre [kg m]."""
        return (Term(self.rhoI_y) + Term(self.rhoI_z)).value

    def beam_properties(self, theory: Theory = "second_order") -> dict[str, Value]:
        """The section properties of a Beam: `Beam(name, joint, length, **section.beam_properties())`.

        Args:
            theory: Theory of the beam: one by strains takes the stiffnesses against stretching and shear, too, and
                centres off the axis.

        Raises:
            DescriptionError: For a beam of second order the axis does not go through all three centres, y and z are no
                principal axes, or strains are coupled.
        """
        if ELASTIC[theory].has_coupled_sections:
            return self._coupled_properties()
        for label, value, size in self._off_axis():
            if not _is_small(value, size):
                raise DescriptionError(
                    f"section: {label} is not zero",
                    f"{value:g}" if isinstance(value, float) else str(value),
                    "a beam of second order has its mass centre, tension centre and shear centre on its axis, and y"
                    " and z are principal axes",
                    "for axes that are not principal ones turn the section (`turned`); for a section whose centres"
                    " differ, which couples bending and twist, state theory: strain",
                )
        if self.stiffness:
            rule = "a beam of second order in its displacements has no such couplings"
            found = "a matrix of stiffness"
            raise DescriptionError("section: couples strains", found, rule, "state theory: strain")
        return {label: getattr(self, label) for label in SECTION if label not in (*STRAIN_STIFFNESSES, *PRODUCTS)}

    def _coupled_properties(self) -> dict[str, Any]:
        """Properties of an exact rod that differ from a rod's defaults; small distances are the mesh's."""
        off_axis = {label for label, value, size in self._off_axis() if not _is_small(value, size)}
        centers = {label for label in CENTERS if {f"{label}'s y", f"{label}'s z"} & off_axis}
        labels = [label for label in SECTION if label not in PRODUCTS or label in off_axis]
        labels += [label for label in CENTERS if label in centers]
        if self.stiffness:
            labels = [label for label in labels if label not in IN_MATRIX] + ["stiffness"]
        elif "EI_yz" in off_axis:  # Then shears along y and z are coupled, by what is not known.
            labels = [label for label in labels if label not in ("GA_y", "GA_z")]
        return {label: getattr(self, label) for label in labels if getattr(self, label) is not None}

    def _off_axis(self) -> list[tuple[str, Value, Value]]:
        """(name, value, reference size) of the properties for which a beam has no entry."""
        height = (Term(self.EI_y) + Term(self.EI_z)) / Term(self.EA)
        size = height.sqrt().value
        centers = [
            (f"{label}'s {axis}", value, size)
            for label in ("tension_center", "shear_center", "mass_center")
            for axis, value in zip("yz", getattr(self, label), strict=True)
        ]
        bending, inertia = (
            (Term(first) * Term(second)).sqrt().value
            for first, second in ((self.EI_y, self.EI_z), (self.rhoI_y, self.rhoI_z))
        )
        return [*centers, ("EI_yz", self.EI_yz, bending), ("rhoI_yz", self.rhoI_yz, inertia)]

    @property
    def principal_angle(self) -> float:
        """Angle about x to the axes for which EI_yz is zero and EI_z not smaller than EI_y [rad], in (-pi/2, pi/2]."""
        EI_y, EI_z, EI_yz = self._numbers(("EI_y", "EI_z", "EI_yz"))
        return 0.5 * float(np.arctan2(2.0 * EI_yz, EI_z - EI_y))

    def turned(self, angle: float) -> Section:
        """The same section with components along axes that are turned about x.

        Args:
            angle: Angle from the present y axis to the new one [rad].
        """
        c, s = float(np.cos(angle)), float(np.sin(angle))
        new: dict[str, Any] = {item.name: getattr(self, item.name) for item in fields(self)}
        for name in ("EI", "rhoI"):
            yy, zz, yz = self._numbers((f"{name}_z", f"{name}_y", f"{name}_yz"))  # Integrals of y^2, z^2, y z.
            new[f"{name}_z"] = c * c * yy + 2.0 * c * s * yz + s * s * zz
            new[f"{name}_y"] = s * s * yy - 2.0 * c * s * yz + c * c * zz
            new[f"{name}_yz"] = (c * c - s * s) * yz - c * s * (yy - zz)
        for name in ("tension_center", "shear_center", "mass_center"):
            y, z = self._point(name)
            new[name] = (c * y + s * z, c * z - s * y)
        for name in ("corners", "radii"):
            new[name] = tuple((c * y + s * z, c * z - s * y) for y, z in self._points(name))
        if self.stiffness:
            T = np.kron(np.eye(2), [[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]])
            new["stiffness"] = tuple(map(tuple, (T @ self.stiffness_matrix() @ T.T).tolist()))
        # Shear along axes that are not principal ones of shear is coupled: unknown, unless the angle is a right one.
        quarter = round(angle / (0.5 * np.pi))
        if abs(angle - quarter * 0.5 * np.pi) > 1e-12:
            new["GA_y"] = new["GA_z"] = None
        elif quarter % 2:
            new["GA_y"], new["GA_z"] = self.GA_z, self.GA_y
        if self.shape is not None:
            new["shape"] = replace(self.shape, angle=self.shape.angle + angle)
        return Section(**new)

    def stiffness_matrix(self, values: Mapping[str, float] | None = None) -> npt.NDArray[np.float64]:
        """Stiffness about the axis: (force, moment) = K (stretch and shears, twist rate and curvatures), (6, 6).

        Args:
            values: Number of each parameter and of the station.

        Raises:
            DescriptionError: The stiffness against shear is not known.
        """
        if self.stiffness:
            return np.array([[number_of(value, "stiffness", values or {}) for value in row] for row in self.stiffness])
        if self.GA_y is None or self.GA_z is None:
            raise DescriptionError(
                "section: stiffness against shear is not known",
                "GA_y or GA_z is None",
                "a stiffness matrix has it",
                "give GA_y and GA_z",
            )
        EA, GA_y, GA_z, GJ, EI_y, EI_z, EI_yz = self._numbers(
            ("EA", "GA_y", "GA_z", "GJ", "EI_y", "EI_z", "EI_yz"), values
        )
        (y_t, z_t), (y_s, z_s) = self._point("tension_center", values), self._point("shear_center", values)
        K = np.diag([EA, GA_y, GA_z, GJ, EI_y, EI_z])
        K[4, 5] = K[5, 4] = -EI_yz
        # Strains at the centres by those of the axis.
        T = np.eye(6)
        T[0, 4], T[0, 5], T[1, 3], T[2, 3] = z_t, -y_t, -z_s, y_s
        return np.asarray(T.T @ K @ T)

    def mass_matrix(self, values: Mapping[str, float] | None = None) -> npt.NDArray[np.float64]:
        """Mass about the axis: (momentum, angular momentum) per length = M (velocity, angular velocity), (6, 6).

        Args:
            values: Number of each parameter and of the station.
        """
        m, I_y, I_z, I_yz = self._numbers(("rhoA", "rhoI_y", "rhoI_z", "rhoI_yz"), values)
        y, z = self._point("mass_center", values)
        M = np.diag([m, m, m, I_y + I_z, I_y, I_z])
        M[4, 5] = M[5, 4] = -I_yz
        T = np.eye(6)
        T[0, 4], T[0, 5], T[1, 3], T[2, 3] = z, -y, -z, y
        return np.asarray(T.T @ M @ T)

    def normal_stress(
        self, forces: npt.ArrayLike, points: npt.ArrayLike, values: Mapping[str, float] | None = None
    ) -> npt.NDArray[np.float64]:
        """Normal stress at points of the section (..., points) [N/m^2], positive in tension (eq. 32).

        Args:
            forces: Section forces N, Vy, Vz, T, My, Mz about the axis (..., 6) [N, N m].
            points: Points (y, z) (points, 2) [m].
            values: Number of each parameter and of the station.

        Raises:
            DescriptionError: Young's modulus is not known.
        """
        constant, gradient = self._normal_stress(forces, values or {})
        return np.asarray(constant[..., None] + gradient @ np.asarray(points, dtype=np.float64).T)

    def extreme_stresses(
        self, forces: npt.ArrayLike, values: Mapping[str, float] | None = None
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Smallest and largest normal stress over the section (...) [N/m^2], as of `normal_stress`.

        Raises:
            DescriptionError: Young's modulus or the outline is not known.
        """
        constant, gradient = self._normal_stress(forces, values or {})
        corners, radii = (np.array(self._points(name, values)).reshape(-1, 2) for name in ("corners", "radii"))
        if len(corners):
            at = constant[..., None] + gradient @ corners.T
            return at.min(axis=-1), at.max(axis=-1)
        if not len(radii):
            rule = "extreme stresses are at the outline"
            raise DescriptionError(
                "section: its outline is not known", "no corners, no radii", rule, "state corners, or use points"
            )
        reach = np.linalg.norm(gradient @ radii.T, axis=-1)
        return constant - reach, constant + reach

    def shear_stress(
        self, forces: npt.ArrayLike, points: npt.ArrayLike, values: Mapping[str, float] | None = None
    ) -> npt.NDArray[np.float64]:
        """Shear stresses tau_xy, tau_xz at points of the section (..., points, 2) [N/m^2] (eqs. 28a, 28c, 32a to 32e).

        They are Saint-Venant's, of rectangles, ellipses and tubes: those far from clamps, jumps and loads, where the
        section is free to warp.

        Args:
            forces: Section forces N, Vy, Vz, T, My, Mz about the axis (..., 6) [N, N m].
            points: Points (y, z) (points, 2) [m].
            values: Number of each parameter and of the station.

        Raises:
            DescriptionError: The stress of this shape is not known, or a point is not on the section.
        """
        if self.shape is None:
            raise DescriptionError(
                "section: its shear stress is not known",
                "no rectangle, ellipse, circle or tube",
                "shear stress has a closed form for these",
                "use finite elements of the outline, as sectionproperties has them",
            )
        values = values or {}
        places = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        _, Vy, Vz, T, _, _ = np.moveaxis(np.asarray(forces, dtype=np.float64), -1, 0)
        y_s, z_s = self._point("shear_center", values)
        loads = np.stack([Vy, Vz, T - (y_s * Vz - z_s * Vy)], axis=-1)
        a, b = (number_of(size, "shape", values) for size in self.shape.sizes)
        ratio = number_of(self.shape.ratio, "E/G", values)
        return self.shape.stresses((a, b), ratio, loads, places, self._point("tension_center", values))

    def _normal_stress(
        self, forces: npt.ArrayLike, values: Mapping[str, float]
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Normal stress on the axis (...), and its gradient by y and z (..., 2)."""
        if self.E is None:
            rule = "stress is Young's modulus times strain"
            raise DescriptionError("section: Young's modulus is not known", "E is None", rule, "state E")
        E, EA, EI_y, EI_z, EI_yz = self._numbers(("E", "EA", "EI_y", "EI_z", "EI_yz"), values)
        y, z = self._point("tension_center", values)
        N, _, _, _, My, Mz = np.moveaxis(np.asarray(forces, dtype=np.float64), -1, 0)
        about_center = np.stack([My - z * N, Mz + y * N], axis=-1)
        curvatures = about_center @ np.linalg.inv([[EI_y, -EI_yz], [-EI_yz, EI_z]])
        gradient = E * np.stack([-curvatures[..., 1], curvatures[..., 0]], axis=-1)
        return np.asarray(E * N / EA - gradient @ [y, z]), gradient

    def _points(self, label: str, values: Mapping[str, float] | None = None) -> list[tuple[float, float]]:
        pairs = getattr(self, label)
        return [(number_of(y, label, values or {}), number_of(z, label, values or {})) for y, z in pairs]

    def _numbers(self, labels: tuple[str, ...], values: Mapping[str, float] | None = None) -> list[float]:
        return [number_of(getattr(self, label), label, values or {}) for label in labels]

    def _point(self, label: str, values: Mapping[str, float] | None = None) -> tuple[float, float]:
        y, z = (number_of(value, label, values or {}) for value in getattr(self, label))
        return y, z


def _is_small(value: Value, size: Value) -> bool:
    """Whether a distance, or a product of inertia, is what a mesh leaves of zero."""
    return isinstance(value, float) and (value == 0.0 or isinstance(size, float) and abs(value) <= _ON_AXIS * size)


def _as_values(stated: Any, label: str) -> Any:
    """A value, a pair of values, or pairs."""
    if isinstance(stated, tuple | list):
        return tuple(_as_values(item, label) for item in stated)
    return as_value(stated, label)


def number_of(value: Value, label: str, values: Mapping[str, float]) -> float:
    """The number of a formula.

    Raises:
        DescriptionError: It depends on what has no value.
    """
    missing = symbols(value) - values.keys()
    if missing:
        raise DescriptionError(
            f"section: {label} has no number",
            f"it depends on {', '.join(sorted(missing))}",
            "this needs numbers: of outlines by finite elements, of angles, of matrices",
            "give numbers, or the values of the parameters where they are asked for",
        )
    return float(evaluate(value, values))
