"""Drive a run to its end, by our own steps or by SUNDIALS, in time slices: Ctrl-C and progress come through."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from symofros.base.arrays import Array
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper
from symofros.simulation.stepping.sundials import Cvode, Ida
from symofros.simulation.stepping.time_slice import TimeSlice

# Rows of records in C, which are taken between two calls.
_ROWS = 4096

Show = Callable[[float], None]


@dataclass
class Recorded:
    """The results of a run.

    Attributes:
        status: The last Status.
        states: Portions of the records: t (n), q (n, nq), v (n, nv), u (n, nu) each.
        events: Index, t, q, v of the events located.
        interrupted: Whether Ctrl-C ended the run.
    """

    status: int = Status.RUNNING
    states: list[list[Array]] = field(default_factory=list)
    events: list[tuple[int, float, Array, Array]] = field(default_factory=list)
    interrupted: bool = False

    def take(self, stepper: Stepper) -> None:
        """Take the records and events since the last call."""
        self.states.append(stepper.take_records())
        self.events += stepper.take_events()

    def arrays(self) -> list[Array]:
        """All records: t (n), q (n, nq), v (n, nv), u (n, nu)."""
        return [np.concatenate(parts) for parts in zip(*self.states, strict=True)]


def run_own(stepper: Stepper, q: Array, v: Array, settings: Settings, show: Show) -> Recorded:
    """Run our own integrator to its end, or to `max_steps`."""
    recorded = Recorded(stepper.start(q, v, max(_ROWS, len(settings.grid))))
    recorded.take(stepper)
    time_slice = TimeSlice()
    try:
        while recorded.status in (Status.RUNNING, Status.RECORDS_FULL):
            left = math.inf if settings.max_steps is None else settings.max_steps - int(stepper.run.steps)
            if left <= 0:
                break
            recorded.status = time_slice.measure(stepper.advance, int(min(time_slice.steps, left)))
            recorded.take(stepper)
            show(float(stepper.run.t))
    except KeyboardInterrupt:
        recorded.interrupted = True
        recorded.take(stepper)
    return recorded


def run_sundials(stepper: Stepper, q: Array, v: Array, settings: Settings, show: Show) -> Recorded:
    """Run CVODE or IDA from one record to the next."""
    run, recorded = stepper.run, Recorded()
    solver = Ida(stepper) if settings.method.kind == "ida" else Cvode(stepper)
    grid = list(settings.grid) if not settings.every else None
    try:
        recorded.status = solver.start(q, v)
        if recorded.status == Status.RUNNING and (grid is None or (grid and grid[0] <= run.t)):
            recorded.states.append(_now(stepper))
        grid = grid[1:] if grid and grid[0] <= run.t else grid
        while recorded.status == Status.RUNNING and (
            settings.max_steps is None or solver.steps < settings.max_steps or solver.met
        ):
            wanted = grid[0] if grid else (None if grid is None else float(run.t_end))
            recorded.status, met = solver.advance(wanted)
            run.steps = solver.steps
            if recorded.status < 0:
                break
            t, q_now, v_now = stepper.state
            if met is not None:
                recorded.events.append((met, t, q_now, v_now))
            final = met is not None and stepper.events[met].terminal
            if final:
                recorded.status, run.terminal_event = Status.TERMINAL_EVENT, met
            elif t >= float(run.t_end) and not solver.met:
                recorded.status = Status.FINISHED
            if grid is None:
                if (met is None and run.steps % settings.every == 0) or recorded.status != Status.RUNNING:
                    recorded.states.append(_now(stepper))
            elif (grid and t >= grid[0]) or final:
                recorded.states.append(_now(stepper))
                grid = [time for time in grid if time > t]
            show(t)
    except KeyboardInterrupt:
        recorded.interrupted = True
    recorded.states = recorded.states or [_now(stepper)]
    return recorded


def _now(stepper: Stepper) -> list[Array]:
    t, q, v = stepper.state
    return [np.array([t]), q[np.newaxis], v[np.newaxis], stepper.inputs_now[np.newaxis]]
