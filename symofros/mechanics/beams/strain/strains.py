"""Strain fields of a geometrically exact rod, and their tables at its sections (docs/theory/rods.md, sections 1 and 4).

Numbers alone, formed by sums, products, quotients and square roots of doubles, or by fractions that are rounded once:
the same on every machine.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache

from symofros.description.beams.beam import Beam
from symofros.description.beams.elastic import STRAINS, Direction
from symofros.description.beams.shapes import Family, Samples, UserShape
from symofros.mechanics.beams.fields import Field, Monomial
from symofros.mechanics.beams.piecewise import Number, Piecewise, fitted, polynomial
from symofros.mechanics.beams.quadrature import Nodes, gauss, radau
from symofros.mechanics.beams.shape_functions import MAX_MODES, FamilyError, b_splines, formula_of_station

# Strain that a direction's coordinates are of, and the sign with which they count: twist rate and curvatures (0 to 2)
# turn the sections about their axes, stretch and shears (3 to 5) move them along those. A positive coordinate bends the
# rod towards positive y or z.
AXES: dict[Direction, tuple[int, int]] = {
    "bend_y": (2, 1),
    "bend_z": (1, -1),
    "twist": (0, 1),
    "stretch": (3, 1),
    "shear_y": (4, 1),
    "shear_z": (5, 1),
}
# Number of strains that turn sections.
TURNING = 3
# The fewest sections an interval beside the root: as many as functions integrate small turns exactly. From three
# functions on there are one and then two more, as these leave less out than a section is worth; of the user's, which
# may be of any degree, one more.
_FEWEST_SECTIONS, _FEWEST_SECTIONS_OF_USER, _MAX_MORE = 2, 3, 2
# Sections an interval where knots divide the rod: the cubic between them is smooth.
_SECTIONS_A_SPAN = 4
# Largest angle [rad] by which the strains of one direction turn the tip in random states; largest stretch and shear.
_LARGEST_TURN, _LARGEST_STRAIN = 0.5 * math.pi, 0.1

Rows = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Strains:
    """The strain fields of one rod over xi = x/L: each function, times its coordinate over L, is a curvature.

    Of stretch and shear the function times the coordinate is the strain itself.

    Attributes:
        functions: Strain functions, one a coordinate, in the order of STRAINS.
        counts: Number of functions of each direction, in the order of STRAINS.
        points: Number of sections an interval between knots, beside the root.
    """

    functions: tuple[Piecewise, ...]
    counts: tuple[int, ...]
    points: int

    def __deepcopy__(self, memo: object) -> Strains:
        """Itself: it never changes, and what is known of it serves all copies of equations."""
        return self

    @cached_property
    def axes(self) -> tuple[tuple[int, int], ...]:
        """Strain that each coordinate is of, below TURNING the axis that it turns sections about; and its sign."""
        return tuple(AXES[d] for d, count in zip(STRAINS, self.counts, strict=True) for _ in range(count))

    @cached_property
    def values(self) -> Rows:
        """Strain of each section by a unit of each coordinate, of twist rate and curvatures over the length (N, n)."""
        xi = self.sections.stations
        columns = [f.scaled(sign).rounded(xi) for f, (_, sign) in zip(self.functions, self.axes, strict=True)]
        return tuple(zip(*columns, strict=True)) if columns else tuple(() for _ in xi)

    @cached_property
    def knots(self) -> tuple[Number, ...]:
        """Ends of the intervals on which all functions are smooth."""
        return tuple(sorted({Fraction(0), Fraction(1), *(k for f in self.functions for k in f.knots)}))

    @cached_property
    def sections(self) -> Nodes:
        """Stations of the sections: Radau's with the root, which costs nothing, up to the first knot, then Gauss's."""
        later = (gauss(self.points),) * (len(self.knots) - 2)
        return Nodes(self.knots, (radau(self.points + 1), *later))

    def strain(self, axis: int) -> Field:
        """Change of the twist rate (axis 0), a curvature (1, 2), stretch or shear as a field of coordinates (1)."""
        terms: dict[Monomial, Piecewise] = {
            (i,): f.scaled(s) for i, (f, (k, s)) in enumerate(zip(self.functions, self.axes, strict=True)) if k == axis
        }
        return Field(-1 if axis < TURNING else 0, (False,) * len(self.functions), terms)

    def turns(self, xi: Sequence[float]) -> Rows:
        """Angle about its own axis by which a unit of each coordinate turns the section at stations (s, n)."""
        columns = [
            f.antiderivative().scaled(s).rounded(xi) if axis < TURNING else [0.0] * len(xi)
            for f, (axis, s) in zip(self.functions, self.axes, strict=True)
        ]
        return tuple(zip(*columns, strict=True)) if columns else tuple(() for _ in xi)

    def moments(self, start: float, end: float) -> Rows:
        """Three moments of each strain function over an interval (5).

        Its integral; the first moment about the middle, over the length; the second one over the length's square,
        less a twelfth of the integral, so that a constant has none.
        """
        rows: list[tuple[float, float, float]] = []
        a, b = Fraction(start), Fraction(end)
        middle, h = (a + b) / 2, b - a
        weights = polynomial(1), polynomial(-middle, 1), polynomial(middle**2 - h**2 / 12, -2 * middle, 1)
        for f, (axis, s) in zip(self.functions, self.axes, strict=True):
            if axis >= TURNING:
                rows.append((0.0, 0.0, 0.0))
                continue
            wholes = ((f * weight).antiderivative() for weight in weights)
            zeroth, first, second = (float(s * (w(b) - w(a)) / h**k) for k, w in enumerate(wholes))
            rows.append((zeroth, first, second))
        return tuple(zip(*rows, strict=True)) if rows else ((), (), ())

    @cached_property
    def masses(self) -> Nodes:
        """Stations that integrate products of two positions exactly."""
        return Nodes(self.knots, (gauss(self.points + 2),) * (len(self.knots) - 1))

    @cached_property
    def positions(self) -> Rows:
        """Weights of the sections in the position at each of the stations of `masses`, over the length."""
        return tuple(self.sections.from_root(xi) for xi in self.masses.stations)

    @cached_property
    def interpolation(self) -> Rows:
        """Weights of the sections in the value of what is known at them, at each of the stations of `masses`."""
        return tuple(self.sections.through(xi) for xi in self.masses.stations)

    @cached_property
    def first_moments(self) -> tuple[float, ...]:
        """Weights of the tangents in the integral of the position, for a section that does not change (N)."""
        w, n = self.masses.weights, len(self.sections.stations)
        return tuple(sum(a * row[k] for a, row in zip(w, self.positions, strict=True)) for k in range(n))

    @cached_property
    def mass_points(self) -> Rows:
        """Rows C of points with C^T C the second moment of the positions, of a uniform rod; triangular (12)."""
        w, n = self.masses.weights, len(self.sections.stations)
        order = (*range(1, n), 0)  # The root last: where it comes alone, nothing moves.
        second = [
            [sum(a * row[i] * row[j] for a, row in zip(w, self.positions, strict=True)) for j in order] for i in order
        ]
        rows = [[0.0] * n for _ in range(n)]
        for i in range(n):
            rows[i][i] = math.sqrt(second[i][i] - sum(rows[k][i] ** 2 for k in range(i)))
            for j in range(i + 1, n):
                rows[i][j] = (second[i][j] - sum(rows[k][i] * rows[k][j] for k in range(i))) / rows[i][i]
        return tuple((row[-1], *row[:-1]) for row in rows)

    @cached_property
    def sizes(self) -> tuple[float, ...]:
        """Sizes of the coordinates with which no direction turns a section by more than a right angle.

        None stretches or shears the rod by more than a tenth, either.
        """
        rows = self.turns([k / 16 for k in range(17)])
        sizes = []
        for i, (axis, _) in enumerate(self.axes):
            share = 1.0 / sum(other == axis for other, _ in self.axes)
            if axis < TURNING:
                sizes.append(share * _LARGEST_TURN / max(abs(row[i]) for row in rows))
            else:
                sizes.append(share * _LARGEST_STRAIN / max(abs(row[i]) for row in self.values))
        return tuple(sizes)


def strains_of(beam: Beam) -> Strains:
    """The strain fields of a rod; rods with equal functions and sections share one.

    Raises:
        FamilyError: The family has no such functions.
    """
    user = tuple(beam.user_shapes(direction) for direction in STRAINS)
    return _shared_strains(beam.family, beam.counts, user, beam.sections)


@lru_cache(maxsize=64)
def _shared_strains(
    family: Family, counts: tuple[int, ...], user: tuple[tuple[UserShape, ...], ...], sections: int
) -> Strains:
    functions: list[Piecewise] = []
    for count, stated in zip(counts, user, strict=True):
        functions += strain_functions(family, count, stated)
    is_divided = any(len(f.pieces) > 1 for f in functions)
    most = max(counts)
    if family == "user":
        chosen = max(_FEWEST_SECTIONS_OF_USER, most + 1)
    else:
        chosen = max(_FEWEST_SECTIONS, most + min((most - 1) // 2, _MAX_MORE))
    chosen = _SECTIONS_A_SPAN if is_divided else chosen
    return Strains(tuple(functions), counts, sections or chosen)


def strain_functions(family: Family, count: int, user: tuple[UserShape, ...] = ()) -> list[Piecewise]:
    """The first strain functions of a family, of any value at root and tip.

    Args:
        family: Name of the family.
        count: Number of functions.
        user: Functions stated by the user, for family "user".

    Raises:
        FamilyError: The family has none, or not as many.
    """
    if not 0 <= count <= MAX_MODES:
        raise FamilyError(f"{count} functions asked for; 0 to {MAX_MODES} can be had")
    if family == "spline":
        return b_splines(0, count) if count else []
    if family == "polynomial":
        return [polynomial(*([0] * k), 1) for k in range(count)]
    if family == "legendre":
        return _shifted_legendre(count)
    if family == "user":
        if len(user) != count:
            raise FamilyError(f"{count} functions asked for, {len(user)} given")
        return [_stated(shape) for shape in user]
    raise FamilyError(f"family '{family}' is one of displacements; strains are of spline, legendre, polynomial or user")


def _stated(shape: UserShape) -> Piecewise:
    if isinstance(shape, Samples):
        raise FamilyError("samples are of displacements; a strain is stated by a formula of xi")
    return fitted(formula_of_station(shape), 1)


def _shifted_legendre(count: int) -> list[Piecewise]:
    """P_k(2 xi - 1)."""
    z, functions = polynomial(-1, 2), [polynomial(1), polynomial(-1, 2)]
    for k in range(2, count):
        following = (z * functions[-1]).scaled(Fraction(2 * k - 1, k)) + functions[-2].scaled(Fraction(1 - k, k))
        functions.append(following)
    return functions[:count]
