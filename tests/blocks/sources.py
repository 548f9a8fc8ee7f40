"""Blocks for tests of others."""

from __future__ import annotations

from dataclasses import dataclass

from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Values
from symofros.diagrams.tensor import joined


@dataclass(frozen=True, kw_only=True)
class Ramp(Block):
    """Time, and twice of it."""

    def ports(self, environment: Environment) -> Ports:
        return Ports((), (Port("y", (2,), "s"),))

    def compute(self, context: EvaluationContext) -> Values:
        return {"y": joined([context.t, 2.0 * context.t])}
