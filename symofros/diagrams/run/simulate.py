"""Run a compiled diagram: parts, instants and recording in one loop of C."""

from __future__ import annotations

import time
from collections.abc import Mapping
from contextlib import closing
from dataclasses import replace
from typing import Any

import numpy as np

from symofros.diagrams.observer import NoObserver, Observer
from symofros.diagrams.program.compiled import CompiledDiagram, rates_of
from symofros.diagrams.program.lowered_block import watched
from symofros.diagrams.rates import Schedule, schedule
from symofros.diagrams.result import DiagramRun
from symofros.diagrams.run.diagnosis import Ended, diagnose
from symofros.diagrams.run.halved_steps import STEPS, halved_steps_note
from symofros.diagrams.run.loop import RECORD, Loop, Task
from symofros.diagrams.run.options import DiagramOptions
from symofros.diagrams.run.parts import place_parts, start
from symofros.diagrams.run.python_blocks import Called, ExternalCalls, begun
from symofros.diagrams.run.recording import Cost, Crossed, Records
from symofros.diagrams.run.values import parameter_values, record_interval
from symofros.runtime.calls.kernel import Array
from symofros.runtime.calls.library import CompiledKernel
from symofros.simulation.progress import bar
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.time_slice import TimeSlice


def run_compiled(
    compiled: CompiledDiagram,
    t_end: float,
    options: DiagramOptions | None = None,
    *,
    parameters: Mapping[str, Any] | None = None,
    progress: bool = False,
    observer: Observer | None = None,
    **changes: Any,
) -> DiagramRun:
    """Run a compiled diagram from its first state.

    Args:
        compiled: Diagram as `compile_diagram` returns it.
        t_end: End time [s].
        options: Options of stepping, constraints, recording and pace; those of `DiagramOptions()` by default.
        parameters: Run-time parameters by name, such as {"pd.kp": [100, 80, 50], "plant.m_load": 0.8}.
        progress: Show a progress bar.
        observer: Receiver of the records while the run goes on, which may stop it by time.
        changes: Fields of DiagramOptions by name, which replace those of `options`: method="dopri5", dt=1e-4, ...

    Raises:
        SymofrosError: The options contradict each other, or name what the diagram lacks.
        UnknownNameError: A field is not one of DiagramOptions.
        AssemblyError: The first state does not meet the constraints.
    """
    resolved, name = compiled.resolved, compiled.resolved.wired.name
    options = (options or DiagramOptions()).changed(changes)
    par = parameter_values(resolved, parameters or {})
    interval = record_interval(options.record, options.t0, t_end, options.dt)
    plan = schedule([*rates_of(resolved.pieces), (RECORD, interval, 0.0)], name)
    with begun(resolved.wired) as called:
        run, evident = _once(compiled, plan, options, t_end, par, called, progress, observer)
        run = replace(run, kept=called.kept())
    external = any(piece.is_external for piece in resolved.pieces.values())
    steps = run.cost.steps // max(1, len(compiled.parts))
    if run.outcome.kind != "finished" or evident or not 0 < steps <= STEPS or external or not resolved.layout.v:
        return run
    h = min(options.settings(compiled.parts[0], t_end).dt, plan.spacing)
    with begun(resolved.wired) as called:
        half, _ = _once(compiled, plan, replace(options, dt=0.5 * h, realtime=False), t_end, par, called)
    finer = (half.t, half.q, half.v) if half.outcome.ok else None
    note = halved_steps_note(resolved.layout, (run.t, run.q, run.v), finer, h)
    return replace(run, outcome=replace(run.outcome, notes=(*run.outcome.notes, *([note] if note else []))))


def _once(
    compiled: CompiledDiagram,
    plan: Schedule,
    options: DiagramOptions,
    t_end: float,
    par: Array,
    called: Called,
    progress: bool = False,
    observer: Observer | None = None,
) -> tuple[DiagramRun, bool]:
    """A run from the first state, and whether its steps evidently resolve it."""
    resolved = compiled.resolved
    parts = place_parts(compiled, lambda model: options.settings(model, t_end), par)
    external = ExternalCalls(resolved, called)
    loop = Loop(
        resolved.layout,
        [part.stepper for part in parts],
        plan,
        _tasks(compiled, plan, external),
        [Task(_kernel(compiled, f"crossed_{i}")) for i in range(len(watched(resolved.pieces)))],
        par,
        np.array(resolved.layout.u0, dtype=np.float64),
        external,
        compiled.reads_accelerations,
    )
    with closing(loop):
        start(parts, resolved, par, options.t0)
        return _drive(compiled, loop, plan, options, t_end, par, progress, observer or NoObserver())


def _tell(observer: Observer, compiled: CompiledDiagram, loop: Loop, states: list[Array], par: Array) -> None:
    """Tell an observer what was recorded; the clock of a run in real time stands still meanwhile."""
    began = time.perf_counter()
    t, q, v, u = states
    portion = Records(compiled, t, q, v, u, par)
    portion.compute(list(map(compiled.resolved.wired.output, observer.signals)))
    observer.see(float(loop.diagram.t[0]), portion.t, {name: portion[name] for name in observer.signals})
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


def _drive(
    compiled: CompiledDiagram,
    loop: Loop,
    plan: Schedule,
    options: DiagramOptions,
    t_end: float,
    par: Array,
    progress: bool,
    observer: Observer,
) -> tuple[DiagramRun, bool]:
    t0, realtime = options.t0, float(options.realtime)
    span = float(plan.base) * plan.cycle
    instants = int((t_end - t0) / span + 2) * len(plan.instants)
    loop.start(t0, t_end, realtime, options.threads, instants)
    portions: list[list[Array]] = []
    met: list[tuple[float, int]] = []
    status, interrupted = int(Status.RUNNING), False
    time_slice = TimeSlice()
    began, worked = time.perf_counter(), time.thread_time()
    with bar(progress, t0, t_end) as show:
        try:
            while status in (Status.RUNNING, Status.RECORDS_FULL):
                instants = min(time_slice.steps, loop.instants_until(observer.stop()))
                status = time_slice.measure(loop.advance, instants)
                states, crossed = loop.take()
                portions.append(states)
                met += crossed
                show(float(loop.diagram.t[0]))
                _tell(observer, compiled, loop, states, par)
        except KeyboardInterrupt:
            interrupted = True
            portions.append(loop.take()[0])
    seconds, worked = time.perf_counter() - began, time.thread_time() - worked
    if isinstance(loop.failure, KeyboardInterrupt):
        interrupted = True
    t, q, v, u = (np.concatenate(columns) for columns in zip(*portions, strict=True))
    settings = [options.settings(part.model, t_end) for part in loop.parts]
    ended = Ended(loop, compiled.resolved, par, settings, plan.spacing, (t, q, v, u), status, interrupted)
    bendings = ended.bendings
    outcome, evident = diagnose(ended, bendings)
    looked_for = watched(compiled.resolved.pieces)
    crossings = tuple(Crossed(*looked_for[which], when) for when, which in met)
    d = loop.diagram
    cost = Cost(
        int(d.steps),
        int(d.rejected),
        int(d.evaluations),
        seconds,
        worked,
        loop.lateness,
        plan.spacing / (realtime or 1.0),
    )
    return DiagramRun(compiled, t, q, v, u, par, outcome, crossings, cost, bendings), evident
