"""Postures in which constraints all but repeat each other, met on the way."""

from __future__ import annotations

import numpy as np

from symofros.runtime.calls.kernel import Array
from symofros.runtime.model import Model

# A loop whose conditions are this much weaker than at their best is close to a singular posture. A step that all but
# lands in the posture itself costs decades of accuracy (atlas of stability, singular postures).
NEAR = 0.05
# States that are looked at, spread over the run; more would cost more than short runs themselves.
MOST = 1000


def nearest_to_singular(
    model: Model, t: Array, q: Array, u: Array, par: Array, rank: int
) -> tuple[float, float] | None:
    """Where the conditions were closest to repeating each other.

    Args:
        model: Model with constraints.
        t: Recorded times (n).
        q: States (n, nq).
        u: Inputs (n, nu).
        par: Run-time parameters (npar).
        rank: Rank of the constraints at regular postures.

    Returns:
        When, and the smallest singular value of G there over its largest in the run; None where it stayed above NEAR.
    """
    if rank < 1 or len(t) < 2:
        return None
    chosen = np.unique(np.linspace(0, len(t) - 1, min(len(t), MOST)).astype(int))
    G = model.with_precision("double").constraint_jacobian(q[chosen], u=u[chosen], par=par, t=t[chosen])
    squares = np.linalg.eigvalsh(G @ np.swapaxes(G, -1, -2))
    # Of the conditions that do not repeat others, the weakest.
    weakest = np.sqrt(np.maximum(squares[:, -rank], 0.0))
    at = int(np.argmin(weakest))
    share = float(weakest[at] / max(weakest.max(), 1e-300))
    return (float(t[chosen[at]]), share) if share < NEAR else None
