"""A run with actions of events, held as a whole against finer steps: errors go on from one part into the next.

docs/theory/simulation.md, section 8, (18f) to (18j).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.simulation.events import undecided_note
from symofros.simulation.results.examination.finer_steps import (
    Part,
    States,
    change_of_states,
    finer_words,
    other_end_note,
    percent,
)
from symofros.simulation.results.examination.near_events import event_values, turns_near_zero
from symofros.simulation.results.examination.run import MOST_STEPS, ExaminedRun, share_of
from symofros.simulation.stepping.methods import Method
from symofros.simulation.stepping.stepper import Stepper
from symofros.simulation.stepping.windows import WHOLE, Window

# Instants at which two runs are compared, about.
_COMPARED = 128
# Refinements of steps that are four times as long. Tolerances are divided, or multiplied, by so much, down to the
# tightest; from the loosest on they are not held against wider ones.
_COARSER, _TIGHTER, _TIGHTEST, _LOOSEST = -2, 100.0, 1e-13, 1e-4
# What is made once more ends after so many times the steps that it should take.
_PATIENCE = 8
# Orders of convergence that are lower than the method's by more are stated, where errors are below what shows any.
_LOST, _SEEN = 0.5, 0.5


@dataclass(frozen=True, kw_only=True)
class SwitchedRun(ExaminedRun):
    """A run whose events may act, and that is of several parts where they have.

    Attributes:
        par: Run-time parameters (npar) that it began with.
        parts: Number of its parts.
        stopped: Whether an event has ended it.
    """

    par: Array
    parts: int
    stopped: bool

    @property
    def h(self) -> float:
        """Step [s]; 0: it adapts."""
        return 0.0 if self.settings.adaptive else self.settings.dt

    @property
    def span(self) -> float:
        """Time from the start to the last record [s]."""
        return float(self.states[0][-1]) - self.settings.t0

    @property
    def short(self) -> bool:
        """Whether its parts are short in the mean."""
        return self.steps <= WHOLE * self.parts

    @property
    def window(self) -> Window:
        """All of it."""
        return Window(0, len(self.states[0]) - 1, float(self.states[0][-1]))

    def halvings(self, part: Part) -> int:
        """Maximum number of refinements."""
        return super().halvings(part) if self.short else 1

    @cached_property
    def _rows(self) -> Any:
        """Numbers of the records that are compared: some, and the last one; none at which something has jumped."""
        later = np.diff(self.states[0]) > 0.0
        alone = np.flatnonzero(np.append(True, later)[:-1] & later)
        return np.append(alone[:: max(1, len(alone) // _COMPARED)], len(later))

    def coarse(self, window: Window, every: int) -> States:
        """Those records."""
        return [x[self._rows] for x in self.states]

    def fine(self, window: Window, refinements: int, every: int) -> States | None:
        """The same by finer steps, over all events but one that has ended it; None where these do not come there."""
        instants, times = self.states[0][self._rows], 2.0**refinements
        most = int(_PATIENCE * max(1.0, times) * self.steps) + MOST_STEPS
        options = {"every": 0, "grid": instants, "max_steps": most, **({} if self.h else self._tolerances(refinements))}
        begin = self.settings.t0, *self.start
        status, states = self.repeated(
            begin, float(instants[-1]), self.settings.dt / (times if self.h else 1.0), **options
        )
        return states if status >= 0 and len(states[0]) == len(instants) else None

    def _another(self, method: Method) -> Stepper:
        """Another stepper for the run, with all events but one that has ended it."""
        again = Stepper(self.model, method, self.stepper.inputs, self.stepper.events, self.par)
        again.set_span(self.settings.span)
        for i, event in enumerate(again.events):
            if event.terminal and self.stopped:
                again.ignore_event(i)
        again.run.acts = int(again.actions is not None)
        return again

    def _tolerances(self, refinements: int) -> dict[str, Any]:
        """Tolerances of a run by finer steps, or by coarser ones."""
        rtol = self.settings.rtol
        refined = min(rtol, max(_TIGHTEST, rtol / _TIGHTER)) if refinements > 0 else rtol * _TIGHTER
        return {"rtol": refined, "atol": refined / rtol * self.settings.atol}

    def change(self, coarse: States, fine: States, part: Part) -> tuple[float, str]:
        """Difference of displacements at any instant, of speeds at the end and in the mean (18g)."""
        (_, q, v, _), (t, q_fine, v_fine, u) = coarse, fine
        with np.errstate(all="ignore"):  # What has exploded overflows.
            apart, faster = (self.norms(q_fine, u, x) for x in (self.model.difference(q_fine, q), v - v_fine))
            moved = self.norms(q_fine, u, self.model.difference(np.broadcast_to(self.start[0], q.shape), q_fine))
            fastest = max(self.norms(q_fine, u, v_fine).max(), self.rounding(fine))
        reach = max(moved.max(), self.rounding(fine) * float(t[-1] - t[0]))
        of_forces = change_of_states(*(x[:, ~self.moving] for x in (self.states[2], v, v_fine)))
        at_end = share_of(max(float(faster[-1]), float(faster.mean())), float(fastest))
        return max(share_of(float(apart.max()), float(reach)), at_end, of_forces), ""

    def error(self, share: float, refinements: int) -> float:
        """Error of the run, by its change where steps are refined so many times (18h)."""
        return share * self.own_share(refinements)

    def own_share(self, refinements: int) -> float:
        """Share of a difference from other steps, refined or coarser, that is the error of its own."""
        if self.h:
            return 1.0 / abs(1.0 - 2.0 ** (-self.settings.method.order * refinements))
        return 1.0 if refinements > 0 else 1.0 / _TIGHTER

    def order(self) -> float:
        """Order of convergence, by what two refinements change one after the other (18i); NaN where none is seen."""
        half, quarter = (self.fine(self.window, k, 1) for k in (1, 2))
        if half is None or quarter is None:
            return math.nan
        first, second = self.change(self.coarse(self.window, 1), half, "run")[0], self.change(half, quarter, "run")[0]
        return math.log2(first / second) if first > 0.0 and second > 0.0 else math.nan


def switched_run_note(run: SwitchedRun) -> str:
    """Note on what finer steps change of a run over its events; "" where that is little."""
    if run.settings.realtime or not run.model.nv or run.steps < 1 or not len(run.states[0]) or not run.repeatable:
        return ""
    tight = run.settings.rtol < _LOOSEST if run.settings.adaptive else not run.short
    if tight and _agrees(run):
        return _near_event_note(run, _COARSER)
    stepping, cure = (f"steps of {run.h:.4g} s", "a smaller dt") if run.h else ("the tolerances", "tighter tolerances")
    worst = run.changed(run.window, "run")
    if not worst.arrived:
        return other_end_note(run, worst, f" over {_actions(run)}", stepping, cure)
    error = run.error(worst.size, worst.refinements)
    if not error > run.tolerance:
        return _near_event_note(run, 1)
    about = f", so that it errs by {'about ' * (error < 1.0)}{percent(error)}" if run.h else ""
    return (
        f"{stepping} do not determine the motion over {_actions(run)}: {finer_words(run, worst)}"
        f" changes it by {percent(worst.size)}{about}{_lost_order(run, error)}; {cure}"
    )


def _near_event_note(run: SwitchedRun, refinements: int) -> str:
    """Note on an event that turns nearer to zero than the run errs there, by other steps (18j); "" for none."""
    turns = turns_near_zero(run.stepper, run.states)
    other = run.fine(run.window, refinements, 1) if turns else None
    if other is None:
        return ""
    ours = run.coarse(run.window, 1)
    off = np.abs(event_values(run.stepper, ours) - event_values(run.stepper, other)) * run.own_share(refinements)
    for turn in turns:
        k = min(max(1, int(np.searchsorted(ours[0], turn.t))), len(off) - 1)
        if turn.distance < off[k - 1 : k + 1, turn.event].min():
            return undecided_note(run.stepper.events[turn.event].name, turn.t)
    return ""


def _lost_order(run: SwitchedRun, error: float) -> str:
    """The order of convergence in words, where it is seen and lower than that of the method."""
    of_method = run.settings.method.order
    order = run.order() if run.h and error < _SEEN else math.nan
    return f", with the order {max(order, 0.0):.1f} in place of {of_method}" if order < of_method - _LOST else ""


def _actions(run: SwitchedRun) -> str:
    """Its actions of events, in words."""
    words = {1: "what its events do", 2: "an action of an event"}
    return words.get(run.parts, f"{run.parts - 1} actions of events")


def _agrees(run: SwitchedRun) -> bool:
    """Whether a run by coarser steps is the same within the tolerance."""
    states = run.fine(run.window, _COARSER, 1)
    return states is not None and run.change(run.coarse(run.window, 1), states, "run")[0] <= run.tolerance
