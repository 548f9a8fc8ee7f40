"""Many trajectories of one model by native/stepping/batches/batch_stepper.c: each thread steps a share of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from threading import Event as Signal
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.base.events import Event
from symofros.errors import CompileError
from symofros.runtime.calls import CompiledKernel, LaneOptions
from symofros.runtime.model import Model
from symofros.simulation.batch_inputs import BatchInputs
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.by_hand import AHEAD
from symofros.simulation.stepping.met import Met
from symofros.simulation.stepping.stepper import Stepper

# Trajectories that are active at once: eight vectors of eight lanes; few enough for the first two levels of cache.
SLOTS = 64
# Events of one trajectory within a step that there is room for beyond a few.
_EVENT_ROWS = 1024
# Functions that trajectories call one by one.
_ONE_BY_ONE = ("project", "events", "contact_state")
# Doubles of a line of cache.
_LINE = 8
# Steps of each trajectory in one call of C, between looks at Ctrl-C.
_STEPS_PER_CALL = 64


@dataclass(frozen=True)
class InitialStates:
    """Initial states, inputs and parameters of trajectories, one row each, or one for all.

    Attributes:
        q: Configurations (n or 1, nq).
        v: Speeds (n or 1, nv).
        par: Run-time parameters (n or 1, npar).
        inputs: Inputs of all trajectories.
        n: Number of trajectories.
        t: Initial time [s].
        events: Zero crossings to locate, of each trajectory; with actions, these have parameters of their own.
    """

    q: Array
    v: Array
    par: Array
    inputs: BatchInputs
    n: int
    t: float
    events: tuple[Event, ...] = ()


@dataclass(frozen=True, repr=False)
class BatchResults:
    """Samples and last states of trajectories, written by C.

    Attributes:
        q: Configurations at the times of the samples (..., m, nq); NaN where a trajectory ended before.
        v: Speeds (..., m, nv), as q.
        u: Inputs (..., m, nu), as q.
        t_last: End time of each trajectory (...) [s].
        q_last: Last good configuration of each (..., nq).
        v_last: Last good speeds of each (..., nv).
        status: Last status code of each (...); one below zero beforehand keeps it from starting.
        steps: Steps taken (...).
        rejected: Steps tried in vain (...).
        beam_errors: Largest estimated error of each beam's theory in each trajectory (..., number of beams).
        beam_times: When that was (..., number of beams) [s].
        beam_coordinates: Elastic coordinates of all beams, each then (..., number of elastic coordinates).
    """

    q: Array
    v: Array
    u: Array
    t_last: Array
    q_last: Array
    v_last: Array
    status: npt.NDArray[np.int32]
    steps: npt.NDArray[np.int64]
    rejected: npt.NDArray[np.int64]
    beam_errors: Array
    beam_times: Array
    beam_coordinates: Array

    @classmethod
    def empty(cls, model: Model, n: int, samples: int) -> BatchResults:
        """Arrays for n trajectories of that many samples, none of which is reached yet."""
        q, v, u = (np.full((n, samples, size), np.nan) for size in (model.nq, model.nv, model.nu))
        beams = model.beams()
        sizes = (model.nq, model.nv, len(beams), len(beams), sum(beam.size for beam in beams))
        q_last, v_last, errors, times, elastic = (np.zeros((n, size)) for size in sizes)
        steps, rejected = np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.int64)
        status = np.zeros(n, dtype=np.int32)
        return cls(q, v, u, np.zeros(n), q_last, v_last, status, steps, rejected, errors, times, elastic)

    def shaped(self, shape: tuple[int, ...]) -> dict[str, Any]:
        """The arrays by name, their rows (n) reshaped to a batch of that shape."""
        return {name: array.reshape(shape + array.shape[1:]) for name, array in vars(self).items()}


class BatchStepper:
    """Every `stride`-th trajectory from the `first` on, stepped by one thread.

    Args:
        model: Compiled to C.
        settings: Settings of every trajectory.
        initial: Initial states of all trajectories.
        results: Arrays for the results of all trajectories.
        first: Index of the first trajectory.
        stride: Number of threads that share the trajectories.

    Attributes:
        single: The single run whose settings every slot copies.
        met: Events met: number of the trajectory, and the event.
    """

    def __init__(
        self,
        model: Model,
        settings: Settings,
        initial: InitialStates,
        results: BatchResults,
        first: int,
        stride: int,
    ) -> None:
        self.single = Stepper(model, settings.method, initial.inputs.plan, initial.events, initial.par[0])
        settings.apply(self.single)
        self.single.set_instant(settings.instant)
        self.met: list[tuple[int, Met]] = []
        self._failures: list[BaseException] = []
        self._native, self._memory = self.single.native, self.single.memory
        self._batch = batch = self.single.ffi.new("sym_batch *")
        batch.slots = min(SLOTS, max(2, -(-initial.n // stride)))
        batch.next, batch.stride, batch.n, batch.max_steps = first, stride, initial.n, settings.max_steps or 0
        self._prepared: list[tuple[CompiledKernel, npt.NDArray[np.float64]]] = []
        self._fill_prototype()
        par = initial.par
        if self.single.actions is not None:
            par = np.array(np.broadcast_to(par, (initial.n, model.npar)), order="C")
        self._fill_functions(par)
        self._fill_events(par, initial.n)
        self._par = par
        self._ahead: Any = None
        self._fill_ahead(settings, initial.n)
        self._fill_rows(initial, results)
        self._fill_beams(initial.par, results)
        self._lay_out()

    def _lay_out(self) -> None:
        """Allocate the memory of the slots, and start them."""
        own, shared = self._sizes(self._batch)
        self._start(self._batch, lines(own), lines(shared))

    def _sizes(self, batch: Any) -> tuple[int, int]:
        """Numbers of doubles of a batch's own memory, and of the memory that it may share."""
        shared = self.single.ffi.new("size_t *")
        return int(self._native.sym_batch_size(batch, shared)), int(shared[0])

    def _start(self, batch: Any, own: Array, shared: Array) -> None:
        if not self._native.sym_batch_start(batch, self._memory.shared(own), self._memory.shared(shared)):
            raise CompileError("the integrator does not know every input of a batch function")

    def _fill_prototype(self) -> None:
        """The single run whose settings every slot copies, and in which first steps are evaluated."""
        run, memory = self.single.run, self._memory
        run.capacity = run.n_grid
        run.record_t = memory.zeros(run.n_grid)
        run.work = memory.zeros(self._native.sym_run_work_size(run))
        self._batch.prototype = run

    def _fill_events(self, par: Array, n: int) -> None:
        """Memory for the events that are met, and of what actions change of each trajectory."""
        batch, memory, single = self._batch, self._memory, self.single
        count = len(single.events)
        if not count:
            return
        single.reserve_events(batch.slots * 8 * count + _EVENT_ROWS)
        self._event_trajectory = np.zeros(single.run.event_capacity, dtype=np.int64)
        batch.event_trajectory = memory.shared(self._event_trajectory)
        self._acted_at = np.full((n, count + 1), -np.inf)
        self._event_terminal = np.zeros((n, count), dtype=np.int32)
        self._contact_memory = np.zeros((n, len(single.contact_memory)))
        batch.contact_memory = memory.shared(self._contact_memory)
        self.forget_events(np.arange(n))
        batch.event_terminal = memory.shared(self._event_terminal)
        batch.par, batch.acted_at = memory.shared(par), memory.shared(self._acted_at)

    def _fill_ahead(self, settings: Settings, n: int) -> None:
        """What looks ahead of each trajectory, where its instants are not those of all to the end of the run."""
        single, batch, memory = self.single, self._batch, self._memory
        instants, laws, kinks = single.model.formula_instants, single.laws, not settings.adaptive
        ends, own, counted = math.isfinite(settings.t_end), len(self._par) > 1, single.counted
        differ = bool(counted) and (own or single.actions is not None)
        if counted is None or (ends and not differ):
            return
        self._ahead = ahead = memory.own("sym_ahead[]", n)
        kept: dict[int, tuple[Array, Array]] = {}

        def look(_: Any, trajectory: int, t: float) -> int:
            try:
                par, known = self._par[trajectory if own else 0], settings.t_end if ends else t + AHEAD * settings.dt
                stops = instants(laws, par, t, known, kinks=kinks)
                looked_at = single.event_instants(par, t, known)
            except BaseException as error:  # It may not pass through C.
                self._failures.append(error)
                return -1
            kept[trajectory], found = (stops, looked_at), ahead[trajectory]
            found.begin, found.known = t, math.inf if ends else known
            found.n_stops, found.n_event_instants = len(stops), len(looked_at)
            found.stops, found.event_instants = (single.ffi.from_buffer("double[]", x) for x in kept[trajectory])
            return 0

        batch.ahead, batch.look_ahead = ahead, memory.callback("int32_t(void *, int64_t, double)", look)

    def forget_events(self, rows: npt.NDArray[np.intp]) -> None:
        """No event of some trajectories has been met yet."""
        if self.single.events:
            self._event_terminal[rows], self._acted_at[rows] = [event.cut for event in self.single.events], -np.inf

    def take_events(self) -> None:
        """Take the events that C has noted; their rows are free again."""
        n = int(self.single.run.n_event_records)
        numbers = self._event_trajectory[:n].tolist() if n else []
        self.met += zip(numbers, self.single.take_events() if n else (), strict=True)

    def _fill_functions(self, par: Array) -> None:
        """Functions that all active trajectories call at once, and those that are called one by one."""
        for name in ("forward_dynamics", "law", *_ONE_BY_ONE):
            kernel = self.single.kernels.get(name)
            if kernel is None:
                continue
            function, prepared = getattr(self._batch, name), kernel.prepare(par)
            self._prepared.append((kernel, prepared))
            self._fill_shared_rows(function.pre, prepared)
            if name in _ONE_BY_ONE:
                continue
            # Laws are few operations on what users gave: in double precision.
            precision = self.single.model.precision if name == "forward_dynamics" else "double"
            by_vectors = kernel.in_lanes(LaneOptions(function.pre.stride != 0, precision))
            function.function = by_vectors.function
            if precision == "double":
                function.lanes = by_vectors.vectors
            self._memory.keep(by_vectors)

    def _fill_shared_rows(self, rows: Any, values: Array) -> None:
        """A sym_batch_rows of an array (n, size), or (1, size) for all trajectories."""
        rows.at, rows.stride = self._memory.shared(values), values.shape[1] if len(values) > 1 else 0

    def _fill_rows(self, initial: InitialStates, results: BatchResults) -> None:
        batch, memory = self._batch, self._memory
        for name, rows in (("q0", initial.q), ("v0", initial.v), ("u_constant", initial.inputs.constant)):
            self._fill_shared_rows(getattr(batch, name), rows)
        batch.signal_stride = memory.own("int64_t[]", list(initial.inputs.strides))
        arrays: dict[str, npt.NDArray[Any]] = {
            "final_status": results.status,
            "final_t": results.t_last,
            "final_q": results.q_last,
            "final_v": results.v_last,
            "steps": results.steps,
            "rejected": results.rejected,
            "record_q": results.q,
            "record_v": results.v,
            "record_u": results.u,
        }
        for name, array in arrays.items():
            setattr(batch, name, memory.shared(array))

    def _fill_beams(self, par: Array, results: BatchResults) -> None:
        batch, memory, model = self._batch, self._memory, self.single.model
        self._beam_rows = self._beam_numbers(par)
        for name, rows in self._beam_rows.items():
            self._fill_shared_rows(getattr(batch, f"beam_{name}"), rows)
        batch.n_beam_coordinates = results.beam_coordinates.shape[1]
        batch.beam_error, batch.beam_t, batch.beam_q = (
            memory.shared(array if array.size else np.zeros(1))
            for array in (results.beam_errors, results.beam_times, results.beam_coordinates)
        )
        batch.beam_reference = memory.zeros(2 * results.beam_coordinates.size)
        batch.beam_weight = memory.zeros(len(results.beam_errors) * model.nv)
        batch.beam_guard = memory.own("sym_beam_guard[]", results.beam_errors.size)

    def _beam_numbers(self, par: Array) -> dict[str, Array]:
        """Arrays by which beams are judged, by their names in C; one row for each set of parameters."""
        beams = [self.single.model.beams(values) for values in par]
        return {
            name: np.array([np.concatenate([np.zeros(0), *(getattr(beam, name) for beam in some)]) for some in beams])
            for name in ("scale", "reach")
        }

    def set_parameters(self, rows: npt.NDArray[np.intp], par: Array) -> None:
        """Set the parameters (m, npar) of some trajectories (m), in effect from their next start."""
        for kernel, prepared in self._prepared:
            prepared[rows] = kernel.prepare(par)
        if len(self._par) > 1:
            self._par[rows] = par
        if self._ahead is not None:
            for row in rows:
                self._ahead[int(row)].known = -math.inf
        for name, numbers in self._beam_numbers(par).items():
            self._beam_rows[name][rows] = numbers

    def run(self, stop: Signal) -> None:
        """Step every trajectory to its end, or until `stop` is set. The interpreter lock is released meanwhile."""
        try:
            while self._native.sym_batch_advance(self._batch, _STEPS_PER_CALL):
                self.take_events()
                if stop.is_set():
                    break
        finally:  # Ctrl-C in the main thread comes between two calls: active trajectories end where they are.
            self._native.sym_batch_stop(self._batch)
            self.take_events()
        if self._failures:
            raise self._failures[0]


def lines(count: int) -> Array:
    """Zeros (count) from the beginning of a line of cache on: whole vectors that lie across two lines cost more."""
    memory = np.zeros(count + _LINE)
    return memory[-(memory.ctypes.data // 8) % _LINE :][:count]


class Worker(Protocol):
    """Runs a share of a batch."""

    def run(self, stop: Signal) -> None:
        """Run each of the share to its end, or until `stop` is set."""


def run_batch_steppers(steppers: Sequence[Worker]) -> None:
    """Run each in a thread of its own; Ctrl-C ends all, and keeps the results so far."""
    stop = Signal()
    try:
        if len(steppers) == 1:
            steppers[0].run(stop)
            return
        with ThreadPoolExecutor(len(steppers)) as pool:
            running = [pool.submit(stepper.run, stop) for stepper in steppers]
            try:
                for future in running:
                    future.result()
            finally:
                stop.set()
    except KeyboardInterrupt:
        pass
