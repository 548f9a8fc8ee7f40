"""Every difference of signs, orders, frames and quaternions between SYMOFROS and the engines, in one place.

The engines' folders state them in words (`Difference`, which reports print); `Chart` carries them out. An engine's
speeds are linear in ours, v_e = T(q) v, with T a permutation of blocks times rotations of balls' and free
joints' speeds, so T is orthogonal and

    a_e = T a + T' v,   M = T^T M_e T,   h = T^T (h_e + M_e T' v),   Q_e = T Q,   J = J_e T,   J' = J_e' T + J_e T'.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from ..mechanics.assembly import Mover
from ..mechanics.geometry import (
    Array,
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


# What MuJoCo's free joint is; one of its free joints on a moving link is three slides, then a ball.
FREE_WXYZ = "free wxyz, linear before and angular after"
SLIDES_AND_BALL = "three lengths + quaternion wxyz, body speeds"

# Axes of speeds: of the frame after the motion, as ours, of the frame before, or of the link that the joint is on.
Axes = Literal["after", "before", "link"]


class Meaning(NamedTuple):
    """A chart of a ball or free joint.

    Attributes:
        coordinates: Its coordinates from positions (N, 3), of a ball (N, 0), and quaternions, scalar last (N, 4).
        linear: Axes of linear speeds.
        angular: Axes of angular speeds.
        angular_first: Whether angular speeds come before linear ones.
    """

    coordinates: Callable[[Array, Array], Array]
    linear: Axes = "after"
    angular: Axes = "after"
    angular_first: bool = False


def xyzw_to_wxyz(quaternion: Array) -> Array:
    """Scalar last -> scalar first (..., 4)."""
    return np.roll(quaternion, 1, axis=-1)


def _xyzw(p: Array, quaternion: Array) -> Array:
    return np.concatenate([p, quaternion], axis=1)


def _wxyz(p: Array, quaternion: Array) -> Array:
    return np.concatenate([p, xyzw_to_wxyz(quaternion)], axis=1)


def _wxyz_first(p: Array, quaternion: Array) -> Array:
    return np.concatenate([xyzw_to_wxyz(quaternion), p], axis=1)


def _vector_first(p: Array, quaternion: Array) -> Array:
    """Rotation vectors, of at most half a turn."""
    e = np.where(quaternion[:, 3:] < 0.0, -quaternion, quaternion)
    sine = np.linalg.norm(e[:, :3], axis=1, keepdims=True)
    # Angle over sine of its half, which tends to 2.
    scale = np.divide(2.0 * np.arctan2(sine, e[:, 3:]), sine, out=np.full_like(sine, 2.0), where=sine > 0.0)
    return np.concatenate([scale * e[:, :3], p], axis=1)


def _angles_first(p: Array, quaternion: Array) -> Array:
    """Roll, pitch, yaw of R = Rz Ry Rx."""
    R = quaternion_matrix(quaternion)
    roll, yaw = np.arctan2(R[:, 2, 1], R[:, 2, 2]), np.arctan2(R[:, 1, 0], R[:, 0, 0])
    pitch = np.arctan2(-R[:, 2, 0], np.hypot(R[:, 0, 0], R[:, 1, 0]))
    return np.concatenate([np.stack([roll, pitch, yaw], axis=1), p], axis=1)


# Charts of `engines.truth.charts` for balls and free joints, and series of them.
_MEANINGS: Mapping[str, Meaning] = {
    "quaternion xyzw, body speeds": Meaning(_xyzw),
    "quaternion xyzw, parent speeds": Meaning(_xyzw, angular="before"),
    "quaternion wxyz, body speeds": Meaning(_wxyz),
    "quaternion wxyz, parent speeds": Meaning(_wxyz, angular="before"),
    "rotation vector, body speeds": Meaning(_vector_first),
    "roll pitch yaw, parent speeds": Meaning(_angles_first, angular="before"),
    "free xyzw, body speeds": Meaning(_xyzw),
    FREE_WXYZ: Meaning(_wxyz, "before"),
    SLIDES_AND_BALL: Meaning(_wxyz, "before"),
    "free xyzw, linear and angular before": Meaning(_xyzw, "before", "before"),
    "free xyzw, angular and linear before": Meaning(_xyzw, "before", "before", True),
    "free rotation vector, angular and linear along the parent's axes": Meaning(_vector_first, "link", "link", True),
    "free roll pitch yaw, angular and linear before": Meaning(_angles_first, "before", "before", True),
    "free quaternion first, angular and linear before": Meaning(_wxyz_first, "before", "before", True),
}
# Charts whose coordinates and speeds are ours.
_OURS = frozenset({"", "angle", "length", "screw angle"})
# Ours are the angles.
_COS_SIN = "cos sin"


@dataclass(frozen=True)
class Slot:
    """Where an engine keeps one of our joints.

    Attributes:
        mover: Our joint.
        q: Start in the engine's coordinates.
        v: Start in the engine's speeds.
        chart: The engine's chart of it, by its name in `engines.truth.charts`, or the charts of the joints that it is a
            series of; "" for ours.
        grounded: Whether the engine's joint stands in the world's frame, whatever ours stands in.
    """

    mover: Mover
    q: int
    v: int
    chart: str = ""
    grounded: bool = False

    def __post_init__(self) -> None:
        """Refuse a chart that is neither ours nor one of those that are converted.

        Raises:
            ValueError: It is not; the message names it.
        """
        if self.chart not in _OURS and self.chart not in _MEANINGS and self.chart != _COS_SIN:
            raise ValueError(f"joint '{self.mover.joint.name}': checks have no conversion of the chart '{self.chart}'")

    @property
    def turns(self) -> bool:
        """Whether some of its speeds are along axes that rotate against ours, which turn with the body."""
        meaning = _MEANINGS.get(self.chart)
        return meaning is not None and (meaning.angular != "after" or (self._is_free and meaning.linear != "after"))

    @property
    def _is_free(self) -> bool:
        return self.mover.kind == "free"

    def coordinates(self, q: Array) -> Array:
        """The engine's coordinates from ours of this joint (N, nq_j)."""
        if self.chart == _COS_SIN:
            return np.concatenate([np.cos(q), np.sin(q)], axis=1)
        meaning = _MEANINGS.get(self.chart)
        if meaning is None:
            return q
        p, turned = q[:, :-4], q[:, -4:]
        if self.grounded:
            X = self.mover.X_AP
            turned = quaternion_product(np.broadcast_to(matrix_quaternion(X.R), turned.shape), turned)
            p = X.p + p @ X.R.T if self._is_free else p
        return meaning.coordinates(p, turned)

    def transform(self, q: Array) -> Array:
        """T of this joint's speeds (N, nv_j, nv_j) from our coordinates of it (N, nq_j)."""
        return self._blocks(q, None)

    def transform_rate(self, q: Array, v: Array) -> Array:
        """T' of this joint's speeds (N, nv_j, nv_j): axes turn with R' = R [w]x."""
        return self._blocks(q, v[:, -3:])

    def _blocks(self, q: Array, w: Array | None) -> Array:
        """T, or with our angular speeds (N, 3) its rate."""
        size = self.mover.v.stop - self.mover.v.start
        T = np.zeros((len(q), size, size))
        meaning = _MEANINGS.get(self.chart)
        if meaning is None:
            T[:] = np.eye(size) if w is None else 0.0
            return T
        first = 3 if meaning.angular_first and self._is_free else 0
        parts = [(size - 3 - first, size - 3, meaning.angular)]
        parts += [(first, 0, meaning.linear)] if self._is_free else []
        for row, column, axes in parts:
            if axes == "after":
                block = np.eye(3) if w is None else np.zeros((3, 3))
            else:
                block = self._rotation(axes, q) @ (np.eye(3) if w is None else skew(w))
            T[:, row : row + 3, column : column + 3] = block
        return T

    def _rotation(self, axes: Axes, q: Array) -> Array:
        """Rotation from the axes of the body to those of the engine's speeds."""
        R_PB = quaternion_matrix(q[:, -4:])
        return self.mover.X_AP.R @ R_PB if self.grounded or axes == "link" else R_PB


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

    @property
    def turns(self) -> bool:
        """Whether T depends on q."""
        return any(slot.turns for slot in self.slots)

    def coordinates(self, q: Array) -> Array:
        """Coordinates of the engine from ours."""
        q_e = np.zeros((len(q), self.nq))
        for slot in self.slots:
            part = slot.coordinates(q[:, slot.mover.q])
            q_e[:, slot.q : slot.q + part.shape[1]] = part
        return q_e

    def transform(self, q: Array) -> Array:
        """T(q) (N, nv, nv): v_e = T v."""
        T = np.zeros((len(q), self.nv, self.nv))
        for slot in self.slots:
            columns = slot.mover.v
            T[:, slot.v : slot.v + columns.stop - columns.start, columns] = slot.transform(q[:, slot.mover.q])
        return T

    def transform_rate(self, q: Array, v: Array) -> Array:
        """T'(q, v) (N, nv, nv)."""
        rate = np.zeros((len(q), self.nv, self.nv))
        for slot in self.slots:
            if slot.turns:
                own, columns = slot.mover.q, slot.mover.v
                turning = slot.transform_rate(q[:, own], v[:, columns])
                rate[:, slot.v : slot.v + columns.stop - columns.start, columns] = turning
        return rate

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
