"""Events within the steps of integrators of others, found by the search that our own steps use."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.calls import constants
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper

_EVALUATE = "int32_t(void *, double, double *)"


class MetEvent(NamedTuple):
    """An event that was met: index, time [s], state y = (q, v)."""

    which: int
    t: float
    y: Array


class EventSearch:
    """The events of one run, step by step.

    Args:
        stepper: Evaluates them; it keeps what is noted of them.
    """

    def __init__(self, stepper: Stepper) -> None:
        self.stepper = stepper
        self._failure: BaseException | None = None
        self._step: tuple[float, float, Callable[[float], Array]]
        self._steps, n, memory = 0, len(stepper.events), stepper.memory
        self._last = constants()["SYM_EVENT_NODES"] - 1
        self._values = np.zeros((constants()["SYM_EVENT_ROWS"], n))
        self._search = stepper.ffi.new("sym_event_search *")
        self._search.n, self._search.direction = n, stepper.system.event_direction
        self._search.memory, self._search.start_changes = memory.shared(self._values), 1
        self._search.evaluate = memory.callback(_EVALUATE, self._evaluate)

    def start(self, t: float, y: Array) -> int:
        """Evaluate the events at the first state; returns a Status."""
        self._values[constants()["SYM_EVENT_EARLIER"]] = np.nan
        return self.stepper.event_values(t, y, self._values[0])

    def find(self, t0: float, t1: float, state: Callable[[float], Array]) -> tuple[int, list[MetEvent]]:
        """The events of a step, in the order of time, up to the first terminal one.

        Args:
            t0: Start of the step, the end of the one before [s].
            t1: Its end [s].
            state: Time -> y = (q, v) along the step.

        Returns:
            A Status, and the events.
        """
        native, search, stepper = self.stepper.native, self._search, self.stepper
        self._step = (t0, t1, state)
        nq, nv = stepper.model.nq, stepper.model.nv
        speeds = np.abs([state(t)[nq : nq + nv] for t in (t0, t1)])
        self._steps += 1
        native.sym_event_search_set_step(search, t1 - t0, (t1 - t0) * speeds.max(initial=0.0), self._steps)
        which, x, met = stepper.ffi.new("int32_t *"), stepper.ffi.new("double *"), list[MetEvent]()
        status = native.sym_event_search_begin(search)
        while status == Status.RUNNING:
            status = native.sym_event_search_next(search, which, x)
            if status != Status.RUNNING or which[0] < 0:
                break
            event = stepper.events[which[0]]
            if event.once and stepper.system.event_terminal[which[0]] == -1:
                continue  # In this step, too, the first one alone counts.
            met.append(MetEvent(which[0], self._time(x[0]), state(self._time(x[0])).copy()))
            if event.once:
                stepper.ignore_event(which[0])
            if event.terminal:
                break
        self._values[0] = self._values[self._last]
        if self._failure is not None:
            raise self._failure
        self._keep_notes()
        return int(status), met

    def _time(self, x: float) -> float:
        t0, t1, _ = self._step
        return t1 if x == 1.0 else t0 + x * (t1 - t0)

    def _evaluate(self, _data: Any, x: float, values: Any) -> int:
        """Values of all events at x; what goes wrong is kept, since it may not pass through C."""
        try:
            t = self._time(x)
            return self.stepper.event_values(t, self._step[2](t), self.stepper.memory.view(values, self._search.n))
        except BaseException as error:
            self._failure = error
            return int(Status.CALLBACK_FAILED)

    def _keep_notes(self) -> None:
        """Keep the first event of each kind: one that turns too near to zero, one that was not followed."""
        run, search = self.stepper.run, self._search
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
