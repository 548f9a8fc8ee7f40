"""Contestants of symofros: a compiled model, stepped by each method."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import symofros as sf
from symofros.tools import METHODS

from ..problem import OURS, Contestant, Measured

Judge = Callable[[sf.Trajectory], float]


@dataclass(frozen=True)
class SymofrosModel:
    """A compiled model, ready to run.

    Attributes:
        label: Name of the model among those of the problem.
        model: Compiled model.
        arguments: Arguments of `sf.simulate` besides method, step and tolerance: state, span, inputs, output.
        judge: Trajectory -> error.
        alone: Whether `sf.simulate` runs it; else a batch of one does, whose precision may be chosen.
    """

    label: str
    model: sf.Model
    arguments: Mapping[str, Any]
    judge: Judge
    alone: bool = True

    def by(self, method: str, steps: Sequence[float], **more: Any) -> list[Contestant]:
        """A contestant for each step of a method [s], or each relative tolerance of one that adapts its steps."""
        adapts = METHODS[method].adaptive

        def run(step: float) -> Measured:
            chosen = {"rtol": step, "atol": step * 1e-2} if adapts else {"dt": step}
            return self.measured(method=method, **chosen, **more)

        return Contestant.swept((OURS, self.label, method), run, steps, adapts)

    def in_single_precision(self, method: str, steps: Sequence[float]) -> list[Contestant]:
        """The same with accelerations in floats, states in doubles, by one lane of the code of batches."""
        coarse = replace(self, label=f"{self.label}, floats", model=self.model.with_precision("single"), alone=False)
        return coarse.by(method, steps)

    def measured(self, **settings: Any) -> Measured:
        """One run; what is refused, or does not come to its end, says why."""
        try:
            run, seconds = self._run(settings)
        except sf.SymofrosError as error:
            return Measured(math.nan, math.nan, str(error).splitlines()[0])
        if not run.outcome.ok:
            return Measured(math.nan, seconds, f"{run.outcome.kind}: {run.outcome.reason}")
        # States that grew without bound, but not to infinity, overflow in the judge.
        with np.errstate(over="ignore", invalid="ignore"):
            return Measured(float(self.judge(run)), seconds)

    def _run(self, settings: Mapping[str, Any]) -> tuple[sf.Trajectory, float]:
        """Run the simulation; returns the motion and the processor time it took [s]."""
        if self.alone:
            run = sf.simulate(self.model, **self.arguments, **settings)
            return run, run.statistics.worked
        runs = sf.simulate_batch(self.model, **self.arguments, **settings)
        return runs[()], runs.processor_seconds
