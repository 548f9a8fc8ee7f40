"""Stiffness under load that the order of a beam's equations leaves out (docs/theory/beams.md, 6, eqs. 26g, 26h)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from symofros.runtime.calls.kernel import Array

_SHORTENING = "state retain: first_order or all, with foreshortening"
# Share of the largest singular value from which a direction counts.
_INDEPENDENT = 1e-9
# Place of the bending moment of each plane among section forces.
_MOMENTS = {"y": 5, "z": 4}


class LeftOut(NamedTuple):
    """What a beam leaves out in a state.

    Attributes:
        what: Of its loads, in words.
        change: How much stiffer the beam would be with it, relative; -1 where loads are past a critical one.
        remedy: What has it.
    """

    what: str
    change: float
    remedy: str

    @property
    def effect(self) -> str:
        """What it would do, in words."""
        if self.change <= -1.0:
            return "its loads are past a critical one"
        return f"it would be about {100.0 * abs(self.change):.2g} % {'stiffer' if self.change > 0.0 else 'softer'}"


@dataclass(frozen=True)
class OmittedStiffness:
    """Parts of a beam's tangent stiffness that its equations do not have.

    Attributes:
        order: Entries that leave them out, as they are stated.
        axial: Whether what axial forces do is left out.
        rigid: Plane of bending without functions, "y" or "z", where the other plane and twist have some; else "".
        coupling: Forms the third derivatives of the strain energy (n, n, n); None where the equations have them.
        in_series: Number of beams, each clamped to the tip of the last, that lack this together.
    """

    order: str
    axial: bool
    rigid: str
    coupling: Callable[[], Array] | None
    in_series: int

    @property
    def leaves_out(self) -> str:
        """What is left out, in words."""
        coupling = f"how loads couple bending and twist ({f'bend_{self.rigid}: 0' if self.rigid else self.order})"
        axial = f"what axial forces do ({self.order})"
        couples = bool(self.rigid) or self.coupling is not None
        return " and ".join([axial] * self.axial + [coupling] * couples)

    @property
    def of_forces(self) -> bool:
        """Whether it follows from section forces."""
        return self.axial or bool(self.rigid)


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
        """Coupling of twist and bending by a moment at stations x/L in the plane that is rigid (26h)."""
        K, bending = np.zeros_like(self.stiffness), self.bending[0]
        twist = slice(sum(self.counts[:2]), len(K))
        curvatures = np.gradient(self.angles[:, bending], self.length * self.xi, axis=0, edge_order=2)
        K[twist, bending] = self.angles[:, twist].T @ (curvatures * self._weighed(stations, moment))
        K[bending, twist] = K[twist, bending].T
        return K

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


def _range(columns: Array) -> Array:
    """Orthonormal basis of what columns span."""
    basis, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(basis[:, sizes > _INDEPENDENT * sizes.max(initial=0.0)])


def left_out(
    omitted: OmittedStiffness, beam: BentBeam, elastic: Array, stations: Array, forces: Array
) -> list[LeftOut]:
    """What a beam leaves out at elastic coordinates (n), with section forces (s, 6) at stations x/L, where known."""
    found, count = [], omitted.in_series
    if omitted.axial and len(stations):
        change = beam.change(count**2 * beam.axial_stiffness(stations, forces[:, 0]))
        found.append(LeftOut(f"what axial forces do to its stiffness ({omitted.order})", change, _SHORTENING))
    if omitted.rigid and len(stations):
        change = beam.change(count * beam.turned_stiffness(stations, forces[:, _MOMENTS[omitted.rigid]]))
        what = f"how its loads couple bending and twist (bend_{omitted.rigid}: 0)"
        found.append(LeftOut(what, change, f"give it functions of bend_{omitted.rigid}, or theory: strain"))
    elif omitted.coupling is not None:
        change = beam.change(count * np.einsum("ijk,k->ij", omitted.coupling(), elastic))
        what = f"how its loads couple bending and twist ({omitted.order})"
        found.append(LeftOut(what, change, "state retain: all"))
    return found


def left_out_notes(beam: str, parts: Sequence[LeftOut]) -> tuple[str, ...]:
    """Sentences on what a beam leaves out."""
    return tuple(f"beam '{beam}' leaves out {part.what}, with which {part.effect}; {part.remedy}" for part in parts)
