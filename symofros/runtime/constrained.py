"""The routines of the C templates in NumPy, for the interpreter: M a = r + G^T lam, G a = c; projection."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from symofros.runtime.calls.kernel import Array

# Singular values of G in the metric of M, below this share of the largest, belong to conditions that repeat others. A
# redundant condition that has drifted by d [m or rad] shows one of about d, and would ask for accelerations that
# contradict the others: so the share is above what integration drifts by, and below what a posture needs to be told
# from a singular one. The C solver's SYM_RANK is the same.
RANK = 1e-6
# What is left of a diagonal entry beyond rounding; SYM_PIVOT in C. Below POOR (SYM_POOR) G helps out M, which alone
# would lose digits.
PIVOT, POOR = 1e-13, 1e-4
# Of the projection, as in C: |phi| that no step improves on, most steps, halvings of one, its largest entry.
CLOSED, NEWTON, HALVINGS, REACH = 1e-13, 30, 30, 0.5

Solution = Callable[[Array, Array, Array, Array], tuple[Array, Array, int]]


def solve(M: Array, r: Array, G: Array, c: Array) -> tuple[Array, Array, int]:
    """The solution for one state, of one or several right-hand sides.

    Args:
        M: (nv, nv).
        r: (nv,) or (nv, k).
        G: (nc, nv).
        c: (nc,) or (nc, k).

    Returns:
        a and lam, shaped like r and c, and the rank of G; NaN and -1 where no acceleration exists.
    """
    L = _factor(M, POOR)
    if L is None:
        # G^T G adds nothing along motions that the constraints allow.
        rho = np.diag(M).max() / max((G * G).sum(axis=1).max(initial=0.0), 1e-300)
        L, r = _factor(M + rho * G.T @ G, PIVOT), r + rho * G.T @ c
    if L is None:
        return np.full_like(r, np.nan), np.full_like(c, np.nan), -1
    Y, y = np.linalg.solve(L, G.T), np.linalg.solve(L, r)
    if not len(G):
        return np.linalg.solve(L.T, y), c, 0
    _, s, Vt = np.linalg.svd(Y, full_matrices=False)
    rank = int(np.sum(s > RANK * s.max(initial=0.0)))
    kept = Vt[:rank]
    sizes = s[:rank] if c.ndim == 1 else s[:rank, None]
    lam = kept.T @ ((kept @ (c - Y.T @ y)) / sizes**2)
    return np.linalg.solve(L.T, y + Y @ lam), lam, rank


def _factor(M: Array, least: float) -> Array | None:
    try:
        L = np.asarray(np.linalg.cholesky(M), dtype=np.float64)
    except np.linalg.LinAlgError:
        return None
    return L if bool(np.all(np.diag(L) ** 2 > least * np.diag(M))) else None


def null_space(M: Array, r: Array, G: Array, c: Array) -> tuple[Array, Array, int]:
    """The solution for one state by a = a_p + Z w, without M^-1; arguments and result as of `solve`."""
    U, s, Vt = np.linalg.svd(G)
    rank = int(np.sum(s > RANK * s.max(initial=0.0)))
    Q, Z = Vt[:rank].T, Vt[rank:].T
    a = Q @ ((U[:, :rank].T @ c) / s[:rank])
    B = _factor(Z.T @ M @ Z, PIVOT)
    if B is None:
        return np.full_like(r, np.nan), np.full_like(c, np.nan), -1
    a = a + Z @ np.linalg.solve(B.T, np.linalg.solve(B, Z.T @ (r - M @ a)))
    return a, U[:, :rank] @ ((Q.T @ (M @ a - r)) / s[:rank]), rank


def constrained(M: Array, r: Array, G: Array, c: Array, *, solve: Solution = solve) -> list[Array]:
    """The solution for each state: a, lam and the rank of G.

    Args:
        M: (n, nv, nv).
        r: (n, nv).
        G: (n, nc, nv).
        c: (n, nc).
        solve: Solver for one state.
    """
    solutions = [solve(*state) for state in zip(M, r, G, c, strict=True)]
    a, lam, rank = zip(*solutions, strict=True)
    return [np.array(a), np.array(lam), np.array(rank, dtype=np.float64)]


def differentiate(M: Array, G: Array, slopes: list[Array]) -> list[Array]:
    """The derivatives of a and lam, from those of the residual by the same arguments: -K^-1 dR/dx of each.

    Args:
        M: (nv, nv).
        G: (nc, nv).
        slopes: dR/dx (nv + nc, k) each.
    """
    nv = len(M)
    return [np.concatenate(solve(M, -slope[:nv], G, -slope[nv:])[:2]) for slope in slopes]


def project(
    terms: Callable[[Array, Array], list[Array]], move: Callable[[Array, Array], Array], q: Array, v: Array
) -> tuple[Array, Array, float, int]:
    """The nearest state on the constraints, in the metric of M.

    Args:
        terms: (q, v) -> M, G, binds, phi, G v - b.
        move: (q, step) -> q.
        q: (nq,).
        v: (nv,).

    Returns:
        q, v, |phi| and the rank of G.
    """
    M, G, binds, phi, rate = terms(q, v)
    left, closer = float(np.linalg.norm(phi)), True
    for _ in range(NEWTON):
        if not (closer and left > CLOSED):
            break
        step, _, _ = solve(M, np.zeros_like(v), G * binds[:, None], -phi)
        step *= min(1.0, REACH / max(float(np.abs(step).max()), 1e-300))
        closer = False
        for half in range(HALVINGS):
            tried = move(q, step * 0.5**half)
            at_trial = terms(tried, v)
            if np.linalg.norm(at_trial[3]) < left:
                q, (M, G, binds, phi, rate), closer = tried, at_trial, True
                left = float(np.linalg.norm(phi))
                break
    if not len(G):
        return q, v, left, 0
    change, _, rank = solve(M, np.zeros_like(v), G, -rate)
    return q, v + change, left, rank
