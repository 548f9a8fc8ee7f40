"""Postures met on the way that say something of a run: singular ones, and those beyond the limits of joints."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.model import Model
from symofros.runtime.record import JointLimit

# A loop whose conditions are this much weaker than at their best is close to a singular posture. A step that all but
# lands in the posture itself costs decades of accuracy (atlas of stability, singular postures).
NEAR = 0.05
# States that are looked at, spread over the run; more would cost more than short runs themselves. Singular values of nc
# conditions take nc^3 operations: of many, that number is bounded, but for the fewest states.
MOST, MAX_OPERATIONS, FEWEST = 1000, 1e7, 16
# From so many conditions on it is tried first to prove from few singular values that all stay above NEAR, at states
# whose Jacobians have so many entries together.
MANY, PROOFS, MAX_ENTRIES = 16, 4, 4e6
# States farther apart than this [rad, m] have others looked at between them, so many at most.
FAR, MAX_BETWEEN = 0.05, 16
# Parts of the motion that are asked for where the straight way between records meets weak conditions.
ASKED = 4
# Singular values of a smaller share of the largest are of conditions that repeat others.
_RANK = 1e-9
# Change of a row of G, relative to its size, while the configuration changes by MAX_CHANGE [rad, m], halved BISECTIONS
# times: a smooth row changes by far less.
TURN, MAX_CHANGE, BISECTIONS = 0.3, 0.02, 16
# What lies beyond a limit by this share of it, or by so much [rad, m], is the error of a motion that ends there.
AT_LIMIT = 1e-6


class Jump(NamedTuple):
    """A row of G that is not continuous.

    Attributes:
        name: Name of the condition.
        turn: Change of the row at once, relative to its size; infinite where the row is not finite.
    """

    name: str
    turn: float


def jump_ahead(model: Model, t: float, q: Array, v: Array, u: Array, par: Array) -> Jump | None:
    """The condition whose row of G changes at once where the motion leads to from a state, or led from.

    Args:
        model: Model with constraints.
        t: Time [s].
        q: Configuration (nq).
        v: Speeds (nv).
        u: Inputs (nu).
        par: Run-time parameters (npar).
    """
    model = model.with_precision("double")
    fastest = float(np.abs(v).max(initial=0.0))
    if fastest == 0.0:
        return None

    def rows(at: Array) -> Array:
        return model.constraint_jacobian(model.integrate(q, at[:, None] * v), u=u, par=par, t=t)

    def turns(G: Array) -> Array:
        change = np.linalg.norm(np.diff(G, axis=0), axis=-1) / size
        return np.where(np.isnan(change), np.inf, change)

    within = MAX_CHANGE / fastest * np.array([1.0, 0.1, 0.01, 1e-3])
    times = np.concatenate([-within, [0.0], within[::-1]])
    G = rows(times)
    size = np.maximum(np.nan_to_num(np.linalg.norm(G, axis=-1)).max(axis=0), 1e-300)
    at = int(np.argmax(turns(G).max(axis=1)))
    ends = times[at : at + 2]
    for _ in range(BISECTIONS):  # A row that only turns fast turns by less within less time.
        halves = np.array([ends[0], ends.mean(), ends[1]])
        larger = int(np.argmax(turns(rows(halves)).max(axis=1)))
        ends = halves[larger : larger + 2]
    turn = turns(rows(ends))[0]
    worst = int(np.argmax(turn))
    return Jump(model.names.constraints[worst], float(turn[worst])) if turn[worst] > TURN else None


class Violation(NamedTuple):
    """A condition on speeds that a run did not keep.

    Attributes:
        name: Name of the condition.
        share: Residual G v - b over the largest coefficient times the largest speed in the run, beyond twice that
            of the first state, which Baumgarte's gains may have been asked to mend.
        t: Instant [s].
    """

    name: str
    share: float
    t: float


def worst_violation(model: Model, t: Array, states: tuple[Array, Array, Array], par: Array) -> Violation | None:
    """The condition on speeds that was kept worst, at the instant when it was first violated by half as much.

    Args:
        model: Model with constraints.
        t: Recorded times (n).
        states: Recorded q (n, nq), v (n, nv), u (n, nu).
        par: Run-time parameters (npar).
    """
    chosen = np.unique(np.linspace(0, len(t) - 1, min(len(t), MOST)).astype(int))
    q, v, u = (x[chosen] for x in states)
    model = model.with_precision("double")
    rate = np.abs(model.constraint_rate(q, v, u=u, par=par, t=t[chosen]))
    G = model.constraint_jacobian(q, u=u, par=par, t=t[chosen])
    # Not of the terms themselves: where nothing moves that a condition binds, these are rounding.
    sizes = np.nan_to_num(np.abs(G)).max(axis=(0, 2), initial=0.0) * np.nan_to_num(np.abs(v)).max(initial=0.0)
    # Where a row is all but zero in every posture met, its terms are rounding of the other rows' terms.
    rounding = 1e-12 * float(sizes.max(initial=0.0))
    shares = np.where(np.isnan(rate), 0.0, rate) / np.maximum(sizes, max(rounding, 1e-300))
    if not shares.size or not sizes.any():
        return None
    shares = np.maximum(shares - 2.0 * shares[0], 0.0)
    worst = int(np.argmax(shares.max(axis=0)))
    share = float(shares[:, worst].max())
    return Violation(
        model.names.constraints[worst], share, float(t[chosen[int(np.argmax(shares[:, worst] > 0.5 * share))]])
    )


def regular_rank(jacobians: Array) -> int:
    """The highest rank of Jacobians of constraints (n, nc, nv): that at regular postures."""
    return int(np.linalg.matrix_rank(jacobians, rtol=_RANK).max(initial=0))


def nearest_to_singular(
    model: Model,
    states: Sequence[Array],
    par: Array,
    rank: int,
    motion: Callable[[int, int], Sequence[Array] | None],
) -> tuple[float, float] | None:
    """Where the conditions were closest to repeating each other.

    Between records that are far apart, weak conditions are looked for on the straight way from one to the next, which
    the motion does not take: what is found there is asked for along the motion itself, and stands where short steps
    can't follow that.

    Args:
        model: Model with constraints.
        states: Recorded t (n), q (n, nq), v (n, nv), u (n, nu).
        par: Run-time parameters (npar).
        rank: Rank of the constraints at regular postures.
        motion: States of the motion between two records, by their numbers, in short steps; None where it is not known,
            no states where short steps fail at the constraints.

    Returns:
        When, and the smallest singular value of G there over its largest in the run; None where it stayed above NEAR.
    """
    if rank < 1 or len(states[0]) < 2:
        return None
    model = model.with_precision("double")
    most = int(min(MOST, max(FEWEST, MAX_OPERATIONS / model.nc**3)))

    def jacobians(at: Sequence[Array]) -> Array:
        times, q, u = at
        (G,) = model.evaluate("constraint_jacobian", q=q, u=u, par=par, t=times)
        return np.asarray(G)

    def weakest(at: Sequence[Array]) -> Array:
        """The singular value of the weakest condition of those that do not repeat others, at states t, q, u."""
        return _weakest(jacobians(at), rank)

    t, q, _, u = states
    all_at_once = int(MAX_ENTRIES / (model.nc * model.nv))
    if (
        model.nc >= MANY
        and len(t) <= all_at_once
        and _stay_regular(jacobians(_between(model, all_at_once, t, q, u)), rank)
    ):
        return None
    rows = np.unique(np.linspace(0, len(t) - 1, min(len(t), most)).astype(int))
    sizes = weakest([x[rows] for x in (t, q, u)])
    lowest, largest = int(np.argmin(sizes)), max(float(sizes.max()), 1e-300)
    found = [(float(sizes[lowest]), float(t[rows[lowest]]))]
    if len(t) > most:  # Between the records that were chosen others may be weaker.
        first, end = (int(rows[max(0, min(len(rows) - 1, i))]) for i in (lowest - 1, lowest + 1))
        near = np.unique(np.linspace(first, end, min(end - first + 1, most)).astype(int))
        found.append(_least(weakest([x[near] for x in (t, q, u)]), t[near]))
    between = _between(model, most, *(x[rows] for x in (t, q, u)))
    if len(between[0]) > len(rows):
        straight, part = weakest(between), np.searchsorted(t[rows], between[0], side="right") - 1
        doubted = [int(part[k]) for k in np.argsort(straight) if straight[k] < NEAR * largest]
        for k in list(dict.fromkeys(k for k in doubted if k + 1 < len(rows)))[:ASKED]:
            along = motion(int(rows[k]), int(rows[k + 1]))
            if along is None:
                continue
            if len(along[0]):
                found.append(_least(weakest([along[0], along[1], along[3]]), along[0]))
            else:
                found.append(_least(straight[part == k], between[0][part == k]))
    size, when = min(found)
    return (when, size / largest) if size < NEAR * largest else None


def _weakest(G: Array, rank: int) -> Array:
    """The smallest but for those of conditions that repeat others of G's singular values (...); G: (..., nc, nv)."""
    squares = np.linalg.eigvalsh(G @ np.swapaxes(G, -1, -2))
    return np.asarray(np.sqrt(np.maximum(squares[..., -rank], 0.0)))


def _stay_regular(G: Array, rank: int) -> bool:
    """Whether the weakest conditions at some states (n, nc, nv) are shown to stay above NEAR of their largest.

    A singular value changes by no more than the norm of the change of G (Weyl), so that few of them bound all.
    """
    if not np.isfinite(G).all():
        return False
    least, most, at = np.zeros(len(G)), np.full(len(G), np.inf), 0
    for _ in range(PROOFS):
        size = float(_weakest(G[at], rank))
        change = np.linalg.norm((G - G[at]).reshape(len(G), -1), axis=1)
        least, most = np.maximum(least, size - change), np.minimum(most, size + change)
        at = int(np.argmin(least))
        if least[at] >= NEAR * most.max():
            return True
    return False


def _least(sizes: Array, t: Array) -> tuple[float, float]:
    """The least of these, and its time."""
    at = int(np.argmin(sizes))
    return float(sizes[at]), float(t[at])


def _between(model: Model, most: int, t: Array, q: Array, u: Array) -> list[Array]:
    """States with others between them where they are far apart, at most about so many: long steps leap over some."""
    changes = model.difference(q[:-1], q[1:])
    if not np.isfinite(changes).all():
        return [t, q, u]
    far = float(np.abs(changes).max(initial=0.0)) / FAR
    parts = int(min(max(1.0, math.ceil(far)), MAX_BETWEEN, max(1, most // len(t))))
    shares, count = (np.arange(parts) / parts)[:, np.newaxis], (len(t) - 1) * parts

    def inner(x: Array) -> Array:
        """Values between consecutive rows (n, m)."""
        return np.asarray(x[:-1, np.newaxis] + shares * np.diff(x, axis=0)[:, np.newaxis]).reshape(count, x.shape[1])

    turned = (shares * changes[:, np.newaxis]).reshape(-1, model.nv)
    configurations = model.integrate(np.repeat(q[:-1], parts, axis=0), turned)
    times = np.append(inner(t[:, np.newaxis])[:, 0], t[-1])
    return [times, np.vstack([configurations, q[-1:]]), np.vstack([inner(u), u[-1:]])]


# What is limited -> what a note says of it, and of what would keep the limit.
_LIMITED = {
    "q": ("'{}' leaves its limits", "limits are data here, no stops"),
    "v": ("the speed of '{}' exceeds its limits", "limits are data here, nothing brakes"),
    "u": ("the effort of '{}' exceeds its limits", "limits are data here, inputs act as they are given"),
}


def limit_notes(
    names: Mapping[str, Sequence[str]], limits: Sequence[JointLimit], t: Array, values: Mapping[str, Array]
) -> tuple[str, ...]:
    """Notes where a run left the limits of its joints, which no force keeps: one of each kind at most.

    Args:
        names: Names of the entries of each vector.
        limits: Limits, as `ModelRecord.joint_limits` has them; those of vectors without values are not looked at.
        t: Recorded times (n).
        values: Vectors at these times, by what is limited: q (n, nq), v (n, nv), u (n, nu).
    """
    kinds = ((of, [limit for limit in limits if limit.of == of]) for of in _LIMITED if of in values)
    notes = (_limit_note(of, names[of], of_kind, t, values[of]) for of, of_kind in kinds if of_kind and len(t))
    return tuple(filter(None, notes))


def _limit_note(of: str, names: Sequence[str], limits: Sequence[JointLimit], t: Array, values: Array) -> str:
    """The note on one kind of limits; "" where they are kept."""
    index, lower, upper = (np.array(column) for column in zip(*(limit[1:] for limit in limits), strict=True))
    reached = values[:, index]
    below, above = lower - AT_LIMIT * (1.0 + np.abs(lower)), upper + AT_LIMIT * (1.0 + np.abs(upper))
    excess = np.fmax(below - reached, reached - above)
    beyond = excess > 0.0
    left = np.flatnonzero(beyond.any(axis=0))
    if not len(left):
        return ""
    first = int(left[np.argmin(beyond[:, left].argmax(axis=0))])
    others = f", as do {len(left) - 1} more" if len(left) > 2 else ", as does one more" * (len(left) == 2)
    when, most = t[beyond[:, first].argmax()], np.nanmax(excess[:, first])
    what, rule = _LIMITED[of]
    return (
        f"{what.format(names[index[first]])}, {lower[first]:.6g} to {upper[first]:.6g}, at"
        f" t = {when:.6g} s, by up to {most:.3g}{others}: {rule}"
    )
