"""One run of one model by the integrator of native/: its steps, its records, what is evaluated at its states."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array, Mask
from symofros.base.measures import ROTATION
from symofros.base.names import TIME
from symofros.runtime.beams import BeamBending, worst_bendings
from symofros.runtime.calls import constants
from symofros.simulation.stepping.bound_run import BoundRun
from symofros.simulation.stepping.met import Done, Met
from symofros.simulation.stepping.status import Status

# Events recorded between two calls that take them.
_EVENT_ROWS = 64
# Ends of steps kept for the diagnosis of a run.
_DIAGNOSTIC_ROWS = 512
_TIMED = re.compile(rf"\b{TIME}\b")


class Stepper(BoundRun):
    """One run of one model, stepped."""

    def start(self, q: Array, v: Array, capacity: int) -> int:
        """Place the run at its initial state, with memory for `capacity` records.

        Returns:
            A Status.
        """
        if capacity > self.run.capacity:
            self.reserve(capacity, _DIAGNOSTIC_ROWS)
        self.set_state(q, v)
        status = int(self.native.sym_run_start(self.run))
        self.take_parameters()
        return status

    def reserve(self, capacity: int, diagnostic_rows: int) -> None:
        """Allocate memory for `capacity` records, and for `diagnostic_rows` ends of steps for the diagnosis."""
        run, model, memory = self.run, self.model, self.memory
        run.work = memory.zeros(self.native.sym_run_work_size(run))
        run.pivots = memory.own("int32_t[]", 2 * (model.nv + model.nc))
        run.event_values = memory.zeros(constants()["SYM_EVENT_ROWS"] * len(self.events))
        run.capacity = capacity
        self._records = memory.table(run, "record_", capacity, t=1, q=model.nq, v=model.nv, u=model.nu)
        self.reserve_events(max(_EVENT_ROWS, 2 * len(self.events)))
        run.diagnostic_capacity = diagnostic_rows
        sizes = {"t": 1, "q": model.nq, "v": model.nv, "u": model.nu}
        self._diagnostic_states = memory.table(run, "diagnostic_", diagnostic_rows, **sizes)

    def reserve_events(self, capacity: int) -> None:
        """Allocate memory for `capacity` events."""
        run, model, memory = self.run, self.model, self.memory
        run.event_capacity = capacity
        self._event_records = memory.table(run, "event_", capacity, t=1, q=model.nq, v=model.nv)
        self._event_index = np.zeros(capacity, dtype=np.int32)
        run.event_index = memory.shared(self._event_index)
        if self.actions is not None:
            (self._event_done,) = memory.table(run, "event_", capacity, done=int(self.native.sym_done_size(run)))

    def set_state(self, q: Array, v: Array) -> None:
        """Write q (nq) and v (nv) into the run's memory as its present state."""
        self.memory.view(self.run.q, self.model.nq)[:] = q
        self.memory.view(self.run.v, self.model.nv)[:] = v

    def set_parameters(self, par: Array) -> None:
        """Run-time parameters (npar) from now on; nothing that was evaluated with others is valid any more."""
        run, system, view = self.run, self.system, self.memory.view
        self.par, self.beams = par, self.model.beams(par)
        self._hold()
        for slot, kernel in self.kernels.items():
            prepared = kernel.prepare(par.reshape(1, -1))
            view(getattr(system, slot).pre, prepared.size)[:] = prepared[0]
        if self.actions is not None:
            view(run.par, len(par))[:] = par
        for i, beam in enumerate(self.beams):
            of = system.beams[i]
            of.EI_z, of.EI_y, of.contrast = beam.EI_z, beam.EI_y, beam.contrast
            view(run.beam_scale + of.first, beam.size)[:] = beam.scale
            view(run.beam_reach + of.first, beam.size)[:] = beam.reach
        run.slope_valid = run.jacobian_valid = 0

    def set_instant(self, instant: float) -> None:
        """Time that counts as one instant to actions that bring about each other [s]; 0: a share of the time so far."""
        if self.actions is not None:
            self.run.actions.at_once = instant

    def accumulation(self, t: float, e: float) -> float:
        """Time within which strikes of coefficient e of a contact that comes to rest at t are its last ones [s]."""
        return float(self.native.sym_run_accumulation(self.run, t, e))

    def ignore_event(self, which: int) -> None:
        """An event is not looked for any more."""
        self.system.event_terminal[which] = -1

    def recall(self, met: Sequence[Met], t0: float) -> None:
        """Events that were met from t0 on: those that count once are over, when others acted, and the begin."""
        for one in met:
            if self.events[one.which].once:
                self.ignore_event(one.which)
            if one.acted:
                self.run.acted_at[one.which] = one.t
        if self.actions is not None:
            self.run.acted_at[len(self.events)] = t0

    def act(self) -> tuple[int, list[Met]]:
        """Do the actions of the events at which the run has been cut: a Status, 0 where it goes on, and the events."""
        status = int(self.native.sym_run_act(self.run))
        return status, self._met(int(self.run.first_met), int(self.run.met_end))

    def advance(self, steps: int) -> int:
        """Make at most `steps` steps. The interpreter lock is released meanwhile.

        Returns:
            A Status.
        """
        return int(self.native.sym_run_advance(self.run, steps))

    def take_records(self) -> list[Array]:
        """The records since the last call, t (n), q (n, nq), v (n, nv), u (n, nu); their rows are free again."""
        n = int(self.run.n_records)
        self.run.n_records = 0
        t, q, v, u = (array[:n].copy() for array in self._records)
        return [t[:, 0], q, v, u]

    def diagnostic_states(self) -> list[Array]:
        """Ends of steps, as many apart as they are thinned, and the last: t (n), q (n, nq), v (n, nv), u (n, nu)."""
        n = int(self.run.n_diagnostic)
        t, q, v, u = (array[:n] for array in self._diagnostic_states)
        return [t[:, 0], q, v, u]

    def take_events(self) -> list[Met]:
        """The events located since the last call; their rows are free again."""
        n = int(self.run.n_event_records)
        self.run.n_event_records = 0
        return self._met(0, n)

    def _met(self, first: int, end: int) -> list[Met]:
        """Events of rows of the records; their actions, where they have been done."""
        (t, q, v), model, rows = self._event_records, self.model, range(first, end)
        done: dict[int, Done | None] = {}
        if self.actions is not None:
            sizes = model.nq, model.nv, model.nu, model.npar
            done = {i: Done.of(self._event_done[i], sizes) for i in rows}
            self._event_done[first:end, 0] = 0.0
            self.take_parameters()
        return [Met(int(self._event_index[i]), float(t[i, 0]), q[i].copy(), v[i].copy(), done.get(i)) for i in rows]

    def take_parameters(self) -> None:
        """Parameters as the run has changed them."""
        if self.actions is not None:
            present = self.memory.view(self.run.par, self.model.npar)
            self.par = self.par if np.array_equal(self.par, present) else present.copy()

    @property
    def bendings(self) -> tuple[BeamBending, ...]:
        """Bending of each beam at the accepted step where its theory errs most, axial loads apart."""
        return self.amplified_bendings(())

    def amplified_bendings(self, amplifications: Sequence[float]) -> tuple[BeamBending, ...]:
        """Bending of each beam at that step, its error amplified by axial loads."""
        self.native.sym_run_settle_beams(self.run)
        _, t, q = self.beam_record
        return worst_bendings(self.beams, t, q, amplifications)

    def judge_beams(self) -> int:
        """Judge the present state's beams, for integrators of others; returns a Status."""
        return int(self.native.sym_run_judge_beams(self.run))

    def set_gains(self, gains: Array) -> None:
        """Baumgarte's gains (2 nc) [1/s]."""
        self.memory.view(self.system.gains, len(gains))[:] = gains

    def inputs_at(self, t: float, q: Array, v: Array) -> Array:
        """The inputs at a state (nu); the last ones where a function of the caller's fails."""
        self.place(t, np.concatenate([q, v]))
        return self.inputs_now

    def place(self, t: float, y: Array) -> int:
        """Make y = (q, v), its quaternions normalised, the present state, and evaluate its inputs; returns a Status."""
        return int(self.native.sym_run_set_state(self.run, t, self._pointer(y)))

    def begin_step(self, t: float, end: float) -> None:
        """Leave held samples and jumps at `end` or later out, from t on; for integrators of others."""
        self.native.sym_run_begin_step(self.run, t, end)

    def end_step(self) -> None:
        """Take in held samples and jumps at the end of the step."""
        self.native.sym_run_end_step(self.run)

    @property
    def counted(self) -> list[int] | None:
        """Indices of the parameters on which instants depend; None where no formula of time has any."""
        instants = self.model.formula_instants
        found = [instants.parameters(formulas) for formulas in (self.laws, self.timed_events)]
        return None if found == [None, None] else sorted({i for indices in found for i in indices or ()})

    def look_ahead(self, t0: float, t_end: float) -> None:
        """Find the instants of formulas of time in a run [s], at which steps end or events are looked at."""
        self.set_event_instants(t0, t_end)
        self.set_stops(t0, t_end, kinks=not self.run.adaptive)

    def set_stops(self, t0: float, t_end: float, *, kinks: bool = False) -> None:
        """Find the instants in a run [s] at which steps have to end for formulas of time, or those of kinks alone."""
        self._looked: tuple[float, bool] = t_end, kinks
        stops = self.model.formula_instants(self.laws, self.par, t0, t_end, kinks=kinks)
        self.system.n_stops, self.system.stops = len(stops), self.memory.doubles(stops)

    def look_ahead_after_actions(self) -> None:
        """Find those at which steps have to end anew where an action that C does, in a diagram, has changed them."""
        if self.actions is None or not (counted := self.counted):
            return
        values = self.par[counted]

        def look(_: Any) -> int:
            nonlocal values
            try:
                self.take_parameters()
                if not np.array_equal(self.par[counted], values):
                    values, (t_end, kinks) = self.par[counted], self._looked
                    self.set_stops(self.t, t_end, kinks=kinks)
            except BaseException as error:  # It may not pass through C.
                self.failure = error
                return -1
            return 0

        self.run.look_ahead = self.memory.callback("int32_t(void *)", look)

    @property
    def laws(self) -> list[Any]:
        """Formulas of inputs."""
        return list(self.inputs.formulas.values())

    @property
    def timed_events(self) -> list[Any]:
        """Formulas of events in which time stands."""
        return [event.formula for event in self.events if _TIMED.search(str(event.formula))]

    def event_instants(self, par: Array, t0: float, t_end: float) -> Array:
        """Instants in a run (n) [s] at which formulas of time in events bend, jump or are narrow, and between them."""
        if not (formulas := self.timed_events):
            return np.zeros(0)
        jumps = self.model.formula_instants(formulas, par, t0, t_end)
        return np.sort(np.concatenate([jumps, 0.5 * (jumps[1:] + jumps[:-1])]))  # Values at jumps may be neither.

    def set_event_instants(self, t0: float, t_end: float) -> None:
        """Look for events at their instants in a run."""
        instants = self.event_instants(self.par, t0, t_end)
        self.system.n_event_instants, self.system.event_instants = len(instants), self.memory.doubles(instants)

    def next_stop(self, t: float, end: float) -> float:
        """The first instant after t at which a step has to end, else `end` [s]; for integrators of others."""
        return float(self.native.sym_run_next_stop(self.run, t, end))

    def slope(self, t: float, y: Array, rate: Array) -> int:
        """Write the rate y' = (N v, v') of a state y = (q, v) into `rate`; returns a Status."""
        return int(self.native.sym_run_rate(self.run, t, self._pointer(y), self._pointer(rate)))

    def preserved(self) -> _Preserved:
        """Within, states may be placed and functions evaluated; afterwards the run is where it was."""
        return _Preserved(self)

    def spectrum(
        self, t: float, q: Array, v: Array, u: Array, h: float, dimension: int, moving: Mask | None = None
    ) -> tuple[Array, Array, Array] | None:
        """The linearised motion about a state, in a subspace of its first directions; within `preserved`.

        Args:
            t: Time [s].
            q: Configuration (nq).
            v: Speeds (nv).
            u: Inputs (nu); those that are held stay so about the state.
            h: Step [s].
            dimension: Most directions m, at most 2 nv.
            moving: Whether each speed is one of the motion (nv), and no state of a force or a block; all by default.

        Returns:
            Orthonormal basis (m, 2 nv) of changes (theta, h v), h times the derivative in that basis (m, m), components
            of the motion of one step (m); None where the accelerations or inputs near the state do not exist.
        """
        basis, matrix = np.zeros((dimension + 5, 2 * self.model.nv)), np.zeros((dimension, dimension))
        motion, m = np.zeros(dimension), int(Status.DIVERGED)
        self.memory.view(self.system.u_constant, self.model.nu)[:] = u
        if self.place(t, np.concatenate([q, v])) == Status.RUNNING:
            arrays = (self._pointer(basis), self._pointer(matrix), self._pointer(motion))
            counted = np.where(True if moving is None else moving, 1 + self._turns, 0).astype(np.int32)
            of_motion = self.ffi.from_buffer("int32_t[]", counted)
            m = int(self.native.sym_run_spectrum(self.run, h, of_motion, dimension, *arrays))
        return (basis[:m], matrix[:m, :m], motion[:m]) if m > 0 else None

    @cached_property
    def _turns(self) -> Mask:
        """Whether each speed is a rotation (nv)."""
        return np.equal(self.model.record.measures.kinds(self.model.nv), ROTATION)

    def accelerations(self, t: Array, q: Array, v: Array) -> tuple[Array, Array] | None:
        """Accelerations (n, nv) and inputs (n, nu) at states of the motion; the run stays where it is.

        Each state is projected onto the constraints first, where the run is.

        Args:
            t: Times (n) [s].
            q: Configurations (n, nq).
            v: Speeds (n, nv).

        Returns:
            NaN where a state has no accelerations; None where a function of the caller's fails.
        """
        n = len(t)
        a, u = np.empty((n, self.model.nv)), np.empty((n, self.model.nu))
        arrays = [self._pointer(x) for x in (*map(np.ascontiguousarray, (t, q, v)), u, a)]
        with self.preserved():
            status = self.native.sym_run_accelerations(self.run, n, *arrays)
        return (a, u) if status == 0 else None

    def path(self, ends: Sequence[Array], which: npt.NDArray[np.intp], x: Array) -> tuple[Array, Array, Array, Array]:
        """Time (m), q (m, nq), v and a (m, nv) of the cubics through ends of intervals, (18a).

        Args:
            ends: The ends, contiguous: t (n) [s], q (n, nq), v (n, nv), accelerations (n, nv).
            which: Numbers of intervals (m).
            x: Shares of these (m).
        """
        (nq, nv), m, ffi = (self.model.nq, self.model.nv), len(x), self.ffi
        made = np.empty(m), np.empty((m, nq)), np.empty((m, nv)), np.empty((m, nv))
        read, work = [self._pointer(y) for y in ends], np.empty(3 * nv)
        where = ffi.from_buffer("int64_t[]", which), self._pointer(x), self._pointer(work)
        self.native.sym_run_path(self.run, *read, m, *where, *[self._pointer(y) for y in made])
        return made

    def configuration_rate(self, q: Array, w: Array) -> Array:
        """The rate N w (nq) at speeds w (nv) and the configuration that was placed last; q: its numbers."""
        rate = np.zeros(self.model.nq)
        self.native.sym_run_configuration_rate(self.run, self._pointer(q), self._pointer(w), self._pointer(rate))
        return rate

    def event_values(self, t: float, y: Array, values: Array) -> int:
        """Write the values of the events at a state y = (q, v) into `values`; returns a Status."""
        return int(self.native.sym_run_event_values(self.run, t, self._pointer(y), self._pointer(values)))

    def _pointer(self, array: Array) -> Any:
        """C's view of an array of doubles, which the caller keeps."""
        return self.ffi.from_buffer("double[]", array)

    @property
    def inputs_now(self) -> Array:
        """The inputs last evaluated (nu)."""
        return self.memory.copy(self.system.u, self.model.nu)

    @property
    def t(self) -> float:
        """The present time [s]."""
        return float(self.run.t)

    @property
    def state(self) -> tuple[float, Array, Array]:
        """The present t, q, v."""
        run, copy = self.run, self.memory.copy
        return float(run.t), copy(run.q, self.model.nq), copy(run.v, self.model.nv)

    @property
    def evaluation_point(self) -> tuple[float, Array, Array]:
        """The t, q, v at which functions were evaluated last; of a step that failed, where it failed."""
        system, copy = self.system, self.memory.copy
        return float(system.t[0]), copy(system.q, self.model.nq), copy(system.v, self.model.nv)


class _Preserved:
    """Puts a stepper's present state and evaluation point back at the end of a block."""

    def __init__(self, stepper: Stepper) -> None:
        self._stepper = stepper

    def __enter__(self) -> None:
        run, of = self._stepper.run, self._stepper
        self._inputs = of.memory.bytes_at(of.system.u_constant, of.system.nu)
        self._kept = of._point.copy(), self._inputs[:], run.t, run.evaluations, of.failure

    def __exit__(self, *_: object) -> None:
        run, of = self._stepper.run, self._stepper
        of._point[:], self._inputs[:], run.t, run.evaluations, of.failure = self._kept
