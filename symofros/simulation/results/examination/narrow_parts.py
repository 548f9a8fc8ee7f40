"""Narrow parts of forces of the state that a step passes over: sought by their formulas, proved by short steps (18e).

docs/theory/simulation.md, section 8.
"""

from __future__ import annotations

import math
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
# What a stretch leaves out from which it is proved, and how far what short steps show may change by half of them, as
# shares of what counts; the most halvings.
_DOUBTED, _SETTLED, _HALVINGS = 0.1, 0.5, 3


class _NoPathError(Exception):
    """A function of the user's fails along the motion, or accelerations are not finite."""


class NarrowPart(NamedTuple):
    """A part of a step: number of the step, its begin and end as shares of the step."""

    step: int
    begin: float
    end: float


class Stretch(NamedTuple):
    """Parts of steps that follow upon each other, looked at as one.

    Attributes:
        first: Number of the step in which it begins.
        begin: Its begin, as a share of that step.
        last: Number of the step in which it ends.
        end: Its end, as a share of that step.
        length: Length of the steps that prove [s].
        missed: Change of speed that the path leaves out in its parts.
    """

    first: int
    begin: float
    last: int
    end: float
    length: float
    missed: float


def passed_over(run: ExaminedRun, ends: States, least: float, size: float) -> tuple[int, float, float]:
    """Number of a step, length of the steps that show what it passes over [s], and the change by these; 0: none does.

    Args:
        run: The run.
        ends: Ends of steps.
        least: Change of speeds, as a share of `size`, that counts.
        size: Speed of the motion, in the norm of the kinetic energy.
    """
    stepper, (t, _, _, u) = run.stepper, ends
    steps, paths = len(t) - 1, list[Cubics]()

    def path() -> Cubics:
        if not paths:
            found = Cubics.of(stepper, ends, np.ones(steps, dtype=bool))
            if found is None or not np.all(np.isfinite(found.ends[3])):
                raise _NoPathError
            paths.append(found)
        return paths[0]

    def states(times: Array) -> dict[str, Array]:
        i = np.clip(np.searchsorted(t, times, side="right") - 1, 0, steps - 1)
        _, q, v, _ = path().at(i, (times - t[i]) / (t[i + 1] - t[i]))
        return {"q": q, "v": v, "u": u[i]}

    try:
        with np.errstate(all="ignore"):  # What has exploded overflows.
            motion = Motion(states, t)
            found = run.model.formula_instants(stepper.laws, stepper.par, float(t[0]), float(t[-1]), motion)
            if not len(found):
                return 0, 0.0, 0.0
            parts = _parts(t, found)
            missed = [_missed(run, path(), part) for part in parts]
    except _NoPathError:
        return 0, 0.0, 0.0
    stretches = _stretches(t, parts, missed, whole=not run.settings.adaptive)
    for stretch in sorted(stretches, key=lambda one: -one.missed)[:_PROVED]:
        if stretch.missed > _DOUBTED * least * size:
            length, change = _proved(run, ends, stretch, least, size)
            if change > least:
                return stretch.first, length, change
    return 0, 0.0, 0.0


def _stretches(t: Array, parts: list[NarrowPart], missed: list[float], *, whole: bool) -> list[Stretch]:
    """Each part by itself, and, if `whole`, all that follow upon each other as one.

    Args:
        t: Ends of steps (n).
        parts: The parts.
        missed: Change of speed that each leaves out.
        whole: Whether several steps may err together, as fixed ones do that are not much longer than what they meet.
    """
    spans = np.diff(t)
    lengths = [float((part.end - part.begin) * spans[part.step] / _STATES) for part in parts]
    stretches = [Stretch(p.step, p.begin, p.step, p.end, *of) for p, *of in zip(parts, lengths, missed, strict=True)]
    if not whole:
        return stretches
    joined = list[Stretch]()
    for one in sorted(stretches, key=lambda one: (one.first, one.begin)):
        if not joined or one.first > joined[-1].last + 1:
            joined.append(one)
            continue
        before = joined[-1]
        last, end = max((before.last, before.end), (one.last, one.end))
        both = max(before.length, one.length), before.missed + one.missed
        joined[-1] = Stretch(before.first, before.begin, last, end, *both)
    return [*stretches, *(one for one in joined if one.last > one.first)]


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


def _proved(run: ExaminedRun, ends: States, stretch: Stretch, least: float, size: float) -> tuple[float, float]:
    """Length of steps [s] within a stretch and the change that they show, as do steps of twice the length.

    The least if none do; 0 where no steps come to its end.
    """
    shown, share = [math.inf], 1.0
    for _ in range(1 + _HALVINGS):
        change = _change(run, ends, stretch, share, size)
        if change is None:
            break
        shown.append(change)
        if change <= least or abs(shown[-1] - shown[-2]) <= _SETTLED * least:
            break
        share *= 0.5
    least_of_two = min(shown[-2:])
    return share * stretch.length, least_of_two if math.isfinite(least_of_two) else 0.0


def _change(run: ExaminedRun, ends: States, stretch: Stretch, share: float, size: float) -> float | None:
    """Change of speed at the end of the last step by short steps from the begin of the first, over the fastest speed.

    Args:
        run: The run.
        ends: Ends of steps: t (n), q, v, u.
        stretch: Where short steps have its length; before and after it they are parts of the run's own.
        share: Share of these lengths that is taken.
        size: Speed of the motion, in the norm of the kinetic energy.

    Returns:
        None where they do not come to the end.
    """
    t, last, finer = ends[0], stretch.last + 1, [x[stretch.first : stretch.first + 1] for x in ends]
    spans, within = np.diff(t), (stretch.first, stretch.last)
    begin, end = (float(t[i] + x * spans[i]) for i, x in zip(within, (stretch.begin, stretch.end), strict=True))
    lengths = (spans[stretch.first] / _STATES, stretch.length, spans[stretch.last] / _STATES)
    for t_end, length in zip((begin, end, float(t[last])), lengths, strict=True):
        start, step = [x[-1] for x in finer[:3]], float(share * length)
        if not t_end > start[0]:
            continue
        if run.settings.adaptive:
            status, finer = run.in_short_steps(start, t_end, step)
        else:  # Whatever the order of the method.
            status, finer = run.repeated(start, t_end, step, method=METHODS["rk4"], max_steps=MOST_STEPS)
        if status != Status.FINISHED:
            return None
    q, v, u = (x[-1:] for x in finer[1:])
    change, fastest = (float(run.norms(q, u, x)[0]) for x in (v - ends[2][last], v))
    return change / max(size, fastest, 1e-300)
