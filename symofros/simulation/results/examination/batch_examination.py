"""What is looked at of one run of a batch when its outcome is asked for: its steps, and its inputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.beams import BeamBending
from symofros.runtime.manifold import retract
from symofros.runtime.model import Model
from symofros.simulation.results.acted import failure_of, notes_of
from symofros.simulation.results.ends import ENDS
from symofros.simulation.results.examination.diagnosis import diagnose_one
from symofros.simulation.results.examination.input_faults import input_fault
from symofros.simulation.results.examination.run import ExaminedRun, Ranks
from symofros.simulation.results.examination.step_size import examine_run
from symofros.simulation.results.notes import distinct, of_steps
from symofros.simulation.results.outcome import Outcome
from symofros.simulation.settings import Settings
from symofros.simulation.simulate import run_to_its_end
from symofros.simulation.stepping.batch_stepper import InitialStates
from symofros.simulation.stepping.met import Met
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper

# Share of the span after the last state in which an input is looked at, where steps have no length of their own.
_NEXT = 1e-3
# Steps of the longest run that is made once more as a whole, how many ends of steps are kept, and the fewest records
# that a longer one is examined at.
_MADE_AGAIN, _KEPT, _RECORDS = 100_000, 4096, 3


@dataclass(frozen=True)
class BatchExamination:
    """Model, settings and initial states of a batch.

    Attributes:
        model: Model that was simulated.
        settings: Settings of every run.
        initial: Initial states, inputs and parameters.
    """

    model: Model
    settings: Settings
    initial: InitialStates

    def outcome(
        self, i: int, status: int, states: tuple[Array, ...], steps: int, bendings: tuple[BeamBending, ...]
    ) -> Outcome:
        """Outcome of run i.

        Args:
            i: Number of the run.
            status: Its last Status.
            states: Samples of the run and its last state: t (n), q, v, u.
            steps: Number of steps.
            bendings: Bending of its beams.
        """
        last = float(states[0][-1]), states[1][-1], states[2][-1]
        # Steps come as near to a pole as they like, and beyond it there is no number.
        fault = self._input_fault(i, *last) if status < 0 and status != Status.STEP_TOO_SMALL else ""
        run = self._run(i, states, steps)
        run = self._made_again(run, failed=status < 0)
        run.stepper.inputs_at(*last)
        done = self.settings.max_steps is not None and steps >= self.settings.max_steps
        outcome = diagnose_one(run, status, bendings, fault, interrupted=status == Status.RUNNING and not done)
        if outcome.kind != "finished" or of_steps(outcome.notes):
            return outcome
        return replace(outcome, notes=(*outcome.notes, *self._not_seen(run)))

    def outcome_with_events(
        self, i: int, status: int, states: tuple[Array, ...], steps: int, met: Sequence[Met]
    ) -> Outcome:
        """Outcome of a run of a batch with events, with the notes of the same motion by itself.

        Args:
            i: Number of the run.
            status: Its last Status.
            states: Samples of the run and its last state: t (n), q, v, u.
            steps: Number of steps.
            met: Events that it met.
        """
        t, end = float(states[0][-1]), ENDS[status]
        failure = failure_of(self.single, met[-1]) if met and status < 0 else None
        ended = [one for one in met if self.initial.events[one.which].terminal]
        reason = f"event '{self.initial.events[ended[-1].which].name}'" if ended else ""
        outcome = failure or end.outcome(t, reason=reason if status == Status.TERMINAL_EVENT else "")
        notes = self._notes_by_itself(i, steps) if status != Status.RUNNING else None
        if notes is None:
            notes = (*distinct(note for one in met for note in notes_of(self.single, one)), _not_examined_note())
        return replace(outcome, notes=(*outcome.notes, *notes))

    def _notes_by_itself(self, i: int, steps: int) -> tuple[str, ...] | None:
        """Notes of a single run in the place of run i that records its steps; None where these are too many."""
        if steps > _MADE_AGAIN:
            return None
        start = _row(self.initial.q, i), _row(self.initial.v, i)
        stepper, settings = self._not_begun(i), replace(self.settings, every=1, grid=np.zeros(0))
        settings.apply(stepper)
        return run_to_its_end(stepper, settings, *start).outcome.notes

    def _not_seen(self, run: ExaminedRun) -> tuple[str, ...]:
        """The note on a run, too long to be made once more, of which little but its end is known."""
        return (_not_examined_note(),) if run.steps > _MADE_AGAIN and len(run.states[0]) < _RECORDS else ()

    def notes_on_steps(self, i: int, states: tuple[Array, ...], steps: int) -> tuple[str, ...]:
        """Notes on the steps of run i, which finished; arguments as of `outcome`."""
        if self.initial.events:
            return of_steps(self._notes_by_itself(i, steps) or ())
        run = self._made_again(self._run(i, states, steps), failed=False)
        return examine_run(run, ended_well=True, failed=False)[1] or self._not_seen(run)

    def first_parameters(self, i: int) -> Array:
        """Run-time parameters of run i where it begins, with its modes of contacts and of friction that sticks."""
        return np.array(self._single(i).par)

    def _run(self, i: int, states: tuple[Array, ...], steps: int) -> ExaminedRun:
        """A single run in the place of run i."""
        start = _row(self.initial.q, i), _row(self.initial.v, i)
        return ExaminedRun(self._stepper(i), self.settings, start, states, steps)

    def _made_again(self, run: ExaminedRun, *, failed: bool) -> ExaminedRun:
        """The run with ranks of its constraints and, unless it failed, the ends of its steps if it has fewer samples.

        It is repeated for that. What steps pass over, and what constraints do on the way, does not depend on what is
        recorded of them. Of many steps the first ones tell the rank.
        """
        begin, every, t = (self.settings.t0, *run.start), -(-run.steps // _KEPT), run.states[0]
        whole, wanted = run.steps <= _MADE_AGAIN, len(t) < run.steps and not failed
        if not run.steps or not ((whole and wanted) or run.model.nc):
            return run
        end = float(t[-1]) if whole else begin[0] + (float(t[-1]) - begin[0]) * _MADE_AGAIN / run.steps
        stepper, recorded = run.made_again(begin, end, self.settings.dt, every=every)
        ends = recorded.arrays()
        run = replace(run, counted=Ranks.of(stepper))
        more = whole and wanted and recorded.status == Status.FINISHED and len(ends[0]) > len(t)
        return replace(run, states=ends) if more else run

    def _input_fault(self, i: int, t: float, q: Array, v: Array) -> str:
        """The input of run i that is not finite about its last state, in words; "" where there is none."""
        row = _row(self.initial.inputs.constant, i)
        bad = np.flatnonzero(~np.isfinite(row))
        if len(bad):
            return f"input '{self.model.names.u[bad[0]]}' is {row[bad[0]]}, a constant"
        stepper = self._stepper(i)
        step = self.settings.dt or _NEXT * (self.settings.t_end - self.settings.t0)
        with np.errstate(all="ignore"):
            ends = [(t, q), (t + step, retract(self.model.record.segments, q, step * v))]
        for when, where in ends:
            stepper.inputs_at(when, where, v)
            fault = input_fault(stepper)
            if fault:
                return fault
        return ""

    def _stepper(self, i: int) -> Stepper:
        """A single run in the place of run i."""
        inputs = self.initial.inputs
        one_serves_all = len(self.initial.par) == len(inputs.constant) == 1 and not any(inputs.strides)
        return self.single if one_serves_all else self._single(i)

    @cached_property
    def single(self) -> Stepper:
        """A single run in the place of the first one."""
        return self._single(0)

    def _single(self, i: int) -> Stepper:
        stepper = self._not_begun(i)
        self.settings.apply(stepper)
        stepper.start(_row(self.initial.q, i), _row(self.initial.v, i), max(1, len(self.settings.grid)))
        return stepper

    def _not_begun(self, i: int) -> Stepper:
        """One whose contacts have no modes yet."""
        inputs = self.initial.inputs
        signals = [
            (index, t, values[i] if stride else values, linear)
            for (index, t, values, linear), stride in zip(inputs.plan.signals, inputs.strides, strict=True)
        ]
        plan = replace(inputs.plan, constant=_row(inputs.constant, i), signals=signals)
        model, par = self.model.with_precision("double"), _row(self.initial.par, i)
        stepper = Stepper(model, self.settings.method, plan, self.initial.events, par)
        stepper.set_instant(self.settings.instant)
        return stepper

    def __getstate__(self) -> dict[str, Any]:
        """All but the stepper, whose memory is that of C."""
        return {name: value for name, value in vars(self).items() if name != "single"}


def _not_examined_note() -> str:
    return "a motion of so many steps is not examined in a batch: sf.simulate says more of it"


def _row(rows: Array, i: int) -> Array:
    """Row i, or the one row for all."""
    row: Array = rows[i if len(rows) > 1 else 0]
    return row
