"""Remarks on fixed steps: whether they resolve the motion, and what energy they bring in."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from symofros.errors import SymofrosError
from symofros.runtime.calls.kernel import Array
from symofros.runtime.manifold import retract
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.resolution import Mode, largest_stable_step, states_to_examine, worst_mode
from symofros.simulation.stepping.stepper import Stepper

# A power is a difference over this share of a step, or of the time in which the largest speed arises where that is
# shorter; but not shorter than this share of that.
_MOMENT, _SHORTEST = 1e-3, 1e-60
# Growth of speeds that no mechanism explains.
EXPLODED = 1e6
# Records, about, among which the fastest is looked for.
_SPEEDS = 200
# Records, about, whose power is looked at first.
_FEW = 32
# Change of energy, over the largest kinetic energy, that is worth a note; work that explains a change, over it.
_NOTED_CHANGE, _NOTED_WORK = 0.05, 0.1
# Records at most this many steps apart show the work between them.
_DENSE = 1.5


def unresolved_mode(
    stepper: Stepper, settings: Settings, start: tuple[Array, Array], states: Sequence[Array], steps: int
) -> Mode | None:
    """The mode that the fixed steps of a run resolve worst, if they err by it; None also of steps that adapt.

    Args:
        stepper: Stepper of the run; its state stays.
        settings: Settings of the run.
        start: Initial q, v.
        states: All that it recorded: t (n), q, v, u.
        steps: Number of steps.
    """
    if settings.adaptive or not stepper.method.family.judged or not stepper.model.nv or steps < 1:
        return None
    if settings.realtime and stepper.system.callback != stepper.ffi.NULL:
        return None  # What the function serves may be hardware: it is not called beside the run.
    t, q, v, _ = states
    good = _finite_rows(q, v)
    wanted = states_to_examine(steps, stepper.method.tableau.stages, stepper.model.nv)
    later = sorted({good * k // (wanted - 1) - 1 for k in range(1, wanted)}) if good else []
    examined = [(settings.t0, *start), *((float(t[i]), q[i], v[i]) for i in later)]
    stride = max(1, good // _SPEEDS)
    norms = _norms(np.concatenate([start[1][np.newaxis], v[:good:stride]]))
    speeds = [_speed_of_motion(norms, i // stride + 2) for i in (0, *later)]
    with stepper.preserved(), np.errstate(all="ignore"):  # States that have exploded overflow.
        return worst_mode(stepper, settings.dt, steps, examined, speeds)


def _speed_of_motion(norms: Array, at: int) -> float:
    """The largest speed that is a measure of the motion about a state.

    It is the largest of the run, unless the run exploded after that state: what an unstable step makes is no measure
    of the motion that it spoils.

    Args:
        norms: Speeds in the order of time.
        at: Number of the one after the state.
    """
    largest, here = float(norms.max()), float(norms[: at + 1].max())
    return here if largest > EXPLODED * here > 0.0 else largest


def _finite_rows(q: Array, v: Array) -> int:
    """Number of records before the first that is not finite."""
    if math.isfinite(float(q.sum() + v.sum())):  # As nearly always; the sum of great numbers may overflow.
        return len(q)
    bad = np.flatnonzero(~(np.isfinite(q).all(axis=1) & np.isfinite(v).all(axis=1)))
    return int(bad[0]) if len(bad) else len(q)


def _norms(rows: Array) -> Array:
    """Norm of each row, without overflow."""
    size = max(float(rows.max(initial=0.0)), -float(rows.min(initial=0.0)))
    if size == 0.0:
        return np.zeros(len(rows))
    norms: Array = size * np.sqrt(np.einsum("ij,ij->i", rows / size, rows / size))
    return norms


def step_size_note(mode: Mode, stepper: Stepper, settings: Settings, states: Sequence[Array]) -> str:
    """What a mode that is not resolved means for a run, in words.

    Args:
        mode: Mode that the run resolves worst.
        stepper: Stepper of the run.
        settings: Settings of the run.
        states: All that it recorded: t (n), q, v, u; none where its energy means nothing.
    """
    method, h = settings.method, settings.dt
    motion = f"{_rate(mode.rate)} (seen at t = {mode.t:.4g} s)"
    if not mode.amplified:
        return (
            f"steps of {h:.4g} s follow a mode of the motion to {_percent(mode.error)} only: {motion} with"
            f" {_percent(mode.share)} of the speed; a smaller dt or an adaptive method"
        )
    limit = largest_stable_step(method, mode.rate)
    allowed = f"stable up to {limit:.4g} s" if limit > 0.0 else "stable at no step"
    with np.errstate(all="ignore"):  # What overflows is left out.
        energy = _energy_that_appeared(stepper, settings, states) if states else ""
    return (
        f"the step of {h:.4g} s is past the limit of stability: '{method.name}' is {allowed} for the mode that"
        f" {motion}, and multiplies it by {abs(mode.factor):.4g} each step; {energy}{remedy(mode, settings)}"
    )


def remedy(mode: Mode, settings: Settings) -> str:
    """What makes a run stable."""
    limit = largest_stable_step(settings.method, mode.rate)
    if limit > 0.0:
        return f"dt below {limit:.3g} s, or an implicit method"
    return "another method, such as rk4"


def _rate(rate: complex) -> str:
    decay = f"decays at {-rate.real:.4g} 1/s" if rate.real < 0.0 else f"grows at {rate.real:.4g} 1/s"
    if abs(rate.imag) <= 1e-3 * abs(rate.real):
        return decay
    oscillation = f"oscillates at {rate.imag:.4g} rad/s"
    return oscillation if abs(rate.real) <= 1e-3 * abs(rate.imag) else f"{oscillation} and {decay}"


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g} %" if share < 1.0 else "more than 100 %"


def energy_note(stepper: Stepper, settings: Settings, states: Sequence[Array]) -> str:
    """Energy that changed although no force did work (17), in words; nothing where it is small or not shown.

    Args:
        stepper: Stepper of the run.
        settings: Settings of the run.
        states: All that it recorded: t (n), q, v, u.
    """
    few = [x[:: max(1, len(x) // _FEW)] for x in states]
    with np.errstate(all="ignore"):  # What overflows is left out.
        # Among all records: a change may last for some steps only. A batch of them takes hardly longer than a few.
        energies = _energies(stepper, states)
        if energies is None:
            return ""
        kinetic, energy = energies
        cure = f"{'a smaller dt' if not settings.adaptive else 'tighter tolerances'}, or another method"
        if not np.isfinite(energy).all():
            return f"energy overflows, although the states do not: speeds have exploded; {cure}"
        gain = float(energy.max() - energy[0])
        growth = math.sqrt(float(kinetic.max()) / max(_first_energy(stepper, few), 1e-300))
        if growth > EXPLODED and gain > 0.5 * kinetic.max() and not few[3].any():
            # Angles may have no digits left, and power none.
            return f"speeds grow {growth:.3g}-fold and energy by {gain:.3g} J although no input acts: {cure}"
        change, largest = float(np.abs(energy - energy[0]).max()), float(kinetic.max())
        if not change > _NOTED_CHANGE * largest > 0.0:
            return ""
        if int(stepper.run.steps) > _DENSE * (len(states[0]) - 1):
            return ""
        # Most forces that do work are seen at once; a short contact is seen among all records.
        span = float(states[0][-1] - states[0][0])
        for records in (few, states):
            power = _power(stepper, span / int(stepper.run.steps), records)
            if not float(np.abs(power).max()) * span <= _NOTED_WORK * change:
                return ""
    return (
        f"energy changes by {change:.3g} J although no force does work, where the motion has {largest:.3g} J at most:"
        f" {cure}"
    )


def _energy_that_appeared(stepper: Stepper, settings: Settings, states: Sequence[Array]) -> str:
    """The change of energy that no force supplied, where the records show it: "... J appeared ...; ", or nothing."""
    energies, t = _energies(stepper, states), states[0]
    if energies is None:
        return ""
    (kinetic, energy), power = energies, _power(stepper, settings.dt, states)
    spans = np.diff(t)
    work, change = float(np.sum(0.5 * (power[1:] + power[:-1]) * spans)), float(energy[-1] - energy[0])
    known = spans.max() <= _DENSE * settings.dt or float(np.abs(power).max() * spans.sum()) <= 1e-2 * abs(change)
    appeared, largest = change - work, float(kinetic.max())
    if not (known and math.isfinite(appeared) and largest > 0.0):
        return ""
    return f"{appeared:.3g} J appeared that no force supplied, where the motion has {largest:.3g} J at most; "


def _first_energy(stepper: Stepper, states: Sequence[Array]) -> float:
    """Kinetic energy of the first record, or that which its accelerations give within a record, if that is more."""
    model, par, (t, q, v, u) = stepper.model, stepper.par, (x[:1] for x in states)
    gained = (states[0][1] - states[0][0]) * model.forward_dynamics(q, v, u, par=par, t=t)
    return max(float(model.kinetic_energy(q, speeds, u=u, par=par)[0]) for speeds in (v, gained))


def _energies(stepper: Stepper, states: Sequence[Array]) -> tuple[Array, Array] | None:
    """Kinetic and total energy (n) of records; None where motions are prescribed or the model has no energies."""
    model, (t, q, v, u) = stepper.model, states
    if model.record.driven or len(t) < 2 or not (np.isfinite(q).all() and np.isfinite(v).all()):
        return None
    try:
        kinetic = model.kinetic_energy(q, v, u=u, par=stepper.par)
        return kinetic, kinetic + model.potential_energy(q, u=u, par=stepper.par, t=t)
    except SymofrosError:  # Options.functions left them out.
        return None


def _power(stepper: Stepper, step: float, states: Sequence[Array]) -> Array:
    """Power of all but conservative forces (n): the rate of the energy along the motion, by central differences.

    Without what the forces of constraints have taken or supplied where G v = b is violated: that is an error, no work.
    """
    model, par, (t, q, v, u) = stepper.model, stepper.par, states
    a, lam = model.forward_dynamics(q, v, u, par=par, t=t, multipliers=True)
    # A fast motion changes its speeds within less than a step that does not follow it.
    pace = _norms(v).max() / np.maximum(_norms(a), 1e-300)
    moment = _MOMENT * step * np.clip(pace / step, _SHORTEST, 1.0)
    ends = []
    for s in (moment, -moment):
        q_s, v_s = retract(model.record.segments, q, s[:, np.newaxis] * v), v + s[:, np.newaxis] * a
        kinetic = model.kinetic_energy(q_s, v_s, u=u, par=par)
        ends.append(kinetic + model.potential_energy(q_s, u=u, par=par, t=t + s))
    rate: Array = (ends[0] - ends[1]) / (2.0 * moment)
    if model.nc:
        rate = rate - np.einsum("ij,ij->i", lam, model.constraint_rate(q, v, u=u, par=par, t=t))
    return rate
