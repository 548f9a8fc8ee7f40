"""Riccati equations by doubling, and the sampled form of a linear system: what a linear quadratic regulator needs.

E. K.-W. Chu, H.-Y. Fan, W.-W. Lin, A structure-preserving doubling algorithm for continuous-time algebraic Riccati
equations, Linear Algebra and its Applications 396 (2005).
"""

from __future__ import annotations

import math

import numpy as np

from symofros.base.arrays import Array

# Doubling: 2^40 is more than any time constant of a mechanism takes.
_ROUNDS = 60
# Each keeps half the digits at least; where the equation has none left they stop by themselves.
_CORRECTIONS = 6
# Costs beyond are those of what can't be stabilised.
_LARGEST = 1e60


def continuous_gain(A: Array, B: Array, Q: Array, R: Array) -> Array | None:
    """K = R^-1 B^T X (m, n) of A^T X + X A - X B R^-1 B^T X + Q = 0; None where nothing stabilises the system."""
    G = B @ np.linalg.solve(R, B.T)
    # The Cayley transform keeps digits with a shift about the size of the closed loop's eigenvalues, and above all of
    # them: those of the open loop say nothing of integrators.
    fast = np.abs(np.linalg.eigvals(np.block([[A, -G], [-Q, -A.T]]))).max(initial=0.0)
    shift = max(1e-3, 1.3 * float(np.sqrt(np.linalg.norm(A) * fast)))
    try:
        X = _continuous(A, G, Q, shift)
        change = math.inf
        for _ in range(_CORRECTIONS):  # What X misses by solves an equation of the same form, about the closed loop.
            residual = A.T @ X + X @ A - X @ G @ X + Q
            step = _continuous(A - G @ X, G, 0.5 * (residual + residual.T), shift)
            change, before = float(np.linalg.norm(step)), change
            if not change < 0.5 * before:
                break
            X = X + step
    except np.linalg.LinAlgError:
        return None
    K = np.asarray(np.linalg.solve(R, B.T @ X), dtype=np.float64)
    return K if bool(np.all(np.linalg.eigvals(A - B @ K).real < 0.0)) else None


def _continuous(A: Array, G: Array, Q: Array, shift: float) -> Array:
    """X of A^T X + X A - X G X + Q = 0 by the Cayley transform and doubling."""
    n, moved = len(A), A - shift * np.eye(len(A))
    W = moved.T + Q @ np.linalg.solve(moved, G)
    A0 = np.eye(n) + 2.0 * shift * np.linalg.inv(W).T
    G0 = 2.0 * shift * np.linalg.solve(moved, G) @ np.linalg.inv(W)
    H0 = 2.0 * shift * np.linalg.solve(W, Q) @ np.linalg.inv(moved)
    return _doubled(A0, G0, H0)


def sampled_gain(A: Array, B: Array, Q: Array, R: Array, N: Array | None = None) -> Array | None:
    """K (m, n) that minimises sum x^T Q x + u^T R u + 2 x^T N u of x[k + 1] = A x[k] + B u[k].

    Returns:
        None where nothing stabilises the system.
    """
    own = np.zeros(B.T.shape) if N is None else np.linalg.solve(R, N.T)  # With u = w - own x no product x^T w is left.
    A, Q = A - B @ own, Q if N is None else Q - N @ own
    try:
        X = _doubled(A, B @ np.linalg.solve(R, B.T), Q)
    except np.linalg.LinAlgError:
        return None
    K = np.asarray(np.linalg.solve(R + B.T @ X @ B, B.T @ X @ A), dtype=np.float64)
    return K + own if bool(np.all(np.abs(np.linalg.eigvals(A - B @ K)) < 1.0)) else None


def filter_gain(A: Array, C: Array, Q: Array, R: Array) -> Array | None:
    """L = P C^T (C P C^T + R)^-1 (n, p) with the covariance P of predictions of x[k + 1] = A x[k] + w[k], y = C x + e.

    Args:
        A: (n, n).
        C: (p, n).
        Q: Covariance of w (n, n).
        R: Covariance of e (p, p).

    Returns:
        None where no estimate settles.
    """
    try:
        P = _doubled(A.T, C.T @ np.linalg.solve(R, C), Q)
    except np.linalg.LinAlgError:
        return None
    L = np.asarray(np.linalg.solve(C @ P @ C.T + R, C @ P).T, dtype=np.float64)
    return L if bool(np.all(np.abs(np.linalg.eigvals(A - A @ L @ C)) < 1.0)) else None


def _doubled(A: Array, G: Array, H: Array) -> Array:
    """The limit of H."""
    one = np.eye(len(A))
    for _ in range(_ROUNDS):
        if not np.abs(H).max(initial=0.0) < _LARGEST:
            raise np.linalg.LinAlgError("the doubling diverges")
        inner = np.linalg.solve(one + G @ H, np.hstack([A, G]))
        forward, across = inner[:, : len(A)], inner[:, len(A) :]
        step = A.T @ H @ forward
        A, G, H = A @ forward, G + A @ across @ A.T, H + 0.5 * (step + step.T)
        if np.linalg.norm(step) <= 1e-15 * np.linalg.norm(H):
            break
    return H


def held_inputs(A: Array, B: Array, period: float) -> tuple[Array, Array]:
    """x[k + 1] = A_d x[k] + B_d u[k] of x' = A x + B u where u is held over each period [s]."""
    n = len(A)
    moved, _ = _held(A, B, np.zeros((n + B.shape[1],) * 2), period)
    return moved[:n, :n], moved[:n, n:]


def held_gain(A: Array, B: Array, Q: Array, R: Array, period: float) -> Array | None:
    """K (m, n) of the least int x^T Q x + u^T R u dt of x' = A x + B u where u = -K x[k] is held over each period [s].

    Returns:
        None where nothing stabilises the system.
    """
    n, m = B.shape
    weights = np.block([[Q, np.zeros((n, m))], [np.zeros((m, n)), R]])
    moved, cost = _held(A, B, weights, period)
    return sampled_gain(moved[:n, :n], moved[:n, n:], cost[:n, :n], cost[n:, n:], cost[:n, n:])


def _held(A: Array, B: Array, weights: Array, period: float) -> tuple[Array, Array]:
    """E = exp(F T) of (x; u)' = F (x; u) = (A x + B u; 0), and (1 / T) int_0^T exp(F t)^T weights exp(F t) dt."""
    n, m = B.shape
    whole = np.zeros((n + m, n + m))
    whole[:n, :n], whole[:n, n:] = A * period, B * period
    halvings = max(0, math.ceil(math.log2(max(1e-300, float(np.linalg.norm(whole, 1))))) + 1)
    small = whole / 2.0**halvings
    # The norm is at most a half: 18 terms of the series are exact to rounding.
    moved, term = np.eye(n + m), np.eye(n + m)
    mean, part = weights, weights
    for k in range(1, 19):
        term = term @ small / k
        part = (small.T @ part + part @ small) / (k + 1)
        moved, mean = moved + term, mean + part
    for _ in range(halvings):
        mean = 0.5 * (mean + moved.T @ mean @ moved)
        moved = moved @ moved
    return moved, mean
