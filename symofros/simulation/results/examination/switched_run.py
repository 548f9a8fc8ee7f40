"""A run by steps of order 1, with actions of events, or with forces that bend, held as a whole against finer steps.

docs/theory/simulation.md, section 8, (18f) to (18j).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.simulation.events import undecided_note
from symofros.simulation.results.examination.finer_steps import HALVINGS, TIGHTENINGS, Part, States, change_of_states
from symofros.simulation.results.examination.near_events import event_values, turns_near_zero
from symofros.simulation.results.examination.run import MOST_STEPS, ExaminedRun, share_of
from symofros.simulation.results.examination.switched_motion import SwitchedMotion, tolerances, whole_run_note
from symofros.simulation.stepping.methods import Method
from symofros.simulation.stepping.stepper import Stepper
from symofros.simulation.stepping.windows import Window

# Instants at which two runs are compared, about.
_COMPARED = 128
# What is made once more ends after so many times the steps that it should take.
_PATIENCE = 8


@dataclass(frozen=True, kw_only=True)
class SwitchedRun(SwitchedMotion, ExaminedRun):
    """A run whose events may act, and that is of several parts where they have; or one with forces that bend or jump.

    Attributes:
        par: Run-time parameters (npar) that it began with.
        parts: Number of its parts.
        stopped: Whether an event has ended it.
    """

    par: Array
    parts: int = 1
    stopped: bool = False

    @classmethod
    def of(cls, run: ExaminedRun) -> SwitchedRun:
        """A run in which no event acts."""
        of, stopped = run.stepper, run.stepper.run.terminal_event >= 0
        held = (run.settings, run.start, run.states, run.steps, run.counted, run.recorded)
        return cls(of, *held, par=of.par, stopped=stopped)

    @property
    def h(self) -> float:
        """Step [s]; 0: it adapts."""
        return 0.0 if self.settings.adaptive else self.settings.dt

    @property
    def span(self) -> float:
        """Time from the start to the last record [s]."""
        return float(self.states[0][-1]) - self.settings.t0

    @property
    def method_order(self) -> int:
        """Order of the method."""
        return self.settings.method.order

    @property
    def rtol(self) -> float:
        """Relative bound of the local error, where steps adapt."""
        return self.settings.rtol

    @property
    def repeatable(self) -> bool:
        """Whether it can be made once more, as a whole by any method: with the same inputs."""
        return self.same_inputs_again

    @property
    def switched(self) -> str:
        """What switches in the run, or its actions of events, in words."""
        if self.stepper.actions is None:
            bends = "forces that bend or jump" if self.amplifies else "all of the run"
            return "its contacts" if self.model.record.has_compliant_contacts else bends
        words = {1: "what its events do", 2: "an action of an event"}
        return words.get(self.parts, f"{self.parts - 1} actions of events")

    def halvings(self, part: Part) -> int:
        """Maximum number of refinements."""
        return HALVINGS if self.h and self.short else 1 if self.h else TIGHTENINGS

    @cached_property
    def _rows(self) -> Any:
        """Numbers of the records that are compared: some, and the last one; none at which something has jumped.

        They are as far apart in time as these allow: steps that adapt are short where speeds change at once.
        """
        t = self.states[0]
        later = np.diff(t) > 0.0
        alone = np.flatnonzero(np.append(True, later)[:-1] & later)
        some = np.unique(np.searchsorted(t[alone], np.linspace(t[0], t[-1], _COMPARED)))
        return np.append(alone[some[some < len(alone)]], len(later))

    def coarse(self, window: Window, every: int) -> States:
        """Records at the compared instants."""
        return [x[self._rows] for x in self.states]

    def fine(self, window: Window, refinements: int, every: int) -> States | None:
        """The same by finer steps, over all events but one that has ended it; None where these do not come there."""
        instants, times = self.states[0][self._rows], 2.0**refinements
        most = int(_PATIENCE * max(1.0, times) * self.steps) + MOST_STEPS
        options: dict[str, Any] = {"every": 0, "grid": instants, "max_steps": most}
        if not self.h:
            options["rtol"], options["atol"] = tolerances(self.rtol, self.settings.atol, refinements)
        begin = self.settings.t0, *self.start
        status, states = self.repeated(
            begin, float(instants[-1]), self.settings.dt / (times if self.h else 1.0), **options
        )
        return states if status >= 0 and len(states[0]) == len(instants) else None

    def _another(self, method: Method) -> Stepper:
        """Another stepper for the run, with all events but one that has ended it."""
        again = Stepper(self.model, method, self.stepper.inputs, self.stepper.events, self.par)
        again.set_instant(self.settings.instant)
        for i, event in enumerate(again.events):
            if event.terminal and self.stopped:
                again.ignore_event(i)
        again.run.acts = int(again.actions is not None)
        return again

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


def switched_run_note(run: SwitchedRun) -> str:
    """Note on what finer steps change of a run over its events; "" where that is little."""
    if run.settings.realtime or not run.model.nv or run.steps < 1 or not len(run.states[0]) or not run.repeatable:
        return ""
    note, shown = whole_run_note(run)
    return note or ("" if run.stepper.actions is None else _near_event_note(run, shown))


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
