"""One run whose caller makes the steps: native/stepping/batches/by_hand.c; its state is kept and put back."""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.base.events import Event
from symofros.native import native_number
from symofros.runtime.calls import constants
from symofros.runtime.model import Model
from symofros.simulation.inputs import InputPlan
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.met import Met
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper
from symofros.simulation.stepping.time_slice import TimeSlice

# Changes of inputs that C notes between two calls that take them, and those that are kept of one run.
_NOTED, MOST_NOTED = 256, 1 << 18
# Steps that are looked ahead for instants of formulas of time; of those of packages as well.
AHEAD = native_number("stepping/instances/instance.c", "SYM_AHEAD")
# Steps of one call between looks at Ctrl-C.
_AT_ONCE = 4096


class Noted(NamedTuple):
    """Inputs by when they changed, a chain that later notes never alter.

    Attributes:
        before: Earlier notes.
        t: Times (n) [s].
        u: Inputs from then on (n, nu).
        total: Number of all, the earlier ones included.
    """

    before: Noted | None
    t: Array
    u: Array
    total: int


@dataclass(frozen=True)
class Start:
    """Where a run that is made once more begins.

    Attributes:
        t: Time [s].
        q: Configuration (nq).
        v: Speeds (nv).
        par: Run-time parameters (npar).
        spent: Indices of the events that have acted for good.
        forgotten: Whether the run began before, and its inputs until then are not kept any more.
    """

    t: float
    q: Array
    v: Array
    par: Array
    spent: tuple[int, ...] = ()
    forgotten: bool = False


@dataclass(frozen=True)
class HandState:
    """All that the following steps depend on, and what has been noted until then.

    Attributes:
        owner: What it is a state of: a stepper of the same takes it.
        t: Time [s].
        q: Configuration (nq).
        v: Speeds (nv).
        numbers: The numbers among the fields of the structs of C.
        arrays: The arrays that C writes.
        start: First state.
        noted: Inputs since then.
        events: Events met since then.
        par: Run-time parameters (npar).
        given: Those that a motion begins with.
    """

    owner: object
    t: float
    q: Array
    v: Array
    numbers: tuple[npt.NDArray[np.uint8], ...] = field(repr=False)
    arrays: tuple[npt.NDArray[Any], ...] = field(repr=False)
    start: Start = field(repr=False)
    noted: Noted | None = field(repr=False)
    events: tuple[Met, ...] = field(repr=False)
    par: Array = field(repr=False)
    given: Array = field(repr=False)


class HandRun:
    """One run that is stepped by hand.

    Args:
        model: Compiled to C.
        settings: Settings of the run; its end counts for nothing.
        inputs: Inputs; what neither signals nor formulas give is given by hand,
        fixed: unless it is one of these, by name, which stay.
        events: Zero crossings to locate.
        par: Run-time parameters (npar).

    Attributes:
        run: The run.
        hand: The sym_hand.
        held: Indices of the inputs that are given by hand.
        start: First state.
        events: Events met.
        looks_ahead: Whether instants of formulas of time are looked for before steps are made.
    """

    def __init__(
        self,
        model: Model,
        settings: Settings,
        inputs: InputPlan,
        fixed: Container[str],
        events: Sequence[Event],
        par: Array,
    ) -> None:
        self.settings = settings
        self.run = run = Stepper(model, settings.method, inputs, events, par)
        settings.apply(run)
        run.set_instant(settings.instant)
        run.run.acts = int(run.actions is not None)
        run.reserve(1, 1)
        self._given = par
        self.looks_ahead = settings.adaptive or run.counted is not None
        self.held = held_by_hand(model, inputs, fixed)
        memory = run.memory
        self.hand = hand = run.ffi.new("sym_hand *")
        hand.run, hand.u, hand.dt = run.run, run.system.u_constant, settings.dt
        hand.n_held, hand.held = len(self.held), memory.own("int32_t[]", list(self.held))
        hand.capacity = _NOTED
        self._table = memory.table(hand, "noted_", _NOTED, t=1, u=model.nu)
        self._constant = inputs.constant.copy()
        self._numbers = [Numbers(run, "sym_run", run.run), Numbers(run, "sym_system", run.system)]
        self._numbers.append(Numbers(run, "sym_hand", hand))
        self._arrays = list(self._written())
        self.q, self.v = (memory.view(*of) for of in ((run.run.q, model.nq), (run.run.v, model.nv)))
        self.q.flags.writeable = self.v.flags.writeable = False
        self.events: list[Met] = []
        self._known = self.settings.t_end
        self.reset(0.0, model.neutral(), np.zeros(model.nv))

    def _written(self) -> Iterator[npt.NDArray[Any]]:
        """The arrays of C that steps write and read again."""
        run, system, model, memory = self.run.run, self.run.system, self.run.model, self.run.memory
        n_events, beams = len(self.run.events), self.run.beams
        elastic = sum(beam.size for beam in beams)
        sizes = {"q": model.nq, "v": model.nv, "work": self.run.native.sym_run_work_size(run)}
        sizes |= {"event_values": constants()["SYM_EVENT_ROWS"] * n_events}
        sizes |= {"beam_error": len(beams), "beam_t": len(beams), "beam_q": elastic}
        sizes |= {"beam_reference": 2 * elastic, "beam_weight": model.nv}
        for name, size in sizes.items():
            yield memory.view(getattr(run, name), size)
        yield memory.raw(run.beam_guard, "sym_beam_guard", len(beams))
        yield self._looked_for
        if self.run.actions is not None:
            yield from (memory.view(run.par, model.npar), memory.view(run.acted_at, n_events + 1))
            sticking = len(model.record.sticking)
            yield memory.raw(system.held, "int32_t", sticking)
            yield self.run.contact_memory
        for name, size in {"u": model.nu, "u_constant": model.nu, "a": model.nv, "lam": model.nc, "rank": 1}.items():
            yield memory.view(getattr(system, name), size)

    @property
    def _looked_for(self) -> npt.NDArray[np.int32]:
        """What each event does, as C has it; -1: it is not looked for any more."""
        events = self.run.memory.raw(self.run.system.event_terminal, "int32_t", len(self.run.events))
        return events.view(np.int32)

    @property
    def t(self) -> float:
        """Present time [s]."""
        return float(self.run.run.t)

    @property
    def status(self) -> int:
        """RUNNING, or why no step is made any more."""
        return int(self.hand.status) if self.hand.started else Status.RUNNING

    @property
    def started(self) -> bool:
        """Whether a step was asked for since the last reset."""
        return bool(self.hand.started)

    def reset(self, t: float, q: Array, v: Array, par: Array | None = None) -> None:
        """Begin anew at a state, the inputs those of the description until a step gives others."""
        self._given = self._given if par is None else par
        self.run.take_parameters()  # Modes may have been chosen without an event.
        if self._given is not self.run.par:
            self.run.set_parameters(self._given)
        self._looked_for[:] = [event.cut for event in self.run.events]
        if self.run.actions is not None:
            self.run.memory.view(self.run.run.acted_at, len(self.run.events) + 1)[:] = -np.inf
            self.run.native.sym_run_forget_contacts(self.run.run)
        run, hand, memory = self.run, self.hand, self.run.memory
        run.set_state(q, v)
        run.run.t = run.run.t0 = t
        run.run.n_event_records = 0
        run.run.h = 0.0 if self.settings.adaptive else self.settings.dt
        self._forget_bendings()
        memory.view(hand.u, len(self._constant))[:] = self._constant
        memory.view(run.system.u, len(self._constant))[:] = self._constant
        run.system.in_step = run.system.held_anew = 0
        # The first step is not made by the fast call: what comes before it is in Python.
        hand.started, hand.status, hand.mark, hand.target, hand.n = 0, Status.RECORDS_FULL, 0, 0, 0
        self.start, self.events = Start(t, q.copy(), v.copy(), self._given), []
        self._noted: Noted | None = None
        self._known = -np.inf

    def _forget_bendings(self) -> None:
        """Forget how far beams bend, as at the start of a run."""
        run, memory, beams = self.run.run, self.run.memory, self.run.beams
        for array in self.run.beam_record:
            array[:] = 0.0
        memory.view(run.beam_reference, 2 * sum(beam.size for beam in beams))[:] = 0.0
        memory.view(run.beam_weight, self.run.model.nv)[:] = 0.0
        memory.raw(run.beam_guard, "sym_beam_guard", len(beams))[:] = 0

    def begin(self, u: Array | None) -> Array:
        """Before the first step: all inputs (nu) at the first state, given those that are held; steps are allowed."""
        self.hand.status = Status.RUNNING
        constant = self.run.memory.view(self.hand.u, len(self._constant))
        kept, constant[list(self.held)] = constant.copy(), constant[list(self.held)] if u is None else u
        with self.run.preserved():
            inputs = self.run.inputs_at(self.t, self.start.q, self.start.v).copy()
        constant[:] = kept
        return inputs

    def inputs_now(self) -> Array:
        """All inputs at the present state (nu)."""
        if len(self.held) == len(self._constant):
            return self.run.memory.view(self.hand.u, len(self._constant)).copy()
        t, q, v = self.run.state
        with self.run.preserved():
            return self.run.inputs_at(t, q, v).copy()

    def step(self, u: Array | None, steps: int) -> int:
        """Make steps, in portions that let Ctrl-C through; returns a Status."""
        pointer = self.run.ffi.NULL if u is None else self.run.ffi.from_buffer("double[]", u)
        time_slice = TimeSlice()
        while True:
            portion = min(steps, _AT_ONCE if self.settings.adaptive else time_slice.steps)
            self._look_ahead(portion)
            status = time_slice.measure(partial(self.run.native.sym_hand_step, self.hand, pointer), portion)
            if status == Status.CALLBACK_FAILED:
                return status
            steps, pointer, status = steps - portion, self.run.ffi.NULL, self.settled(status)
            if status != Status.RUNNING or steps <= 0:
                return status

    def settled(self, status: int) -> int:
        """After steps with that status: events and notes are taken, what is left is made; returns a Status."""
        while True:
            if self.run.run.n_event_records:
                self._take_events()
            if self.hand.n >= _NOTED:
                self._seal()
            if status != Status.RECORDS_FULL:
                return status
            status = int(self.run.native.sym_hand_go_on(self.hand))

    def _take_events(self) -> None:
        """Events that were met; where they act, formulas of time may have other instants from then on."""
        met = self.run.take_events()
        self.events += met
        if any(one.done is not None for one in met):
            self._known = -np.inf
            self._look_ahead(int(self.hand.target - self.hand.mark))

    def _look_ahead(self, steps: int) -> None:
        """Find the instants of formulas of time at which steps end or formulas jump, or events are looked at."""
        if not self.looks_ahead:
            return
        t_end = self.start.t + (int(self.hand.mark) + steps) * self.settings.dt
        if t_end > self._known:
            self._known = max(t_end, self.t + AHEAD * self.settings.dt)
            self.run.look_ahead(self.t, self._known)

    def _seal(self) -> None:
        """What C has noted joins the chain; of a run that changes its inputs too often the first part is forgotten."""
        n = int(self.hand.n)
        if not n:
            return
        t, u = (array[:n].copy() for array in self._table)
        before, self.hand.n = self._noted, 0
        self._noted = Noted(before, t[:, 0], u, n + (before.total if before else 0))
        if self._noted.total > MOST_NOTED:
            spent = tuple(np.flatnonzero(self._looked_for == -1).tolist())
            self.start = Start(self.t, self.q.copy(), self.v.copy(), self.run.par, spent, forgotten=True)
            self._noted = Noted(None, np.array([self.t]), u[-1:], 1)

    def noted(self) -> tuple[Array, Array]:
        """The inputs by when they changed: t (n) [s], u (n, nu)."""
        self._seal()
        parts: list[Noted] = []
        link = self._noted
        while link is not None:
            parts.append(link)
            link = link.before
        if not parts:
            return np.array([self.start.t]), self.run.memory.view(self.hand.u, len(self._constant)).copy()[np.newaxis]
        parts.reverse()
        return np.concatenate([part.t for part in parts]), np.concatenate([part.u for part in parts])

    def once_more(self) -> tuple[Stepper, Settings]:
        """The same run as one of `simulate`, its inputs the noted ones: set up, and its settings."""
        t, u = self.noted()
        run, plan = self.run, self.run.inputs
        signals = [(i, t, np.ascontiguousarray(u[:, i]), False) for i in self.held]
        steps = int(self.hand.target) + (0 if self.status == Status.RUNNING else 1)
        t_end = self.t if self.status == Status.RUNNING else self.start.t + steps * self.settings.dt
        settings = replace(self.settings, t0=self.start.t, t_end=t_end, every=1)
        if self.settings.adaptive:
            settings = replace(settings, dt=0.0)
        plan = replace(plan, signals=[*plan.signals, *signals])
        again = Stepper(run.model, run.method, plan, run.events, self.start.par)
        settings.apply(again)
        again.set_instant(self.settings.instant)
        for which in self.start.spent:
            again.ignore_event(which)
        return again, settings

    def save(self, owner: object) -> HandState:
        """The present state, and what has been noted."""
        self._seal()
        numbers = tuple(of.read() for of in self._numbers)
        arrays = tuple(array.copy() for array in self._arrays)
        q, v = arrays[0], arrays[1]
        return HandState(
            owner,
            self.t,
            q,
            v,
            numbers,
            arrays,
            self.start,
            self._noted,
            tuple(self.events),
            self.run.par,
            self._given,
        )

    def restore(self, state: HandState) -> None:
        """Go on from a state that `save` gave, bit by bit as from there."""
        if state.par is not self.run.par:
            self.run.set_parameters(state.par)
        for of, numbers in zip(self._numbers, state.numbers, strict=True):
            of.write(numbers)
        for to, array in zip(self._arrays, state.arrays, strict=True):
            to[...] = array
        self.start, self._noted, self.events = state.start, state.noted, list(state.events)
        self._given = state.given
        self._known = -np.inf


def held_by_hand(model: Model, plan: InputPlan, fixed: Container[str]) -> tuple[int, ...]:
    """Indices of the inputs that steps hold: those without a signal, a formula, or a number, which `fixed` names."""
    given = {*plan.formulas, *(index for index, *_ in plan.signals)}
    return tuple(i for i in range(model.nu) if i not in given and model.names.u[i] not in fixed)


class Numbers:
    """The numbers among the fields of structs of C: all but pointers and what is a struct itself."""

    def __init__(self, run: Stepper, kind: str, structs: Any, count: int = 1) -> None:
        ffi = run.ffi
        self._bytes = run.memory.raw(structs, kind, count).reshape(count, -1)
        places = [
            np.arange(field.offset, field.offset + ffi.sizeof(field.type))
            for _, field in ffi.typeof(kind).fields
            if field.type.kind in ("primitive", "enum")
        ]
        self._places = np.concatenate(places)

    def read(self) -> npt.NDArray[np.uint8]:
        """A copy of them."""
        return np.asarray(self._bytes[:, self._places])

    def write(self, numbers: npt.NDArray[np.uint8]) -> None:
        """Replace them by what was read; of structs of another object, too."""
        self._bytes[:, self._places] = numbers
