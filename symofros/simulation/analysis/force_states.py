"""States of forces at rest: their equilibria beside those of coordinates, and kinks of their rates.

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
    """A note on states whose rates have a kink in this state, where a linear model has the mean of both sides (27)."""
    slopes = slopes_of_rates(model, q, v, u, par, t)
    if slopes is None:
        return ()
    up, down = slopes
    kinks = np.abs(up - down) > _KINK * np.maximum(np.abs(up), np.abs(down)).max(axis=1, keepdims=True, initial=1e-300)
    found = np.flatnonzero(kinks.any(axis=1))
    if not len(found):
        return ()
    n, first = up.shape[1], int(found[0])
    speed = int(np.abs(up - down)[first].argmax())
    sides = f"{down[first, speed]:.3g} and {up[first, speed]:.3g} by '{model.names.v[speed]}'"
    return (
        f"rates of {_listed(model.names.v, (n + found).tolist())} have a kink here (slopes {sides}): modes are those of"
        " the mean slope",
    )


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
    shown = ", ".join(f"'{names[i]}'" for i in sorted(indices)[:_SHOWN])
    return f"states of forces {shown}" + (", ..." if len(indices) > _SHOWN else "")
