"""Remarks on fixed steps: whether they resolve the motion."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from symofros.base.arrays import Array
from symofros.errors import SymofrosError
from symofros.simulation.analysis.kinematics.postures import worst_violation
from symofros.simulation.results.examination.creep import creep_note
from symofros.simulation.results.examination.energy_balance import EXPLODED, energy_note, energy_that_appeared
from symofros.simulation.results.examination.finer_steps import percent
from symofros.simulation.results.examination.formula_impulses import formula_impulse_note
from symofros.simulation.results.examination.input_impulses import input_impulse_note
from symofros.simulation.results.examination.repetition import halved_step_note, tolerance_note
from symofros.simulation.results.examination.run import ExaminedRun, norms_in
from symofros.simulation.results.examination.stepped_over import stepped_over_note
from symofros.simulation.results.examination.switched_run import SwitchedRun, switched_run_note
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.methods import Method
from symofros.simulation.stepping.resolution import (
    Mode,
    Pull,
    Resolution,
    Spectrum,
    directions,
    largest_stable_step,
    pull_rates,
    resolution,
    states_to_examine,
)
from symofros.simulation.stepping.stepper import Stepper

# Records, about, among which the fastest is looked for.
_SPEEDS = 200


def examine_run(run: ExaminedRun, *, ended_well: bool, failed: bool) -> tuple[Mode | None, tuple[str, ...]]:
    """The mode that a run resolves worst, and notes on its steps: on that, on half the step, on inputs, on energy.

    Args:
        run: The run.
        ended_well: Whether it came to its end.
        failed: Whether it diverged; its energy means nothing then.
    """
    resolution = examine_steps(run)
    mode = resolution.worst
    notes = []
    if mode is not None:
        with np.errstate(all="ignore"):  # What overflows is left out.
            energy = energy_that_appeared(run) if mode.amplified and not failed else ""
        notes.append(step_size_note(mode, run.settings.method, run.settings.dt, energy))
    if not ended_well:
        return mode, tuple(notes)
    # Of a run with actions all parts are held as one.
    whole = (run.is_of_first_order or run.amplifies) and run.stepper.actions is None
    if mode is None and not (whole and not run.short):
        evident = resolution.evident and not run.settings.samples_within_steps(run.stepper.inputs.jumps)
        notes.append(halved_step_note(run, evident=evident))
    notes.append(input_impulse_note(run))
    if not any(notes):
        notes.append(formula_impulse_note(run))
    if mode is None and not any(notes):
        notes.append(stepped_over_note(run))
    notes.append(tolerance_note(run))
    if (mode is None or not mode.amplified) and not (mode is None and any(notes)):
        notes.append(energy_note(run))
    if whole and mode is None and not any(notes):
        notes.append(switched_run_note(SwitchedRun.of(run)))
    notes.append(creep_note(run))
    return mode, tuple(note for note in notes if note)


def examine_steps(run: ExaminedRun) -> Resolution:
    """How well the fixed steps of a run resolve its modes; steps that adapt are not examined."""
    stepper, settings, (t, q, v, u) = run.stepper, run.settings, run.states
    if not settings.judged or not run.model.nv or run.steps < 1:
        return Resolution()
    if run.model.record.rigid_contacts:
        return Resolution()  # Across a slip that begins friction has no bounded rate, nor does the motion need one.
    if settings.realtime and stepper.system.callback != stepper.ffi.NULL:
        return Resolution()  # What the function serves may be hardware: it is not called beside the run.
    good = _finite_rows(q, v)
    stride = max(1, good // _SPEEDS)
    rows = np.arange(0, good, stride)
    q = _without_integrals(run, q)
    begin = _without_integrals(run, run.start[0]), run.start[1]
    q_all, v_all = (np.concatenate([x[np.newaxis], y[rows]]) for x, y in zip(begin, (q, v), strict=True))
    metric = run.metrics(q_all, np.concatenate([u[:1], u[rows]]))
    norms = norms_in(metric, v_all)
    if not norms.max() > run.rounding(run.states):
        return Resolution()
    # The start, and the fastest state of equal parts of the run: modes are fast where the motion is.
    wanted = states_to_examine(run.steps, stepper.method.tableau.stages, run.model.nv)
    parts = [part for part in np.array_split(np.arange(1, len(norms)), wanted - 1) if len(part)]
    chosen = [0, *(int(part[np.argmax(norms[part])]) for part in parts)]
    later = [(float(t[i]), q[i], v[i], u[i]) for i in (rows[k - 1] for k in chosen[1:])]
    examined = [(settings.t0, *begin, u[0]), *later]
    speeds = [_speed_of_motion(norms, k + 1) for k in chosen]

    def spectrum(i: int) -> Spectrum | None:
        return stepper.spectrum(*examined[i], settings.dt, directions(run.model.nv), run.moving)

    with stepper.preserved(), np.errstate(all="ignore"):  # States that have exploded overflow.
        times = [when for when, *_ in examined]
        pull = _pull(stepper, settings, examined)
        reach = float(np.abs(q_all).max(initial=0.0))
        return resolution(stepper.method, settings.dt, run.steps, times, spectrum, speeds, metric[chosen], pull, reach)


def _without_integrals(run: ExaminedRun, q: Array) -> Array:
    """Configurations (..., nq) with zeros for the integrals of states, idle coordinates: they may be large."""
    idle = np.zeros(run.model.nq, dtype=bool)
    for segment in run.model.record.segments:
        if segment.kind == "linear":
            idle[segment.q : segment.q + segment.size] = ~run.moving[segment.v : segment.v + segment.size]
    return np.where(idle, 0.0, q) if idle.any() else q


def _pull(stepper: Stepper, settings: Settings, examined: Sequence[tuple[float, Array, Array, Array]]) -> Pull:
    """The way back to the constraints by Baumgarte's gains, with how far the states t, q, v, u are from them."""
    model = stepper.model
    if not settings.gains.any():
        return Pull()
    rates = pull_rates(settings.gains, [name in model.record.speed_conditions for name in model.names.constraints])
    t, q, v, u = (np.array(x) for x in zip(*examined, strict=True))
    try:
        worst = worst_violation(model, t, (q, v, u), stepper.par)
    except SymofrosError:  # Options.functions left out what says it.
        worst = None
    return Pull(rates, min(worst.share, 1.0), worst.t) if worst is not None else Pull(rates)


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


def step_size_note(mode: Mode, method: Method, h: float, energy: str = "") -> str:
    """Note on a mode that the steps follow inaccurately or amplify.

    Args:
        mode: Mode that the run resolves worst.
        method: Stepping method.
        h: Step [s].
        energy: Energy that appeared, in words that end in a semicolon.
    """
    motion = f"{_rate(mode.rate)} (seen at t = {mode.t:.4g} s)"
    if mode.of_gains:
        motion = f"leads back to the constraints by the gains, and {motion}"
    if not mode.amplified:
        return (
            f"steps of {h:.4g} s follow a mode of the motion to {percent(mode.error)} only: {motion} with"
            f" {percent(mode.share)} of the speed; a smaller dt or an adaptive method"
        )
    limit = largest_stable_step(method, mode.rate)
    allowed = f"stable up to {limit:.4g} s" if limit > 0.0 else "stable at no step"
    return (
        f"the step of {h:.4g} s is past the limit of stability: '{method.name}' is {allowed} for the mode that"
        f" {motion}, and multiplies it by {abs(mode.factor):.4g} each step; {energy}{remedy(mode, method)}"
    )


def remedy(mode: Mode, method: Method) -> str:
    """The remedy for steps beyond the limit of stability for a mode."""
    limit = largest_stable_step(method, mode.rate)
    if limit > 0.0:
        return f"dt below {limit:.3g} s, or {'smaller gains' if mode.of_gains else 'an implicit method'}"
    return "another method, such as rk4"


def _rate(rate: complex) -> str:
    decay = f"decays at {-rate.real:.4g} 1/s" if rate.real < 0.0 else f"grows at {rate.real:.4g} 1/s"
    if abs(rate.imag) <= 1e-3 * abs(rate.real):
        return decay
    oscillation = f"oscillates at {rate.imag:.4g} rad/s"
    return oscillation if abs(rate.real) <= 1e-3 * abs(rate.imag) else f"{oscillation} and {decay}"
