"""The energy of a run: what changed although no force did work (docs/theory/simulation.md, section 8)."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from symofros.base.arrays import Array
from symofros.base.measures import ROTATION
from symofros.runtime.manifold import retract
from symofros.simulation.analysis.sliding import contact_dynamics
from symofros.simulation.results.examination.finer_steps import States
from symofros.simulation.results.examination.paths import path_within
from symofros.simulation.results.examination.run import ExaminedRun

# A power is a difference over this share of a step, or of the time in which the largest speed arises where that is
# shorter; but not shorter than this share of that.
_MOMENT, _SHORTEST = 1e-3, 1e-60
# Difference of two energies, over their parts, that is rounding: no power; of those of states so many times that.
_ROUNDING, _SUMS = 1e-15, 16.0
# Growth of speeds that no mechanism explains.
EXPLODED = 1e6
# Kinetic energy, over the first, up to which growth is held against the work of forces.
_BEGUN = 1e3
# States, about, whose power is looked at first.
_FEW = 32
# Change of energy, over the largest kinetic energy, that is worth a note; work that explains a change, over it.
_NOTED_CHANGE, _NOTED_WORK = 0.05, 0.1
# States at most this many steps apart show the work between them.
_DENSE = 1.5
# Intervals between states farther apart that are repeated step by step: those where the energy changes most.
_REPEATED = 8
# States within each of these.
_INSIDE = 16


def energy_note(run: ExaminedRun) -> str:
    """Energy that changed although no force did work (18), in words; nothing where it is small or not shown."""
    states = run.states
    few = [x[:: max(1, len(x) // _FEW)] for x in states]
    with np.errstate(all="ignore"):  # What overflows is left out.
        # Among all states: a change may last for some steps only. A batch of them takes hardly longer than a few.
        energies = run.energies(states)
        if energies is None or len(states[0]) < 2:
            return ""
        kinetic, energy = energies
        cure = f"{'a smaller dt' if not run.settings.adaptive else 'tighter tolerances'}, or another method"
        if not np.isfinite(energy).all():  # States beyond 1e100 have ended the run: it is a mass that is immense.
            return "energy overflows, although the states do not, and is not judged: units in which it is smaller"
        change, largest = float(np.abs(energy - energy[0]).max()), float(kinetic.max())
        if not change > _SUMS * _ROUNDING * np.abs(energy).max():
            return ""
        gain = float(energy.max() - energy[0])
        if gain > 0.5 * kinetic.max() and not _acts(run):
            first = max(_first_energy(run, few), 1e-300)
            growth = math.sqrt(float(kinetic.max()) / first)
            if growth > EXPLODED and not _driven(run, energies, first):
                return f"speeds grow {growth:.3g}-fold and energy by {gain:.3g} J although no input acts: {cure}"
        # At rest, as after an impact that takes all speed, only rounding moves.
        if not change > _NOTED_CHANGE * largest > 0.5 * _NOTED_CHANGE * run.rounding(states) ** 2:
            return ""
        # Most forces that do work are seen at once; a short contact is seen among all states, or between them.
        for shown in (few, states, *_between(run, energy)):
            if shown is None:
                return ""
            if not _works_little(run, shown, change):
                return ""
        inside = _within(run, states, energy)
        if inside is None or not _works_little(run, inside, change):
            return ""
    return (
        f"energy changes by {change:.3g} J although no force does work, where the motion has {largest:.3g} J at most:"
        f" {cure}"
    )


def _works_little(run: ExaminedRun, shown: States, change: float) -> bool:
    """Whether the power in these states explains no such change of energy [J] over their span."""
    work = float(np.abs(_power(run, run.span / run.steps, shown)).max()) * float(shown[0].max() - shown[0].min())
    return work <= _NOTED_WORK * change


def _driven(run: ExaminedRun, energies: tuple[Array, Array], first: float) -> bool:
    """Whether forces do the work by which a motion begins to grow: where it has exploded power has no digits left."""
    kinetic, energy = energies
    begun = int(np.argmax(np.append(kinetic, np.inf) > _BEGUN * first))
    if begun < 2:
        return False
    gain = float(energy[:begun].max() - energy[0])
    return gain > 0.5 * float(kinetic[:begun].max()) and not _works_little(run, [x[:begun] for x in run.states], gain)


def _acts(run: ExaminedRun) -> bool:
    """Whether an input is, or may be, other than zero at some time, or forces depend on time."""
    inputs = run.stepper.inputs
    signals = any(np.any(values) for _, _, values, _ in inputs.signals)
    given = inputs.callback is not None or bool(inputs.formulas) or bool(np.any(inputs.constant))
    return given or signals or run.model.record.timed or _states_move(run)


def _states_move(run: ExaminedRun) -> bool:
    """Whether states of forces move by themselves at first: a clock, or what cools down, drives as an input does."""
    t, q, v, u = (x[:1] for x in run.states)
    if run.moving.all():
        return False
    at_rest = np.where(run.moving, 0.0, v)
    rates = run.model.forward_dynamics(q, at_rest, u, par=run.stepper.par, t=t)[:, ~run.moving]
    return bool(np.any(rates))


def _within(run: ExaminedRun, states: States, energy: Array) -> list[Array] | None:
    """States within the intervals in which the energy changes most; None where there are none.

    An input may come and go between the ends of two steps, which then show no power.
    """
    counts = np.zeros(len(energy) - 1, dtype=int)
    counts[np.argsort(-np.abs(np.diff(energy)), kind="stable")[:_REPEATED]] = _INSIDE
    path = path_within(run.stepper, states, counts)
    return None if path is None else path.states


def _between(run: ExaminedRun, energy: Array) -> Iterator[list[Array] | None]:
    """Ends of all steps in the intervals where the energy changes most, and states within; None: not repeatable."""
    states, steps, settings = run.states, run.steps, run.settings
    intervals = len(states[0]) - 1
    # Of adaptive steps many may lie in one interval between samples, though there are fewer of them in all.
    if steps == intervals or (not settings.adaptive and steps < _DENSE * intervals):
        return
    if not run.repeatable:
        yield None
        return
    t, q, v, _ = states
    changes = np.abs(np.diff(energy))
    for i in np.argsort(-changes)[:_REPEATED]:
        if changes[i] > 0.0:
            ends = run.repeated((t[i], q[i], v[i]), float(t[i + 1]), settings.dt)[1]
            yield ends
            energies = run.energies(ends)
            if energies is not None and len(ends[0]) > 1:
                yield _within(run, ends, energies[1])


def energy_that_appeared(run: ExaminedRun) -> str:
    """The change of energy that no force supplied, where the states show it: "... J appeared ...; ", or nothing."""
    energies, t, dt = run.energies(run.states), run.states[0], run.settings.dt
    if energies is None or len(t) < 2:
        return ""
    (kinetic, energy), power = energies, _power(run, dt, run.states)
    spans = np.diff(t)
    work, change = float(np.sum(0.5 * (power[1:] + power[:-1]) * spans)), float(energy[-1] - energy[0])
    known = spans.max() <= _DENSE * dt or float(np.abs(power).max() * spans.sum()) <= 1e-2 * abs(change)
    appeared, largest = change - work, float(kinetic.max())
    if not (known and math.isfinite(appeared) and largest > 0.0):
        return ""
    return f"{appeared:.3g} J appeared that no force supplied, where the motion has {largest:.3g} J at most; "


def _first_energy(run: ExaminedRun, states: States) -> float:
    """Kinetic energy of the first record, or that which its accelerations give within a record, if that is more."""
    model, par, (t, q, v, u) = run.model, run.stepper.par, (x[:1] for x in states)
    gained = (states[0][1] - states[0][0]) * model.forward_dynamics(q, v, u, par=par, t=t)
    return max(float(model.kinetic_energy(q, speeds, u=u, par=par)[0]) for speeds in (v, gained))


def _power(run: ExaminedRun, step: float, states: States) -> Array:
    """Power of all but conservative forces (n): the rate of the energy along the motion, by central differences.

    Without what the forces of constraints have taken or supplied where G v = b is violated: that is an error, no work.
    """
    model, par, (t, q, v, u) = run.model, run.stepper.par, states
    a, lam = contact_dynamics(model, (t, q, v, u), par)
    # A fast motion changes its speeds within less than a step that does not follow it.
    pace = _norms(v).max() / np.maximum(_norms(a), 1e-300)
    moment = _MOMENT * step * np.clip(pace / step, _SHORTEST, 1.0)
    # Nor is a force the same over more than a small angle.
    turning = np.abs(v[:, np.array(model.record.measures.speed) == ROTATION]).max(axis=1, initial=0.0)
    moment = np.minimum(moment, _MOMENT / np.maximum(turning, 1e-300))
    ends, size = [], np.zeros(len(t))
    for s in (moment, -moment):
        q_s, v_s = retract(model.record.segments, q, s[:, np.newaxis] * v), v + s[:, np.newaxis] * a
        kinetic = model.kinetic_energy(q_s, v_s, u=u, par=par)
        potential = model.potential_energy(q_s, u=u, par=par, t=t + s, z=model.states_of(v_s))
        ends.append(kinetic + potential)
        size += np.abs(kinetic) + np.abs(potential)
    change = ends[0] - ends[1]
    rate: Array = np.where(np.abs(change) > _ROUNDING * size, change, 0.0) / (2.0 * moment)
    if model.nc:
        violated = model.constraint_rate(q, v, u=u, par=par, t=t)  # Zero of what is released, as of balls that slide.
        rate = rate - np.einsum("ij,ij->i", lam, violated)
    return rate


def _norms(rows: Array) -> Array:
    """Norm of each row, without overflow."""
    size = max(float(rows.max(initial=0.0)), -float(rows.min(initial=0.0)))
    if size == 0.0:
        return np.zeros(len(rows))
    norms: Array = size * np.sqrt(np.einsum("ij,ij->i", rows / size, rows / size))
    return norms
