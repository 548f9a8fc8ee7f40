"""Linearisation: derivatives of accelerations and of the state's changes (docs/theory/linear.md)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from symofros.runtime.constrained import solve
from symofros.runtime.kernel import Array

if TYPE_CHECKING:
    from symofros.runtime.model import Given, Model


@dataclass(frozen=True)
class Accelerations:
    """The derivatives of v' (..., nv, nv or nu), and of the multipliers alike."""

    by_q: Array
    by_v: Array
    by_u: Array
    lam_by_q: Array
    lam_by_v: Array
    lam_by_u: Array
    rate_by_q: Array


def accelerations(model: Model, q: Given, v: Given, u: Given, **more: Any) -> Accelerations:
    """Derivatives of v' at a state, by the implicit function theorem.

    R(q, v, a, u, lam) = 0 gives da = -(dR/d(a, lam))^-1 dR, with the symmetric matrix of M and G.
    """
    a, lam, _ = model.constrained_dynamics(q, v, u, **more)
    nv, nc = model.nv, model.nc
    by_q, by_v, by_u, rate_by_q = model.residual_derivatives(q, v, a, u, lam, **more)
    M = model.mass_matrix(q, u=u, par=more.get("par"))
    batch = by_q.shape[:-2]
    G = model.constraint_jacobian(q, u=u, **more) if nc else np.zeros((*batch, 0, nv))
    right = -np.concatenate([by_q, by_v, by_u], axis=-1)
    count = right.shape[-1]
    size = int(np.prod(batch))
    flat = [np.broadcast_to(x, (*batch, *x.shape[-2:])).reshape(size, *x.shape[-2:]) for x in (M, right, G)]
    pairs = [solve(m, r[:nv], g, r[nv:])[:2] for m, r, g in zip(*flat, strict=True)]
    solved = np.array([np.concatenate(pair) for pair in pairs]).reshape(*batch, nv + nc, count)
    a_by_q, a_by_v, a_by_u = np.split(solved[..., :nv, :], [nv, 2 * nv], axis=-1)
    lam_by_q, lam_by_v, lam_by_u = np.split(solved[..., nv:, :], [nv, 2 * nv], axis=-1)
    return Accelerations(a_by_q, a_by_v, a_by_u, lam_by_q, lam_by_v, lam_by_u, rate_by_q)


def state_matrices(model: Model, q: Given, v: Given, u: Given, **more: Any) -> tuple[Array, Array]:
    """A and B of x' = A x + B u for small changes x = (along q, of v)."""
    found = accelerations(model, q, v, u, **more)
    nv = model.nv
    batch = found.by_q.shape[:-2]
    A, B = np.zeros((*batch, 2 * nv, 2 * nv)), np.zeros((*batch, 2 * nv, found.by_u.shape[-1]))
    A[..., :nv, :nv] = _turning(model, np.broadcast_to(np.asarray(v, dtype=np.float64), (*batch, nv)))
    A[..., :nv, nv:] = np.eye(nv)
    A[..., nv:, :nv], A[..., nv:, nv:], B[..., nv:, :] = found.by_q, found.by_v, found.by_u
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
