"""Drive a run to its end, by our own steps or by SUNDIALS, in time slices: Ctrl-C and progress come through."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from symofros.runtime.kernel import Array
from symofros.simulation import stepper as native
from symofros.simulation.settings import Settings
from symofros.simulation.stepper import Stepper
from symofros.simulation.sundials import Cvode, Ida

# Records are taken from C in portions of this many states.
_PORTION = 4096
# Seconds that C may step before Python looks up.
_SPELL = 0.05
_LONGEST = 1 << 20  # Steps in a spell.

Show = Callable[[float], None]


@dataclass
class Recorded:
    """What a run left.

    Attributes:
        status: C's last word.
        states: Portions of t, q, v, u.
        events: Which, when, q, v.
        interrupted: Whether by Ctrl-C.
    """

    status: int = native.GOING
    states: list[list[Array]] = field(default_factory=list)
    events: list[tuple[int, float, Array, Array]] = field(default_factory=list)
    interrupted: bool = False

    def take(self, stepper: Stepper) -> None:
        """What C has recorded since."""
        self.states.append(stepper.take_records())
        self.events += stepper.take_events()

    def arrays(self) -> list[Array]:
        """All t (n), q, v, u."""
        return [np.concatenate(parts) for parts in zip(*self.states, strict=True)]


def run_own(stepper: Stepper, q: Array, v: Array, settings: Settings, show: Show) -> Recorded:
    """The loop in C, spell by spell."""
    recorded = Recorded(stepper.start(q, v, max(_PORTION, len(settings.grid))))
    recorded.take(stepper)
    spell = 64
    try:
        while recorded.status in (native.GOING, native.FULL):
            left = spell if settings.max_steps is None else min(spell, settings.max_steps - int(stepper.run.steps))
            if left <= 0:
                break
            before = time.perf_counter()
            recorded.status = stepper.advance(left)
            took = time.perf_counter() - before
            if took > _SPELL:
                spell = max(1, spell // 2)
            elif took < _SPELL / 4:
                spell = min(2 * spell, _LONGEST)
            recorded.take(stepper)
            show(float(stepper.run.t))
    except KeyboardInterrupt:
        recorded.interrupted = True
        recorded.take(stepper)
    return recorded


def run_sundials(stepper: Stepper, q: Array, v: Array, settings: Settings, show: Show) -> Recorded:
    """CVODE or IDA, from one record to the next."""
    run, recorded = stepper.run, Recorded()
    solver = Ida(stepper) if settings.method.kind == "ida" else Cvode(stepper)
    grid = list(settings.grid) if not settings.every else None
    try:
        recorded.status = solver.start(q, v)
        if recorded.status == native.GOING and (grid is None or (grid and grid[0] <= run.t)):
            recorded.states.append(_now(stepper))
        grid = grid[1:] if grid and grid[0] <= run.t else grid
        while recorded.status == native.GOING and (settings.max_steps is None or solver.steps < settings.max_steps):
            wanted = grid[0] if grid else (None if grid is None else float(run.t_end))
            recorded.status, met = solver.advance(wanted)
            run.steps = solver.steps
            if recorded.status < 0:
                break
            t, q_now, v_now = stepper.state
            recorded.events += [(which, t, q_now, v_now) for which in met]
            final = [which for which in met if stepper.events[which].terminal]
            if final:
                recorded.status, run.stopped_by = native.EVENT, final[0]
            elif t >= float(run.t_end):
                recorded.status = native.DONE
            if grid is None:
                if run.steps % settings.every == 0 or recorded.status != native.GOING:
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
