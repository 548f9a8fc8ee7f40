"""How far a state bends the beams, and what their theory errs there (docs/theory/beams.md, 6; rods.md, 6)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symofros.native import native_number
from symofros.runtime.beam_orders import BentBeam, LeftOut, OmittedStiffness, Turning, left_out, left_out_notes
from symofros.runtime.calls.kernel import Array

# Judges each step of a run, and has the numbers of (24).
_JUDGE = "stepping/beams/beams.c"
# Judges the axial loads of a motion, and has the numbers of (26a) and (26c).
_AXIAL = "stepping/beams/axial_loads.c"
# Estimated error from which results carry a note.
NOTED_ERROR = 0.01
# Estimated error beyond which a result fails by default: up to there the estimate is calibrated (section 6).
BEAM_LIMIT = 0.5
# Slope [rad] below which a beam is straight but for rounding.
_STRAIGHT = 1e-9
# Elastic coordinate [m or 1] beyond which a run has diverged, and squares of angles might overflow.
_LARGEST = 1e100
# Tangent stiffness over elastic stiffness below which an axial load counts as critical.
_CRITICAL = 1e-9
# Imaginary part, of an eigenvalue, that rounding gives to two that are equal.
_REAL = 1e-6
# Stations of a block in C (SYM_BEAM_BLOCK).
_BLOCK = 8
# Largest slope [rad] from which the number of beams that would do is no longer stated: true slopes stay below it.
_LARGEST_SLOPE = math.pi


def slope_error(square: float) -> float:
    """Estimated error of second-order theory, relative to the deflection, from the square of the largest slope (24)."""
    error = native_number(_JUDGE, "SYM_BEAM_SLOPE_ERROR") * square
    return error / math.sqrt(1.0 + native_number(_JUDGE, "SYM_BEAM_LARGE_SLOPE") * square)


def slope_of_error(error: float) -> float:
    """Largest slope [rad] at which second-order theory errs by so much of the deflection: (24) solved for it."""
    factor, y = native_number(_JUDGE, "SYM_BEAM_SLOPE_ERROR"), native_number(_JUDGE, "SYM_BEAM_LARGE_SLOPE")
    y *= 0.5 * error / factor
    return math.sqrt(error / factor * (y + math.sqrt(1.0 + y * y)))


@dataclass(frozen=True)
class BeamBending:
    """How far one beam is bent, and the error of second-order theory that follows.

    Attributes:
        beam: Name of the beam.
        station: Place of the largest slope, from the root along the axis [m].
        slope: Largest rotation by bending of a section relative to the root [rad].
        twist: Largest rotation about the axis of a section relative to the root [rad].
        foreshortening: Share of the length by which bending draws the tip towards the root.
        error: Estimated error of the deflection relative to its exact value; infinite past a critical load.
        t: Instant [s]; NaN where the result has none.
        sections: Number of sections of a geometrically exact rod, whose error is that of its shape's integration over
            the length; zero of a beam of second order.
        left_out: Stiffness under loads that the order of its equations leaves out.
    """

    beam: str
    station: float
    slope: float
    twist: float
    foreshortening: float
    error: float
    t: float = math.nan
    sections: int = 0
    left_out: tuple[LeftOut, ...] = ()

    def __str__(self) -> str:
        """One sentence."""
        instant = "" if math.isnan(self.t) else f" at t = {self.t:.6g} s"
        if math.isinf(self.error):
            return f"beam '{self.beam}' is loaded past its critical load{instant}: second-order theory has no bent rest"
        percent = 100.0 * self.error
        twisted = f" and is twisted by {self.twist:.2g} rad" if self.twist > 0.01 else ""
        if self.sections:
            return (
                f"rod '{self.beam}' bends by {self.slope:.2g} rad{twisted}{instant}: its {self.sections} sections place"
                f" it to about {percent:.1g} % of its length"
            )
        rounded = f"{percent:.3g}" if percent >= 1e4 else f"{percent:.{0 if percent >= 10 else 1}f}"
        return (
            f"beam '{self.beam}' bends by {self.slope:.2g} rad at x = {self.station:.3g} m{twisted}{instant}:"
            f" second-order theory errs by about {rounded} % of the deflection"
        )

    def amplified(self, amplification: float) -> BeamBending:
        """The same under axial loads, which amplify no error of a rod.

        Args:
            amplification: Elastic stiffness over the stiffness that axial loads leave (26).
        """
        return self if self.sections else replace(self, error=self.error * 0.25 * (amplification + 3.0))

    @property
    def remedy(self) -> str:
        """A model that would do: the error falls with the square of the number of beams that share the slope."""
        if self.sections:
            return f"state more sections, such as sections: {2 * self.sections}"
        countable = self.slope < _LARGEST_SLOPE and math.isfinite(self.error)
        count = f"{max(2, math.ceil(math.sqrt(self.error / NOTED_ERROR)))}" if countable else "many"
        return f"divide it into {count} beams joined end to end, or state theory: strain, which is geometrically exact"


class StationLaw(NamedTuple):
    """The elastic law at the stations of a beam's section forces, for small changes of its k strains with functions.

    Both are times the root of the length that is nearest to the station over the stiffness, so that squares of their
    difference add up to the integral of (34).

    Attributes:
        by_forces: Conjugates of the strains by N, Vy, Vz, T, My, Mz (s, k, 6).
        by_strains: The same by each elastic coordinate (s, k, n).
        slopes: Slopes of the axis at each station in both planes, times the root of that length, by what both are in,
            as strains from the root on (s, 2, s, k).
        damping: Damping over stiffness [s].
    """

    by_forces: Array
    by_strains: Array
    slopes: Array
    damping: float


@dataclass(frozen=True)
class ElasticBeam:
    """One beam at given parameters, as far as its bending is to be judged.

    Attributes:
        name: Name of the beam.
        length: Length [m].
        q: First index of the elastic coordinates in q.
        v: First index of their rates in v.
        counts: Number of coordinates of bend_y, bend_z and twist.
        xi: Stations x/L (s).
        angles: Yaw, pitch and twist of the section at each station per scaled coordinate (s, n).
        displacements: Whether each coordinate is a displacement (n), which counts by the length.
        elastic_stiffness: Forms the elastic stiffness (n, n).
        EI_z: Stiffness against bending in the x-y plane at mid-length [N m^2].
        EI_y: Stiffness against bending in the x-z plane at mid-length [N m^2].
        omitted: What its equations leave out of the stiffness under loads; None of a beam that leaves out nothing.
        station_law: Forms the elastic law at its stations.
    """

    name: str
    length: float
    q: int
    v: int
    counts: tuple[int, int, int]
    xi: Array
    angles: Array
    displacements: npt.NDArray[np.bool_]
    elastic_stiffness: Callable[[], Array]
    EI_z: float
    EI_y: float
    omitted: OmittedStiffness | None
    station_law: Callable[[], StationLaw]

    # Error up to which a run does not look for the step that bends a beam most: of what is stated, the last digit.
    NEGLIGIBLE = 1e-4

    @property
    def size(self) -> int:
        """Number of elastic coordinates."""
        return sum(self.counts)

    @property
    def scale(self) -> Array:
        """Factor of each coordinate (n): 1/L of a displacement, else 1."""
        return np.where(self.displacements, 1.0 / self.length, 1.0)

    @property
    def in_q(self) -> slice:
        """Place of the elastic coordinates in q."""
        return slice(self.q, self.q + self.size)

    @property
    def in_v(self) -> slice:
        """Place of their rates in v."""
        return slice(self.v, self.v + self.size)

    @property
    def angle_blocks(self) -> Array:
        """Angles as C reads them: by block of eight stations that turn, coordinate and station; zeros fill the last."""
        turning = self.angles[np.any(self.angles != 0.0, axis=1)]
        blocks = -(-len(turning) // _BLOCK)
        angles = np.zeros((_BLOCK * blocks, self.size))
        angles[: len(turning)] = turning
        return np.ascontiguousarray(angles.reshape(blocks, _BLOCK, self.size).transpose(0, 2, 1))

    @property
    def contrast(self) -> float:
        """Difference of the stiffnesses over the smaller: how twist acts on bending; zero where a plane is rigid."""
        if not (self.counts[0] and self.counts[1]) or min(self.EI_z, self.EI_y) <= 0.0:
            return 0.0
        return abs(self.EI_z - self.EI_y) / min(self.EI_z, self.EI_y)

    @property
    def scaled_reach(self) -> Array:
        """Largest yaw, pitch or twist at the stations by each scaled coordinate (n)."""
        largest: Array = np.abs(self.angles).max(axis=0)
        return largest

    @property
    def reach(self) -> Array:
        """Largest yaw, pitch or twist at the stations by each coordinate (n)."""
        return self.scaled_reach * self.scale

    def error_bound(self, elastic: Array) -> float:
        """An upper bound of the error of a deformation that costs little: each coordinate's largest angle counts."""
        angles = self.reach * np.abs(elastic)
        slope, twist = float(angles[: sum(self.counts[:2])].sum()), float(angles[sum(self.counts[:2]) :].sum())
        return native_number(_JUDGE, "SYM_BEAM_SLOPE_ERROR") * slope**2 + self.contrast * twist**2

    def bending(self, elastic: Array, t: float = math.nan, amplification: float = 1.0) -> BeamBending:
        """Judge a deformation.

        Args:
            elastic: Elastic coordinates (n).
            t: Instant [s].
            amplification: Elastic stiffness over the stiffness that axial loads leave (26).
        """
        n_y, n_z, _ = self.counts
        by_coordinate = self.angles * (self.scale * np.clip(elastic, -_LARGEST, _LARGEST))
        yaw, pitch, twist = (part.sum(axis=1) ** 2 for part in np.split(by_coordinate, (n_y, n_y + n_z), axis=1))
        slope = yaw + pitch
        at = int(np.argmax(slope))
        error = self._error(float(yaw.max()), float(pitch.max()), float(slope[at]), float(twist.max()))
        if amplification <= 0.0:
            error = math.inf if slope[at] > _STRAIGHT**2 else 0.0
        return BeamBending(
            self.name,
            float(self.xi[at]) * self.length,
            math.sqrt(slope[at]),
            math.sqrt(twist.max()),
            0.5 * float(np.trapezoid(slope, self.xi)),
            error,
            t,
        ).amplified(amplification)

    def _error(self, yaw: float, pitch: float, slope: float, twist: float) -> float:
        """Estimated error from squares of the largest angles (24), (25)."""
        error = slope_error(slope)
        stiffness = self.EI_y * pitch + self.EI_z * yaw
        if twist > 0.0 and self.contrast > 0.0 and stiffness > 0.0:
            contrast = abs(self.EI_z - self.EI_y) * abs(pitch - yaw) / stiffness
            error += contrast * twist * slope / (slope + twist)
        return error

    def left_out(
        self,
        elastic: Array,
        stations: Array,
        forces: Array,
        free: Array | None = None,
        turning: tuple[Array, Array] | None = None,
    ) -> tuple[LeftOut, ...]:
        """What is worth a note of the stiffness that the order leaves out.

        Args:
            elastic: Elastic coordinates (n).
            stations: Stations x/L of the section forces (s); none where they are not known.
            forces: Section forces (s, 6).
            free: Changes of the elastic coordinates that constraints leave (n, k), where there are some.
            turning: As of `Turning`, where that is known and left out.
        """
        if self.omitted is None:
            return ()
        angles = self.angles * self.scale
        beam = BentBeam(self.length, self.xi, angles, self.counts, self.elastic_stiffness(), free)
        parts = left_out(self.omitted, beam, elastic, (stations, forces), Turning(*turning) if turning else None)
        return tuple(part for part in parts if abs(part.change) > NOTED_ERROR)

    def difference_step(self, elastic: Array) -> Array:
        """Share of elastic coordinates (..., n) that turns sections by the angle of differences (...)."""
        turned = np.abs(elastic) @ self.reach
        angle, least = (native_number(_AXIAL, f"SYM_BEAM_{name}") for name in ("TURN", "LEAST_TURN"))
        step: Array = np.divide(angle, turned, out=np.zeros_like(turned), where=turned > least)
        return step

    def amplification(self, elastic: Array, tangent: Array) -> float:
        """Elastic stiffness over the stiffness that loads leave, in the direction of a deformation (26).

        Args:
            elastic: Elastic coordinates (n).
            tangent: Tangent stiffness of the elastic coordinates at rest under loads (n, n).

        Returns:
            One without axial loads, more under compression, below one in tension; zero past the critical load, where
            the stiffness has a negative direction.
        """
        stiffness = self.elastic_stiffness()
        try:
            inverse = np.linalg.inv(np.linalg.cholesky(stiffness))
        except np.linalg.LinAlgError:  # A direction without elastic stiffness.
            return 1.0
        # Of forces that follow, as a thrust along the tip, it is not symmetric: complex pairs are no loss of stiffness.
        left = np.linalg.eigvals(inverse @ tangent @ inverse.T)
        if np.any((np.abs(left.imag) <= _REAL * np.abs(left)) & (left.real <= _CRITICAL)):
            return 0.0
        energy, loaded = float(elastic @ stiffness @ elastic), abs(float(elastic @ tangent @ elastic))
        return energy / max(loaded, _CRITICAL * energy) if energy > 0.0 else 1.0


@dataclass(frozen=True)
class ExactElasticBeam(ElasticBeam):
    """A geometrically exact beam, a rod: only the integration over its sections errs (docs/theory/rods.md, section 6).

    Angles are those by which each coordinate alone turns sections, made small: runs keep the state that turns a rod
    most, and no such angle reaches a limit, which is one of second-order theory.

    Attributes:
        sections: Number of sections.
        integration_error: Gives the error of the shape over the length for elastic coordinates.
    """

    sections: int
    integration_error: Callable[[Array], float]

    # Factor of the angles, whose errors are a measure of how far a rod turns and no errors.
    REDUCED = 1e-4
    NEGLIGIBLE = 0.0

    def bending(self, elastic: Array, t: float = math.nan, amplification: float = 1.0) -> BeamBending:
        """Judge a deformation; axial loads amplify no error of a rod."""
        bent = super().bending(elastic, t)
        finite = bool(np.isfinite(elastic).all())
        error = self.integration_error(elastic) if finite else math.inf
        slope, twist = bent.slope / self.REDUCED, bent.twist / self.REDUCED
        return replace(bent, slope=slope, twist=twist, foreshortening=math.nan, error=error, sections=self.sections)

    def difference_step(self, elastic: Array) -> Array:
        """Share of elastic coordinates (..., n) that turns sections by the angle of differences (...)."""
        return self.REDUCED * super().difference_step(elastic)

    def amplification(self, elastic: Array, tangent: Array) -> float:
        """One: a rod has its rest positions beyond critical loads as well."""
        return 1.0


def amplification_of(work: Array, loaded: Array) -> float:
    """Amplification of a beam's error in a motion (26a); one without deformation.

    Args:
        work: Work of the elastic stiffness in states of the motion (n).
        loaded: Work of the tangent stiffness there (n).
    """
    elastic, total = float(work.sum()), float(loaded.sum())
    if not (elastic > 0.0 and math.isfinite(total)):
        return 1.0
    return elastic / max(abs(total), native_number(_AXIAL, "SYM_BEAM_LEAST_WORK") * elastic)


def worst_bendings(
    beams: Sequence[ElasticBeam], t: Array, elastic: Array, amplifications: Sequence[float] = ()
) -> tuple[BeamBending, ...]:
    """The bending of each beam at an instant of its own.

    Args:
        beams: Beams.
        t: Instant of each (k) [s].
        elastic: Elastic coordinates of all, one beam after the other.
        amplifications: Amplification of each by its axial loads (k); ones if not given.
    """
    parts = np.split(elastic, np.cumsum([beam.size for beam in beams])[:-1]) if beams else []
    factors = amplifications or [1.0] * len(beams)
    return tuple(
        beam.bending(q, float(when), factor) for beam, q, when, factor in zip(beams, parts, t, factors, strict=True)
    )


def largest_bending(bendings: Sequence[BeamBending]) -> BeamBending | None:
    """The bending with the largest error; None without beams."""
    return max(bendings, key=lambda bending: bending.error, default=None)


def bending_notes(bendings: Sequence[BeamBending], *, vibrating: bool = False) -> tuple[str, ...]:
    """Sentences on the beams whose error, or what their order leaves out, is worth a note.

    A straight beam has no deflection that stiffness would change: of it only a critical load counts.

    Args:
        bendings: Bending of each beam.
        vibrating: Whether straight beams vibrate, as in modes.
    """
    notes = [f"{bending}; {bending.remedy}" for bending in bendings if bending.error > NOTED_ERROR]
    for bending in bendings:
        bent = vibrating or max(bending.slope, bending.twist) > _STRAIGHT
        notes += left_out_notes(bending.beam, [part for part in bending.left_out if bent or part.change <= -1.0])
    return tuple(notes)
