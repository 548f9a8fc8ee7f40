"""Drive a run to its end, by our own steps or by SUNDIALS, in time slices: Ctrl-C and progress come through."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from symofros.base.arrays import Array
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.met import Met
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper
from symofros.simulation.stepping.sundials import Cvode, Ida
from symofros.simulation.stepping.time_slice import TimeSlice

# Rows of records in C, which are taken between two calls.
_ROWS = 4096

Show = Callable[[float], None]


class Executor(Protocol):
    """Advances a motion by some steps or instants at a time: a `Stepper`, or the loop of a diagram."""

    @property
    def t(self) -> float:
        """Time reached [s]."""
        ...

    def advance(self, count: int) -> int:
        """Advance by at most `count` steps or instants; returns a Status."""
        ...

    def take_records(self) -> list[Array]:
        """The records since the last call: t (n), q (n, nq), v (n, nv), u (n, nu)."""
        ...

    def take_events(self) -> list[Any]:
        """The events met since the last call, each with its index and time first."""
        ...


@dataclass
class Recorded:
    """The results of a run.

    Attributes:
        status: The last Status.
        states: Portions of the records: t (n), q (n, nq), v (n, nv), u (n, nu) each.
        events: Events located: index, t, and the state q, v of a single model.
        interrupted: Whether Ctrl-C ended the run.
    """

    status: int = Status.RUNNING
    states: list[list[Array]] = field(default_factory=list)
    events: list[Any] = field(default_factory=list)
    interrupted: bool = False

    def take(self, executor: Executor) -> None:
        """Take the records and events since the last call."""
        self.states.append(executor.take_records())
        self.events += executor.take_events()

    def arrays(self) -> list[Array]:
        """All records: t (n), q (n, nq), v (n, nv), u (n, nu)."""
        if len(self.states) == 1:
            return list(self.states[0])
        return [np.concatenate(parts) for parts in zip(*self.states, strict=True)]


def drive(
    executor: Executor, recorded: Recorded, most: Callable[[int], int], show: Callable[[Recorded], None]
) -> Recorded:
    """Advance a started motion to its end, or until `most` allows no further step.

    Args:
        executor: What advances it.
        recorded: Its results so far; others are added.
        most: Number of steps or instants of the next call, given the number that a time slice has room for; 0 stops.
        show: Called after each call, with the results.
    """
    time_slice = TimeSlice()
    try:
        while recorded.status in (Status.RUNNING, Status.RECORDS_FULL):
            count = most(time_slice.steps)
            if count <= 0:
                break
            recorded.status = time_slice.measure(executor.advance, count)
            recorded.take(executor)
            show(recorded)
    except KeyboardInterrupt:
        recorded.interrupted = True
        recorded.take(executor)
    return recorded


def run_to_end(stepper: Stepper, q: Array, v: Array, settings: Settings, show: Show) -> Recorded:
    """Run to the end, or to `max_steps`, by our own steps or by SUNDIALS, as the method says."""
    return (_run_sundials if settings.method.family.multistep else _run_own)(stepper, q, v, settings, show)


def _run_own(stepper: Stepper, q: Array, v: Array, settings: Settings, show: Show) -> Recorded:
    """Run our own integrator to its end, or to `max_steps`."""
    recorded = Recorded(stepper.start(q, v, max(_ROWS, len(settings.grid))))
    counted = stepper.counted or []
    values = stepper.par[counted]

    def most(steps: int) -> int:
        nonlocal values
        if counted and not np.array_equal(stepper.par[counted], values):  # An action within the run has changed some.
            stepper.look_ahead(stepper.t, settings.t_end)
            values = stepper.par[counted]
        return steps if settings.max_steps is None else min(steps, settings.max_steps - int(stepper.run.steps))

    drive(stepper, recorded, most, lambda _: show(stepper.t))
    if not recorded.states:  # It ends where it starts.
        recorded.take(stepper)
    return recorded


def _run_sundials(stepper: Stepper, q: Array, v: Array, settings: Settings, show: Show) -> Recorded:
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
                recorded.events.append(Met(met, t, q_now, v_now))
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
