"""Beam: a flexible body, with the loads along its axis. No computation."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, fields
from itertools import pairwise
from numbers import Real
from typing import Any, Literal, get_args

from symofros.base.arguments import entries_of
from symofros.description.beams.elastic import (
    AXIS,
    CENTERS,
    ELASTIC,
    IN_MATRIX,
    PRE_STRAINS,
    STRAIN_STIFFNESSES,
    STRAINS,
    THEORIES,
    Direction,
    ElasticDescription,
    Point,
    Theory,
    stiffness_rows,
)
from symofros.description.beams.shapes import FAMILIES, Family, UserShape, as_shape
from symofros.description.entries import pairs_of, refuses_unknown_entries
from symofros.description.frames import Frame
from symofros.description.joints.joint import Joint
from symofros.description.values import ORIGIN, Value, Vector, as_value, as_values, as_vector
from symofros.errors import DescriptionError, did_you_mean

Retain = Literal["zeroth_order", "first_order", "all"]
RETAIN: tuple[Retain, ...] = get_args(Retain)
MAX_SECTIONS = 64
# Stations x/L of section forces, where none are stated.
STATIONS = tuple(k / 8 for k in range(9))

# What may depend on the station x, and so taper.
SECTION = ("rhoA", "EI_y", "EI_z", "GJ", *STRAIN_STIFFNESSES, "rhoJ", "rhoI_y", "rhoI_z", "EI_yz", "rhoI_yz")
STATION = "x"


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
                "beam load: station off the beam",
                f"at {self.at!r}",
                "at is x/L, from 0 (root) to 1 (tip)",
                "divide the station by the length; leave at out for a load that is spread",
            )
        if self.axes not in ("body", "world", "section"):
            raise DescriptionError(
                f"beam load: axes '{self.axes}'",
                str(self.axes),
                "axes are 'body', 'world' or 'section'",
                did_you_mean(str(self.axes), ("body", "world", "section")),
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
    tension_center: Point = AXIS
    shear_center: Point = AXIS
    mass_center: Point = AXIS
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
        shapes = tuple((key, tuple(as_shape(x, f"{what}: {key}") for x in functions[key])) for key in directions)
        object.__setattr__(self, "shapes", shapes)
        choices = (
            ("family", self.family, FAMILIES),
            ("retain", self.retain, RETAIN),
            ("theory", self.theory, THEORIES),
        )
        for label, choice, known in choices:
            if choice not in known:
                raise DescriptionError(
                    f"{what}: unknown {label}",
                    f"'{choice}'",
                    f"one of {', '.join(known)}",
                    did_you_mean(str(choice), known),
                )
        self._check_theory(what)
        self._check_shapes(what, given)
        for direction in STRAINS:
            if not _is_count(getattr(self, direction), 0):
                raise DescriptionError(
                    f"{what}: {direction} is not a number of functions",
                    repr(getattr(self, direction)),
                    "a whole number, 0 or more",
                    "0 makes the beam rigid in that direction",
                )
        if not _is_count(self.segments, 1):
            raise DescriptionError(
                f"{what}: segments is not a number of segments",
                repr(self.segments),
                "a whole number, 1 or more",
                "1 leaves the beam in one piece",
            )
        self._check_stations(what)

    def _set_stiffness(self, what: str) -> None:
        """Convert the matrix of stiffness, and check that it stands alone."""
        rows = stiffness_rows(self.stiffness, f"{what}: stiffness")
        object.__setattr__(self, "stiffness", rows)
        stated = [name for name in IN_MATRIX if getattr(self, name) not in (0.0, AXIS)]
        if rows and stated:
            rule = "a matrix has all stiffnesses, about the axis"
            raise DescriptionError(
                f"{what}: stiffness and {', '.join(stated)}", "both", rule, "keep the one or the other"
            )

    def _check_stations(self, what: str) -> None:
        """Convert the stations of section forces, and check that they rise along the beam."""
        object.__setattr__(self, "stations", tuple(float(xi) for xi in self.stations))
        rising = all(a < b for a, b in pairwise(self.stations))
        if not rising or not all(0.0 <= xi <= 1.0 for xi in self.stations):
            raise DescriptionError(
                f"{what}: stations of section forces",
                ", ".join(f"{xi:g}" for xi in self.stations),
                "stations x/L rise, from 0 (root) to 1 (tip) at most",
                "divide them by the length, and sort them",
            )
        if not self.modes and self.stations != STATIONS:
            raise DescriptionError(
                f"{what}: stations of section forces on a rigid beam",
                ", ".join(f"{xi:g}" for xi in self.stations),
                "section forces are those of beams with shape functions; a rigid beam is one rigid body",
                "leave stations out, or state functions of bend_y, bend_z or twist",
            )

    def _check_shapes(self, what: str, given: Iterable[str]) -> None:
        """Functions of the user, which one family alone has."""
        if self.shapes and self.family != "user":
            raise DescriptionError(
                f"{what}: shapes with family '{self.family}'",
                ", ".join(key for key, _ in self.shapes),
                "functions of the user are those of family 'user'; other families have their own",
                "state family: user, or leave shapes out",
            )
        for key in given:
            if key not in STRAINS:
                raise DescriptionError(
                    f"{what}: shapes for an unknown direction",
                    f"'{key}'",
                    f"one of {', '.join(STRAINS)}",
                    did_you_mean(str(key), STRAINS),
                )

    def _check_theory(self, what: str) -> None:
        """Entries that one theory has and the other lacks."""
        if not _is_count(self.sections, 0) or self.sections > MAX_SECTIONS:
            raise DescriptionError(
                f"{what}: sections is not a number of sections",
                repr(self.sections),
                f"a whole number from 0, which leaves the choice to the generator, to {MAX_SECTIONS}",
                "leave it out",
            )
        elastic = self.elastic
        if not elastic.is_exact and any(load.axes == "section" for load in self.loads):
            raise DescriptionError(
                f"{what}: a load along the axes of the sections",
                f"theory '{self.theory}'",
                "sections of a beam of second order turn by small angles: a load does not follow them exactly",
                "state theory: strain, or put a rigid body with a load on a frame of the beam",
            )
        lacking_direction = next((key for key, _ in self.shapes if key not in elastic.directions), None)
        if lacking_direction is not None:
            raise DescriptionError(
                f"{what}: shapes for {lacking_direction}",
                f"theory '{self.theory}'",
                f"{elastic.noun} has functions for {', '.join(elastic.directions)}",
                f"leave shapes for {lacking_direction} out, or state theory: strain",
            )
        defaults = {item.name: item.default for item in fields(self)}
        for label in elastic.lacking:
            if getattr(self, label) != defaults[label]:
                raise DescriptionError(
                    f"{what}: {label} = {getattr(self, label)}",
                    f"theory '{self.theory}'",
                    f"{elastic.noun} {elastic.lacks}: it has no entry {label}",
                    f"leave {label} out, or state the other theory",
                )

    @property
    def inertia(self) -> None:
        """A beam's mass is in its section, not in an inertia of a rigid body."""
        return None

    @property
    def elastic(self) -> ElasticDescription:
        """The theory by which it is elastic."""
        return ELASTIC[self.theory]

    @property
    def is_coupled(self) -> bool:
        """Whether the section has a centre off the axis, axes that are no principal ones, or a matrix of stiffness."""
        off = any(getattr(self, label) != AXIS for label in CENTERS)
        return off or bool(self.stiffness) or self.EI_yz != 0.0 or self.rhoI_yz != 0.0

    @property
    def modes(self) -> int:
        """Number of elastic coordinates of the beam."""
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


def _is_count(stated: Any, least: int) -> bool:
    return isinstance(stated, int) and not isinstance(stated, bool) and stated >= least
