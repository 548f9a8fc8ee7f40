"""How a beam deforms: its axis, sections and curvatures to second order (docs/theory/beams.md, sections 1 and 3)."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache

from symofros.description.beams.beam import Beam
from symofros.description.beams.elastic import DIRECTIONS
from symofros.description.beams.shapes import Family, UserShape
from symofros.mechanics.beams.fields import Field, UnitIntegral, unit_field
from symofros.mechanics.beams.piecewise import XI
from symofros.mechanics.beams.shape_functions import Shape, shapes

_HALF = Fraction(1, 2)
# Slope and twist [rad] up to which second-order theory errs by less than a percent.
SMALL = 0.1
# Intervals of the stations at which the largest angle of a shape function is looked for.
_SAMPLES = 32
# Fewest intervals between the stations at which bending is judged.
_FEWEST_INTERVALS = 8


@dataclass(frozen=True)
class Deformation:
    """The second-order displacement field of one beam.

    Attributes:
        functions: Shape functions, one an elastic coordinate: those of bend_y, then bend_z, then twist.
        counts: Number of functions of bend_y, bend_z and twist.
        foreshortening: Whether bending draws the sections towards the root, to second order.
    """

    functions: tuple[Shape, ...]
    counts: tuple[int, int, int]
    foreshortening: bool

    def __deepcopy__(self, memo: object) -> Deformation:
        """Itself: it never changes, and what is known of it serves all copies of equations."""
        return self

    @cached_property
    def integrals(self) -> dict[Hashable, UnitIntegral]:
        """Cache of the integrals of products of its fields that were formed so far."""
        return {}

    @cached_property
    def lengths(self) -> tuple[bool, ...]:
        """Whether each coordinate is a displacement [m] (else an angle)."""
        return tuple(shape.length for shape in self.functions)

    def _superposition(self, direction: int, power: int) -> Field:
        """The sum of coordinates times shape functions of one direction."""
        start = sum(self.counts[:direction])
        indices = range(start, start + self.counts[direction])
        return Field(power, self.lengths, {(i,): self.functions[i].phi for i in indices})

    @cached_property
    def v(self) -> Field:
        """Deflection v of the axis along y."""
        return self._superposition(0, 1)

    @cached_property
    def w(self) -> Field:
        """Deflection w of the axis along z."""
        return self._superposition(1, 1)

    @cached_property
    def roll(self) -> Field:
        """Rotation of sections about x: the twist angle."""
        return self._superposition(2, 0)

    @cached_property
    def yaw(self) -> Field:
        """Rotation of sections about z: v' (eq. 3)."""
        return self.v.along()

    @cached_property
    def pitch(self) -> Field:
        """Rotation of sections about y: -w' (eq. 3)."""
        return -self.w.along()

    @cached_property
    def u(self) -> Field:
        """Axial displacement u by foreshortening: -1/2 the integral of v'^2 + w'^2 from the root (eq. 2)."""
        if not self.foreshortening:
            return Field(1, self.lengths, {})
        slopes = self.yaw.times(self.yaw) + self.pitch.times(self.pitch)
        return slopes.from_root().scaled(_HALF).scaled(-1)

    @cached_property
    def position(self) -> tuple[Field, Field, Field]:
        """Position p_BS of the section's centroid from the root, in B (eq. 1)."""
        return Field(1, self.lengths, {(): XI}) + self.u, self.v, self.w

    @cached_property
    def rotation(self) -> tuple[tuple[Field, Field, Field], ...]:
        """Rotation R_BS of the section to second order, row by row (eq. 4)."""
        one = unit_field(self.lengths)
        P, T, F = self.yaw, self.pitch, self.roll
        PP, TT, FF = (x.times(x).scaled(_HALF) for x in (P, T, F))
        return (
            (one - PP - TT, F.times(T) - P, F.times(P) + T),
            (P, one - FF - PP, P.times(T) - F),
            (-T, F, one - FF - TT),
        )

    @cached_property
    def partial_spins(self) -> tuple[tuple[Field, Field, Field], ...]:
        """Partial angular velocities of the section, in its own axes, one triple a coordinate (eq. 5)."""
        P, T, F = self.yaw, self.pitch, self.roll
        triples = []
        for i in range(len(self.functions)):
            Pi, Ti, Fi = P.by(i), T.by(i), F.by(i)
            triples.append((Fi - T.times(Pi), Ti + F.times(Pi), Pi - F.times(Ti)))
        return tuple(triples)

    @cached_property
    def turning(self) -> tuple[tuple[Field, Field, Field], ...]:
        """Partial angular velocities of the section in the axes of B, to first order, one triple a coordinate."""
        P, T = self.yaw, self.pitch
        triples = []
        for i in range(len(self.functions)):
            Pi, Ti, Fi = P.by(i), T.by(i), self.roll.by(i)
            triples.append((Fi - P.times(Ti), Ti + P.times(Fi), Pi - T.times(Fi)))
        return tuple(triples)

    @cached_property
    def station_angles(self) -> tuple[tuple[float, ...], tuple[tuple[float, ...], ...]]:
        """Stations xi (s), and the yaw, pitch or twist there by each coordinate of a beam of unit length (s, n).

        Yaw and pitch without their signs; there are enough stations to meet the largest angle within a few per cent.
        """
        intervals = max(_FEWEST_INTERVALS, 2 * max(self.counts, default=0))
        stations = [Fraction(k, intervals) for k in range(intervals + 1)]
        bending = sum(self.counts[:2])
        angles = [f.phi.derivative() if i < bending else f.phi for i, f in enumerate(self.functions)]
        rows = tuple(tuple(float(angle(xi)) for angle in angles) for xi in stations)
        return tuple(map(float, stations)), rows

    @cached_property
    def curvatures(self) -> tuple[Field, Field, Field]:
        """Twist rate and curvatures to second order (eq. 6)."""
        P, T, F = self.yaw, self.pitch, self.roll
        dP, dT, dF = P.along(), T.along(), F.along()
        return dF - T.times(dP), dT + F.times(dP), dP - F.times(dT)


def deformation_of(beam: Beam) -> Deformation:
    """The displacement field of a beam; beams with equal shape functions share one.

    Raises:
        FamilyError: The family has no such functions.
    """
    counts = (beam.bend_y, beam.bend_z, beam.twist)
    user = tuple(beam.user_shapes(direction) for direction in DIRECTIONS)
    return _shared_deformation(beam.family, counts, user, beam.foreshortening)


def small_coordinates(beam: Beam, length: float) -> tuple[float, ...]:
    """Sizes of the elastic coordinates up to which second-order theory holds: bounds for random states.

    With every coordinate of a direction at its size, no slope and no twist angle exceeds SMALL.

    Args:
        beam: The beam as described.
        length: Length of the beam [m].
    """
    shape = deformation_of(beam)
    sizes = []
    for i, function in enumerate(shape.functions):
        direction = 0 if i < shape.counts[0] else 1 if i < sum(shape.counts[:2]) else 2
        angle = function.phi if direction == 2 else function.phi.derivative()
        largest = max(abs(float(angle(Fraction(k, _SAMPLES)))) for k in range(_SAMPLES + 1))
        sizes.append(SMALL / (largest * shape.counts[direction]) * (length if function.length else 1.0))
    return tuple(sizes)


@lru_cache(maxsize=64)
def _shared_deformation(
    family: Family, counts: tuple[int, int, int], user: tuple[tuple[UserShape, ...], ...], foreshortening: bool
) -> Deformation:
    functions: tuple[Shape, ...] = ()
    for direction, count, stated in zip(DIRECTIONS, counts, user, strict=True):
        functions += shapes(family, direction, count, stated)
    return Deformation(functions, counts, foreshortening)
