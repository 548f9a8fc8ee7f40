"""Run a compiled diagram: parts, instants and recording in one loop of C."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from symofros.base.arguments import checked
from symofros.base.arrays import Array
from symofros.diagrams.inlets import not_given, open_inlets
from symofros.diagrams.observer import NoObserver, Observer
from symofros.diagrams.program.compiled import CompiledDiagram, Resolved, rates_of
from symofros.diagrams.program.layout import Place
from symofros.diagrams.program.lowered_block import watched
from symofros.diagrams.rates import Schedule, schedule
from symofros.diagrams.result import DiagramRun
from symofros.diagrams.run.examination.controllers import Rerun, RerunSpan, blamed
from symofros.diagrams.run.examination.deep_contacts import contact_notes
from symofros.diagrams.run.examination.diagnosis import Ended, diagnose
from symofros.diagrams.run.examination.examined import Energies, Examined
from symofros.diagrams.run.examination.faults import signal_notes, signals_of
from symofros.diagrams.run.examination.prescribed import judge_prescribed
from symofros.diagrams.run.examination.remarks import remarks
from symofros.diagrams.run.loop import RECORD, Loop, Task
from symofros.diagrams.run.met import acted_at, crossings_of, events_of
from symofros.diagrams.run.parts import Placed, place_parts, start_parts
from symofros.diagrams.run.python_blocks import Called, CalledBefore, ExternalCalls, NotKeptError, begun
from symofros.diagrams.run.recording import Cost, Records
from symofros.diagrams.run.starts import Start
from symofros.diagrams.run.values import diagram_options, parameter_values, part_settings, record_interval
from symofros.diagrams.wiring import Source
from symofros.errors import DescriptionError, SymofrosError
from symofros.runtime.beams import BeamBending
from symofros.runtime.calls import CompiledKernel
from symofros.runtime.model import Model
from symofros.simulation.analysis.sliding import contact_dynamics
from symofros.simulation.options import SimulationOptions
from symofros.simulation.progress import bar
from symofros.simulation.results.ends import unexamined
from symofros.simulation.results.examination.paths import Numbers
from symofros.simulation.results.examination.switched_motion import tolerances
from symofros.simulation.results.outcome import Outcome
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.loops import Recorded, drive
from symofros.simulation.stepping.methods import METHODS
from symofros.simulation.stepping.status import Status

# What external blocks gave, by block and time.
Given = dict[tuple[str, float], dict[str, Array]]


@checked
def run_compiled(
    compiled: CompiledDiagram,
    t_end: float,
    options: SimulationOptions | None = None,
    *,
    parameters: Mapping[str, Any] | None = None,
    starts: Mapping[str, Any] | None = None,
    threads: int = 1,
    progress: bool | Callable[[float], None] = False,
    observer: Observer | None = None,
    **changes: Any,
) -> DiagramRun:
    """Run a compiled diagram from its first state.

    Args:
        compiled: Diagram as `compile_diagram` returns it.
        t_end: End time [s].
        options: Options of stepping, constraints, recording and pace; those of `SimulationOptions()` by default;
            methods are explicit.
        parameters: Run-time parameters by name, such as {"pd.kp": [100, 80, 50], "plant.m_load": 0.8}.
        starts: First values of states by name, in place of the diagram's, such as {"plant.q1": 0.3, "filter.s": 0.0}.
        threads: Number of threads that share the parts that meet at samples only; results do not depend on it.
        progress: Show a progress bar; or a function that is called with the time reached [s], now and then.
        observer: Receiver of the records while the run goes on, which may stop it by time.
        changes: Fields of SimulationOptions by name, which replace those of `options`: method="dopri5", dt=1e-4, ...

    Raises:
        SymofrosError: The options contradict each other, or name what the diagram lacks.
        UnknownNameError: A field is not one of SimulationOptions, or there is no such parameter or state.
        AssemblyError: The first state does not meet the constraints.
        DescriptionError: The diagram has inlets, and it was resolved without inputs.
    """
    resolved, name = compiled.resolved, compiled.resolved.wired.name
    if still_open := open_inlets(resolved.wired.blocks):
        raise DescriptionError([not_given(name, inlet.name) for inlet in still_open])
    options = diagram_options(options, changes)
    par = parameter_values(resolved, parameters or {})
    task = PlannedRun(compiled, recording_plan(resolved, options, t_end), options, t_end, par, threads)
    return run_planned(task, Start.of(resolved, options.t0, par, starts), progress, observer)


def recording_plan(resolved: Resolved, options: SimulationOptions, t_end: float) -> Schedule:
    """The instants of a run: those of its blocks, and those that are recorded."""
    interval = record_interval(options.output, options.t0, t_end, options.dt)
    return schedule([*rates_of(resolved.pieces), (RECORD, interval, 0.0)], resolved.wired.name)


def run_planned(
    task: PlannedRun,
    begin: Start,
    progress: bool | Callable[[float], None] = False,
    observer: Observer | None = None,
) -> DiagramRun:
    """Run from a first state, and examine the run."""
    with begun(task.compiled.resolved.wired) as called:
        ended = run_from(task, begin, called, progress, observer)
        kept = called.kept()
    return examined_run(task, ended, called.given, kept)


def examined_run(task: PlannedRun, ended: Ended, given: Given, kept: Mapping[str, Mapping[str, Array]]) -> DiagramRun:
    """A run from the first state that has ended, its outcome examined."""
    resolved, bendings = task.compiled.resolved, ended.bendings
    try:
        outcome = _judged(task, ended, given, bendings)
    except KeyboardInterrupt:
        outcome = unexamined(ended.recorded.status, ended.t, (*ended.start_notes, *resolved.notes))
    return _recorded(task, ended, outcome, bendings, kept)


def _judged(task: PlannedRun, ended: Ended, given: Given, bendings: tuple[BeamBending, ...]) -> Outcome:
    """What is found of a run that has ended; arguments as of `examined_run`, and the bending of its beams."""
    resolved, options, par = task.compiled.resolved, task.options, task.par
    t, q, v, u = ended.states
    records = Records(task.compiled, t, q, v, u, par)

    def signal(source: Source) -> Array:
        return records[".".join(source)]

    again = _rerun(task, ended, given)
    outcome, modes = diagnose(ended, bendings, again)
    outcome = replace(outcome, notes=(*ended.start_notes, *resolved.notes, *outcome.notes))
    if outcome.kind in ("finished", "event") and not options.realtime:
        notes = remarks(_examined(task, ended, given), modes, signal)
        outcome = replace(outcome, notes=(*outcome.notes, *notes))
    outcome = blamed(outcome, resolved, again)
    outcome = judge_prescribed(outcome, resolved, records.t, signal)
    deep = contact_notes(resolved, resolved.layout.present(par, u), (t, q, v), signal)
    unseen = signal_notes(t, signals_of(records)) if outcome.ok and not ended.loop.fault else ()
    return replace(outcome, notes=(*outcome.notes, *deep, *unseen))


@dataclass(frozen=True)
class PlannedRun:
    """A run before it starts.

    Attributes:
        compiled: Diagram.
        plan: Schedule of the instants.
        options: Options.
        t_end: End time [s].
        par: Run-time parameters (npar).
        threads: Number of threads that share the parts.
        hold: Entries of u that keep the values they begin with, whatever their blocks give.
    """

    compiled: CompiledDiagram
    plan: Schedule
    options: SimulationOptions
    t_end: float
    par: Array
    threads: int = 1
    hold: tuple[Place, ...] = ()

    def settings(self, model: Model) -> Settings:
        """Settings of a part."""
        return part_settings(self.options, model, self.t_end)


def _examined(task: PlannedRun, ended: Ended, given: Given) -> Examined:
    """A run as its steps are judged."""
    layout, parts, states, met = ended.layout, task.compiled.parts, ended.states, ended.recorded.events
    settings = ended.settings[0] if ended.settings else None
    h = 0.0 if settings is None or settings.adaptive else min(settings.dt, ended.spacing)

    def repeat(first: int, t_end: float, refinements: int, method: str | None = None) -> Sequence[Array] | None:
        o = task.options
        once = replace(o, realtime=False, method=method or o.method, adaptive=False if method else o.adaptive)
        if (refinements or method) and h:
            once = replace(once, dt=0.5**refinements * h)
        elif refinements:
            rtol, atol = tolerances(o.rtol, o.atol, refinements)
            # Steps that instants cut may err by far less than their tolerances, as finer ones would.
            longest = 0.5 * ended.spacing if refinements > 0 else math.inf
            once = replace(once, rtol=rtol, atol=atol, max_step=min(o.max_step, longest))
        return _resumed(replace(task, options=once, t_end=t_end, threads=1), ended, given, first)

    def accelerations(rows: Numbers) -> Array:
        t, q, v, u = (array[rows] for array in states)
        a, par = np.zeros_like(v), layout.present(ended.par, u)
        for part, model in zip(layout.parts, parts, strict=True):
            at = t, q[:, part.q], v[:, part.v], u
            a[:, part.v] = (
                contact_dynamics(model, at, par)[0] if model.nc else model.forward_dynamics(*at[1:], par=par, t=t)
            )
        return np.asarray(a)

    steps = int(ended.loop.diagram.steps) // max(1, len(parts))
    energies = Energies(ended.resolved, ended.par, task.compiled.energies)
    options, parts_met = task.options, 1 + len(met)
    method, bounds = METHODS[options.method], (options.rtol, options.atol)
    return Examined(
        energies, states, h, method, bounds, steps, repeat, accelerations, acted_at(met), parts_met, ended.spacing
    )


def _rerun(task: PlannedRun, ended: Ended, given: Given) -> Rerun:
    """Function that repeats a span of a run with other records and steps; it returns None where it can't."""
    wired = task.compiled.resolved.wired

    def again(span: RerunSpan) -> Sequence[Array] | None:
        t = ended.states[0]
        if not len(t):
            return None
        i = max(0, int(np.searchsorted(t, span.start, "right")) - 1)
        if not t[i] < span.stop:
            return None
        plan = schedule([*rates_of(task.compiled.resolved.pieces), (RECORD, span.interval, 0.0)], wired.name)
        options = replace(task.options, realtime=False, dt=span.dt)
        finer = replace(task, options=options, plan=plan, t_end=span.stop, threads=1, hold=span.hold)
        found = _continued_run(finer, ended, given, i)
        return found and found[1]

    return again


def _resumed(task: PlannedRun, before: Ended, given: Given, i: int) -> Sequence[Array] | None:
    """The records of a run that goes on from a record; None where it does not come to its end.

    Raises:
        NotKeptError: What external blocks gave is not known.
    """
    found = _continued_run(task, before, given, i)
    if found is None:
        return None
    ended, joined = found
    if isinstance(ended.loop.failure, NotKeptError):
        raise ended.loop.failure
    ends = ended.recorded.status == Status.TERMINAL_EVENT and ended.t > task.t_end - task.plan.spacing
    return joined if ended.recorded.status == Status.FINISHED or ends else None


def _continued_run(task: PlannedRun, before: Ended, given: Given, i: int) -> tuple[Ended, Sequence[Array]] | None:
    """A run continued from record i, and its states from there on; None if it fails.

    Of the records of a crossing, at one time, the last has what the crossing changed: from that the run goes on.
    """
    states = before.states
    last = int(np.searchsorted(states[0], states[0][i], "right")) - 1
    t = float(states[0][last])
    met = tuple(one for one in before.recorded.events if one.t <= t)
    q, v, u = (array[last].copy() for array in states[1:])
    begin = Start(t, q, v, u, met)
    try:
        ended = run_from(task, begin, CalledBefore(task.compiled.resolved.wired, given), resumed=True)
    except SymofrosError:
        return None
    return ended, [np.concatenate([x[i : last + 1], y]) for x, y in zip(states, ended.states, strict=True)]


def _tell(observer: Observer, compiled: CompiledDiagram, loop: Loop, states: list[Array], par: Array) -> None:
    """Send records to an observer; the clock of a real-time run stops meanwhile."""
    began = time.perf_counter()
    t, q, v, u = states
    portion = Records(compiled, t, q, v, u, par)
    portion.compute(list(map(compiled.resolved.wired.output, observer.signals)))
    observer.see(loop.t, portion.t, {name: portion[name] for name in observer.signals})
    if observer.signals:
        loop.diagram.clock_start += time.perf_counter() - began


def _kernel(compiled: CompiledDiagram, name: str) -> CompiledKernel:
    kernel = compiled.instants.kernels[name, ""]
    assert isinstance(kernel, CompiledKernel)
    return kernel


def _tasks(compiled: CompiledDiagram, plan: Schedule, external: ExternalCalls) -> list[list[Task]]:
    """Tasks of each set of the plan: external blocks in order, then all others at once."""
    index_of = {due: i for i, due in enumerate(compiled.resolved.schedule.sets)}
    tasks: list[list[Task]] = []
    for due in plan.sets:
        own = due - {RECORD}
        if not own:
            tasks.append([])
            continue
        i = index_of[own]
        callbacks = [
            Task(_kernel(compiled, f"inputs_{i}_{j}"), external.names.index(name))
            for j, name in enumerate(external.due(own))
        ]
        tasks.append([*callbacks, Task(_kernel(compiled, f"due_{i}"))])
    return tasks


def placed_loop(task: PlannedRun, begin: Start, called: Called) -> tuple[Loop, list[Placed]]:
    """The loop of a run, and its parts, placed at a state.

    Raises:
        SymofrosError: The method is implicit.
        AssemblyError: The state closes no loop.
    """
    compiled, resolved = task.compiled, task.compiled.resolved
    parts = place_parts(compiled, task.settings, task.par, begin)
    external = ExternalCalls(resolved, called)
    loop = Loop(
        resolved.layout,
        [part.stepper for part in parts],
        task.plan,
        _tasks(compiled, task.plan, external),
        [Task(_kernel(compiled, f"crossed_{i}")) for i in range(len(watched(resolved.pieces)))],
        [Task(_kernel(compiled, "begun"))] if ("begun", "") in compiled.instants.kernels else [],
        task.par,
        begin.u,
        external,
        compiled.reads_accelerations,
    )
    return loop, parts


def run_from(
    task: PlannedRun,
    begin: Start,
    called: Called,
    progress: bool | Callable[[float], None] = False,
    observer: Observer | None = None,
    *,
    resumed: bool = False,
) -> Ended:
    """Run from a state; from one that is recorded, with the instants after it."""
    compiled, plan, options, t_end, par = task.compiled, task.plan, task.options, task.t_end, task.par
    resolved, watcher = compiled.resolved, observer or NoObserver()
    loop, parts = placed_loop(task, begin, called)
    t0, realtime = options.t0, float(options.realtime)
    instants = int((t_end - t0) / (float(plan.base) * plan.cycle) + 2) * len(plan.instants)

    def most(steps: int) -> int:
        return 1 if task.hold else min(steps, loop.instants_until(watcher.stop()))

    with closing(loop):
        start_parts(parts, resolved, par, begin)
        loop.start(t0, t_end, realtime, task.threads, instants, begin.t if resumed else None)
        began, worked = time.perf_counter(), time.thread_time()
        with bar(progress, t0, t_end) as show:

            def look(recorded: Recorded) -> None:
                loop.put(task.hold, begin.u)
                show(loop.t)
                _tell(watcher, compiled, loop, recorded.states[-1], par)

            recorded = drive(loop, Recorded(), most, look)
        spent = time.perf_counter() - began, time.thread_time() - worked
    recorded.interrupted |= isinstance(loop.failure, KeyboardInterrupt)
    settings = [task.settings(part.model) for part in loop.parts]
    notes = tuple(note for part in parts for note in part.notes)
    par = resolved.layout.present(par, loop.held)
    return Ended(loop, resolved, par, settings, plan.spacing, recorded.arrays(), recorded, spent, notes)


def _recorded(
    task: PlannedRun,
    ended: Ended,
    outcome: Outcome,
    bendings: tuple[BeamBending, ...],
    kept: Mapping[str, Mapping[str, Array]],
) -> DiagramRun:
    """The DiagramRun of an ended run: records, outcome, crossings, cost and results of blocks."""
    d, (seconds, worked), met = ended.loop.diagram, ended.spent, ended.recorded.events
    crossings, events = crossings_of(task.compiled, met), events_of(task.compiled, met, ended.par)
    clock = ended.spacing / (float(task.options.realtime) or 1.0)
    counts, late = (int(d.steps), int(d.rejected), int(d.evaluations), 0), ended.loop.lateness
    cost = Cost(task.options.method, *counts, seconds, worked=worked, late=late, spacing=clock)
    t, q, v, u = ended.states
    return DiagramRun(task.compiled, t, q, v, u, ended.par, outcome, crossings, events, cost, bendings, kept)
