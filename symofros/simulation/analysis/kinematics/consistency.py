"""Whether a motion meets the constraints: phi = 0, G v = b, G a = gamma."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.errors import ActuationError, SymofrosError
from symofros.runtime.constrained import STILL, residual_weights
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.kinematics.facing import refuse_opposite


class Refusal(NamedTuple):
    """How a motion that does not meet the constraints is refused: what it is, the rule, the remedy, and the limit.

    The limit is that of phi, and of G v - b and G a - gamma relative to their terms; trajectories that are interpolated
    meet 1e-6.
    """

    error: type[SymofrosError]
    what: str
    rule: str
    remedy: str
    limit: float = 1e-6


EFFORTS = Refusal(
    ActuationError,
    "the motion",
    "efforts are those of a motion with phi = 0, G v = b and G a = gamma",
    "q and v from sf.assemble or model.project; a from forward_dynamics, or with G a = gamma",
)


def consistent_jacobian(
    model: Model,
    state: tuple[ArrayLike, ArrayLike, Array | None, Array],
    par: ArrayLike | None,
    t: ArrayLike,
    refusal: Refusal = EFFORTS,
) -> Array:
    """G (..., nc, nv), at a state, or a motion, that meets the constraints.

    Args:
        model: Model, with or without constraints.
        state: Configurations (..., nq), speeds (..., nv), accelerations (..., nv), of which None is not judged, and
            inputs (..., nu).
        par: Run-time parameters.
        t: Time [s].
        refusal: Error of one that does not.

    Raises:
        SymofrosError: It does not; of the refusal's class.
        AssemblyError: A closure is closed the wrong way round.
    """
    if not model.nc:
        return np.zeros((0, model.nv))
    q, v, a, u = state
    refuse_opposite(model, q, u, par)
    G = model.constraint_jacobian(q, u=u, par=par, t=t)
    speeds, size = np.asarray(model.by_name("v", v), dtype=np.float64), np.abs(G)
    weights = np.array([residual_weights(one, model.record.measures) for one in G.reshape(-1, model.nc, model.nv)])
    phi = model.constraint(q, u=u, par=par, t=t)
    rate = model.constraint_rate(q, v, u=u, par=par, t=t)
    square = np.square(speeds).max(axis=-1, keepdims=True, initial=0.0)
    moved = (size @ np.abs(speeds)[..., None])[..., 0]
    # At rest residuals are rounding; gamma is a sum of products of speeds, which may cancel.
    rest = STILL * size.sum(axis=-1)
    residuals = {
        "phi = {:.3g}": (phi * weights.reshape(phi.shape), np.ones_like(phi)),
        "G v - b = {:.3g}": (rate, rest + moved + np.abs(rate - (G @ speeds[..., None])[..., 0])),
    }
    if a is not None:
        gamma = model.constraint_bias(q, v, u=u, par=par, t=t)
        terms = (size @ np.abs(a)[..., None])[..., 0] + np.abs(gamma) + size.sum(axis=-1) * square + rest
        residuals["G a - gamma = {:.3g}"] = ((G @ a[..., None])[..., 0] - gamma, terms)
    for text, (residual, against) in residuals.items():
        excess = np.abs(residual) - refusal.limit * against
        if excess.max(initial=0.0) > 0.0:
            *index, row = (int(i) for i in np.unravel_index(int(np.argmax(excess)), excess.shape))
            raise refusal.error(
                f"model '{model.record.name}': {refusal.what} violates its constraints{place_in_batch(tuple(index))}",
                f"{text.format(residual[(*index, row)])} at '{model.names.constraints[row]}'",
                refusal.rule,
                refusal.remedy,
            )
    return G


def place_in_batch(index: tuple[int, ...]) -> str:
    """Words for a state of a batch; none where there is but one."""
    return f", state {index if len(index) > 1 else index[0]}" if index else ""
