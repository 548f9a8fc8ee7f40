"""Checks of beams: section properties, and conditioning of the shape functions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache, partial, reduce

import numpy as np

from symofros.base.arrays import Array
from symofros.description.beams.beam import STATION, Beam
from symofros.description.beams.elastic import AXIS, IN_MATRIX, MATRIX_ORDER, STRAINS
from symofros.description.beams.sections.material import SPRING
from symofros.description.values import ORIGIN, Term, Value, substituted, symbols
from symofros.errors import Problem
from symofros.expr.expression import Expression
from symofros.mechanics.beams.piecewise import Piecewise
from symofros.mechanics.beams.quadrature import stations
from symofros.mechanics.beams.shape_functions import FamilyError
from symofros.mechanics.beams.theories import theory_of
from symofros.mechanics.beams.theory import Interpolated
from symofros.mechanics.topology.conditions import Condition, Formulas, Sign
from symofros.mechanics.topology.numbers import Numbers

# Beyond this the mass matrix loses all but four of a double's sixteen digits.
MAX_CONDITION = 1e12
# Relative error of the quadrature of section properties that change along the beam.
QUADRATURE_TOLERANCE = 1e-9
_POINTS = (16, 24)
# Error, between a rod's sections, of what is known at them alone, over its largest value.
INTERPOLATION_TOLERANCE = 1e-3
# Relative drop of a frequency by rotary inertia or shear that is left out, up to which nothing is said.
MAX_FREQUENCY_DROP = 0.01
# Relative difference between rhoJ and rhoI_y + rhoI_z up to which nothing is said.
MAX_POLAR_MISMATCH = 0.01
# EI/GJ from which walls are thin and open; relative drop of the twist by warping up to which nothing is said.
OPEN_WALLS, MAX_TWIST_DROP = 10.0, 0.01
# EI rhoA/(GA rhoI) where GA is not stated: E/G over the shear factor, 2.4 to 3.6 of full isotropic sections.
ISOTROPIC_SHEAR = 3.0
# Stations x/L at which section properties are looked at.
_STATIONS = np.linspace(0.0, 1.0, 33)


def beam_problems(beam: Beam, where: str) -> Iterator[Problem]:
    """Faults that need no numbers."""
    what = f"beam '{beam.name}'"
    for frame in beam.frames:
        if frame.position != ORIGIN or not frame.rotation.is_identity:
            yield Problem(
                f"{what}: frame '{frame.name}' has a placement of its own",
                "a position or a rotation",
                "a beam's frame turns with the section at its station, about the section's own axes",
                "drop it; state the station as at, and fix a massless body to the frame for another place",
                where,
            )
    try:
        _ = theory_of(beam).functions
    except FamilyError as error:
        yield Problem(
            f"{what}: family '{beam.family}' can't give its functions",
            str(error),
            "each family has its own functions (docs/theory/beams.md, section 2; rods.md, section 1)",
            "change the number of functions, or the family",
            where,
        )


def beam_conditions(beam: Beam, where: str) -> Iterator[Condition]:
    """Length and section properties have their signs, all along the beam."""
    return _Section(beam, where).conditions()


def beam_number_problems(beam: Beam, numbers: Numbers, where: str) -> Iterator[Problem]:
    """Section properties too abrupt for the quadrature, stiffness without a sign, ill-conditioned shape functions."""
    section = _Section(beam, where)
    yield from section.quadrature_problems(numbers)
    yield from section.interpolation_problems(numbers)
    yield from section.stiffness_problems(numbers)
    yield from _conditioning(beam, where)


def omitted_rotary_inertia(beam: Beam, numbers: Numbers) -> Iterator[tuple[str, int, float]]:
    """Rotary inertia that is stated, left out, and not small (docs/theory/beams.md, eq. 13a).

    Yields:
        Entry of the inertia, bending mode, and the share by which its frequency would fall. The mode is the highest but
        one that the functions have, as that of the last function errs by more itself.
    """
    if beam.rotary_inertia:
        return
    for plane, mode, square in _squared_radii(beam, numbers):
        share = _frequency_drop(mode, square)
        if share > MAX_FREQUENCY_DROP:
            yield f"rhoI_{_ACROSS[plane]}", mode, share


def omitted_shear(beam: Beam, numbers: Numbers) -> Iterator[tuple[str, int, float, float]]:
    """Shear that the beam does not have and that is not small (docs/theory/beams.md, eq. 13b).

    Yields:
        Plane of bending, a mode of it, the second at most, the share by which shear lowers its frequency, and the share
        that it adds to the deflection under a load at the tip.
    """
    for plane, highest, square in _squared_radii(beam, numbers):
        if getattr(beam, f"shear_{plane}"):
            continue
        GA, ratio = getattr(beam, f"GA_{plane}"), ISOTROPIC_SHEAR * square
        if GA != 0.0 and not beam.stiffness:
            EI = getattr(beam, f"EI_{_ACROSS[plane]}")
            ratio = _at_middle(beam, EI, numbers) / _at_middle(beam, GA, numbers) / numbers.value(beam.length) ** 2
        mode = min(highest, 2)
        share = _frequency_drop(mode, ratio)
        if share > MAX_FREQUENCY_DROP:
            yield plane, mode, share, 3.0 * ratio


def omitted_warping(beam: Beam, numbers: Numbers) -> tuple[float, float] | None:
    """Where GJ is that of open thin walls: EI/GJ, and how much less a tip twists whose root holds warping (27a)."""
    stated = (beam.GJ, beam.EI_y, beam.EI_z, beam.rhoA, beam.rhoI_y, beam.rhoI_z)
    if not beam.twist or beam.stiffness or 0.0 in stated:
        return None
    GJ, EI_y, EI_z, mass, inertia_y, inertia_z = (_at_middle(beam, value, numbers) for value in stated)
    ratio = min(EI_y, EI_z) / GJ
    length = numbers.value(beam.length) / np.sqrt(ratio * max(inertia_y, inertia_z) / mass)
    share = float(np.tanh(length) / length)
    return (ratio, share) if ratio > OPEN_WALLS and share > MAX_TWIST_DROP else None


def massless_shear(beam: Beam) -> Iterator[tuple[str, str]]:
    """Planes in which a shear undoes a bending, so that both move no mass, and axes across (docs/theory/rods.md, 4)."""
    functions = theory_of(beam).functions
    first = dict(zip(STRAINS, np.cumsum((0, *beam.counts[:-1])).tolist(), strict=True))
    for plane, across in _ACROSS.items():
        turned = beam.rotary_inertia and getattr(beam, f"rhoI_{across}") != 0.0 or beam.mass_center != AXIS
        names = f"bend_{plane}", f"shear_{plane}"
        bending, shear = (functions[first[name] : first[name] + getattr(beam, name)] for name in names)
        slopes = *(f.antiderivative() for f in bending), *shear
        if shear and not turned and not _condition(slopes) < MAX_CONDITION:
            yield plane, across


def polar_mismatch(beam: Beam, numbers: Numbers) -> tuple[float, float] | None:
    """rhoJ, and rhoI_y + rhoI_z, which it is of any section, where all are stated and differ at mid-length."""
    stated = beam.rhoJ, beam.rhoI_y, beam.rhoI_z
    if 0.0 in stated:
        return None
    polar, *others = (_at_middle(beam, value, numbers) for value in stated)
    return (polar, sum(others)) if abs(polar - sum(others)) > MAX_POLAR_MISMATCH * sum(others) else None


# Axis about which bending in a plane turns sections.
_ACROSS = {"y": "z", "z": "y"}


def _squared_radii(beam: Beam, numbers: Numbers) -> Iterator[tuple[str, int, float]]:
    """Planes of bending whose inertia is stated: the highest mode but one, and rhoI/(rhoA L^2) at mid-length."""
    for plane, count in (("y", beam.bend_y), ("z", beam.bend_z)):
        inertia = getattr(beam, f"rhoI_{_ACROSS[plane]}")
        if count and inertia != 0.0:
            mass, length = _at_middle(beam, beam.rhoA, numbers), numbers.value(beam.length)
            yield plane, max(1, count * beam.segments - 1), _at_middle(beam, inertia, numbers) / mass / length**2


def _at_middle(beam: Beam, value: Value, numbers: Numbers) -> float:
    return float(section_values(beam, value, np.array([0.5]), numbers.parameters).item())


def _frequency_drop(mode: int, ratio: float) -> float:
    return float(1.0 - 1.0 / np.sqrt(1.0 + _squared_slope(mode) * ratio))


def _squared_slope(mode: int) -> float:
    """Mean square of the slope of a cantilever's mode, by xi, over that of the deflection."""
    number = (mode - 0.5) * np.pi
    return 4.648 if mode == 1 else number * (number + 2.0)


class _Section:
    """The section's properties along one beam."""

    def __init__(self, beam: Beam, where: str) -> None:
        self.beam, self.where, self.what = beam, where, f"beam '{beam.name}'"

    def conditions(self) -> Iterator[Condition]:
        beam = self.beam
        yield Condition(
            (beam.length,),
            "positive",
            partial(self._wrong_number, "length", "the length of a beam is positive", "give a positive length"),
        )
        # A matrix has all stiffnesses: `stiffness_problems`.
        elsewhere = IN_MATRIX if beam.stiffness else beam.elastic.lacking
        for label, counts, why in (
            ("rhoA", True, "a beam has mass all along"),
            ("EI_z", beam.bend_y, "bending along y bends against EI_z"),
            ("EI_y", beam.bend_z, "bending along z bends against EI_y"),
            ("GJ", beam.twist, "twist acts against GJ"),
            ("EA", beam.stretch, "a rod stretches against EA"),
            ("GA_y", beam.shear_y, "shear along y is against GA_y"),
            ("GA_z", beam.shear_z, "shear along z is against GA_z"),
            ("rhoJ", beam.twist, "a twist coordinate moves the polar inertia rhoJ"),
            ("rhoI_y", False, "no moment of inertia is negative"),
            ("rhoI_z", False, "no moment of inertia is negative"),
        ):
            needed = bool(counts) and label not in elsewhere
            rule = f"{label} is {'positive' if needed else 'not negative'}: {why}"
            sign: Sign = "positive" if needed else "not negative"
            yield Condition(self._margins(getattr(beam, label)), sign, partial(self._wrong_sign, label, rule))
        for product, first, second in (("EI_yz", "EI_y", "EI_z"), ("rhoI_yz", "rhoI_y", "rhoI_z")):
            stated = [Term(getattr(beam, label)) for label in (first, second, product)]
            if stated[2].value != 0.0:
                margin = (stated[0] * stated[1] - stated[2] * stated[2]).value
                yield Condition(self._margins(margin), "positive", partial(self._wrong_product, product, first, second))
        yield Condition(
            (beam.damping,),
            "not negative",
            partial(self._wrong_number, "damping", "a retardation time is not negative", "give zero or more seconds"),
        )

    def _margins(self, value: Value) -> tuple[Value, ...]:
        """A property at stations; along a beam of no length, which is reported, at the root."""
        if STATION not in symbols(value):
            return (value,)
        length = Term(self.beam.length).maximum(Term(0.0))
        return tuple(substituted(value, STATION, (Term(xi) * length).value) for xi in _STATIONS.tolist())

    def _wrong_number(self, label: str, rule: str, remedy: str, numbers: Numbers) -> Problem:
        stated = getattr(self.beam, label)
        return Problem(f"{self.what}: {label} {numbers.value(stated):g}", f"'{stated}'", rule, remedy, self.where)

    def _wrong_sign(self, label: str, rule: str, numbers: Numbers) -> Problem:
        (values,) = section_values(self.beam, getattr(self.beam, label), _STATIONS, numbers.parameters)
        length = numbers.value(self.beam.length)
        at = int(np.argmin(np.where(np.isfinite(values), values, -np.inf)))
        return Problem(
            f"{self.what}: {label} = {values[at]:g} at x = {_STATIONS[at] * length:g}",
            f"'{getattr(self.beam, label)}'",
            rule,
            SPRING if label == "rhoA" and values[at] == 0.0 else "mend the value",
            self.where,
        )

    def _wrong_product(self, product: str, first: str, second: str, numbers: Numbers) -> Problem:
        found = ", ".join(f"{label} = '{getattr(self.beam, label)}'" for label in (product, first, second))
        rule = f"{first} and {second} are positive, and their product exceeds the square of {product}"
        missing = [label for label in (first, second) if getattr(self.beam, label) == 0.0]
        remedy = f"state {' and '.join(missing)}" if missing else f"state a smaller {product}, or turn the section"
        return Problem(f"{self.what}: {product} too large", found, rule, remedy, self.where)

    def stiffness_problems(self, numbers: Numbers) -> Iterator[Problem]:
        """A matrix of stiffness that is not positive definite at a station."""
        least, at = least_stiffness(self.beam, numbers.parameters)
        if not least[0] > 0.0:
            yield Problem(
                f"{self.what}: stiffness is not positive definite",
                f"at x = {at[0]:g} m the least eigenvalue, of unit diagonal, is {least[0]:.3g}",
                "every strain takes energy",
                "check the order of its rows and their units, or state EA, GA_y, GA_z, GJ, EI_y and EI_z in its place",
                self.where,
            )

    def interpolation_problems(self, numbers: Numbers) -> Iterator[Problem]:
        """Problems of properties that vary too fast for a rod's few sections (docs/theory/rods.md, section 6)."""
        interpolated = theory_of(self.beam).interpolated
        for labels, values in interpolated.properties:
            error = float(_interpolation_error(self.beam, interpolated, values, numbers.parameters)[0])
            if not error <= INTERPOLATION_TOLERANCE:
                yield Problem(
                    f"{self.what}: {labels} changes more along x than the rod's sections follow",
                    f"between them it is off by {error:.1g} of its largest value",
                    f"it is taken through the sections, to {INTERPOLATION_TOLERANCE:g}",
                    "state more sections, or split the rod",
                    self.where,
                )

    def quadrature_problems(self, numbers: Numbers) -> Iterator[Problem]:
        """Properties whose integral is not determined by their values at stations."""
        for label, value in self.beam.along_axis():
            error = float(quadrature_error(self.beam, value, numbers.parameters)[0])
            if not error <= QUADRATURE_TOLERANCE:
                yield Problem(
                    f"{self.what}: {label} changes too abruptly along x",
                    f"its integral is uncertain by {error:.1g}",
                    f"section properties are smooth: quadrature errs by less than {QUADRATURE_TOLERANCE:g}",
                    "split the beam where the section jumps",
                    self.where,
                )


def section_values(beam: Beam, value: Value, xi: Array, values: Mapping[str, Array | float]) -> Array:
    """A section property at stations xi = x/L (n) for each of several states (states, n).

    Args:
        beam: Beam.
        value: The property.
        xi: Stations (n).
        values: Number of each parameter, or one for each state (states).
    """
    columns = {name: np.reshape(value, (-1, 1)) for name, value in values.items()}
    x = Formulas([beam.length])(columns)[0] * xi[None, :]
    (along,) = Formulas([value])({**columns, STATION: x})
    return np.array(np.broadcast_to(along, np.broadcast_shapes(np.shape(along), x.shape)))


def beam_mass(beam: Beam, numbers: Numbers) -> float:
    """Mass of a beam [kg], by Gauss's quadrature where its section changes."""
    xi, w = stations((0.0, 1.0), _POINTS[0])
    along = section_values(beam, beam.rhoA, np.array(xi), numbers.parameters)[0]
    return numbers.value(beam.length) * float(along @ np.array(w))


def least_stiffness(beam: Beam, values: Mapping[str, Array | float]) -> tuple[Array, Array]:
    """Least eigenvalue of a matrix of stiffness, its diagonal scaled to one, and its station x [m] (states).

    It is 1 at the root of a beam that has no such matrix.
    """
    if not beam.stiffness:
        return np.ones(1), np.zeros(1)
    size = len(MATRIX_ORDER)
    entries = [section_values(beam, value, _STATIONS, values) for row in beam.stiffness for value in row]
    K = np.stack(np.broadcast_arrays(*entries), axis=-1)
    K = K.reshape(*K.shape[:-1], size, size)
    diagonal = np.diagonal(K, axis1=-2, axis2=-1)
    scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    scaled = scale[..., :, None] * K * scale[..., None, :]
    finite = np.isfinite(scaled).all(axis=(-2, -1))
    least = np.linalg.eigvalsh(np.where(finite[..., None, None], scaled, -np.eye(size)))[..., 0]
    x = np.broadcast_to(section_values(beam, Expression("symbol", name=STATION), _STATIONS, values), least.shape)
    at = np.argmin(least, axis=1)[:, None]
    return np.take_along_axis(least, at, axis=1)[:, 0], np.take_along_axis(x, at, axis=1)[:, 0]


def quadrature_error(beam: Beam, value: Value, values: Mapping[str, Array | float]) -> Array:
    """Relative difference of a property's total by two quadratures, which is the error of the coarser one (states)."""
    if STATION not in symbols(value):
        return np.zeros(1)
    knots = sorted({float(k) for f in theory_of(beam).functions for k in f.knots} or {0.0, 1.0})
    totals = []
    for points in _POINTS:
        xi, w = stations(knots, points)
        along = section_values(beam, value, np.array(xi), values)
        totals.append(along @ np.array(w))
    scale = np.abs(along) @ np.array(w)  # Not of the total: what changes its sign, as a centre may, has a small one.
    return np.asarray(np.abs(totals[0] - totals[1]) / np.where(scale > 0.0, scale, 1.0))


def interpolation_error(beam: Beam, values: Mapping[str, Array | float]) -> Array:
    """Largest relative error of properties interpolated through their values at a beam's sections (states)."""
    interpolated = theory_of(beam).interpolated
    errors = [_interpolation_error(beam, interpolated, stated, values) for _, stated in interpolated.properties]
    return np.asarray(reduce(np.maximum, errors, np.zeros(1)))


def _interpolation_error(
    beam: Beam, interpolated: Interpolated, stated: Sequence[Value], values: Mapping[str, Array | float]
) -> Array:
    """Largest difference of values to polynomials through a beam's sections, over the largest value (states)."""
    if not any(STATION in symbols(value) for value in stated):
        return np.zeros(1)
    off, largest = np.zeros(1), np.zeros(1)
    for value in stated:
        known, between = (
            section_values(beam, value, np.array(xi), values) for xi in (interpolated.known, interpolated.between)
        )
        through = known @ np.array(interpolated.weights).T
        off = np.maximum(off, np.abs(through - between).max(axis=1))
        largest = np.maximum(largest, np.abs(between).max(axis=1))
    return np.asarray(off / np.where(largest > 0.0, largest, 1.0))


def _conditioning(beam: Beam, where: str) -> Iterator[Problem]:
    """The condition of the modal mass matrix, direction by direction, each coordinate scaled to unit mass.

    Of a rod it is that of the strain functions themselves: that of the strain energy.
    """
    start, every = 0, theory_of(beam).functions
    for direction, count in zip(STRAINS, beam.counts, strict=True):
        functions = tuple(every[start : start + count])
        start += count
        if not count:
            continue
        condition = _condition(functions)
        if not condition < MAX_CONDITION:
            yield Problem(
                f"beam '{beam.name}': the modal mass matrix of {direction} is ill-conditioned",
                f"{count} functions of family '{beam.family}', condition {condition:.1e}",
                f"a condition below {MAX_CONDITION:g}",
                "use fewer functions, or family legendre, spline or clamped_free",
                where,
            )


@lru_cache(maxsize=256)
def _condition(functions: tuple[Piecewise, ...]) -> float:
    """Condition of the mass matrix of some shape functions; cached, because an editor checks the same ones often."""
    M = np.array([[float((a * b).integral()) for b in functions] for a in functions])
    scale = 1.0 / np.sqrt(np.diag(M))
    return float(np.linalg.cond(M * np.outer(scale, scale)))
