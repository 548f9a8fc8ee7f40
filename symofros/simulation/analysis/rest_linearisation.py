"""Linear models about a rest, by functions that know no speeds, and growth about a motion (docs/theory/linear.md)."""

from __future__ import annotations

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.constrained import null_space
from symofros.runtime.methods.linear import state_matrices
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.rest_search import Balance, Search

# Speeds from which this is derived and compiled sooner than derivatives in motion are: of a chain of 10 links on
# springs in a quarter of the time, of one of 30 in a fortieth.
MANY = 9
# Imbalance of what rests, relative to the largest force, as `equilibrium` accepts it, or to the least stiffness where
# all forces vanish, as of what hangs. d(M a)/dq, which is left out, is as small a share of the forces' derivatives.
_BALANCED = 1e-9
# Growth, of the largest eigenvalue, that is more than rounding of zeros that count three times.
_GROWS = 1e-4
_FUNCTIONS = ("rest_forces", "rest_stiffness", "rest_damping", "mass_matrix")


def functions_of_modes(model: Model, v: Array) -> tuple[str, ...]:
    """Functions that the linear model about a state with speeds v (nv) is likely to need, to be compiled together."""
    if not model.nc and not model.nz and model.nv >= MANY and not np.any(v):
        return _FUNCTIONS
    return "forward_dynamics", "forward_dynamics_derivatives", "mass_matrix"


def matrix_at_rest(
    model: Model, q: Array, u: Array, par: ArrayLike | None, t: float, *, judged: bool = True
) -> Array | None:
    """A of x' = A x at v = 0, x = (along q, of v) (2 nv, 2 nv).

    Args:
        model: Model in double precision.
        q: Configuration (nq).
        u: Inputs (nu).
        par: Run-time parameters.
        t: Time [s].
        judged: Whether forces have to balance; where they need not, d(M a)/dq is left out.

    Returns:
        None where `Model.linearize` is to be asked: forces do not balance, there are constraints or few speeds, a
        function was not generated, or M is singular.
    """
    if model.nc or model.nv < MANY or not all(map(model.has, _FUNCTIONS)):
        return None
    h, Q = model.evaluate("rest_forces", q=q, u=u, par=par, t=t)
    K = model.evaluate("rest_stiffness", q=q, u=u, lam=np.zeros(0), par=par, t=t)[0]
    allowed = _BALANCED * max(np.abs(h).max(), np.abs(Q).max(), np.abs(np.diag(K)).min())
    if judged and not np.abs(h - Q).max() <= allowed:
        return None
    M = model.evaluate("mass_matrix", q=q, u=u, par=par, t=t)[0]
    D = model.evaluate("rest_damping", q=q, u=u, par=par, t=t)[0]
    try:
        rates = -np.linalg.solve(M, np.hstack([K, D]))
    except np.linalg.LinAlgError:
        return None
    A = np.vstack([np.eye(model.nv, 2 * model.nv, model.nv), rates])
    return A if np.all(np.isfinite(A)) else None


def growing(balance: Balance, end: Search) -> tuple[int, float] | None:
    """How an unstable steady motion is left, coordinates that are held staying (7h).

    Returns:
        Speed that takes part most, by its reach, and the rate [1/s]; None of a motion that is not left, and of models
        with conditions on speeds or states of forces, which are not looked at.
    """
    model, free, n = balance.model, balance.free, balance.n
    if model.record.speed_conditions or n < model.nv:
        return None
    slopes = model.residual_derivatives(end.q, end.v, np.zeros(n), balance.u, end.lam, par=balance.par, t=balance.t)
    Z = np.eye(n)[:, free] @ null_space(balance.jacobian(end.q)[:, free], model.record.measures.of_speeds(free))
    turning = Z.T @ state_matrices(model.record.segments, slopes, end.v)[0][:n, :n] @ Z
    by_q, by_v = (Z.T @ slope[:n] @ Z for slope in slopes[:2])
    try:
        rates = -np.linalg.solve(Z.T @ balance.mass(end.q) @ Z, np.hstack([by_q, by_v]))
        s, changes = np.linalg.eig(np.vstack([np.hstack([turning, np.eye(len(by_q))]), rates]))
    except np.linalg.LinAlgError:  # What moves no mass, or forces that are not finite.
        return None
    if not s.real.max(initial=0.0) > _GROWS * np.abs(s).max(initial=0.0):
        return None
    x = np.abs(Z @ changes[: len(by_q), np.argmax(s.real)])[free]
    return int(free[np.argmax(x / balance.reach.speeds[free])]), float(s.real.max())
