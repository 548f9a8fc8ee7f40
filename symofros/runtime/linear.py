"""Linearisation: derivatives of accelerations and of the state's changes (docs/theory/linear.md)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from symofros.runtime.kernel import Array

if TYPE_CHECKING:
    from symofros.runtime.model import Given, Model


def state_matrices(model: Model, q: Given, v: Given, u: Given, **more: Any) -> tuple[Array, Array]:
    """A and B of x' = A x + B u for small changes x = (along q, of v)."""
    by_q, by_v, by_u = model.forward_dynamics_derivatives(q, v, u, **more)
    nv = model.nv
    batch = by_q.shape[:-2]
    A, B = np.zeros((*batch, 2 * nv, 2 * nv)), np.zeros((*batch, 2 * nv, by_u.shape[-1]))
    A[..., :nv, :nv] = _turning(model, np.broadcast_to(np.asarray(v, dtype=np.float64), (*batch, nv)))
    A[..., :nv, nv:] = np.eye(nv)
    A[..., nv:, :nv], A[..., nv:, nv:], B[..., nv:, :] = by_q, by_v, by_u
    return A, B


def _turning(model: Model, v: Array) -> Array:
    """How a change along q turns as its frame does: minus the adjoint of the speeds, for balls and free joints."""
    block = np.zeros((*v.shape[:-1], model.nv, model.nv))
    for segment in model.record.segments:
        if segment.kind == "linear":
            continue
        i = segment.v + (3 if segment.kind == "pose" else 0)
        W = _skew(v[..., i : i + 3])
        block[..., i : i + 3, i : i + 3] = -W
        if segment.kind == "pose":
            k = segment.v
            block[..., k : k + 3, k : k + 3] = -W
            block[..., k : k + 3, i : i + 3] = -_skew(v[..., k : k + 3])
    return block


def _skew(w: Array) -> Array:
    K = np.zeros((*w.shape[:-1], 3, 3))
    K[..., 0, 1], K[..., 0, 2], K[..., 1, 2] = -w[..., 2], w[..., 1], -w[..., 0]
    return K - np.swapaxes(K, -1, -2)
