"""What the order of a beam's equations leaves out under loads and in rotation (docs/theory/beams.md, 6, 26g to 26l)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from symofros.runtime.calls.kernel import Array

_SHORTENING = "state retain: first_order or all, with foreshortening"
# Share of the largest singular value from which a direction counts.
_INDEPENDENT = 1e-9
# Place of the moment that works on what is rigid among section forces.
_MOMENTS = {"y": 5, "z": 4, "x": 3}


class LeftOut(NamedTuple):
    """What a beam leaves out in a state.

    Attributes:
        what: Of its loads, in words.
        change: How much stiffer the beam would be with it, relative; -1 where loads are past a critical one. Or how
            much higher a frequency would be.
        remedy: What has it.
        of_frequency: Whether it changes frequencies, and no stiffness.
    """

    what: str
    change: float
    remedy: str
    of_frequency: bool = False

    @property
    def effect(self) -> str:
        """What it would do, in words."""
        if self.of_frequency:
            return f"its frequencies would change by about {100.0 * abs(self.change):.2g} %"
        if self.change <= -1.0:
            return "its loads are past a critical one"
        return f"it would be about {100.0 * abs(self.change):.2g} % {'stiffer' if self.change > 0.0 else 'softer'}"


@dataclass(frozen=True)
class OmittedStiffness:
    """Parts of a beam's tangent stiffness that its equations do not have.

    Attributes:
        order: Entries that leave them out, as they are stated.
        axial: Whether what axial forces do is left out.
        rigid: Direction without functions where both others have some: "y" or "z", a plane of bending, or "x", twist;
            else "".
        coupling: Forms the third derivatives of the strain energy (n, n, n); None where the equations have them.
        in_series: Number of beams, each clamped to the tip of the last, that lack this together.
        turning: Whether what rotation does to a bent beam is left out, too.
    """

    order: str
    axial: bool
    rigid: str
    coupling: Callable[[], Array] | None
    in_series: int
    turning: bool

    @property
    def by_axial(self) -> str:
        """What is left out with axial forces, in words."""
        return "axial forces and rotation do" if self.turning else "axial forces do"

    @property
    def leaves_out(self) -> str:
        """What is left out, in words."""
        coupling = f"how loads couple {self.coupled} ({self.lacking or self.order})"
        axial = f"what {self.by_axial} ({self.order})"
        couples = bool(self.rigid) or self.coupling is not None
        return " and ".join([axial] * self.axial + [coupling] * couples)

    @property
    def lacking(self) -> str:
        """The entry that leaves a direction without functions, where that matters."""
        return {"": "", "x": "twist: 0"}.get(self.rigid, f"bend_{self.rigid}: 0")

    @property
    def coupled(self) -> str:
        """The directions that loads couple, in words."""
        return "bending in both planes" if self.rigid == "x" else "bending and twist"

    @property
    def of_forces(self) -> bool:
        """Whether it follows from section forces."""
        return self.axial or bool(self.rigid)


class Turning(NamedTuple):
    """How a beam turns in a motion, and the inertia of its deflections there.

    Attributes:
        rates: Angular velocity of the root in its own axes (n, 3) [rad/s].
        mass: Mass matrix of the elastic coordinates (k, k).
    """

    rates: Array
    mass: Array


class BentBeam(NamedTuple):
    """Numbers of a beam that its stiffness under loads follows from.

    Attributes:
        length: Length [m].
        xi: Stations x/L (s), an odd number at equal distances.
        angles: Yaw, pitch and twist there per coordinate (s, n).
        counts: Number of coordinates of bend_y, bend_z and twist.
        stiffness: Elastic stiffness (n, n).
        free: Changes of the coordinates that constraints leave (n, k), where there are some.
    """

    length: float
    xi: Array
    angles: Array
    counts: Sequence[int]
    stiffness: Array
    free: Array | None

    @property
    def blocks(self) -> Iterator[slice]:
        """Places of the coordinates of each direction that has some."""
        ends = np.cumsum(self.counts)
        return (slice(int(end) - n, int(end)) for end, n in zip(ends, self.counts, strict=True) if n)

    @property
    def bending(self) -> Sequence[slice]:
        """Places of the coordinates of the planes of bending that have some."""
        return [block for block in self.blocks if block.start < sum(self.counts[:2])]

    def _weighed(self, stations: Array, force: Array) -> Array:
        """A force or moment at stations x/L, times the weights of Simpson's rule over the length (s, 1)."""
        weights = np.full(len(self.xi), 2.0)
        weights[1::2] = 4.0
        weights[[0, -1]] = 1.0
        weights *= self.length / (3.0 * (len(self.xi) - 1))
        return np.asarray(weights * np.interp(self.xi, stations, force))[:, np.newaxis]

    def axial_stiffness(self, stations: Array, N: Array) -> Array:
        """Stiffness by axial forces N at stations x/L (26g)."""
        K, weighed = np.zeros_like(self.stiffness), self._weighed(stations, N)
        for block in self.bending:
            slopes = self.angles[:, block]
            K[block, block] = slopes.T @ (slopes * weighed)
        return K

    def turned_stiffness(self, stations: Array, moment: Array) -> Array:
        """Coupling of the two directions with functions by a moment at stations x/L on the rigid one (26h), (26j)."""
        K, (bent, turned) = np.zeros_like(self.stiffness), self.blocks
        curvatures = np.gradient(self.angles[:, bent], self.length * self.xi, axis=0, edge_order=2)
        K[turned, bent] = self.angles[:, turned].T @ (curvatures * self._weighed(stations, moment))
        K[bent, turned] = K[turned, bent].T
        return K

    def centrifugal_stiffness(self, turning: Turning) -> Array:
        """What rotation takes from the stiffness of each plane, but for a spin that couples both (26k)."""
        K, squares = np.zeros_like(self.stiffness), np.square(turning.rates).mean(axis=0)
        spin = 0.0 if self.counts[0] and self.counts[1] else squares[0]
        for block, square in zip(
            np.split(np.arange(len(K)), np.cumsum(self.counts[:2])), squares[[2, 1]], strict=False
        ):
            K[np.ix_(block, block)] = -(spin + square) * turning.mass[np.ix_(block, block)]
        return K

    def coupled_frequencies(self, turning: Turning) -> float:
        """How much higher a frequency is by a spin about the axis that couples both planes, relative (26l)."""
        n_y, both = self.counts[0], slice(sum(self.counts[:2]))
        spin, M, K = float(turning.rates[:, 0].mean()), turning.mass[both, both], self.stiffness[both, both]
        deflections = np.zeros_like(self.angles[:, both])
        steps = 0.5 * np.diff(self.xi)[:, np.newaxis]
        deflections[1:] = np.cumsum((self.angles[1:, both] + self.angles[:-1, both]) * steps, axis=0)
        G = np.zeros_like(M)
        G[:n_y, n_y:] = -M[:n_y, :n_y] @ np.linalg.lstsq(deflections[:, :n_y], deflections[:, n_y:])[0]
        G -= G.T
        if self.free is not None:
            basis = _range(self.free[both])
            M, K, G = (basis.T @ A @ basis for A in (M, K, G))
        if not len(M) or not np.isfinite([M, K, G]).all() or np.linalg.matrix_rank(M) < len(M):
            return 0.0
        squares, turned = (np.asarray(np.linalg.solve(M, A), dtype=np.float64) for A in (K, G))
        at_rest = _rates(squares, turned, 0.0)
        return float(max(_rates(squares, turned, spin) / at_rest - 1.0, key=abs)) if at_rest[0] > 0.0 else 0.0

    def change(self, added: Array) -> float:
        """How much stiffer a direction becomes at most, relative; -1 where no stiffness is left (26i)."""
        blocks, stiffness = list(self.blocks), self.stiffness
        if self.free is not None:
            parts = [_range(self.free[block]) for block in blocks]
            basis = np.zeros((len(stiffness), sum(part.shape[1] for part in parts)))
            ends = np.cumsum([part.shape[1] for part in parts])
            places = [slice(int(end) - part.shape[1], int(end)) for end, part in zip(ends, parts, strict=True)]
            for block, place, part in zip(blocks, places, parts, strict=True):
                basis[block, place] = part
            blocks, stiffness, added = places, basis.T @ stiffness @ basis, basis.T @ added @ basis
        if not len(stiffness) or not np.isfinite(added).all():
            return 0.0
        try:
            inverse = np.linalg.inv(np.linalg.cholesky(stiffness))
        except np.linalg.LinAlgError:  # A direction without elastic stiffness.
            return 0.0
        loaded = np.eye(len(added)) + inverse @ added @ inverse.T
        if np.linalg.eigvalsh(loaded)[0] <= 0.0:
            return -1.0
        compliance = np.linalg.inv(loaded)
        # The elastic stiffness does not couple directions, so that its factor has blocks as well.
        changes = [1.0 / np.linalg.eigvalsh(compliance[block, block]) - 1.0 for block in blocks]
        return float(max(np.concatenate(changes), key=abs))


def _rates(squares: Array, turned: Array, spin: float) -> Array:
    """Sizes of the eigenvalues of q'' + 2 spin turned q' + (squares - spin^2) q = 0, rising."""
    unit = np.eye(len(squares))
    A = np.block([[np.zeros_like(unit), unit], [spin**2 * unit - squares, -2.0 * spin * turned]])
    return np.sort(np.abs(np.linalg.eigvals(A)))


def _range(columns: Array) -> Array:
    """Orthonormal basis of what columns span."""
    basis, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(basis[:, sizes > _INDEPENDENT * sizes.max(initial=0.0)])


def left_out(
    omitted: OmittedStiffness, beam: BentBeam, elastic: Array, loads: tuple[Array, Array], turning: Turning | None
) -> list[LeftOut]:
    """What a beam leaves out at elastic coordinates (n), under section forces (s, 6) at stations x/L, where known."""
    found, count, (stations, forces) = [], omitted.in_series, loads
    if omitted.axial and len(stations):
        added = count**2 * beam.axial_stiffness(stations, forces[:, 0])
        if turning is not None:
            turning = turning._replace(mass=count * turning.mass)
            added += beam.centrifugal_stiffness(turning)
        what = f"what {omitted.by_axial} to its stiffness ({omitted.order})"
        found.append(LeftOut(what, beam.change(added), _SHORTENING))
    if turning is not None and all(beam.counts[:2]) and np.any(turning.rates[:, 0]):
        what = f"how a spin about its axis couples bending in both planes ({omitted.order})"
        found.append(LeftOut(what, beam.coupled_frequencies(turning), _SHORTENING, of_frequency=True))
    if omitted.rigid and len(stations):
        change = beam.change(count * beam.turned_stiffness(stations, forces[:, _MOMENTS[omitted.rigid]]))
        what = f"how its loads couple {omitted.coupled} ({omitted.lacking})"
        found.append(LeftOut(what, change, f"give it functions of {omitted.lacking[:-3]}, or theory: strain"))
    elif omitted.coupling is not None:
        change = beam.change(count * np.einsum("ijk,k->ij", omitted.coupling(), elastic))
        what = f"how its loads couple bending and twist ({omitted.order})"
        found.append(LeftOut(what, change, "state retain: all"))
    return found


def left_out_notes(beam: str, parts: Sequence[LeftOut]) -> tuple[str, ...]:
    """Sentences on what a beam leaves out."""
    return tuple(f"beam '{beam}' leaves out {part.what}, with which {part.effect}; {part.remedy}" for part in parts)
