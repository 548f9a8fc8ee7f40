"""Exudyn's contestants of a problem: a system, stepped by each of its solvers."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ...adapters.exudyn.steps import ADAPTIVE, Recorded, Solver, Timed
from ..problem import Contestant, Measured


@dataclass(frozen=True)
class ExudynModel:
    """A system of Exudyn's, ready to run.

    Attributes:
        label: Name of the model among those of the problem.
        system: Built afresh for each run, which is not timed.
        end: Duration [s].
        output: Interval of what is recorded [s].
        judge: Record of a run -> error. Solvers that choose their steps record at the first step after each time due,
            so that the times count.
    """

    label: str
    system: Timed
    end: float
    output: float
    judge: Callable[[Recorded], float]

    def by(self, solver: Solver, steps: Sequence[float]) -> list[Contestant]:
        """A contestant for each step [s]; of solvers that choose their steps, for each tolerance."""
        adapts = solver.kind in ADAPTIVE

        def run(step: float) -> Measured:
            chosen = Solver(solver.kind, relative=step) if adapts else solver
            return self.measured(self.system.run(chosen, self.output if adapts else step, self.end, self.output))

        return Contestant.swept(("Exudyn", self.label, solver.name), run, steps, adapts)

    def measured(self, recorded: Recorded) -> Measured:
        """A run that is judged; one that is cut short has no error."""
        if recorded.ended:
            return Measured(math.nan, recorded.seconds, recorded.ended)
        if len(recorded.values) != round(self.end / self.output) + 1:
            return Measured(math.nan, recorded.seconds, f"{len(recorded.values)} records at other times")
        with np.errstate(over="ignore", invalid="ignore"):
            return Measured(self.judge(recorded), recorded.seconds)
