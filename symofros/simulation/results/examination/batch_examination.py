"""What is looked at of one run of a batch when its outcome is asked for: its steps, and its inputs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.manifold import retract
from symofros.runtime.model import Model
from symofros.simulation.results.examination.input_faults import input_fault
from symofros.simulation.results.examination.repetition import repeatable, repeated
from symofros.simulation.results.examination.step_size import examine_run
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.batch_stepper import InitialStates
from symofros.simulation.stepping.resolution import Mode
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper

# Share of the span after the last state in which an input is looked at, where steps have no length of their own.
_NEXT = 1e-3
# Steps of the longest run that is made once more for its ends of steps, and how many of these are kept.
_MADE_AGAIN, _KEPT = 100_000, 4096


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

    def step_size(
        self, i: int, states: tuple[Array, ...], steps: int, *, ended_well: bool, failed: bool
    ) -> tuple[Mode | None, tuple[str, ...]]:
        """The mode that run i resolves worst, and notes on its steps.

        Args:
            i: Number of the run.
            states: Samples of the run and its last state: t (n), q, v, u.
            steps: Number of steps.
            ended_well: Whether the run came to its end.
            failed: Whether it diverged.
        """
        stepper, start = self._stepper(i), (_row(self.initial.q, i), _row(self.initial.v, i))
        how = {"ended_well": ended_well, "failed": failed}
        if ended_well and len(states[0]) < steps <= _MADE_AGAIN:
            states = self._ends_of_steps(stepper, start, states, steps)
        return examine_run(stepper, self.settings, start, states, steps, **how)

    def _ends_of_steps(
        self, stepper: Stepper, start: tuple[Array, Array], states: tuple[Array, ...], steps: int
    ) -> tuple[Array, ...]:
        """Ends of the steps of a run that is made once more, where its samples are fewer; the samples where it is not.

        What steps pass over does not depend on what is recorded of them.
        """
        begin, every = (self.settings.t0, *start), -(-steps // _KEPT)
        if not repeatable(stepper, self.settings, states):
            return states
        status, ends = repeated(stepper, self.settings, begin, float(states[0][-1]), self.settings.dt, every=every)
        return tuple(ends) if status == Status.FINISHED and len(ends[0]) > len(states[0]) else states

    def input_fault(self, i: int, t: float, q: Array, v: Array) -> str:
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
        return self._first if one_serves_all else self._single(i)

    @cached_property
    def _first(self) -> Stepper:
        return self._single(0)

    def _single(self, i: int) -> Stepper:
        inputs = self.initial.inputs
        signals = [
            (index, t, values[i] if stride else values, linear)
            for (index, t, values, linear), stride in zip(inputs.plan.signals, inputs.strides, strict=True)
        ]
        plan = replace(inputs.plan, constant=_row(inputs.constant, i), signals=signals)
        model, par = self.model.with_precision("double"), _row(self.initial.par, i)
        stepper = Stepper(model, self.settings.method, plan, (), par)
        self.settings.apply(stepper)
        stepper.start(_row(self.initial.q, i), _row(self.initial.v, i), max(1, len(self.settings.grid)))
        return stepper

    def __getstate__(self) -> dict[str, Any]:
        """All but the stepper, whose memory is that of C."""
        return {name: value for name, value in vars(self).items() if name != "_first"}


def _row(rows: Array, i: int) -> Array:
    """Row i, or the one row for all."""
    row: Array = rows[i if len(rows) > 1 else 0]
    return row
