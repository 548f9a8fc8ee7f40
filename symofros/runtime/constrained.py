"""Forward dynamics under constraints in NumPy: what the interpreter does in place of the C solver."""

from __future__ import annotations

import numpy as np

from symofros.runtime.kernel import Array

# Singular values below this share of the largest belong to conditions that repeat others.
RANK = 1e-10


def constrained(M: Array, r: Array, G: Array, c: Array) -> list[Array]:
    """M a = r + G^T lam, G a = c for each state: a, lam and the rank of G.

    Args:
        M: (n, nv, nv).
        r: (n, nv).
        G: (n, nc, nv).
        c: (n, nc).
    """
    found = [_one(*state) for state in zip(M, r, G, c, strict=True)]
    a, lam, rank = zip(*found, strict=True)
    return [np.array(a), np.array(lam), np.array(rank, dtype=np.float64)]


def _one(M: Array, r: Array, G: Array, c: Array) -> tuple[Array, Array, int]:
    try:
        L = np.linalg.cholesky(M)
        regular = bool(np.all(np.diag(L) ** 2 > 1e-13 * np.diag(M)))
    except np.linalg.LinAlgError:
        regular = False
    if not regular:
        # G^T G adds nothing along motions that the constraints allow.
        rho = np.diag(M).max() / max((G * G).sum(axis=1).max(), 1e-300)
        M, r = M + rho * G.T @ G, r + rho * G.T @ c
        try:
            L = np.linalg.cholesky(M)
        except np.linalg.LinAlgError:
            return np.full(len(r), np.nan), np.full(len(c), np.nan), -1
    Y, y = np.linalg.solve(L, G.T), np.linalg.solve(L, r)
    U, s, Vt = np.linalg.svd(Y, full_matrices=False)
    rank = int(np.sum(s > RANK * s.max(initial=0.0)))
    kept = Vt[:rank]
    lam = kept.T @ ((kept @ (c - Y.T @ y)) / s[:rank] ** 2)
    return np.linalg.solve(L.T, y + Y @ lam), lam, rank
