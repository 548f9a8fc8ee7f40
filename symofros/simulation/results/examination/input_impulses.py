"""Inputs that change within fixed steps: their impulse against what the nodes of the steps make of it.

docs/theory/simulation.md, section 8, (18c).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.manifold import retract
from symofros.simulation.inputs import held_samples
from symofros.simulation.results.examination.run import ExaminedRun
from symofros.simulation.stepping.methods import Method
from symofros.simulation.stepping.resolution import TOLERANCE
from symofros.simulation.stepping.stepper import Stepper

# Of a step: what happens nearer to one of its ends than this happens there.
AT_END = 1e-6
# Steps about one within which an input bends: the one before it, and two after it, in which it is made good or not.
_ABOUT = np.arange(-1, 3)
# Samples that are looked at, at most: those at which a signal bends most.
_MOST = 10_000
# Points of Gauss by which formulas are integrated between instants.
POINTS = 5
# Intervals of a run in which formulas are integrated, besides those between their instants.
_INTERVALS = 256
# Of a step, the distance of two values that make a rate.
RATE = 1e-7
# Share of what an input gives in all below which a part of it is rounding.
_ROUNDING = 1e-12
# Share of the speeds at the start and of one by which formulas are asked whether they depend on the state.
_MOVED = 0.37


@dataclass(frozen=True)
class TimedInput:
    """An input that is known as a function of time.

    Attributes:
        index: Its number among all.
        at: Its values at times (n) [s]; at held samples those before them if asked for.
        impulse: Its integral up to times (n) in order [s], from any instant on.
        instants: Where it bends, jumps or is narrow (n), in order [s].
    """

    index: int
    at: Callable[[Array, bool], Array]
    impulse: Callable[[Array], Array]
    instants: Array


@dataclass(frozen=True)
class _Misjudged:
    """What steps make of an input's impulse.

    Attributes:
        t: End of the step at which that is off most [s].
        missed: By how much; less what a delay by a step explains.
        whole: Range of the impulse over the run, less that of the input's mean.
    """

    t: float
    missed: float
    whole: float


def input_impulse_note(run: ExaminedRun) -> str:
    """An input of time whose impulse fixed steps misjudge (18c), in words; nothing where none is, or does no harm."""
    stepper, settings, states = run.stepper, run.settings, run.states
    if settings.adaptive or not stepper.model.nv or stepper.inputs.callback is not None or not len(states[0]):
        return ""
    h, t_end = settings.dt, float(states[0][-1])
    for one in timed_inputs(run):
        found = _misjudged(one, settings.method, settings.t0, t_end, h)
        if found is not None and found.missed > TOLERANCE * found.whole and _matters(run, one, found, h):
            return (
                f"steps of {h:.4g} s misjudge the input '{stepper.model.names.u[one.index]}', which changes within"
                f" them: at t = {found.t:.6g} s its impulse is off by {found.missed:.3g}, of {found.whole:.3g} in the"
                " run; a smaller dt or an adaptive method"
            )
    return ""


def timed_inputs(run: ExaminedRun) -> Iterator[TimedInput]:
    """Inputs that are signals, or formulas of time alone with instants; none of those that prescribe motions."""
    stepper, settings, start = run.stepper, run.settings, run.start
    inputs, free = stepper.inputs, stepper.model.nu - stepper.model.record.driven
    for index, t, values, linear in inputs.signals:
        if index < free:
            yield _lines(index, t, values) if linear else _held(index, t, values)
    of_law = sorted(inputs.formulas)
    if not of_law or of_law[0] >= free:
        return
    formulas = [inputs.formulas[i] for i in of_law]
    instants = stepper.model.formula_instants(formulas, stepper.par, settings.t0, settings.t_end)
    if not len(instants):
        return
    q, v = start
    moved = retract(stepper.model.record.segments, q, np.full(len(v), _MOVED)), v + _MOVED * (1.0 + np.abs(v))
    with np.errstate(all="ignore"):
        here, there = (_law(stepper, state, instants) for state in (start, moved))
    for column, index in enumerate(of_law):
        if index < free and np.array_equal(here[:, column], there[:, column]):
            yield _formula(stepper, start, column, index, instants)


def _lines(index: int, t: Array, values: Array) -> TimedInput:
    slopes = np.concatenate([[0.0], np.diff(values) / np.diff(t), [0.0]])
    areas = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(t) * (values[1:] + values[:-1]))])

    def at(when: Array, before: bool) -> Array:
        return np.interp(when, t, values)

    def impulse(when: Array) -> Array:
        k = np.maximum(np.searchsorted(t, when, "right") - 1, 0)
        return np.asarray(areas[k] + 0.5 * (when - t[k]) * (values[k] + at(when, False)))

    return TimedInput(index, at, impulse, _sharpest(t, np.diff(slopes)))


def _held(index: int, t: Array, values: Array) -> TimedInput:
    areas = np.concatenate([[0.0], np.cumsum(np.diff(t) * values[:-1])])

    def at(when: Array, before: bool) -> Array:
        return np.asarray(values[held_samples(t, when, when if before else np.inf)])

    def impulse(when: Array) -> Array:
        k = np.maximum(np.searchsorted(t, when, "right") - 1, 0)
        return np.asarray(areas[k] + (when - t[k]) * values[k])

    return TimedInput(index, at, impulse, _sharpest(t, np.diff(values, prepend=values[:1])))


def _sharpest(t: Array, changes: Array) -> Array:
    """The samples at which a signal changes most (n): at most _MOST, none at which it goes on as before."""
    sizes = np.abs(changes)
    if len(t) > _MOST:
        chosen = np.sort(np.argpartition(-sizes, _MOST)[:_MOST])
        t, sizes = t[chosen], sizes[chosen]
    return np.asarray(t[sizes > _ROUNDING * sizes.max(initial=0.0)])


def _formula(stepper: Stepper, start: tuple[Array, Array], column: int, index: int, instants: Array) -> TimedInput:
    x, weights = np.polynomial.legendre.leggauss(POINTS)

    def at(when: Array, before: bool) -> Array:
        return _law(stepper, start, when)[:, column]

    def impulse(when: Array) -> Array:
        between = instants[(instants > when[0]) & (instants < when[-1])]
        times = np.union1d(when, between)
        middle, half, total = 0.5 * (times[1:] + times[:-1]), 0.5 * np.diff(times), np.zeros(len(times))
        for place, weight in zip(x, weights, strict=True):
            total[1:] += weight * half * at(middle + place * half, False)
        return np.asarray(np.cumsum(total)[np.searchsorted(times, when)])

    return TimedInput(index, at, impulse, instants)


def _law(stepper: Stepper, state: tuple[Array, Array], t: Array) -> Array:
    """Values (n, number of formulas) of the inputs' formulas at a state and times (n)."""
    given = {"q": state[0], "v": state[1], "u": stepper.inputs.constant}
    rows = {name: x[np.newaxis] for name, x in given.items()} | {"t": t[:, np.newaxis]}
    return evaluated(stepper, "law", rows, len(t))


def evaluated(stepper: Stepper, slot: str, given: dict[str, Array], n: int, par: Array | None = None) -> Array:
    """The first output of a function of the run at n states, given by group; by its parameters, or others (npar)."""
    kernel, par = stepper.kernels[slot], stepper.par if par is None else par
    inputs = [given[group] if group in given else np.zeros((1, size)) for group, size in kernel.signature.inputs]
    return np.asarray(kernel.run(n, kernel.prepare(par[np.newaxis]), inputs)[0], dtype=np.float64)


def nodes(method: Method) -> tuple[Array, Array, float]:
    """Nodes and weights by which a step integrates a function of time, and the weight of its rate at the start.

    Generalised alpha weighs the accelerations of several steps: one or the other end, in the mean.
    """
    tableau, m = method.tableau, method.tableau.stages
    if method.kind == "alpha":
        return np.array([0.0, 1.0]), np.array([0.5, 0.5]), 0.0
    if method.kind == "variational":
        return np.array([0.5]), np.array([1.0]), 0.0
    if method.kind != "rosenbrock":
        return tableau.c[:m], tableau.b[:m], 0.0
    coupling = np.tril(tableau.coupling[:m, :m], -1)
    solved = np.linalg.solve((np.eye(m) - tableau.gamma * coupling).T, tableau.b[:m])
    weights = tableau.gamma * np.asarray(solved, dtype=np.float64)
    return tableau.c[:m], weights, float(weights @ tableau.d[:m])


def _misjudged(one: TimedInput, method: Method, t0: float, t_end: float, h: float) -> _Misjudged | None:
    """The largest error of the impulse by steps; None if no step contains an instant, or the error is rounding."""
    place = (one.instants - t0) / h
    last = int(np.ceil((t_end - t0) / h - AT_END)) - 1
    within = np.unique(np.floor(place[np.abs(place - np.rint(place)) > AT_END]).astype(np.int64))
    within = within[(within >= 0) & (within <= last)]
    if not len(within):
        return None
    k = np.unique(np.minimum(np.maximum(within[:, np.newaxis] + _ABOUT, 0), last))
    begin, end, after = (np.minimum(t0 + (k + i) * h, t_end) for i in range(3))
    known = one.instants[(one.instants > t0) & (one.instants < t_end)]
    apart = np.linspace(t0, t_end, _INTERVALS + 1)
    times = np.unique(np.concatenate([apart, known, begin, end, after]))
    with np.errstate(all="ignore"):
        impulse = one.impulse(times)
        impulse = impulse - impulse[0]
        exact = impulse[np.searchsorted(times, end)] - impulse[np.searchsorted(times, begin)]
        missed = np.cumsum(exact - _made(one, method, begin, end))
        beyond = impulse - impulse[-1] * (times - t0) / (t_end - t0)  # A constant part is met by any step.
        near = np.array([beyond[np.searchsorted(times, t)] for t in (begin, end, after)])
        made = near[1] - missed
        off = np.maximum(np.maximum(near.min(axis=0) - made, made - near.max(axis=0)), 0.0)
    worst, whole = int(np.argmax(off)), float(np.ptp(beyond))
    if not off[worst] > _ROUNDING * np.abs(np.diff(impulse)).sum():  # Nor where it is not finite: the run says that.
        return None
    return _Misjudged(float(end[worst]), float(off[worst]), whole)


def _made(one: TimedInput, method: Method, begin: Array, end: Array) -> Array:
    """Integrals of an input over steps, by the quadrature of the method."""
    c, weights, of_rate = nodes(method)
    h, total = end - begin, np.zeros(len(begin))
    for node, weight in zip(c, weights, strict=True):
        if weight:
            total += weight * h * one.at(end if node == 1.0 else begin + node * h, node == 1.0)
    if of_rate:
        ahead = begin + RATE * h
        total += of_rate * h**2 * (one.at(ahead, True) - one.at(begin, False)) / (ahead - begin)
    return total


def _matters(run: ExaminedRun, one: TimedInput, found: _Misjudged, h: float) -> bool:
    """Whether the motion would be faster or slower by more than TOLERANCE of its largest speed."""
    t, q, v, u = run.states
    row = [min(max(0, int(np.searchsorted(t, found.t)) - 1), len(t) - 1)]
    pushed = np.repeat(u[row], 2, axis=0)
    pushed[1, one.index] += found.missed / h
    given = {"q": q[row], "v": v[row], "u": pushed, "t": t[row][:, np.newaxis]}
    with np.errstate(all="ignore"):
        a = evaluated(run.stepper, "forward_dynamics", given, 2)
        change = float(run.norms(q[row], u[row], h * (a[1:] - a[:1]))[0])
        return change > TOLERANCE * run.fastest
