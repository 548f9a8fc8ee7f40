"""Every difference of signs, orders, frames and quaternions between SYMOFROS and the engines, in one place.

The engines' folders state them in words (`Difference`, which reports print); `Chart` carries them out. An engine's
speeds are linear in ours, v_e = T(q) v, with T a permutation of blocks times rotations of the free joints' linear
speeds, so T is orthogonal and

    a_e = T a + T' v,   M = T^T M_e T,   h = T^T (h_e + M_e T' v),   Q_e = T Q,   J = J_e T,   J' = J_e' T + J_e T'.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..mechanics.assembly import Mover
from ..mechanics.geometry import (
    Array,
    Placement,
    matrix_quaternion,
    quaternion_matrix,
    quaternion_product,
    skew,
)


class Difference(NamedTuple):
    """One convention that an engine states otherwise."""

    engine: str
    what: str
    symofros_convention: str
    engine_convention: str


# A free joint that stands in the world, whatever ours stands in; one that is three slides in P, then a ball.
IN_WORLD = "free wxyz, linear before and angular after"
IN_PARENT = "three lengths + quaternion wxyz, body speeds"


@dataclass(frozen=True)
class Slot:
    """Where an engine keeps one of our joints.

    Attributes:
        mover: Our joint.
        q: Start in the engine's coordinates.
        v: Start in the engine's speeds.
        chart: The engine's chart of it, by its name in `engines.truth.charts`, or the charts of the joints that it is a
            series of; "" for ours.
    """

    mover: Mover
    q: int
    v: int
    chart: str = ""

    @property
    def turns(self) -> bool:
        """Whether its linear speeds are along the axes of its position: they rotate against ours, along the body's."""
        return self.chart in (IN_WORLD, IN_PARENT)


def _in_world(mover: Mover, q: Array) -> Array:
    return _free(mover.X_AP, q)


def _in_parent(_: Mover, q: Array) -> Array:
    return _free(Placement.identity(), q)


def _free(X: Placement, q: Array) -> Array:
    turned = quaternion_product(np.broadcast_to(matrix_quaternion(X.R), q[:, 3:].shape), q[:, 3:])
    return np.concatenate([X.p + q[:, :3] @ X.R.T, xyzw_to_wxyz(turned)], axis=1)


def xyzw_to_wxyz(quaternion: Array) -> Array:
    """Scalar last -> scalar first (..., 4)."""
    return np.roll(quaternion, 1, axis=-1)


# Charts whose coordinates are not ours.
_ENCODE: Mapping[str, Callable[[Mover, Array], Array]] = {
    "cos sin": lambda _, q: np.concatenate([np.cos(q), np.sin(q)], axis=1),
    "quaternion wxyz, body speeds": lambda _, q: xyzw_to_wxyz(q),
    IN_WORLD: _in_world,
    IN_PARENT: _in_parent,
}
# Charts whose coordinates and speeds are.
_OURS = frozenset({"", "angle", "length", "screw angle", "quaternion xyzw, body speeds", "free xyzw, body speeds"})


@dataclass(frozen=True)
class Chart:
    """An engine's coordinates against ours; methods take and give batches (N, ...).

    Attributes:
        slots: One for each of our moving joints, in our order.
        nq: Length of the engine's q.
        nv: Length of the engine's v, and of ours.
    """

    slots: tuple[Slot, ...]
    nq: int
    nv: int

    def __post_init__(self) -> None:
        """Check that the chart of each slot is one of ours or has a conversion."""
        for slot in self.slots:
            assert slot.chart in _OURS or slot.chart in _ENCODE, slot.chart

    @property
    def turns(self) -> bool:
        """Whether T depends on q."""
        return any(slot.turns for slot in self.slots)

    def coordinates(self, q: Array) -> Array:
        """Coordinates of the engine from ours."""
        q_e = np.zeros((len(q), self.nq))
        for slot in self.slots:
            part = q[:, slot.mover.q]
            if slot.chart in _ENCODE:
                part = _ENCODE[slot.chart](slot.mover, part)
            q_e[:, slot.q : slot.q + part.shape[1]] = part
        return q_e

    def transform(self, q: Array) -> Array:
        """T(q) (N, nv, nv): v_e = T v."""
        T = np.zeros((len(q), self.nv, self.nv))
        for slot in self.slots:
            columns = slot.mover.v
            size = columns.stop - columns.start
            T[:, slot.v : slot.v + size, columns] = np.eye(size)
            if slot.turns:
                T[:, slot.v : slot.v + 3, columns.start : columns.start + 3] = self._free_rotation(slot, q)
        return T

    def transform_rate(self, q: Array, v: Array) -> Array:
        """T'(q, v) (N, nv, nv): only free joints turn, R' = R [w]x."""
        rate = np.zeros((len(q), self.nv, self.nv))
        for slot in self.slots:
            if slot.turns:
                start = slot.mover.v.start
                turning = self._free_rotation(slot, q) @ skew(v[:, start + 3 : start + 6])
                rate[:, slot.v : slot.v + 3, start : start + 3] = turning
        return rate

    @staticmethod
    def _free_rotation(slot: Slot, q: Array) -> Array:
        R_PB = quaternion_matrix(q[:, slot.mover.q][:, 3:])
        return slot.mover.X_AP.R @ R_PB if slot.chart == IN_WORLD else R_PB

    def mass_matrix(self, q: Array, M_e: Array) -> Array:
        """Mass matrix M from the engine's."""
        T = self.transform(q)
        return _transposed(T) @ M_e @ T

    def bias(self, q: Array, v: Array, h_e: Array, M_e: Array) -> Array:
        """Bias h from the engine's: the chart's own acceleration T' v is among our velocity terms."""
        carried = times(M_e, times(self.transform_rate(q, v), v))
        return times(_transposed(self.transform(q)), h_e + carried)

    def speeds(self, q: Array, v: Array) -> Array:
        """Speeds v_e of the engine from ours."""
        return times(self.transform(q), v)

    def accelerations(self, q: Array, v: Array, a: Array) -> Array:
        """Accelerations a_e of the engine from ours."""
        return times(self.transform(q), a) + times(self.transform_rate(q, v), v)

    def our_accelerations(self, q: Array, v: Array, a_e: Array) -> Array:
        """Our accelerations from a_e."""
        return times(_transposed(self.transform(q)), a_e - times(self.transform_rate(q, v), v))

    def forces(self, q: Array, Q: Array) -> Array:
        """Forces Q_e of the engine from ours; T is orthogonal, so forces turn like speeds."""
        return times(self.transform(q), Q)

    def our_forces(self, q: Array, Q_e: Array) -> Array:
        """Our forces from Q_e."""
        return times(_transposed(self.transform(q)), Q_e)

    def jacobian(self, q: Array, J_e: Array) -> Array:
        """Jacobian J (N, F, 6, nv) from the engine's."""
        return J_e @ self.transform(q)[:, None]

    def jacobian_rate(self, q: Array, v: Array, J_e: Array, J_e_rate: Array) -> Array:
        """Rate J' from the engine's J and J'."""
        return J_e_rate @ self.transform(q)[:, None] + J_e @ self.transform_rate(q, v)[:, None]


def times(A: Array, x: Array) -> Array:
    """Matrix times vector over the batch: (N, m, n), (N, n) -> (N, m)."""
    return np.asarray((A @ x[..., None])[..., 0])


def _transposed(A: Array) -> Array:
    return A.swapaxes(-1, -2)
