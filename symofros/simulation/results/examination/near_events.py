"""Events that a run comes near to without meeting them (docs/theory/simulation.md, (18j))."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array, Mask
from symofros.simulation.events import ModeEvent
from symofros.simulation.results.examination.finer_steps import States
from symofros.simulation.results.examination.input_impulses import evaluated
from symofros.simulation.stepping.stepper import Stepper

# Shares of an event's range within which a turn is near to zero, and is there by rounding.
_NEAR, _ROUNDING = 0.1, 1e-9
# What actions set is changed by so much of one and of itself, up and down, to see which events depend on it.
_FAR = 1.3


class Turn(NamedTuple):
    """Where an event turns before it has come to zero.

    Attributes:
        event: Its index.
        t: Instant [s].
        distance: Its value there, without a sign.
    """

    event: int
    t: float
    distance: float


def event_values(stepper: Stepper, states: States, par: Array | None = None) -> Array:
    """Values of the events (n, n_events) at states, by the present parameters or others (npar)."""
    t, q, v, u = states
    return evaluated(stepper, "events", {"q": q, "v": v, "u": u, "t": t[:, np.newaxis]}, len(t), par)


def _judged(stepper: Stepper, states: States, values: Array) -> Mask:
    """Whether values (n, n_events) are those of the state alone, whatever actions have set (n_events)."""
    judged: Mask = np.array([not isinstance(event, ModeEvent) for event in stepper.events])
    set_by_actions = {name for event in stepper.events for name in event.action or ()}
    which = np.array([name in set_by_actions for name in stepper.model.names.par], dtype=bool)
    for far in (_FAR, -_FAR) if which.any() and judged.any() else ():
        par = np.where(which, stepper.par + far * (1.0 + np.abs(stepper.par)), stepper.par)
        judged &= (event_values(stepper, states, par) == values).all(axis=0)
    return judged


def turns_near_zero(stepper: Stepper, states: States) -> list[Turn]:
    """Turns near to zero, each by the parabola through three records."""
    if len(states[0]) < 3 or stepper.system.events_of_reactions:
        return []
    t, values = states[0], event_values(stepper, states)
    judged = np.flatnonzero(_judged(stepper, states, values)).tolist()
    return [turn for i in judged for turn in _turns(i, stepper.events[i].sign, t, values[:, i])]


def _turns(event: int, sign: int, t: Array, g: Array) -> Iterator[Turn]:
    a, b, c = (np.abs(x) for x in (g[:-2], g[1:-1], g[2:]))
    same = np.abs(np.sign(g[:-2]) + np.sign(g[1:-1]) + np.sign(g[2:])) == 3.0
    one_side: Mask = same & (sign * g[1:-1] <= 0.0)
    steady = (np.diff(t)[:-1] > 0.0) & (np.diff(t)[1:] > 0.0)
    with np.errstate(all="ignore"):
        spread = np.ptp(g)
    for k in np.flatnonzero(one_side & steady & (b < a) & (b <= c)):
        before, after = t[k + 1] - t[k], t[k + 2] - t[k + 1]
        slopes = (b[k] - a[k]) / before, (c[k] - b[k]) / after
        bend = (slopes[1] - slopes[0]) / (before + after)
        rate = (slopes[0] * after + slopes[1] * before) / (before + after)
        distance = abs(float(b[k] - 0.25 * rate**2 / bend))
        if _ROUNDING * spread < distance < _NEAR * spread:
            yield Turn(event, float(t[k + 1] - 0.5 * rate / bend), distance)
