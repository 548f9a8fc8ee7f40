"""MuJoCo's contestants of a problem: a model, stepped by each of its integrators."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...adapters.mujoco.motion import stepped
from ...mechanics.geometry import Array
from ..problem import Contestant, Measured


@dataclass(frozen=True)
class MujocoModel:
    """A model of MuJoCo's, ready to run.

    Attributes:
        label: Name of the model among those of the problem.
        model: Step [s] -> MuJoCo's model; most do not depend on the step, soft closures do.
        q0: Positions at the start (nq).
        v0: Speeds at the start (nv).
        times: Number of records, the start not counted.
        output: Interval of the records [s].
        judge: Positions at the records (times + 1, nq) -> error.
    """

    label: str
    model: Callable[[float], Any]
    q0: Array
    v0: Array
    times: int
    output: float
    judge: Callable[[Array], float]

    def by(self, integrator: str, steps: Sequence[float]) -> list[Contestant]:
        """A contestant for each step [s]."""
        made = {h: self.model(h) for h in steps}

        def run(h: float) -> Measured:
            q, seconds = stepped(made[h], integrator, h, self.q0, self.v0, self.times, round(self.output / h))
            with np.errstate(over="ignore", invalid="ignore"):
                error = self.judge(q)
            return Measured(error, seconds, "" if math.isfinite(error) else "diverged")

        return Contestant.swept(("MuJoCo", self.label, integrator), run, steps, adapts=False)
