"""Linearisation: the state's small changes and what they do to outputs (docs/theory/linear.md)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from symofros.base.arguments import check_argument
from symofros.base.rotations import skew
from symofros.errors import UnknownNameError, did_you_mean
from symofros.runtime.calls.kernel import Array
from symofros.runtime.record import Segment

# An output: the name of a quantity, or (frame_pose | frame_velocity | frame_acceleration, frame).
Output = str | tuple[str, str]
_PLAIN = ("q", "v", "a", "lam")
_FRAME_FUNCTIONS = ("frame_pose", "frame_velocity", "frame_acceleration")


class FrameDerivatives(NamedTuple):
    """What small changes do to a frame: 6 rows in world axes, linear part first; columns run over speeds or inputs."""

    pose_by_q: Array
    pose_by_u: Array
    velocity_by_q: Array
    velocity_by_v: Array
    velocity_by_u: Array
    acceleration_by_q: Array
    acceleration_by_v: Array
    acceleration_by_u: Array


class StateMatrices(NamedTuple):
    """x' = A x + B u, y = C x + D u for small changes."""

    A: Array
    B: Array
    C: Array
    D: Array


def state_matrices(segments: Sequence[Segment], slopes: Sequence[Array], v: Array) -> tuple[Array, Array]:
    """A (..., 2 nv, 2 nv) and B (..., 2 nv, nu) of small changes (along q, of v) (linear.md, eqs. 3, 4).

    Args:
        segments: Segments of the configuration.
        slopes: The derivatives of (v'; lam) by q, v and u.
        v: Speeds (..., nv).
    """
    by_q, by_v, by_u = slopes
    nv, nu = by_v.shape[-1], by_u.shape[-1]
    A, B = np.zeros((*by_q.shape[:-2], 2 * nv, 2 * nv)), np.zeros((*by_q.shape[:-2], 2 * nv, nu))
    A[..., nv:, :nv], A[..., nv:, nv:], B[..., nv:, :] = by_q[..., :nv, :], by_v[..., :nv, :], by_u[..., :nv, :]
    A[..., :nv, nv:] = np.eye(nv)
    if any(segment.kind != "linear" for segment in segments):
        A[..., :nv, :nv] = _turning(segments, np.broadcast_to(v, (*by_q.shape[:-2], nv)))
    return A, B


def linearize(
    segments: Sequence[Segment],
    slopes: Sequence[Array],
    v: Array,
    outputs: Sequence[Output],
    frame_derivatives: Callable[[str], FrameDerivatives],
) -> StateMatrices:
    """The matrices of small changes x = (along q, of v); C and D have the rows of the outputs, in order.

    Args:
        segments: Segments of the configuration.
        slopes: The derivatives of (v'; lam) by q, v and u.
        v: Speeds (..., nv).
        outputs: Outputs, as of `Model.linearize`.
        frame_derivatives: The derivatives of a frame's motion by its name, at the state and its accelerations.
    """
    check_argument("linearize: outputs", outputs, Sequence[Output])
    A, B = state_matrices(segments, slopes, v)
    nv, nu = slopes[1].shape[-1], slopes[2].shape[-1]
    batch = slopes[0].shape[:-2]
    both = np.concatenate(slopes, axis=-1)
    x_rows = np.broadcast_to(np.eye(2 * nv, 2 * nv + nu), (*batch, 2 * nv, 2 * nv + nu))
    known = {"q": x_rows[..., :nv, :], "v": x_rows[..., nv:, :], "a": both[..., :nv, :], "lam": both[..., nv:, :]}
    rows = [np.zeros((*batch, 0, 2 * nv + nu))]
    for output in outputs:
        if isinstance(output, tuple) and len(output) == 2 and output[0] in _FRAME_FUNCTIONS:
            rows.append(_frame_rows(output[0], frame_derivatives(output[1]), known["a"]))
        elif isinstance(output, str) and output in _PLAIN:
            rows.append(known[str(output)])
        else:
            raise _unknown(output)
    matrix = np.concatenate([np.broadcast_to(row, (*batch, *row.shape[-2:])) for row in rows], axis=-2)
    return StateMatrices(A, B, matrix[..., : 2 * nv], matrix[..., 2 * nv :])


def _unknown(output: Output) -> UnknownNameError:
    known = (*_PLAIN, *_FRAME_FUNCTIONS)
    return UnknownNameError(
        "linearize: no such output",
        repr(output)[:80],
        "an output is q, v, a, lam, or (frame_pose, frame_velocity or frame_acceleration, frame)",
        did_you_mean(output if isinstance(output, str) else output[0], known) or "name one of these",
    )


def _frame_rows(name: str, by: FrameDerivatives, a_rows: Array) -> Array:
    """A frame's pose, velocity or acceleration (..., 6, 2 nv + nu), by the chain rule through v'."""
    none = np.zeros_like(by.pose_by_q)
    if name == "frame_pose":
        return np.concatenate([by.pose_by_q, none, by.pose_by_u], axis=-1)
    if name == "frame_velocity":
        return np.concatenate([by.velocity_by_q, by.velocity_by_v, by.velocity_by_u], axis=-1)
    own = np.concatenate([by.acceleration_by_q, by.acceleration_by_v, by.acceleration_by_u], axis=-1)
    through: Array = own + by.velocity_by_v @ a_rows
    return through


def _turning(segments: Sequence[Segment], v: Array) -> Array:
    """How a change along q turns as its frame does: minus the adjoint of the speeds, for balls and free joints."""
    block = np.zeros((*v.shape[:-1], v.shape[-1], v.shape[-1]))
    for segment in segments:
        if segment.kind == "linear":
            continue
        i = segment.v + segment.translations
        W = skew(v[..., i : i + 3])
        block[..., i : i + 3, i : i + 3] = -W
        if segment.kind == "pose":
            k = segment.v
            block[..., k : k + 3, k : k + 3] = -W
            block[..., k : k + 3, i : i + 3] = -skew(v[..., k : k + 3])
    return block
