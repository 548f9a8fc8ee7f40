"""States of forces at rest: their equilibria beside those of coordinates, and kinks of forces and of their rates.

docs/theory/states.md, sections 6 and 7.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from symofros.base.arrays import Array
from symofros.errors import SymofrosError
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.rest_search import Balance, Search, search_rest

# Change of a speed by which slopes of rates are taken to either side [rad/s or m/s]: small beside speeds over which
# friction changes, and large beside the rounding of rates.
_STEP = 1e-7
# Share of the larger of two slopes from which their difference is a kink, and below which a slope is zero.
_KINK = 1e-4
# Share of the largest force that may be rounding of a second difference, and steps whose differences tell: of a kink
# they grow as the step, by a share of LINEAR; of a curve as its square, of a contact to the power 3/2, of rounding not.
_ROUNDING, _STEPS, _LINEAR = 1e-13, (1.0, 10.0, 100.0), 0.3
# Singular value, of the largest, that is zero; share of a direction from which a state is named.
_NULL, _NAMED = 1e-9, 0.1
_SHOWN = 8


def rest_with_states(
    balance: Balance, q: Array, tolerance: float, iterations: int
) -> tuple[Balance, Search, tuple[str, ...]]:
    """Search a rest of coordinates and states; where states yield, the coordinates move in their place (26).

    Args:
        balance: What has to vanish.
        q: Guess (nq).
        tolerance: Bound of the imbalance, relative to the largest force.
        iterations: Most steps of each part of a search.

    Returns:
        The balance that was searched last, where the search ends, remarks on states.
    """
    end = search_rest(balance, q, tolerance, iterations)
    if not len(balance.searched):
        return balance, end, ()
    names, kept = balance.model.names.v, list[int]()
    while balance.size(end.R, end.sizes) <= tolerance and len(yielding := _yielding(balance, end)):
        kept += yielding
        balance = replace(balance, searched=np.setdiff1d(balance.searched, yielding))
        end = search_rest(balance, q, tolerance, iterations)
    remarks = []
    if kept:
        remarks.append(f"{_listed(names, kept)} would yield under the forces of the guess: kept as in the guess")
    balanced = balance.size(end.R, end.sizes) <= tolerance
    resting = _resting(balance, end) if balanced else []
    if resting:
        remarks.append(
            f"{_listed(names, resting)} may rest at other values, too: of many equilibria this is the one of the least"
            " change of the guess"
        )
    return balance, end, tuple(remarks)


def slopes_of_rates(
    model: Model, q: Array, v: Array, u: Array, par: ArrayLike | None, t: float
) -> tuple[Array, Array] | None:
    """Slopes of the rates of states by each speed of the mechanism, upwards and downwards (nz, nv) (24).

    Args:
        model: Model whose speeds end with its states (`Model.carried`).
        q: Configuration (nq).
        v: Speeds and states (nv + nz).
        u: Inputs (nu).
        par: Run-time parameters.
        t: Time [s].

    Returns:
        None where `Options.functions` left out what gives them.
    """
    n = model.nv - len(model.record.state_names)
    steps = np.concatenate([np.zeros((1, model.nv)), _STEP * np.eye(n, model.nv), -_STEP * np.eye(n, model.nv)])
    try:
        rates = model.generalized_force(q, v + steps, u, par=par, t=t)[:, n:]
    except SymofrosError:
        return None
    up, down = (rates[1 : n + 1] - rates[0]) / _STEP, (rates[0] - rates[n + 1 :]) / _STEP
    return up.T, down.T


def kink_notes(model: Model, q: Array, v: Array, u: Array, par: ArrayLike | None, t: float) -> tuple[str, ...]:
    """A note on forces and rates of states with a kink in this state, of which a linear model has the mean slope (27).

    By a kink the second difference grows as the step (28).
    """
    n = model.nv - len(model.record.state_names)
    moves = np.concatenate([_STEP * k * sign * np.eye(n, model.nv) for k in _STEPS for sign in (1.0, -1.0)])
    still = np.zeros_like(moves)
    configurations = model.integrate(np.tile(q, (2 * len(moves) + 1, 1)), np.concatenate([still[:1], moves, still]))
    try:
        Q = model.generalized_force(configurations, v + np.concatenate([still[:1], still, moves]), u, par=par, t=t)
    except SymofrosError:
        return ()
    # By coordinates and by speeds: (2, step, side, n, row); second differences by the step.
    changes = (Q[1:] - Q[0]).reshape(2, len(_STEPS), 2, n, -1)
    up, down = changes[:, 0, 0], changes[:, 0, 1]
    by_step = changes.sum(axis=2) / np.array(_STEPS)[:, None, None]
    kink = np.abs(by_step[:, 0])
    slopes = np.maximum(np.abs(up), np.abs(down)).max(axis=(0, 1), initial=0.0)
    linear = np.abs(by_step[:, 1:] - by_step[:, :1]).max(axis=1) < _LINEAR * kink
    found = linear & (kink > _KINK * slopes + _ROUNDING * np.abs(Q).max(initial=0.0))
    if not found.any():
        return ()
    names = model.names.v
    kind, move, row = np.unravel_index(int(np.argmax(found * kink)), kink.shape)
    by = f"the speed of '{names[move]}'" if kind else f"'{names[move]}'"
    sides = f"{-down[kind, move, row] / _STEP:.3g} and {up[kind, move, row] / _STEP:.3g} by {by}"
    rows = np.flatnonzero(found.any(axis=(0, 1))).tolist()
    forces, rates = [i for i in rows if i < n], [i for i in rows if i >= n]
    parts = [f"forces on {_named(names, forces)}"] if forces else []
    parts += [f"rates of {_listed(names, rates)}"] if rates else []
    return (f"{' and '.join(parts)} have a kink here (slopes {sides}): modes are those of the mean slope",)


def _yielding(balance: Balance, end: Search) -> list[int]:
    """Searched states, among the speeds, that give way in one direction: slopes of opposite sign (25)."""
    slopes = slopes_of_rates(balance.model, end.q, end.v, balance.u, balance.par, balance.t)
    if slopes is None:
        return []
    up, down = slopes[0][:, balance.free], slopes[1][:, balance.free]
    small = _KINK * np.maximum(np.abs(up), np.abs(down)).max(axis=1, keepdims=True, initial=0.0)
    opposite = ((up * down < 0.0) & (np.minimum(np.abs(up), np.abs(down)) > small)).any(axis=1)
    K = balance.stiffness(end.q, end.v, end.lam)
    pushes = np.abs(K[np.ix_(balance.free, balance.searched)]).max(axis=0, initial=0.0) > 0.0
    return [int(i) for i in balance.searched[opposite[balance.searched - balance.n] & pushes]]


def _resting(balance: Balance, end: Search) -> list[int]:
    """States, among the speeds, whose rates vanish whatever coordinates and states are: no condition fixes them."""
    n, nv = balance.n, balance.model.nv
    K = balance.stiffness(end.q, end.v, end.lam)[n:][:, np.concatenate([balance.free, np.arange(n, nv)])]
    if not np.all(np.isfinite(K)):
        return []
    left, values, _ = np.linalg.svd(K)
    null = left[
        :, np.concatenate([values, np.zeros(nv - n - len(values))]) <= _NULL * max(values.max(initial=0.0), 1.0)
    ]
    return [int(n + i) for i in np.flatnonzero((np.abs(null) > _NAMED).any(axis=1))]


def _listed(names: tuple[str, ...], indices: list[int]) -> str:
    return f"states of forces {_named(names, indices)}"


def _named(names: tuple[str, ...], indices: list[int]) -> str:
    return ", ".join(f"'{names[i]}'" for i in sorted(indices)[:_SHOWN]) + (", ..." if len(indices) > _SHOWN else "")
