"""One run of a compiled diagram by native/diagrams/diagram.c: memory, tasks of instants, records."""

from __future__ import annotations

import math
import sys
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.program.layout import Layout, Place
from symofros.diagrams.rates import Schedule
from symofros.diagrams.run.python_blocks import ExternalCalls
from symofros.errors import CompileError
from symofros.runtime.calls import CompiledKernel, NativeMemory, native_library
from symofros.simulation.stepping.met import Met
from symofros.simulation.stepping.stepper import Stepper

# Name of the recording of an instant in a schedule.
RECORD = "(record)"
# Rows of records in C, which are taken between two calls.
_ROWS = 4096
# Share of a number of ticks that is rounding of a time.
_ROUNDING = 1e-12
_BLOCK_CALLBACK = "int32_t(void *, int32_t, double, const double *, double *)"


@dataclass(frozen=True)
class Task:
    """A function that is evaluated at an instant.

    Attributes:
        kernel: The function.
        callback: Index of the external block that takes its output; -1: the outputs are the new u (and q, v).
    """

    kernel: CompiledKernel
    callback: int = -1


class Loop:
    """One run of one diagram.

    Args:
        layout: Layout of the diagram's vectors.
        parts: A stepper for each part, started.
        schedule: Schedule of the instants; RECORD is among the members of its sets.
        tasks: Tasks of each set of the schedule.
        crossings: Task of each crossing.
        begin: Task at the start, if there is one.
        par: Run-time parameters (npar).
        u0: Initial inputs, with all that is held between samples (nu).
        external: Calls of the external blocks.
        reads_accelerations: Whether tasks read accelerations and multipliers of the instant.

    Attributes:
        diagram: The sym_diagram: state, counters, records.
        failure: Exception that an external block raised; it ended the run.
        failed_block: Name of the block that raised it.
        fault: Message that names the first output of an external block that was not finite.
    """

    def __init__(
        self,
        layout: Layout,
        parts: Sequence[Stepper],
        schedule: Schedule,
        tasks: Sequence[Sequence[Task]],
        crossings: Sequence[Task],
        begin: Sequence[Task],
        par: Array,
        u0: Array,
        external: ExternalCalls,
        reads_accelerations: bool,
    ) -> None:
        self.native, self.parts = native_library(), parts
        self._memory = NativeMemory()
        self._ffi = self._memory.ffi
        self._external, self._par = external, par
        self.failure: BaseException | None = None
        self.failed_block = self.fault = ""
        self.diagram = self._ffi.new("sym_diagram *")
        self.diagram.reads_accelerations = int(reads_accelerations)
        self._fill_point(layout, u0)
        self._fill_parts(layout)
        self._fill_schedule(schedule, tasks)
        self.diagram.n_crossings, self.diagram.crossing_tasks = len(crossings), self._tasks(crossings)
        if begin:
            self.diagram.begin_task = self._tasks(begin)
        self._fill_records()
        self.diagram.callback = self._memory.callback(_BLOCK_CALLBACK, self._call_block)

    def _fill_point(self, layout: Layout, u0: Array) -> None:
        """The point at which tasks are evaluated, the signals and the locks."""
        d, memory = self.diagram, self._memory
        d.nq, d.nv, d.nu, d.nc = len(layout.q0), len(layout.v0), len(layout.u0), len(layout.condition_names)
        d.q, d.v, d.t = memory.doubles(layout.q0), memory.doubles(layout.v0), memory.zeros(1)
        d.u, d.a, d.lam = memory.doubles(u0), memory.zeros(d.nv), memory.zeros(d.nc)
        signals = [
            (i, int(linear), len(t), memory.doubles(t), memory.doubles(values))
            for i, t, values, linear in layout.signals
        ]
        d.n_signals, d.signals = len(signals), memory.own("sym_signal[]", signals)
        d.n_locks, d.lock_inputs = len(layout.lock_inputs), memory.own("int32_t[]", layout.lock_inputs)
        d.lock_values = memory.doubles(u0[layout.lock_inputs])

    def _fill_parts(self, layout: Layout) -> None:
        """The parts, which read the inputs of the diagram: these are held between instants."""
        d, memory = self.diagram, self._memory
        for stepper in self.parts:
            stepper.system.u_constant = d.u
        d.n_parts, d.parts = len(self.parts), memory.own("sym_run *[]", [stepper.run for stepper in self.parts])
        d.q_offset = memory.own("int32_t[]", [part.q.start for part in layout.parts])
        d.v_offset = memory.own("int32_t[]", [part.v.start for part in layout.parts])
        d.c_offset = memory.own("int32_t[]", [part.conditions.start for part in layout.parts])
        d.n_kept, d.kept = len(layout.kept_rows), memory.own("sym_kept[]", layout.kept_rows)

    def _fill_schedule(self, schedule: Schedule, tasks: Sequence[Sequence[Task]]) -> None:
        d, memory = self.diagram, self._memory
        d.base_numerator, d.base_denominator = float(schedule.base.numerator), float(schedule.base.denominator)
        d.cycle_ticks, d.n_instants = schedule.cycle, len(schedule.instants)
        d.instant_tick = memory.own("int64_t[]", [tick for tick, _ in schedule.instants])
        d.instant_set = memory.own("int32_t[]", [index for _, index in schedule.instants])
        sets = [
            (len(of_set), int(RECORD in due), self._tasks(of_set))
            for due, of_set in zip(schedule.sets, tasks, strict=True)
        ]
        d.task_sets = memory.own("sym_task_set[]", sets)

    def _tasks(self, tasks: Sequence[Task]) -> Any:
        """A C array of tasks, bound to the diagram's point."""
        array = self._memory.own("sym_task[]", len(tasks))
        for i, task in enumerate(tasks):
            array[i].callback = task.callback
            self._memory.bind(array[i].call, task.kernel, self._par)
            if not self.native.sym_diagram_bind(self.diagram, self._ffi.addressof(array[i], "call")):
                raise CompileError(f"the diagram does not know every input of '{task.kernel.signature.name}'")
        return array

    def _fill_records(self) -> None:
        d, memory = self.diagram, self._memory
        d.capacity = _ROWS
        self._records = memory.table(d, "record_", _ROWS, t=1, q=d.nq, v=d.nv, u=d.nu)

    def _call_block(self, _data: Any, block: int, t: float, inputs: Any, u: Any) -> int:
        """Call an external block and write its outputs into u; its exception is stored and ends the run."""
        try:
            given = self._memory.view(inputs, self._external.input_sizes[block]).copy()
            outputs = self._external.call(block, t, given)
            if not (self.fault or np.isfinite(outputs).all()) and np.isfinite(given).all():
                self.fault = self._external.fault(block, t, outputs)
            into, first = self._memory.view(u, self.diagram.nu), 0
            for place in self._external.output_places[block]:
                into[place.slice] = outputs[first : first + place.size]
                first += place.size
        except BaseException as error:  # It may not pass through C.
            self.failure, self.failed_block = error, self._external.names[block]
            return 1
        return 0

    def start(
        self, t0: float, t_end: float, realtime: float, threads: int, instants: int, after: float | None = None
    ) -> None:
        """Place the run at its start, with memory for the lateness of `instants` instants in real time.

        Args:
            t0: Time from which instants are counted [s].
            t_end: End time [s].
            realtime: Seconds of motion a second; 0: as fast as possible.
            threads: Number of threads that share the parts.
            instants: Number of instants in all.
            after: Time from which the run goes on; an instant then is over [s].
        """
        d = self.diagram
        d.t0, d.t_end = t0, t_end
        d.realtime_scale = 1.0 / realtime if realtime else 0.0
        d.lateness_capacity = instants if realtime else 0
        self._lateness = np.zeros(max(1, d.lateness_capacity))
        d.lateness = self._memory.shared(self._lateness)
        if threads > 1 and d.n_parts > 1 and not d.n_crossings:
            self.native.sym_diagram_start_threads(d, min(threads, d.n_parts))
        self.native.sym_diagram_start(d)
        if after is not None:
            d.begun = 1
            ticks = [int(d.instant_tick[i]) for i in range(d.n_instants)]
            over = (after - t0) * float(d.base_denominator / d.base_numerator)
            d.cycle, rest = divmod(math.floor(over + _ROUNDING * max(1.0, over)), d.cycle_ticks)
            d.next_instant, d.t[0] = bisect_right(ticks, rest), after
            if d.next_instant == len(ticks):
                d.next_instant, d.cycle = 0, d.cycle + 1

    def close(self) -> None:
        """Stop the threads."""
        self.native.sym_diagram_stop_threads(self.diagram)

    def advance(self, instants: int) -> int:
        """Advance the run by at most `instants` sampling instants; returns a Status."""
        return int(self.native.sym_diagram_advance(self.diagram, instants))

    def instants_until(self, t: float) -> int:
        """The number of instants from the next one up to the first that is not before t [s]; at least one."""
        d = self.diagram
        if not math.isfinite(t):
            return sys.maxsize
        base = float(d.base_numerator) / float(d.base_denominator)
        ticks = [int(d.instant_tick[i]) for i in range(d.n_instants)]
        cycles, rest = divmod(math.ceil((t - float(d.t0)) / base - 1e-9), int(d.cycle_ticks))
        before = cycles * len(ticks) + bisect_left(ticks, rest)
        return max(1, before + 1 - self.instants_done)

    @property
    def instants_done(self) -> int:
        """Number of instants that were executed."""
        d = self.diagram
        return int(d.cycle) * int(d.n_instants) + int(d.next_instant)

    def view(self, pointer: Any, size: int) -> Array:
        """The doubles behind a pointer of the diagram (size), not copied."""
        return self._memory.view(pointer, size)

    @property
    def held(self) -> Array:
        """The inputs that are held between samples (nu)."""
        return self._memory.view(self.diagram.u, self.diagram.nu).copy()

    def put(self, places: Iterable[Place], values: Array) -> None:
        """Copy the entries at some places from values (nu) into the inputs."""
        u = self._memory.view(self.diagram.u, self.diagram.nu)
        for place in places:
            u[place.slice] = values[place.slice]

    @property
    def t(self) -> float:
        """Time reached [s]."""
        return float(self.diagram.t[0])

    def take_records(self) -> list[Array]:
        """The records since the last call: t (n), q (n, nq), v (n, nv), u (n, nu); their rows are reused."""
        n = int(self.diagram.n_records)
        self.diagram.n_records = 0
        t, q, v, u = (array[:n].copy() for array in self._records)
        return [t[:, 0], q, v, u]

    def take_events(self) -> list[Met]:
        """The events since the last call; their rows are reused. Where some are located, all that moves is one part."""
        return [met for stepper in self.parts for met in stepper.take_events()]

    @property
    def lateness(self) -> Array:
        """Lateness of each instant's beginning in real time (n) [s]."""
        return self._lateness[: int(self.diagram.n_lateness)].copy()
