"""Checks of beams: section properties, and conditioning of the shape functions."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from symofros.base.rotations import Array
from symofros.description.beam import STATION, Beam
from symofros.description.system import System
from symofros.description.values import ORIGIN, Value
from symofros.errors import Problem
from symofros.mechanics.beams.deformation import Deformation, deformation_of
from symofros.mechanics.beams.piecewise import stations
from symofros.mechanics.beams.shape_functions import FamilyError, Shape
from symofros.mechanics.topology.numbers import Numbers

# Beyond this the mass matrix loses all but four of a double's sixteen digits.
MOST_CONDITION = 1e12
# Relative error of the quadrature of section properties that change along the beam.
QUADRATURE_TOLERANCE = 1e-9
_POINTS = (16, 24)


def beam_problems(beam: Beam, where: str) -> Iterator[Problem]:
    """Faults that need no numbers."""
    what = f"beam '{beam.name}'"
    if len(beam.frames) > 1:
        names = ", ".join(f"'{frame.name}'" for frame in beam.frames)
        yield Problem(
            f"{what}: more than one extremity frame",
            names,
            "a slender beam has one extremity frame, at its tip",
            "keep one, and put others on a rigid body fixed to the tip",
            where,
        )
    for frame in beam.frames:
        if frame.position != ORIGIN or not frame.rotation.is_identity:
            yield Problem(
                f"{what}: frame '{frame.name}' has a placement of its own",
                "a position or a rotation",
                "the place of a beam's frame is its tip, and is computed",
                "drop it, and fix a massless body to the tip for another place",
                where,
            )
    try:
        deformation_of(beam)
    except FamilyError as error:
        yield Problem(
            f"{what}: family '{beam.family}' can't give its functions",
            str(error),
            "each family has its own functions (docs/theory/beams.md, section 2)",
            "change the number of functions, or the family",
            where,
        )


def beam_number_problems(system: System, numbers: Numbers) -> Iterator[Problem]:
    """Faults of numbers, at the parameters' defaults."""
    for beam in system.bodies:
        if isinstance(beam, Beam):
            where = system.origin.get(("body", beam.name), "")
            section_problems = list(_Section(beam, numbers, where).problems())
            yield from section_problems or _conditioning(beam, where)


class _Section:
    """The section's properties along one beam."""

    def __init__(self, beam: Beam, numbers: Numbers, where: str) -> None:
        self.beam, self.numbers, self.where = beam, numbers, where
        self.length = numbers.value(beam.length)

    def along(self, value: Value, xi: Array) -> Array:
        return np.array([self.numbers.extended({STATION: x * self.length}).value(value) for x in xi.tolist()])

    def problems(self) -> Iterator[Problem]:
        beam, what = self.beam, f"beam '{self.beam.name}'"
        if not self.length > 0.0:
            yield Problem(
                f"{what}: length {self.length:g}",
                f"'{beam.length}'",
                "the length of a beam is positive",
                "give a positive length",
                self.where,
            )
            return
        xi = np.linspace(0.0, 1.0, 33)
        for label, needed, why in (
            ("rhoA", True, "a beam has mass all along"),
            ("EI_z", bool(beam.bend_y), "bending along y bends against EI_z"),
            ("EI_y", bool(beam.bend_z), "bending along z bends against EI_y"),
            ("GJ", bool(beam.twist), "twist acts against GJ"),
            ("rhoJ", bool(beam.twist), "a twist coordinate moves the polar inertia rhoJ"),
            ("rhoI_y", False, "no moment of inertia is negative"),
            ("rhoI_z", False, "no moment of inertia is negative"),
        ):
            values = self.along(getattr(beam, label), xi)
            at = int(np.argmin(np.where(np.isfinite(values), values, -np.inf)))
            bad = not np.isfinite(values[at]) or values[at] < 0.0 or (needed and values[at] == 0.0)
            if bad:
                rule = f"{label} is {'positive' if needed else 'not negative'}: {why}"
                yield Problem(
                    f"{what}: {label} = {values[at]:g} at x = {xi[at] * self.length:g}",
                    f"'{getattr(beam, label)}'",
                    rule,
                    "mend the value",
                    self.where,
                )
            elif np.ptp(values) > 0.0:
                yield from self._quadrature(label)
        if not self.numbers.value(beam.damping) >= 0.0:
            yield Problem(
                f"{what}: damping {self.numbers.value(beam.damping):g}",
                f"'{beam.damping}'",
                "a retardation time is not negative",
                "give zero or more seconds",
                self.where,
            )

    def _quadrature(self, label: str) -> Iterator[Problem]:
        """The total of a property by two quadratures: their difference is the error of the coarser one."""
        knots = sorted({float(k) for f in deformation_of(self.beam).functions for k in f.phi.knots} or {0.0, 1.0})
        totals = []
        for points in _POINTS:
            xi, w = stations(knots, points)
            totals.append(float(np.dot(self.along(getattr(self.beam, label), np.array(xi)), w)))
        error = abs(totals[0] / totals[1] - 1.0)
        if error > QUADRATURE_TOLERANCE:
            yield Problem(
                f"beam '{self.beam.name}': {label} changes too abruptly along x",
                f"its integral is uncertain by {error:.1g}",
                f"section properties are smooth: quadrature errs by less than {QUADRATURE_TOLERANCE:g}",
                "split the beam where the section jumps",
                self.where,
            )


def _conditioning(beam: Beam, where: str) -> Iterator[Problem]:
    """The condition of the modal mass matrix, direction by direction, each coordinate scaled to unit mass."""
    shape: Deformation = deformation_of(beam)
    start = 0
    for direction, count in zip(("bend_y", "bend_z", "twist"), shape.counts, strict=True):
        functions = shape.functions[start : start + count]
        start += count
        if not count:
            continue
        condition = _condition(functions)
        if not condition < MOST_CONDITION:
            yield Problem(
                f"beam '{beam.name}': the modal mass matrix of {direction} is ill-conditioned",
                f"{count} functions of family '{beam.family}', condition {condition:.1e}",
                f"a condition below {MOST_CONDITION:g}",
                "use fewer functions, or family legendre, spline or clamped_free",
                where,
            )


@lru_cache(maxsize=256)
def _condition(functions: tuple[Shape, ...]) -> float:
    """Condition of the mass matrix of some shape functions; cached, because an editor checks the same ones often."""
    M = np.array([[float((a.phi * b.phi).integral()) for b in functions] for a in functions])
    scale = 1.0 / np.sqrt(np.diag(M))
    return float(np.linalg.cond(M * np.outer(scale, scale)))
