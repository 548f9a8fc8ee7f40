"""Blocks for tests of others."""

from __future__ import annotations

from dataclasses import dataclass

from symofros.diagrams.block import At, Block, Known, Port, Ports, Values
from symofros.diagrams.tensor import joined


@dataclass(frozen=True, kw_only=True)
class Ramp(Block):
    """Time, and twice of it."""

    def ports(self, known: Known) -> Ports:
        return Ports((), (Port("y", (2,), "s"),))

    def compute(self, at: At) -> Values:
        return {"y": joined([at.t, 2.0 * at.t])}
