"""sf.simulate: a model, a first state, inputs, a method -> a Trajectory."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from itertools import accumulate
from typing import Any

import numpy as np

from symofros.base.arguments import checked
from symofros.base.arrays import Array
from symofros.base.threads import ending_together, submit
from symofros.runtime.beams import BeamBending
from symofros.runtime.calls import native_library, native_library_is_loaded
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.actions import refuse_actions
from symofros.simulation.events import event_notes, events_of
from symofros.simulation.inputs import Inputs, plan_inputs
from symofros.simulation.options import USUAL, SimulationOptions
from symofros.simulation.prescribed_motions import contradiction, recorded_notes, refuse_contradiction
from symofros.simulation.progress import bar
from symofros.simulation.results.acted import failure_of, found_of, notes_of
from symofros.simulation.results.ends import unexamined
from symofros.simulation.results.examination.diagnosis import diagnose, too_long
from symofros.simulation.results.examination.switched_run import SwitchedRun, switched_run_note
from symofros.simulation.results.notes import distinct, of_steps
from symofros.simulation.results.outcome import Outcome
from symofros.simulation.results.trajectory import Found, Statistics, Trajectory
from symofros.simulation.settings import Settings, check_fit, check_start, first_configuration, vector
from symofros.simulation.stepping.loops import run_to_end
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper


@checked
def simulate(
    model: Model,
    q0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    t_end: float = 1.0,
    *,
    z0: ArrayLike | None = None,
    u: Inputs | None = None,
    par: ArrayLike | None = None,
    events: Mapping[str, Any] | None = None,
    options: SimulationOptions | None = None,
    progress: bool | Callable[[float], None] = False,
    **changes: Any,
) -> Trajectory:
    """Move a model from a state through time; the stepping loop is C.

    Args:
        model: Compiled with backend "c".
        q0: First configuration (nq), or values by name, on the constraints (see `assemble`); the neutral one by
            default.
        v0: First speeds (nv), or values by name; rest by default.
        t_end: End time [s].
        z0: First states of forces (nz), or values by name; the neutral ones, zeros, by default.
        u: Inputs: an array (nu), a Signal of all, a mapping from input names to numbers, formulas (of coordinates,
            speeds, parameters and t, compiled to C) and Signals, or a function (t, q, v) -> (nu), called from the loop
            and hence slow; after a run of fixed steps, but not in real time, it is called about a few states again, and
            where it gives the same, a short run in doubt is made once more with half the step.
            Those not given are zero, but for the rates of a prescribed motion that is a formula of t.
        par: Run-time parameters (npar), or values by name; the model's own by default.
        events: Name -> formula or Event, after those of the description; one of the same name stands in its place, and
            None leaves it out.
        options: Options of stepping, stabilisation and recording; those of `SimulationOptions()` by default.
        progress: Show a progress bar; or a function that is called with the time reached [s], now and then.
        changes: Fields of SimulationOptions by name, which replace those of `options`: method="dopri5", dt=1e-4, ...

    Returns:
        The Trajectory; its `outcome` says how the run ended. What went wrong in motion is an outcome, not an
        exception, so that the part before it is kept; so does Ctrl-C.

    Raises:
        ShapeError: An array does not fit, or a quaternion is no rotation.
        UnknownNameError: The name of an option, an input or in a formula is unknown.
        AssemblyError: The first state does not meet the constraints.
        SymofrosError: The options contradict each other, or inputs that prescribe a motion.
    """
    settings = Settings.of(model, (options or USUAL).changed(changes), t_end)
    stated, model = model, model.carried.with_precision("double")
    q0, v0 = stated.carry(q0, v0, z0)
    values = model.parameter_values
    if par is not None:
        values = vector(model, "par", model.checked_parameters(par), model.npar)
    q = first_configuration(model, q0)
    v = np.zeros(model.nv) if v0 is None else vector(model, "v0", v0, model.nv)
    looked_for = events_of(model, events)
    inputs = plan_inputs(stated, u)
    check_fit(model, settings, inputs)
    if settings.method.family.multistep:
        refuse_actions(looked_for, f"simulation by '{settings.method.name}'", "method='rodas4', or 'dopri5'")
        model.record.refuse_sticking(f"simulation by '{settings.method.name}'")
    prepare_run(model, settings)
    stepper = Stepper(model, settings.method, inputs, looked_for, values)
    stepper.set_instant(settings.instant)
    settings.apply(stepper)
    span = settings.t0, settings.t_end
    refuse_contradiction(contradiction(model, inputs, lambda at: stepper.inputs_at(at, q, v), span))
    check_start(model, settings, q, v, stepper.inputs_at(settings.t0, q, v), np.asarray(values))
    with bar(progress, settings.t0, t_end) as show:
        return run_to_its_end(stepper, settings, q, v, show).of(stated)


def run_to_its_end(
    stepper: Stepper,
    settings: Settings,
    q: Array,
    v: Array,
    show: Callable[[float], None] = lambda t: None,
) -> Trajectory:
    """Run a prepared stepper to its end; returns the trajectory with its outcome.

    At actions of events the motion begins anew (docs/theory/simulation.md, section 2).

    Args:
        stepper: Stepper to which the settings were applied.
        settings: Settings of the run.
        q: First configuration (nq).
        v: First speeds (nv).
        show: Called with the time reached [s], now and then.
    """
    phases, whole, ended, start = list[_Phase](), settings, False, (q, v, stepper.par)
    while not ended:
        phase, which = _phase(stepper, settings, q, v, show)
        repeats = settings.every and phases and not phases[-1].acted
        phases.append(phase.without_first() if repeats else phase)
        phase = phases[-1]
        acts = phase.outcome.kind == "event" and any(stepper.events[i].acts for i in which)
        if acts:
            ended = _act(stepper, phases)
        elif phase.outcome.kind != "finished" or stepper.t >= whole.t_end:
            break
        t, q, v = stepper.state
        steps, records = (sum(counts) for counts in zip(*(phase.counts for phase in phases), strict=True))
        settings = whole.onwards(t, steps, records)
        settings.apply(stepper)
    return _held_as_a_whole(_joined(stepper, phases), stepper, phases, whole, start)


def _held_as_a_whole(
    run: Trajectory, stepper: Stepper, phases: Sequence[_Phase], settings: Settings, start: tuple[Array, Array, Array]
) -> Trajectory:
    """A run with the note on what its events make of errors, where nothing is said of steps.

    Args:
        run: The run.
        stepper: Its stepper.
        phases: Its parts.
        settings: Settings of the whole.
        start: Initial q, v, and the run-time parameters (npar).
    """
    acted, outcome = sum(phase.acted for phase in phases), run.outcome
    if stepper.actions is None or outcome.kind not in ("finished", "event", "singular", "not converged"):
        return run
    left_out = int(acted > 0 and not phases[-1].statistics.steps)  # What the actions of a terminal event leave.
    states = [x[: len(x) - left_out] for x in (run.t, run.q, run.v, run.u)]
    fields: dict[str, Any] = {"par": start[2], "parts": 1 + acted, "stopped": outcome.kind == "event"}
    whole = SwitchedRun(stepper, settings, start[:2], states, run.statistics.steps, **fields)
    try:
        if not outcome.ok:
            return replace(run, outcome=too_long(whole, outcome)) if acted else run
        note = "" if of_steps(outcome.notes) else switched_run_note(whole)
    except KeyboardInterrupt:
        return replace(run, outcome=unexamined(0, outcome.t, outcome.notes)) if outcome.ok else run
    return replace(run, outcome=replace(outcome, notes=(*outcome.notes, note))) if note else run


def _act(stepper: Stepper, phases: list[_Phase]) -> bool:
    """Do the actions that the last phase has come to; whether the run ends with them."""
    phase, (status, met) = phases[-1], stepper.act()
    phase.met[len(phase.met) - len(met) :] = [found_of(stepper, one) for one in met]
    phase.notes += tuple(note for one in met for note in notes_of(stepper, one))
    if status < 0:
        phase.outcome = next(failure for one in met if (failure := failure_of(stepper, one)) is not None)
        return True
    phase.acted = True
    if status == Status.TERMINAL_EVENT:
        phases.append(_after(phase, stepper))
    return status == Status.TERMINAL_EVENT


@dataclass
class _Phase:
    """A part of a run without actions within it.

    Attributes:
        states: Its records: t (n), q (n, nq), v (n, nv), u (n, nu).
        par: Run-time parameters (npar).
        outcome: How it ended.
        met: Events met.
        statistics: Cost.
        bendings: Largest bending of each beam so far.
        notes: Remarks on the actions at its end.
        acted: Whether there were any.
    """

    states: list[Array]
    par: Array
    outcome: Outcome
    met: list[Found]
    statistics: Statistics
    bendings: tuple[BeamBending, ...]
    notes: tuple[str, ...] = ()
    acted: bool = False

    @property
    def counts(self) -> tuple[int, int]:
        """Numbers of steps and records."""
        return self.statistics.steps, len(self.states[0])

    def without_first(self) -> _Phase:
        """The same without a first record that is the last of the phase before."""
        return replace(self, states=[x[1:] for x in self.states])


def _phase(
    stepper: Stepper, settings: Settings, q: Array, v: Array, show: Callable[[float], None]
) -> tuple[_Phase, list[int]]:
    """Run to the end or to the next action, and examine that; indices of the events met at its last instant."""
    began, worked = time.perf_counter(), time.thread_time()
    recorded = run_to_end(stepper, q, v, settings, show)
    seconds, worked = time.perf_counter() - began, time.thread_time() - worked
    states = recorded.arrays()
    bendings: tuple[BeamBending, ...] = ()
    try:
        outcome, bendings = diagnose(stepper, recorded, states, settings, (q, v))
        outcome = replace(outcome, notes=(*outcome.notes, *event_notes(stepper.run, stepper.events)))
        if stepper.inputs.callback is not None:
            notes = recorded_notes(stepper.model.record, states[0], states[3])
            outcome = replace(outcome, notes=(*outcome.notes, *notes))
    except KeyboardInterrupt:
        outcome = unexamined(recorded.status, float(states[0][-1]))
    met = [found_of(stepper, event) for event in recorded.events]
    notes = tuple(note for event in recorded.events for note in notes_of(stepper, event))  # Strikes at the start.
    phase = _Phase(states, stepper.par, outcome, met, _statistics(stepper, seconds, worked), bendings, notes)
    return phase, [which for which, when, *_ in recorded.events if when == stepper.t]


def _after(phase: _Phase, stepper: Stepper) -> _Phase:
    """The state that the actions of a terminal event leave."""
    t, q, v = stepper.state
    states = [np.array([t]), q[np.newaxis], v[np.newaxis], stepper.inputs_at(t, q, v)[np.newaxis]]
    none = replace(phase.statistics, steps=0, rejected=0, evaluations=0, jacobians=0, seconds=0.0, worked=0.0)
    return replace(phase, states=states, par=stepper.par, met=[], statistics=none, notes=(), acted=False)


def _joined(stepper: Stepper, phases: Sequence[_Phase]) -> Trajectory:
    """The run that phases make."""
    last, statistics = phases[-1], phases[0].statistics
    for phase in phases[1:]:
        statistics = statistics.and_then(phase.statistics)
    parts = zip(*(phase.states for phase in phases), strict=True)
    t, q, v, u = (np.concatenate(arrays) for arrays in parts) if len(phases) > 1 else last.states
    outcome, met = last.outcome, tuple([found for phase in phases for found in phase.met])
    if len(phases) > 1 or last.notes:
        notes = distinct(note for phase in phases for note in (*phase.outcome.notes, *phase.notes))
        reason = outcome.reason.replace(f"{last.statistics.steps} steps", f"{statistics.steps} steps")
        outcome = replace(outcome, notes=notes, reason=reason)
    firsts = accumulate(len(phase.states[0]) for phase in phases[:-1])
    pairs = zip(firsts, phases, phases[1:], strict=False)
    changes = tuple([(first, after.par) for first, before, after in pairs if before.acted])
    par = np.array(phases[0].par)
    z = stepper.model.states_of(v)
    return Trajectory(stepper.model, t, q, v, u, par, outcome, met, statistics, last.bendings, changes, z)


def prepare_run(model: Model, settings: Settings | None = None) -> None:
    """Compile the functions of a run and its diagnosis in parallel; the integrator is compiled once per machine.

    Args:
        model: Model.
        settings: Settings of the run; those by default if not given.
    """
    settings = settings or Settings.of(model, USUAL, 1.0)
    names = ["forward_dynamics", *settings.method.family.functions, "kinetic_energy"]
    names += ["project", "constraint"] if model.nc else []
    names += ["dynamics"] if settings.judged else []
    if native_library_is_loaded():  # A thread would take longer than a short run.
        model.prepare(*names)
        return
    with ThreadPoolExecutor(1) as pool, ending_together():
        integrator = submit(pool, native_library)
        model.prepare(*names)
        integrator.result()


def _statistics(stepper: Stepper, seconds: float, worked: float) -> Statistics:
    run = stepper.run
    paced = max(1, int(run.paced_steps))
    ranks = (int(run.rank_min), int(run.rank_max)) if stepper.model.nc else (-1, -1)
    return Statistics(
        stepper.method.name,
        int(run.steps),
        int(run.rejected),
        int(run.evaluations),
        int(run.jacobians),
        seconds,
        int(run.late_steps),
        float(run.late_max),
        float(run.late_sum) / paced,
        *ranks,
        worked,
    )
