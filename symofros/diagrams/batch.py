"""Simulation.run_batch: a diagram run many times, with parameters, first states and inputs of each run's own."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from threading import Event
from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.base.arguments import checked
from symofros.base.arrays import Array
from symofros.diagrams.observer import NoObserver
from symofros.diagrams.program.compiled import CompiledDiagram
from symofros.diagrams.rates import Schedule
from symofros.diagrams.result import DiagramRun
from symofros.diagrams.run.examination.diagnosis import Ended
from symofros.diagrams.run.examination.prescribed import judge_prescribed
from symofros.diagrams.run.loop import RECORD
from symofros.diagrams.run.members import Members
from symofros.diagrams.run.python_blocks import begun
from symofros.diagrams.run.recording import Records
from symofros.diagrams.run.simulate import PlannedRun, recording_plan, run_from, run_planned
from symofros.diagrams.run.starts import Start
from symofros.diagrams.run.values import diagram_options
from symofros.errors import AssemblyError, BeamTheoryError, SymofrosError
from symofros.runtime.beams import largest_bending
from symofros.simulation.options import SimulationOptions
from symofros.simulation.results.ends import ENDS
from symofros.simulation.results.outcome import Outcome
from symofros.simulation.results.runs import Index, Runs
from symofros.simulation.stepping.batch_stepper import run_batch_steppers
from symofros.simulation.stepping.status import Status


@dataclass(frozen=True, repr=False)
class DiagramRuns(Runs):
    """Records of many runs of one diagram, whose batch dimensions are written (...).

    Signals are `runs["block.port"]` (..., m, *shape); NaN where a run ended before. One run is `runs[index]`, a
    DiagramRun: it is made once more, to the same bits, and examined.

    Attributes:
        members: What each run is given.
        t: Times of the records (m) [s], the same for all.
        q: Configurations (..., m, nq) of all mechanisms.
        v: Speeds and continuous states (..., m, nv).
        u: Inputs, held between samples (..., m, nu).
        status: Last status code of each (...).
        t_last: End time of each run (...) [s].
        steps: Steps taken (...), of all parts together.
        method: Name of the method.
        seconds: Wall time of all runs together [s].
        processor_seconds: Processor time of all threads together [s].
        failures: Number of a run -> why it did not begin.
    """

    members: Members
    t: Array
    q: Array
    v: Array
    u: Array
    status: npt.NDArray[np.int32]
    t_last: Array
    steps: npt.NDArray[np.int64]
    method: str
    seconds: float
    processor_seconds: float
    failures: Mapping[int, SymofrosError]
    _plan: PlannedRun
    _known: dict[str, Array] = field(default_factory=dict)

    def __getitem__(self, index: Index | str) -> Any:
        """One run, a DiagramRun; or a signal "block.port" of all (..., m, *shape).

        Raises:
            DescriptionError: There is no such output.
            SymofrosError: The run did not begin.
        """
        if isinstance(index, str):
            return self._signal(index)
        return run_planned(*_begun(self._plan, self.members, self.number(index)))

    def _signal(self, name: str) -> Array:
        if name not in self._known:
            shape = self.members.compiled.resolved.wired.shape(self.members.compiled.resolved.wired.output(name))
            found = np.full((len(self), len(self.t), *shape), np.nan)
            q, v, u = (x.reshape(len(self), len(self.t), x.shape[-1]) for x in (self.q, self.v, self.u))
            for i in range(len(self)):
                there = ~np.isnan(u[i]).all(axis=-1) if u.shape[-1] else self.t <= self.t_last.reshape(-1)[i]
                states = self.t[there], q[i][there], v[i][there], u[i][there]
                found[i, there] = Records(self.members.given(i), *states, self.members.par[i])[name]
            self._known[name] = found.reshape((*self.shape, *found.shape[1:]))
        return self._known[name]

    def outcome(self, index: Index) -> Outcome:
        """Outcome of one run; it is made once more, and examined."""
        failure = self.failures.get(self.number(index))
        if failure is not None:
            kind, problem = ENDS[int(self.status[index])].kind, failure.problems[0]
            return Outcome(kind, float(self.t_last[index]), f"{problem.what}: {problem.found}", problem.remedy)
        found: Outcome = self[index].outcome
        return found

    def __iter__(self) -> Iterator[DiagramRun]:
        """Run after run."""
        return (self[index] for index in np.ndindex(self.shape))

    def __repr__(self) -> str:
        """Diagram, method, sizes, and how the runs ended."""
        name = self.members.compiled.resolved.wired.name
        return f"<DiagramRuns of '{name}' by {self.method}: {self.shape} runs, {len(self.t)} records; {self.ends}>"

    def __str__(self) -> str:
        """Counts of outcomes, the first failure, and the first note on some of the others."""
        lines = [self.ends or "no runs", *self.first_failure()]
        for index in self.examined():
            if notes := self.outcome(index).notes:
                lines.append(f"  note, first seen in {list(index)}: {notes[0]}")
                break
        return "\n".join(lines)


@checked
def run_batch(
    compiled: CompiledDiagram,
    t_end: float,
    options: SimulationOptions | None = None,
    *,
    parameters: Mapping[str, Any] | None = None,
    starts: Mapping[str, Any] | None = None,
    inputs: Mapping[str, Any] | None = None,
    threads: int = 1,
    **changes: Any,
) -> DiagramRuns:
    """Run a compiled diagram many times; arguments as of `Simulation.run_batch`.

    Args:
        compiled: Diagram, with what one run is given for its inlets.
        t_end: End time [s].
        options: Options of stepping, as of `run_compiled`.
        parameters: Run-time parameter -> its values (..., *shape).
        starts: State -> its first values (..., *shape).
        inputs: Inlet -> what is given.
        threads: Number of threads.
        changes: Fields of SimulationOptions by name.

    Raises:
        SymofrosError: The diagram has blocks that code outside of C answers for.
    """
    chosen, resolved = diagram_options(options, changes), compiled.resolved
    chosen.refuse(("realtime",), "run_batch: an option of single runs", "runs of a batch are not paced")
    external = [name for name, piece in resolved.pieces.items() if piece.is_external]
    if external:
        what = f"diagram '{resolved.wired.name}': block '{external[0]}' in a batch"
        rule = "runs of a batch share threads in C, and a block of Python's, of a network or an imported FMU is called"
        remedy = "run(...) in a loop; or write the block of formulas"
        raise SymofrosError(what, type(resolved.wired.blocks[external[0]]).__name__, rule, remedy)
    if threads < 1:
        raise SymofrosError("run_batch: no thread", f"threads = {threads}", "threads >= 1", "leave it out")
    members = Members.of(compiled, chosen.t0, parameters, starts, inputs)
    shape, n = members.shape, len(members.par)
    plan = recording_plan(resolved, chosen, t_end)
    task = PlannedRun(compiled, plan, chosen, t_end, resolved.layout.begun(np.array(resolved.layout.par)))
    grid, layout = recorded_times(plan, chosen.t0, t_end), resolved.layout
    sizes = len(layout.q0), len(layout.v0), len(layout.u0)
    q, v, u = (np.full((n, len(grid), size), np.nan) for size in sizes)
    status, steps = np.full(n, Status.RUNNING, dtype=np.int32), np.zeros(n, dtype=np.int64)
    results = _Results(grid, q, v, u, status, np.full(n, chosen.t0), steps, np.zeros(n))
    count, began = min(threads, n), time.perf_counter()
    if n:
        run_batch_steppers([_Share(task, members, results, i, count) for i in range(count)])
    shaped = {
        name: getattr(results, name).reshape((*shape, *getattr(results, name).shape[1:]))
        for name in ("q", "v", "u", "status", "t_last", "steps")
    }
    return DiagramRuns(
        members=members,
        t=grid,
        **shaped,
        method=chosen.method,
        seconds=time.perf_counter() - began,
        processor_seconds=float(results.spent.sum()),
        failures=results.failures,
        _plan=task,
    )


def recorded_times(plan: Schedule, t0: float, t_end: float) -> Array:
    """Times at which every run that gets there is recorded, its end among them (m) [s]."""
    times = [t for t, due in plan.between(t0, t_end) if RECORD in due]
    slack = 1e-9 * float(plan.base)
    return np.array([t for t in times if t < t_end - slack] + [t_end])


@dataclass
class _Results:
    """Records of the runs, each written by its own thread: as DiagramRuns has them, in rows (n, ...).

    Attributes:
        spent: Processor time of each run (n) [s].
    """

    t: Array
    q: Array
    v: Array
    u: Array
    status: npt.NDArray[np.int32]
    t_last: Array
    steps: npt.NDArray[np.int64]
    spent: Array
    failures: dict[int, SymofrosError] = field(default_factory=dict)

    def take(self, number: int, task: PlannedRun, ended: Ended) -> None:
        """Keep the last record at each time: of an event at such a time the state after it."""
        t, slack = ended.states[0], 1e-9 * float(task.plan.base)
        rows = np.searchsorted(t, self.t + slack, "right") - 1
        there = (
            (rows >= 0) & (np.abs(t[np.maximum(rows, 0)] - self.t) <= slack) if len(t) else np.zeros_like(rows, bool)
        )
        for into, states in zip((self.q, self.v, self.u), ended.states[1:], strict=True):
            into[number, there] = states[rows[there]]
        self.status[number], self.t_last[number] = _status(task.compiled, ended), ended.t
        self.steps[number], self.spent[number] = int(ended.loop.diagram.steps), ended.spent[1]


@dataclass
class _Share(NoObserver):
    """The runs first, first + count, ... of a batch, one after the other."""

    task: PlannedRun
    members: Members
    results: _Results
    first: int
    count: int
    stop_now: Event = field(default_factory=Event)

    def run(self, stop: Event) -> None:
        """Run each to its end, or until `stop` is set."""
        self.stop_now = stop
        for number in range(self.first, len(self.members.par), self.count):
            if stop.is_set():
                return
            try:
                task, begin = _begun(self.task, self.members, number)
                with begun(task.compiled.resolved.wired) as called:
                    ended = run_from(task, begin, called, observer=self)
            except tuple(_START_FAILED) as error:
                self.results.failures[number] = error
                self.results.status[number] = _START_FAILED[type(error)]
                continue
            except SymofrosError as error:  # What no run could be given, as a single one refuses it.
                raise self.members.naming(number, error) from None
            self.results.take(number, task, ended)
            if ended.recorded.interrupted:
                stop.set()

    def see(self, t: float, times: Array, values: Mapping[str, Array]) -> None:
        """End the run where the others are ended, too."""
        if self.stop_now.is_set():
            raise KeyboardInterrupt


# How a run is said to have ended that did not begin.
_START_FAILED: dict[type[SymofrosError], Status] = {
    AssemblyError: Status.PROJECTION_FAILED,
    BeamTheoryError: Status.BEYOND_THEORY,
}


def _begun(task: PlannedRun, members: Members, number: int) -> tuple[PlannedRun, Start]:
    """One run of a batch, and its first state."""
    compiled = members.given(number)
    own = PlannedRun(compiled, task.plan, task.options, task.t_end, members.par[number])
    return own, members.begin(number, compiled)


def _status(compiled: CompiledDiagram, ended: Ended) -> int:
    """How a run ended: what is known of its beams and of rotations that wires prescribe counts, too."""
    status, resolved = int(ended.recorded.status), ended.resolved
    if ended.recorded.interrupted:
        return int(Status.RUNNING)
    if status < 0:
        return status
    worst, limits = largest_bending(ended.bendings), [settings.beam_limit for settings in ended.settings]
    if worst is not None and worst.error > min(limits):
        return int(Status.BEYOND_THEORY)
    if resolved.layout.driven:
        t, q, v, u = ended.states
        records = Records(compiled, t, q, v, u, ended.par)
        outcome = Outcome("finished", ended.t, "")
        if not judge_prescribed(outcome, resolved, t, lambda source: records[".".join(source)]).ok:
            return int(Status.CALLBACK_FAILED)
    return status
