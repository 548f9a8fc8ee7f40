"""Beam: a flexible body, with the loads along its axis. No computation."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import combinations, pairwise
from numbers import Real
from typing import Any, Literal, get_args

from symofros.base.arguments import entries_of
from symofros.description.entries import pairs_of, refuses_unknown_entries
from symofros.description.frames import Frame
from symofros.description.joints.joint import Joint
from symofros.description.values import ORIGIN, Value, Vector, as_value, as_values, as_vector
from symofros.errors import DescriptionError, Problem, did_you_mean

Direction = Literal["bend_y", "bend_z", "twist", "stretch", "shear_y", "shear_z"]
# Strains of a geometrically exact rod; a beam of second order deforms in the first three directions.
STRAINS: tuple[Direction, ...] = get_args(Direction)
DIRECTIONS = STRAINS[:3]
Family = Literal["spline", "polynomial", "legendre", "clamped_free", "hermite", "user"]
FAMILIES: tuple[Family, ...] = get_args(Family)
Retain = Literal["zeroth_order", "first_order", "all"]
RETAIN: tuple[Retain, ...] = get_args(Retain)
Theory = Literal["second_order", "strain"]
THEORIES: tuple[Theory, ...] = get_args(Theory)
MOST_SECTIONS = 64
# Stations x/L of section forces, where none are stated.
STATIONS = tuple(k / 8 for k in range(9))

# Stiffnesses that rods alone have.
ROD_STIFFNESSES = ("EA", "GA_y", "GA_z")
# What may depend on the station x, and so taper.
SECTION = ("rhoA", "EI_y", "EI_z", "GJ", *ROD_STIFFNESSES, "rhoJ", "rhoI_y", "rhoI_z", "EI_yz", "rhoI_yz")
# Points (y, z) of the section, of rods alone, which may depend on it too.
CENTERS = ("tension_center", "shear_center", "mass_center")
# Strains of a rod without stress: functions of the station as well.
PRE_STRAINS = ("twist_rate", "curvature_y", "curvature_z")
# Strains in the order of a matrix of stiffness, and what such a matrix takes the place of.
MATRIX_ORDER = ("stretch", "shear_y", "shear_z", "twist_rate", "curvature_y", "curvature_z")
IN_MATRIX = ("EI_y", "EI_z", "GJ", *ROD_STIFFNESSES, "EI_yz", "tension_center", "shear_center")
STATION = "x"


@refuses_unknown_entries
@dataclass(frozen=True)
class Samples:
    """A shape function by its values at stations; a cubic spline goes through them, the cubic itself where it is one.

    Attributes:
        xi: Stations x/L of the samples, rising from 0 to 1.
        values: Values of the function at the stations.
    """

    xi: tuple[float, ...]
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        """Convert, and check the stations."""
        object.__setattr__(self, "xi", tuple(float(x) for x in self.xi))
        object.__setattr__(self, "values", tuple(float(x) for x in self.values))
        rising = all(a < b for a, b in zip(self.xi, self.xi[1:], strict=False))
        if len(self.xi) < 4 or len(self.xi) != len(self.values) or not rising or (self.xi[0], self.xi[-1]) != (0, 1):
            raise DescriptionError(
                Problem(
                    "sampled shape function: unusable stations",
                    f"{len(self.xi)} stations, {len(self.values)} values",
                    "at least 4 stations that rise from 0 to 1, and one value for each",
                    "sort the stations, divide them by the length, and give each its value",
                )
            )
        if not all(map(math.isfinite, self.values)):
            at = next(i for i, value in enumerate(self.values) if not math.isfinite(value))
            raise DescriptionError(
                Problem(
                    "sampled shape function: a value is not a finite number",
                    f"{self.values[at]} at xi = {self.xi[at]:g}",
                    "values of shape functions are finite numbers",
                    "mend or leave out the sample",
                )
            )


# Difference of two entries across the diagonal of a matrix of stiffness, over the root of the product of the
# diagonal's: programs for sections write seven digits.
_ASYMMETRY = 1e-6

UserShape = Value | Samples
Point = tuple[Value, Value]
_AXIS: Point = (0.0, 0.0)


@refuses_unknown_entries
@dataclass(frozen=True)
class BeamLoad:
    """A force and a moment on the axis, at one station or spread over the length.

    Attributes:
        force: Force [N], or [N/m] if spread; formulas as for a Load, and of the station x [m] if spread.
        torque: Moment [N m], or [N m/m] if spread; formulas as for the force.
        at: Station x/L, from 0 (root) to 1 (tip); spread over the length if not given.
        axes: Axes of the components: "body" (those of the undeformed beam), "world", or "section" (those of each
            section of a geometrically exact rod: a force that follows it).
    """

    force: Vector = ORIGIN
    torque: Vector = ORIGIN
    at: float | None = None
    axes: Literal["body", "world", "section"] = "body"

    def __post_init__(self) -> None:
        """Convert the components, check the station."""
        object.__setattr__(self, "force", as_vector(self.force, "beam load: force"))
        object.__setattr__(self, "torque", as_vector(self.torque, "beam load: torque"))
        if self.at is not None and not (isinstance(self.at, Real) and 0.0 <= self.at <= 1.0):
            raise DescriptionError(
                Problem(
                    "beam load: station off the beam",
                    f"at {self.at!r}",
                    "at is x/L, from 0 (root) to 1 (tip)",
                    "divide the station by the length; leave at out for a load that is spread",
                )
            )
        if self.axes not in ("body", "world", "section"):
            raise DescriptionError(
                Problem(
                    f"beam load: axes '{self.axes}'",
                    str(self.axes),
                    "axes are 'body', 'world' or 'section'",
                    did_you_mean(str(self.axes), ("body", "world", "section")),
                )
            )


@refuses_unknown_entries
@dataclass(frozen=True)
class Beam:
    """A slender elastic body along x of its frame B, clamped to B at the root (docs/theory/beams.md).

    Section properties are numbers or formulas of parameters and, where the section changes, of the station x [m].

    Attributes:
        name: Unique; also the name of its body frame, at the root.
        joint: Joint between the root and its parent; kind "fixed" clamps it there.
        length: Length [m].
        rhoA: Mass per length [kg/m].
        EI_z: Stiffness against bending in the x-y plane, about the tension centre [N m^2].
        EI_y: Stiffness against bending in the x-z plane, about the tension centre [N m^2].
        GJ: Stiffness against twist [N m^2].
        rhoJ: Polar moment of inertia per length, about x through the mass centre [kg m].
        rhoI_y: Moment of inertia per length about y; counts with rotary_inertia, without it is drawn alone [kg m].
        rhoI_z: Moment of inertia per length about z, as rhoI_y [kg m].
        bend_y: Number of shape functions for the displacement along y; 0 is rigid.
        bend_z: Number of shape functions for the displacement along z; 0 is rigid.
        twist: Number of shape functions for the rotation about x; 0 is rigid.
        family: Family of the shape functions (docs/theory/beams.md, section 2).
        shapes: User-defined functions for family "user": direction -> formulas of xi = x/L, or samples.
        damping: Voigt-Kelvin retardation time: stress is E (strain + damping strain rate) [s].
        foreshortening: Whether bending pulls the axis back, which is what stiffens a spinning beam.
        rotary_inertia: Whether sections resist being turned by bending.
        retain: How far elastic terms are kept: "zeroth_order" (linear elastic terms only, no stiffening or softening
            by motion), "first_order" (consistent to first order) or "all" (everything the second-order field gives).
        theory: "second_order" in the displacements (docs/theory/beams.md), or "strain": a geometrically exact rod whose
            curvatures and twist rate, and stretch and shear if asked for, are sums of shape functions
            (docs/theory/rods.md). Of a rod, `bend_y`, `bend_z`, `twist`, `stretch`, `shear_y` and `shear_z` count those
            functions, `family` is theirs, and `retain` and `foreshortening` have no meaning.
        sections: Number of sections of a rod, beside the root, at which its motion is integrated, an interval between
            knots; 0: chosen.
        curvature_y: Curvature about y of a rod without stress [1/m].
        curvature_z: Curvature about z of a rod without stress [1/m].
        twist_rate: Twist rate of a rod without stress [rad/m].
        frames: Extremity frames, each at a station of the axis and turning with the section there; one at the tip
            unless stated.
        loads: Loads along the axis.
        waive: Names of checks that the beam is allowed to fail.
        segments: Number of beams of equal length, each clamped to the tip of the last, that a system makes of it
            (segments.py); each has the functions stated.
        stations: Stations x/L, rising from 0 (root) to 1 (tip) at most, whose section forces can be asked for.
        EA: Stiffness against stretching, of a rod with functions of `stretch` [N].
        GA_y: Stiffness against shear along y, its shear correction factor included, of a rod with `shear_y` [N].
        GA_z: Stiffness against shear along z, of a rod with `shear_z` [N].
        stretch: Number of shape functions for the stretch of a rod's axis; 0 leaves its length as it is.
        shear_y: Number of shape functions for the shear of a rod's sections along y; 0 keeps them across the axis.
        shear_z: Number of shape functions for the shear of a rod's sections along z.
        EI_yz: Integral of E y z about the tension centre, of a rod whose axes y and z are not principal ones [N m^2].
        rhoI_yz: Integral of rho y z about the mass centre, of a rod; counts as rhoI_y [kg m].
        tension_center: Point (y, z) of a rod's section where a force along x does not bend it [m].
        shear_center: Point (y, z) of a rod's section where a force across does not twist it [m].
        mass_center: Mass centre (y, z) of a rod's section; moments of inertia are about it [m].
        stiffness: Stiffness of a rod's section about the axis, six rows of six, in place of EA to EI_yz and of the
            tension and shear centres: force and moment (N, V_y, V_z, T, M_y, M_z) per strain (stretch, shear_y,
            shear_z; twist rate, curvature_y, curvature_z), symmetric.
    """

    name: str
    joint: Joint
    length: Value
    rhoA: Value
    EI_z: Value = 0.0
    EI_y: Value = 0.0
    GJ: Value = 0.0
    rhoJ: Value = 0.0
    rhoI_y: Value = 0.0
    rhoI_z: Value = 0.0
    bend_y: int = 0
    bend_z: int = 0
    twist: int = 0
    family: Family = "spline"
    shapes: tuple[tuple[Direction, tuple[UserShape, ...]], ...] = ()
    damping: Value = 0.0
    foreshortening: bool = True
    rotary_inertia: bool = False
    retain: Retain = "first_order"
    theory: Theory = "second_order"
    sections: int = 0
    curvature_y: Value = 0.0
    curvature_z: Value = 0.0
    twist_rate: Value = 0.0
    frames: tuple[Frame, ...] = (Frame("tip"),)
    loads: tuple[BeamLoad, ...] = ()
    waive: tuple[str, ...] = ()
    segments: int = 1
    stations: tuple[float, ...] = STATIONS
    EA: Value = 0.0
    GA_y: Value = 0.0
    GA_z: Value = 0.0
    stretch: int = 0
    shear_y: int = 0
    shear_z: int = 0
    EI_yz: Value = 0.0
    rhoI_yz: Value = 0.0
    tension_center: Point = _AXIS
    shear_center: Point = _AXIS
    mass_center: Point = _AXIS
    stiffness: tuple[tuple[Value, ...], ...] = ()

    def __post_init__(self) -> None:
        """Convert numbers, freeze collections, check the choices."""
        what = f"beam '{self.name}'"
        for label in ("length", "damping", *SECTION, *PRE_STRAINS):
            object.__setattr__(self, label, as_value(getattr(self, label), f"{what}: {label}"))
        for label in CENTERS:
            object.__setattr__(self, label, as_values(getattr(self, label), 2, f"{what}: {label}"))
        self._set_stiffness(what)
        for label in ("frames", "loads", "waive"):
            object.__setattr__(self, label, tuple(getattr(self, label)))
        given = dict(pairs_of(self.shapes, f"{what}: shapes"))
        entries = {key: entries_of(listed) for key, listed in given.items()}
        functions = {key: [given[key]] if listed is None else listed for key, listed in entries.items()}
        directions = [key for key in STRAINS if key in functions]
        shapes = tuple((key, tuple(_shape(x, f"{what}: {key}") for x in functions[key])) for key in directions)
        object.__setattr__(self, "shapes", shapes)
        choices = (
            ("family", self.family, FAMILIES),
            ("retain", self.retain, RETAIN),
            ("theory", self.theory, THEORIES),
        )
        for label, choice, known in choices:
            if choice not in known:
                raise DescriptionError(
                    Problem(
                        f"{what}: unknown {label}",
                        f"'{choice}'",
                        f"one of {', '.join(known)}",
                        did_you_mean(str(choice), known),
                    )
                )
        self._check_theory(what)
        self._check_shapes(what, given)
        for direction in STRAINS:
            if not _is_count(getattr(self, direction), 0):
                raise DescriptionError(
                    Problem(
                        f"{what}: {direction} is not a number of functions",
                        repr(getattr(self, direction)),
                        "a whole number, 0 or more",
                        "0 makes the beam rigid in that direction",
                    )
                )
        if not _is_count(self.segments, 1):
            raise DescriptionError(
                Problem(
                    f"{what}: segments is not a number of segments",
                    repr(self.segments),
                    "a whole number, 1 or more",
                    "1 leaves the beam in one piece",
                )
            )
        self._check_stations(what)

    def _set_stiffness(self, what: str) -> None:
        """Convert the matrix of stiffness, and check that it stands alone."""
        rows = stiffness_rows(self.stiffness, f"{what}: stiffness")
        object.__setattr__(self, "stiffness", rows)
        stated = [name for name in IN_MATRIX if getattr(self, name) not in (0.0, _AXIS)]
        if rows and stated:
            rule = "a matrix has all stiffnesses, about the axis"
            raise DescriptionError(
                Problem(f"{what}: stiffness and {', '.join(stated)}", "both", rule, "keep the one or the other")
            )

    def _check_stations(self, what: str) -> None:
        """Convert the stations of section forces, and check that they rise along the beam."""
        object.__setattr__(self, "stations", tuple(float(xi) for xi in self.stations))
        rising = all(a < b for a, b in pairwise(self.stations))
        if not rising or not all(0.0 <= xi <= 1.0 for xi in self.stations):
            raise DescriptionError(
                Problem(
                    f"{what}: stations of section forces",
                    ", ".join(f"{xi:g}" for xi in self.stations),
                    "stations x/L rise, from 0 (root) to 1 (tip) at most",
                    "divide them by the length, and sort them",
                )
            )
        if not self.modes and self.stations != STATIONS:
            raise DescriptionError(
                Problem(
                    f"{what}: stations of section forces on a rigid beam",
                    ", ".join(f"{xi:g}" for xi in self.stations),
                    "section forces are those of beams with shape functions; a rigid beam is one rigid body",
                    "leave stations out, or state functions of bend_y, bend_z or twist",
                )
            )

    def _check_shapes(self, what: str, given: Iterable[str]) -> None:
        """Functions of the user, which one family alone has."""
        if self.shapes and self.family != "user":
            raise DescriptionError(
                Problem(
                    f"{what}: shapes with family '{self.family}'",
                    ", ".join(key for key, _ in self.shapes),
                    "functions of the user are those of family 'user'; other families have their own",
                    "state family: user, or leave shapes out",
                )
            )
        for key in given:
            if key not in STRAINS:
                raise DescriptionError(
                    Problem(
                        f"{what}: shapes for an unknown direction",
                        f"'{key}'",
                        f"one of {', '.join(STRAINS)}",
                        did_you_mean(str(key), STRAINS),
                    )
                )

    def _check_theory(self, what: str) -> None:
        """Entries that one theory has and the other lacks."""
        if not _is_count(self.sections, 0) or self.sections > MOST_SECTIONS:
            raise DescriptionError(
                Problem(
                    f"{what}: sections is not a number of sections",
                    repr(self.sections),
                    f"a whole number from 0, which leaves the choice to the generator, to {MOST_SECTIONS}",
                    "leave it out",
                )
            )
        if self.theory != "strain" and any(load.axes == "section" for load in self.loads):
            raise DescriptionError(
                Problem(
                    f"{what}: a load along the axes of the sections",
                    f"theory '{self.theory}'",
                    "sections of a beam of second order turn by small angles: a load does not follow them exactly",
                    "state theory: strain, or put a rigid body with a load on a frame of the beam",
                )
            )
        lacking_direction = next((key for key, _ in self.shapes if key not in DIRECTIONS), None)
        if self.theory != "strain" and lacking_direction is not None:
            raise DescriptionError(
                Problem(
                    f"{what}: shapes for {lacking_direction}",
                    f"theory '{self.theory}'",
                    f"a beam of second order in its displacements has functions for {', '.join(DIRECTIONS)}",
                    f"leave shapes for {lacking_direction} out, or state theory: strain",
                )
            )
        if self.theory == "strain":
            plain: dict[str, Any] = {"retain": "first_order", "foreshortening": True}
            theory, lacking = "a geometrically exact rod (theory 'strain')", "keeps every term, and shortens by itself"
        else:
            plain = (
                {"sections": 0, "stiffness": ()}
                | dict.fromkeys((*PRE_STRAINS, *ROD_STIFFNESSES, "EI_yz", "rhoI_yz"), 0.0)
                | dict.fromkeys(STRAINS[3:], 0)
                | dict.fromkeys(CENTERS, _AXIS)
            )
            theory, lacking = (
                "a beam of second order in its displacements",
                "is straight without stress, neither stretches nor shears, has its centres on the axis, and principal"
                " axes y and z",
            )
        for label, value in plain.items():
            if getattr(self, label) != value:
                raise DescriptionError(
                    Problem(
                        f"{what}: {label} = {getattr(self, label)}",
                        f"theory '{self.theory}'",
                        f"{theory} {lacking}: it has no entry {label}",
                        f"leave {label} out, or state the other theory",
                    )
                )

    @property
    def inertia(self) -> None:
        """A beam's mass is in its section, not in an inertia of a rigid body."""
        return None

    @property
    def is_coupled(self) -> bool:
        """Whether the section has a centre off the axis, axes that are no principal ones, or a matrix of stiffness."""
        off = any(getattr(self, label) != _AXIS for label in CENTERS)
        return off or bool(self.stiffness) or self.EI_yz != 0.0 or self.rhoI_yz != 0.0

    @property
    def modes(self) -> int:
        """How many elastic coordinates it has."""
        return sum(self.counts)

    @property
    def counts(self) -> tuple[int, ...]:
        """Number of shape functions of each direction, in the order of STRAINS."""
        return tuple(getattr(self, direction) for direction in STRAINS)

    def user_shapes(self, direction: Direction) -> tuple[UserShape, ...]:
        """The user's own functions for a direction."""
        return dict(self.shapes).get(direction, ())

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the elastic coordinates: beam.bend_y[0] and so on."""
        return tuple(f"{self.name}.{key}[{i}]" for key in STRAINS for i in range(getattr(self, key)))

    def along_axis(self) -> Iterator[tuple[str, Value]]:
        """What may depend on the station, by label: properties of the section, and strains without stress."""
        for label in (*SECTION, *PRE_STRAINS):
            yield label, getattr(self, label)
        for label in CENTERS:
            yield from ((f"{label}[{k}]", value) for k, value in enumerate(getattr(self, label)))
        for i, row in enumerate(self.stiffness):
            yield from ((f"stiffness[{i}][{j}]", row[j]) for j in range(i, len(row)))

    def changed_along_axis(self, change: Callable[[Value], Value]) -> dict[str, Any]:
        """The entries of `along_axis`, each value changed."""
        return (
            {label: change(getattr(self, label)) for label in (*SECTION, *PRE_STRAINS)}
            | {label: tuple(map(change, getattr(self, label))) for label in CENTERS}
            | {"stiffness": tuple(tuple(map(change, row)) for row in self.stiffness)}
        )


def stiffness_rows(stated: Any, label: str) -> tuple[tuple[Value, ...], ...]:
    """A matrix of stiffness (6, 6), made symmetric where rounding left a difference; empty where none is stated.

    Args:
        stated: Its rows, or nothing.
        label: What it is, for errors.

    Raises:
        DescriptionError: It has other rows, or is not symmetric.
    """
    listed = entries_of(stated)
    listed = [stated] if listed is None else listed
    if not listed:
        return ()
    size = len(MATRIX_ORDER)
    if len(listed) != size:
        rule = f"{size} rows of {size} entries: {', '.join(MATRIX_ORDER)}"
        raise DescriptionError(Problem(label, f"{len(listed)} rows", rule, "give all, zeros included"))
    rows = [list(as_values(row, size, f"{label}[{i}]")) for i, row in enumerate(listed)]
    for i, j in combinations(range(size), 2):
        a, b, first, second = rows[i][j], rows[j][i], rows[i][i], rows[j][j]
        if a == b:
            continue
        if isinstance(a, float) and isinstance(b, float) and isinstance(first, float) and isinstance(second, float):
            if abs(a - b) <= _ASYMMETRY * math.sqrt(abs(first * second)):
                rows[i][j] = rows[j][i] = 0.5 * (a + b)
                continue
        rule = "a matrix of stiffness is symmetric: forces have the strain energy as their potential"
        found = f"[{i}][{j}] is {a}, [{j}][{i}] is {b}"
        raise DescriptionError(Problem(f"{label} is not symmetric", found, rule, "state the same value for both"))
    return tuple(map(tuple, rows))


def _shape(stated: Any, what: str) -> UserShape:
    return stated if isinstance(stated, Samples) else as_value(stated, what)


def _is_count(stated: Any, least: int) -> bool:
    return isinstance(stated, int) and not isinstance(stated, bool) and stated >= least
