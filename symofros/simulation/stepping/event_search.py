"""Events within the steps of integrators of others, found by the search that our own steps use."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.calls import NativeMemory, constants, native_library
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper

_EVALUATE = "int32_t(void *, double, double *)"


class MetEvent(NamedTuple):
    """An event that was met: index, time [s], state y = (q, v)."""

    which: int
    t: float
    y: Array


class StepSearch:
    """Where functions of x in [0, 1], the events along one step, arrive at zero: native/stepping/events/event_search.c.

    Args:
        directions: Of the arrivals that count: 1 rising, -1 falling, 0 both.
        evaluate: x, array -> values of all events at x into the array; returns a Status.

    Attributes:
        values: Memory of the search; the first row has the values at the end of the step before.
        noted: The sym_event_search, which notes what it does not follow.
    """

    def __init__(self, directions: Sequence[int], evaluate: Callable[[float, Array], int]) -> None:
        self._native, self._memory, n = native_library(), NativeMemory(), len(directions)
        self._evaluate, self._failure = evaluate, list[BaseException]()
        self.values = np.zeros((constants()["SYM_EVENT_ROWS"], n))
        self.noted = self._memory.ffi.new("sym_event_search *")
        self.noted.n, self.noted.direction = n, self._memory.own("int32_t[]", list(directions))
        self.noted.memory, self.noted.start_changes = self._memory.shared(self.values), 1
        self.noted.evaluate = self._memory.callback(_EVALUATE, self._called)

    def restart(self) -> None:
        """Forget the steps before."""
        self.values[constants()["SYM_EVENT_EARLIER"]] = np.nan

    def arrivals(self, t: float, h: float, way: float, number: int) -> Iterator[tuple[int, float]]:
        """Which events arrive, and at which x of a step, in the order of time.

        Args:
            t: Start of the step [s].
            h: Its length [s].
            way: The largest way of a coordinate in it [rad or m].
            number: Number of the step.

        Raises:
            SearchFailedError: The events have no values there.
        """
        ffi, native, noted = self._memory.ffi, self._native, self.noted
        native.sym_event_search_set_step(noted, t, h, way, number)
        which, x = ffi.new("int32_t *"), ffi.new("double *")
        self._check(native.sym_event_search_begin(noted))
        while True:
            self._check(native.sym_event_search_next(noted, which, x))
            if which[0] < 0:
                return
            yield int(which[0]), float(x[0])

    def is_met(self, which: int, x: float, value: float) -> bool:
        """Whether an event that was not returned yet has arrived by x by that value, which is rounding."""
        return bool(self._native.sym_event_is_met(self.noted, which, x, value))

    def end_step(self) -> None:
        """The next step begins where this one ended."""
        self.values[0] = self.values[constants()["SYM_EVENT_NODES"] - 1]

    def _called(self, _data: Any, x: float, values: Any) -> int:
        """Values of all events at x; what goes wrong is kept, since it may not pass through C."""
        try:
            return self._evaluate(x, self._memory.view(values, self.noted.n))
        except BaseException as error:
            self._failure.append(error)
            return int(Status.CALLBACK_FAILED)

    def _check(self, status: int) -> None:
        if self._failure:
            raise self._failure.pop()
        if status != Status.RUNNING:
            raise SearchFailedError(int(status))


class SearchFailedError(Exception):
    """Events have no values within a step; its argument is a Status."""


class EventSearch:
    """The events of one run, step by step.

    Args:
        stepper: Evaluates them; it keeps what is noted of them.
    """

    def __init__(self, stepper: Stepper) -> None:
        self.stepper, self._steps = stepper, 0
        self._step: tuple[float, float, Callable[[float], Array]]
        self._search = StepSearch([event.sign for event in stepper.events], self._evaluate)

    def start(self, t: float, y: Array) -> int:
        """Evaluate the events at the first state; returns a Status."""
        self._search.restart()
        system, noted = self.stepper.system, self._search.noted
        noted.n_instants, noted.instants = system.n_event_instants, system.event_instants
        return self.stepper.event_values(t, y, self._search.values[0])

    def find(self, t0: float, t1: float, state: Callable[[float], Array]) -> tuple[int, list[MetEvent]]:
        """The events of a step, in the order of time, up to the first terminal one.

        Args:
            t0: Start of the step, the end of the one before [s].
            t1: Its end [s].
            state: Time -> y = (q, v) along the step.

        Returns:
            A Status, and the events.
        """
        stepper, status = self.stepper, int(Status.RUNNING)
        self._step = (t0, t1, state)
        nq, nv = stepper.model.nq, stepper.model.nv
        speeds = np.abs([state(t)[nq : nq + nv] for t in (t0, t1)])
        self._steps += 1
        met = list[MetEvent]()
        try:
            for which, x in self._search.arrivals(t0, t1 - t0, (t1 - t0) * speeds.max(initial=0.0), self._steps):
                event = stepper.events[which]
                if event.once and stepper.system.event_terminal[which] == -1:
                    continue  # In this step, too, the first one alone counts.
                met.append(MetEvent(which, self._time(x), state(self._time(x)).copy()))
                if event.once:
                    stepper.ignore_event(which)
                if event.terminal:
                    break
        except SearchFailedError as failed:
            (status,) = failed.args
        self._search.end_step()
        self._keep_notes()
        return status, met

    def _time(self, x: float) -> float:
        t0, t1, _ = self._step
        return t1 if x == 1.0 else t0 + x * (t1 - t0)

    def _evaluate(self, x: float, values: Array) -> int:
        t = self._time(x)
        return self.stepper.event_values(t, self._step[2](t), values)

    def _keep_notes(self) -> None:
        """Keep the first event of each kind: one that turns too near to zero, one that was not followed."""
        run, search = self.stepper.run, self._search.noted
        if run.unresolved_event < 0 <= search.unresolved:
            run.unresolved_event, run.unresolved_t = search.unresolved, self._step[0]
        if run.touched_event < 0 <= search.touched:
            t, which = self._time(search.touched_x), search.touched
            value, error = self._error(t, which)
            if abs(value) <= error:
                run.touched_event, run.touched_t = which, t

    def _error(self, t: float, which: int) -> tuple[float, float]:
        """The value of an event, and what the errors that steps may have change of it."""
        stepper, run = self.stepper, self.stepper.run
        y = self._step[2](t)[: stepper.model.nq + stepper.model.nv].copy()
        bound = float(run.atol) + float(run.rtol) * np.abs(y)
        bound[1::2] *= -1.0
        values = np.zeros((3, len(stepper.events)))
        for row, shifted in zip(values, (y, y + bound, y - bound), strict=True):
            if stepper.event_values(t, shifted, row) != Status.RUNNING:
                return 0.0, -1.0
        value, *others = values[:, which].tolist()
        return value, sum(abs(other - value) for other in others)
