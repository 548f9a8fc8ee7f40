"""Forces that act within a step and that the step does not see: looked for in long steps, and proved by short ones.

docs/theory/simulation.md, section 8.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from symofros.base.arrays import Array
from symofros.simulation.results.examination.finer_steps import States, percent
from symofros.simulation.results.examination.narrow_parts import passed_over
from symofros.simulation.results.examination.paths import Numbers, path_within
from symofros.simulation.results.examination.run import ExaminedRun, norms_in
from symofros.simulation.stepping.resolution import TOLERANCE
from symofros.simulation.stepping.status import Status

# States within steps, about: this share of the run's evaluations within these numbers; of a function of the user's,
# which each state calls, this many where steps adapt and the share, if that is less, where they are fixed; most where
# bodies may touch, as obstacles are small against the way of a flight, which is one step. Steps with
# fewer than the last are short against the run; what acts in them their own stages see.
_SHARE, _LEAST, _MOST, _CALLS, _FEWEST = 0.25, 512, 4096, 256, 4
# Of intervals of several steps the longest are made once more: about so many steps, or this share of all where that is
# more. Steps that are held against shorter ones.
_REPEATED, _PROVED = (512, 0.05), 4
# Change by shorter steps that is worth a note where steps adapt: this many times the bound of a step's error, that by
# rtol within these shares, and that by atol. A step that is no longer than its error allows is off by far less.
_BOUNDS, _NOTED = 100.0, (0.01, TOLERANCE)
# Largest atol by which a motion counts as a rest, that of runs which state none: a larger one may hide a whole motion.
_REST = 1e-9
# Change of speed that a step leaves out, by the cubic through its ends, from which it is held against shorter ones.
_DOUBTED = 0.5


def stepped_over_note(run: ExaminedRun) -> str:
    """Note on what acts within steps and is passed over (18b); "" where no shorter step shows any."""
    settings, steps = run.settings, run.steps
    run = _from_the_start(run)
    if settings.realtime or not run.model.nv or steps < 1 or len(run.states[0]) < 2 or not run.span:
        return ""
    function = run.stepper.inputs.callback is not None
    if function and not run.same_inputs_again:
        return ""
    share = _SHARE * steps * max(1, run.stepper.method.tableau.stages)
    least, most = _MOST if run.amplifies else _LEAST, _MOST
    if function:
        least, most = _CALLS if settings.adaptive else 0, _CALLS
    number = int(min(max(share, least), most))
    noted = min(max(_BOUNDS * settings.rtol, _NOTED[0]), _NOTED[1]) if settings.adaptive else TOLERANCE
    rest = run.allowed * min(1.0, _REST / settings.atol)
    size = max(run.fastest, run.rounding(run.states), _BOUNDS * rest / noted)
    for ends in _single_steps(run, number):
        for i, part in _doubted(run, ends, number, _DOUBTED * noted, size):
            coarse, first = [x[i : i + 2] for x in ends], [x[i] for x in ends[:3]]
            status, finer = run.in_short_steps(first, float(ends[0][i + 1]), part)
            if status != Status.FINISHED:
                continue
            change = run.change_in_part(coarse, [x[[0, -1]] for x in finer], size)
            if change > noted:
                return _note(run, ends, i, part, change)
        step, part, change = passed_over(run, ends, noted, size)
        if change > 0.0:
            return _note(run, ends, step, part, change)
    return ""


def _note(run: ExaminedRun, ends: States, step: int, part: float, change: float) -> str:
    """The note on a step, by its number, and a change by steps of that length [s]."""
    cure = f"max_step={part:.2g}" if run.settings.adaptive else "a smaller dt"
    return (
        f"the step from t = {ends[0][step]:.6g} s to {ends[0][step + 1]:.6g} s passes over what acts within it: steps"
        f" of {part:.2g} s change the motion there by {percent(change)}; {cure}"
    )


def _from_the_start(run: ExaminedRun) -> ExaminedRun:
    """A run with its first state put before its records if it was not recorded."""
    stepper, t0, states = run.stepper, run.settings.t0, run.states
    if not len(states[0]) or states[0][0] <= t0:
        return run
    with stepper.preserved():
        u = stepper.inputs_at(t0, *run.start)
    return replace(run, states=[np.concatenate([[x], y]) for x, y in zip((t0, *run.start, u), states, strict=True)])


def _single_steps(run: ExaminedRun, number: int) -> Iterator[States]:
    """Ends of steps, those of all or of the longest intervals; of methods with a history the records."""
    (t, q, v, _), steps = run.states, run.steps
    if steps <= len(t) - 1 or run.stepper.method.family.multistep:
        yield run.states
        return
    spans = np.diff(t)
    most = max(_REPEATED[0], _REPEATED[1] * steps) * len(spans) // steps
    longest = np.argsort(-spans, kind="stable")[: int(most)]
    # Fixed steps are all alike, and states within them would be as far apart as they are.
    if not run.settings.adaptive or not run.same_inputs_again:
        return
    for i in longest:
        if number * spans[i] < _FEWEST * (t[-1] - t[0]):
            return
        status, ends = run.repeated((t[i], q[i], v[i]), float(t[i + 1]), run.settings.dt)
        if status == Status.FINISHED and len(ends[0]) > 1:
            yield ends


def _doubted(run: ExaminedRun, ends: States, number: int, least: float, size: float) -> list[tuple[int, float]]:
    """Steps, by number, that leave out most of a speed `size`, (18b), and how far apart the states within them were."""
    spans = np.diff(ends[0])
    counts = np.floor(number * spans / run.span).astype(int)
    counts[counts < _FEWEST] = 0
    if not counts.any():
        return []
    path = path_within(run.stepper, ends, counts)
    if path is None:
        return []
    chosen = np.flatnonzero(counts)
    metric = run.metrics(ends[1][chosen], ends[3][chosen])
    with np.errstate(all="ignore"):  # What has exploded overflows.
        missed = (path.a - path.path_a) * (spans / np.maximum(counts, 1))[path.interval, np.newaxis]
        if (_bounds_of_sums(missed, counts[chosen], metric) <= least * size).all():
            return []
        left_out = _largest_sums(missed, counts[chosen], metric)
    shares = left_out / max(size, left_out.max(), 1e-300)
    worst = np.argsort(-shares, kind="stable")[:_PROVED]
    return [(int(chosen[k]), float(spans[chosen[k]] / counts[chosen[k]])) for k in worst if shares[k] > least]


def _bounds_of_sums(changes: Array, counts: Numbers, metric: Array) -> Array:
    """Bounds of what `_largest_sums` gives (k): no eigenvalue of M is above its trace. Arguments as there."""
    sizes = np.sqrt(np.einsum("ij,ij->i", changes, changes))
    traces = np.trace(metric, axis1=-2, axis2=-1)
    return np.asarray(np.sqrt(traces) * np.add.reduceat(sizes, np.cumsum(counts) - counts))


def _largest_sums(changes: Array, counts: Numbers, metric: Array) -> Array:
    """The largest norm of the sums from the first change of an interval to each (k), in the interval's metric.

    Args:
        changes: Changes of speed, interval by interval (sum of counts, nv).
        counts: Number of changes in each interval (k), at least 1.
        metric: Metric of each interval (k, nv, nv).
    """
    largest, begins = np.zeros(len(counts)), np.cumsum(counts) - counts
    sizes = np.frexp(counts)[1]
    for size in np.unique(sizes):  # Together what is filled up with zeros to less than twice its length.
        some = np.flatnonzero(sizes == size)
        within = np.arange(counts[some].max()) < counts[some, np.newaxis]
        sums = np.zeros((*within.shape, changes.shape[1]))
        sums[within] = changes[(begins[some, np.newaxis] + np.arange(within.shape[1]))[within]]
        largest[some] = norms_in(metric[some], np.nan_to_num(np.cumsum(sums, axis=1))).max(axis=1)
    return largest
