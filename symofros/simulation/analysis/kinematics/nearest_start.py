"""The state on the constraints nearest to what is stated of a start that can't be kept (docs/theory/constraints.md, 5).

What counts is the root of the sum of squares of the changes of what is stated, translations over the largest reach.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from symofros.base.arrays import Array
from symofros.errors import AssemblyError
from symofros.runtime.constrained import LARGEST_STEP, null_space
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.kinematics.assembly import (
    Assembled,
    Attempt,
    approach,
    assemble,
    free_speeds,
    shift_scales,
)
from symofros.simulation.analysis.kinematics.nearest_posture import pull

# Drawn guesses of what is not stated, a half turn and the reach either way at most: other branches of a loop.
DRAWN = 4
# Most steps of a descent, halvings of a step, and the relative decrease of the distance that ends it.
STEPS, HALVINGS, SETTLED = 30, 12, 1e-6
# Share of a motion of one below which what is stated does not follow it.
FOLLOWS = 1e-6


@dataclass(frozen=True)
class Instant:
    """A model with its inputs and parameters at an instant."""

    model: Model
    u: ArrayLike | None = None
    par: ArrayLike | None = None
    t: float = 0.0

    def assembled(self, q: Array, v: Array | None = None, held: Sequence[str] = ()) -> Assembled:
        """The state on the constraints that a guess leads to.

        Raises:
            AssemblyError: It leads to none.
        """
        return assemble(self.model, q, v, held=held, u=self.u, par=self.par, t=self.t)

    def approached(self, q: Array, held: Sequence[str] = ()) -> Attempt:
        """Result of the steps from this guess alone; see `approach`."""
        return approach(self.model, q, held=held, u=self.u, par=self.par, t=self.t)

    def motions(self, q: Array) -> Array:
        """Orthonormal motions (nv, n) that keep the constraints."""
        G = self.model.constraint_jacobian(q, u=self.u, par=self.par, t=self.t)
        return null_space(G, self.model.record.measures)

    def scales(self, q: Array) -> Array:
        """Size of a unit change of each speed (nv): a radian, or the largest reach; 1 for elastic coordinates."""
        G = self.model.constraint_jacobian(q, u=self.u, par=self.par, t=self.t)
        scales = shift_scales(self.model, G)
        return np.where(scales > 0.0, scales, 1.0)


def nearest_posture_to(at: Instant, q: Array, stated: Sequence[str], accepted: Callable[[Array], bool]) -> Array:
    """The closed posture (nq) nearest to the stated coordinates of those that are found.

    Args:
        at: The model at the first instant.
        q: What is stated, with a guess of what is not (nq).
        stated: Speeds whose coordinates are stated.
        accepted: Whether a posture changes so little of what is stated that the search ends.

    Raises:
        AssemblyError: None is found.
    """
    rows = _rows(at.model, stated)
    distance = _Distance(at, q, rows, at.scales(q)[rows])
    best = None
    for posture in _postures(distance, stated):
        if accepted(posture):
            return posture
        if best is None or distance(posture) < distance(best):
            best = posture
    return at.assembled(q).q if best is None else best


def nearest_speeds_to(
    at: Instant, q: Array, v: Array, stated: Sequence[str], accepted: Callable[[Array], bool]
) -> Array:
    """The speeds (nv) that keep a closed posture closed and change the stated ones least; see `nearest_posture_to`."""
    rows = _rows(at.model, stated)
    found, Z, weights = at.assembled(q, v).v, at.motions(q), 1.0 / at.scales(q)[rows]
    change = _least(weights[:, None] * Z[rows], weights * (v - found)[rows])
    nearest = at.assembled(q, found + Z @ change).v
    if accepted(nearest):
        return nearest
    for held in _all_but_one(stated):
        with suppress(AssemblyError):
            candidate = at.assembled(q, v, held).v
            if accepted(candidate):
                return candidate
    return nearest


@dataclass(frozen=True)
class _Distance:
    """Distance of a posture from the stated coordinates.

    Attributes:
        at: The model at the first instant.
        asked: What is stated, with a guess of what is not (nq).
        rows: Speeds whose coordinates are stated.
        sizes: What counts as a change of one for each of them.
    """

    at: Instant
    asked: Array
    rows: list[int]
    sizes: Array

    def changes(self, q: Array) -> Array:
        """Displacements along the stated speeds that lead back to the stated coordinates, over their sizes."""
        return np.asarray(pull(self.at.model, q, self.asked)[self.rows] / self.sizes)

    def __call__(self, q: Array) -> float:
        return float(np.linalg.norm(self.changes(q)))

    def with_stated(self, q: Array) -> Array:
        """A posture with its stated coordinates as they are stated."""
        step = np.zeros(self.at.model.nv)
        step[self.rows] = self.changes(q) * self.sizes
        return self.at.model.integrate(q, step)

    def descend(self, q: Array) -> Array:
        """Descend from a closed posture to one whose distance is the least nearby (Gauss, Newton)."""
        for _ in range(STEPS):
            nearer = self._nearer(q)
            if nearer is None:
                return q
            settled = self(nearer) > (1.0 - SETTLED) * self(q)
            q = nearer
            if settled:
                break
        return q

    def _nearer(self, q: Array) -> Array | None:
        Z = self.at.motions(q)
        step = Z @ _least(Z[self.rows] / self.sizes[:, None], self.changes(q))
        largest = float(np.abs(step / self.at.scales(q)).max(initial=0.0))
        step *= min(1.0, LARGEST_STEP / max(largest, 1e-300))
        for _ in range(HALVINGS):
            with suppress(AssemblyError):
                tried = self.at.approached(self.at.model.integrate(q, step))
                if tried.closes and self(tried.q) < self(q):
                    return tried.q
            step = 0.5 * step
        return None


def _postures(distance: _Distance, stated: Sequence[str]) -> Iterator[Array]:
    """Closed postures near the stated coordinates: from guesses of the others, by descents, and with one released."""
    at = distance.at
    for guess in _guesses(distance):
        with suppress(AssemblyError):
            placed = at.approached(guess, stated).q
            nearest = distance.descend(at.assembled(placed).q)
            yield nearest
            yield from _with_one_released(distance, distance.with_stated(nearest), stated)


def _with_one_released(distance: _Distance, q: Array, stated: Sequence[str]) -> Iterator[Array]:
    """Closed postures with all but one stated coordinate held, each followed by the end of a descent from it."""
    for held in _all_but_one(stated):
        with suppress(AssemblyError):
            end = distance.at.approached(q, held)
            if end.closes:
                yield end.q
                yield distance.descend(end.q)


def _guesses(distance: _Distance) -> Iterator[Array]:
    """The guess, then drawn ones of what is not stated, the same for the same model."""
    at, random = distance.at, np.random.default_rng(0)
    yield distance.asked
    scales = shift_scales(at.model, at.model.constraint_jacobian(distance.asked, u=at.u, par=at.par, t=at.t))
    scales[distance.rows] = 0.0
    scales *= np.where(scales == 1.0, np.pi, 1.0)
    for _ in range(DRAWN if scales.any() else 0):
        yield at.model.integrate(distance.asked, scales * random.uniform(-1.0, 1.0, at.model.nv))


def _all_but_one(stated: Sequence[str]) -> list[list[str]]:
    """All but one of the stated, in turn; none where there is one alone."""
    return [[name for name in stated if name != left_out] for left_out in stated if len(stated) > 1]


def _least(A: Array, b: Array) -> Array:
    """The least x of least |A x - b|, for an A of orthonormal motions, without those that hardly reach b."""
    U, s, Vt = np.linalg.svd(A, full_matrices=False)
    follows = s > FOLLOWS
    return np.asarray(Vt[follows].T @ (U[:, follows].T @ b / s[follows]))


def _rows(model: Model, stated: Sequence[str]) -> list[int]:
    """Indices of the stated speeds, in order."""
    return sorted(set(range(model.nv)) - set(free_speeds(model, stated).tolist()))
