"""Narrow parts of forces of the state that a step passes over: sought by their formulas, proved by short steps (18e).

docs/theory/simulation.md, section 8.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.model import Motion
from symofros.simulation.results.examination.finer_steps import States
from symofros.simulation.results.examination.paths import Cubics
from symofros.simulation.results.examination.run import MOST_STEPS, ExaminedRun
from symofros.simulation.stepping.methods import METHODS
from symofros.simulation.stepping.status import Status

# Instants that are nearer to each other than one of these shares of a step are of one part, which is looked at beyond
# them by that share of its length, at so many states. Parts that are looked at, the first of a run; that are proved.
_NEAR, _BEYOND, _STATES = (1.0 / 16.0, 1.0), 0.5, 64
_LOOKED_AT, _PROVED = 64, 4


class _NoPathError(Exception):
    """A function of the user's fails along the motion, or accelerations are not finite."""


class NarrowPart(NamedTuple):
    """A part of a step: number of the step, its begin and end as shares of the step."""

    step: int
    begin: float
    end: float


def passed_over(run: ExaminedRun, ends: States, least: float) -> tuple[int, float, float]:
    """Number of a step, length of the steps that show what it passes over [s], and the change by these; 0: none does.

    Args:
        run: The run.
        ends: Ends of steps.
        least: Change of speeds, as a share of the fastest, that counts.
    """
    stepper, (t, _, _, u) = run.stepper, ends
    steps = np.arange(len(t) - 1)

    @cache
    def path() -> Cubics:
        found = Cubics.of(stepper, ends, steps)
        if found is None or not np.all(np.isfinite(found.ends[3])):
            raise _NoPathError
        return found

    def states(times: Array) -> dict[str, Array]:
        i = np.clip(np.searchsorted(t, times, side="right") - 1, 0, len(steps) - 1)
        _, q, v, _ = path().at(i, (times - t[i]) / (t[i + 1] - t[i]))
        return {"q": q, "v": v, "u": u[i]}

    try:
        with stepper.preserved(), np.errstate(all="ignore"):  # What has exploded overflows.
            formulas = list(stepper.inputs.formulas.values())
            motion = Motion(states, t)
            found = run.model.formula_instants(formulas, stepper.par, float(t[0]), float(t[-1]), motion)
            if not len(found):
                return 0, 0.0, 0.0
            parts = _parts(t, found)
            missed = [_missed(run, path(), part) for part in parts]
    except _NoPathError:
        return 0, 0.0, 0.0
    for k in sorted(range(len(parts)), key=lambda k: -missed[k])[:_PROVED]:
        if missed[k] > 0.5 * least * run.fastest:
            part = parts[k]
            length = float((part.end - part.begin) * (t[part.step + 1] - t[part.step]) / _STATES)
            change = _change(run, path(), part, length)
            if change > least:
                return part.step, length, change
    return 0, 0.0, 0.0


def _parts(t: Array, instants: Array) -> list[NarrowPart]:
    """Parts of steps, which end at times t (n), in which instants (m) lie close together."""
    parts = dict[NarrowPart, None]()
    step = np.clip(np.searchsorted(t, instants, side="right") - 1, 0, len(t) - 2)
    x = (instants - t[step]) / np.diff(t)[step]
    for near in _NEAR if len(x) > 1 else ():
        apart = (np.diff(step) > 0) | (np.diff(x) > near)
        for group in np.split(np.arange(len(x)), np.flatnonzero(apart) + 1):
            begin, end = x[group[0]], x[group[-1]]
            if len(group) == 1:  # It may go on in the step beside it.
                begin, end = (0.0, end) if end < 0.5 else (begin, 1.0)
            wider = _BEYOND * (end - begin)
            parts[NarrowPart(int(step[group[0]]), max(0.0, begin - wider), min(1.0, end + wider))] = None
    return list(parts)[:_LOOKED_AT]


def _missed(run: ExaminedRun, path: Cubics, part: NarrowPart) -> float:
    """Largest change of speed that the path leaves out from the begin of a part on, in the norm of the energy."""
    x = part.begin + (part.end - part.begin) * (np.arange(_STATES) + 0.5) / _STATES
    t, q, v, path_a = path.at(np.full(_STATES, part.step), x)
    found = run.stepper.accelerations(t, q, v)
    if found is None:
        return 0.0
    changes = np.cumsum(found[0] - path_a, axis=0) * (t[-1] - t[0]) / (_STATES - 1)
    return float(np.nan_to_num(run.norms(q, found[1], changes)).max())


def _change(run: ExaminedRun, path: Cubics, part: NarrowPart, length: float) -> float:
    """Change of speed over a part by steps of that length [s], beside that of the path, as a share of the fastest."""
    t, q, v, _ = path.at(np.full(2, part.step), np.array([part.begin, part.end]))
    start, t_end = (t[0], q[0], v[0]), float(t[1])
    if run.settings.adaptive:
        status, finer = run.in_short_steps(start, t_end, length)
    else:  # Whatever the order of the method.
        status, finer = run.repeated(start, t_end, length, method=METHODS["rk4"], max_steps=MOST_STEPS)
    if status != Status.FINISHED:
        return 0.0
    change = float(run.norms(q[1:], finer[3][-1:], finer[2][-1:] - v[1:])[0])
    return change / max(run.fastest, float(run.norms(q[1:], finer[3][-1:], finer[2][-1:])[0]), 1e-300)
