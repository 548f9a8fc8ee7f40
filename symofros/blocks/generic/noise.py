"""Random numbers that are the same compiled and interpreted.

The generator is MRG32k3a: P. L'Ecuyer, Good parameters and implementations for combined multiple recursive random
number generators, Operations Research 47 (1999). Its integers stay below 2^53, so that double arithmetic is exact.
Streams lie 2^127 apart and their substreams 2^76, as in L'Ecuyer, Simard, Chen, Kelton, Operations Research 50 (2002).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from symofros.blocks.checks import choice, numbers, whole
from symofros.blocks.generic.sampling import needs_period
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Values
from symofros.diagrams.tensor import Tensor, stacked

_M1, _M2 = 4294967087, 4294944443
_A12, _A13N, _A21, _A23N = 1403580, 810728, 527612, 1370589
_FIRST = 12345
_STREAM, _SUBSTREAM = 127, 76
# Components of one block, each with a substream.
MAX_COMPONENTS = 64

_Matrix = list[list[int]]
_RECURSIONS: tuple[tuple[_Matrix, int], ...] = (
    ([[0, 1, 0], [0, 0, 1], [-_A13N, _A12, 0]], _M1),
    ([[0, 1, 0], [0, 0, 1], [-_A23N, 0, _A21]], _M2),
)


def stream(seed: int, component: int) -> list[int]:
    """The six integers with which a component of a stream begins."""
    state: list[int] = []
    for A, m in _RECURSIONS:
        jump = _product(_power(A, seed << _STREAM, m), _power(A, component << _SUBSTREAM, m), m)
        state += [sum(row) * _FIRST % m for row in jump]
    return state


def _product(A: _Matrix, B: _Matrix, m: int) -> _Matrix:
    return [[sum(a * b for a, b in zip(row, col, strict=True)) % m for col in zip(*B, strict=True)] for row in A]


def _power(A: _Matrix, n: int, m: int) -> _Matrix:
    result: _Matrix = [[int(i == j) for j in range(3)] for i in range(3)]
    while n:
        if n & 1:
            result = _product(result, A, m)
        A, n = _product(A, A, m), n >> 1
    return result


@dataclass(frozen=True, kw_only=True)
class Noise(Block):
    """White noise at samples: y = mean + scale n, with n normal (0, 1), or uniform within -1 to 1.

    The generator is exact on any machine. What is made of its numbers may differ in the last bit between processors
    with and without fused operations.

    Attributes:
        scale: Standard deviation, or greatest distance from the mean; one, or one an entry.
        mean: Mean of the signal.
        seed: Seed of the stream; different seeds never overlap.
        kind: "normal" (Box and Muller) or "uniform".
        size: Number of entries (n); 0 for a scalar.
        unit: Unit of the signal.
    """

    scale: Any = 1.0
    mean: Any = 0.0
    seed: int = 0
    kind: str = "normal"
    size: int = 0
    unit: str = ""
    tunable: ClassVar[tuple[str, ...]] = ("scale", "mean")

    def __post_init__(self) -> None:
        """Numbers that fit the size."""
        whole(self.name, "seed", self.seed, 0, 2**32 - 1)
        whole(self.name, "size", self.size, 0, MAX_COMPONENTS)
        choice(self.name, "kind", self.kind, ("normal", "uniform"))
        for field in self.tunable:
            value = getattr(self, field)
            numbers(self.name, field, value, (self.size,) if np.ndim(value) else ())
        needs_period(self)

    def ports(self, environment: Environment) -> Ports:
        """Output y."""
        return Ports((), (Port("y", (self.size,) if self.size else (), self.unit),))

    def memory(self, environment: Environment) -> dict[str, Any]:
        """The state of each component's generator (6, n)."""
        return {"state": np.array([stream(self.seed, i) for i in range(max(1, self.size))], dtype=np.float64).T}

    def _drawn(self, context: EvaluationContext) -> tuple[Tensor, Tensor]:
        """Numbers (n), and the state after."""
        state, first = _advance(context.memory["state"])
        if self.kind == "uniform":
            return 2.0 * first - 1.0, state
        state, second = _advance(state)
        angle = (2.0 * math.pi) * second
        return (-2.0 * first.apply("log")).apply("sqrt") * angle.apply("cos"), state

    def compute(self, context: EvaluationContext) -> Values:
        """The next numbers."""
        drawn = self._drawn(context)[0].reshape(*(self.size,) if self.size else ())
        return {"y": context.parameters["mean"] + context.parameters["scale"] * drawn}

    def update(self, context: EvaluationContext) -> Values:
        """The state after them."""
        return {"state": self._drawn(context)[1]}


def _advance(state: Tensor) -> tuple[Tensor, Tensor]:
    """One turn of the generator: state (6, n), numbers (n) between 0 and 1, both ends left out."""
    p = _remainder(_A12 * state[1] - _A13N * state[0], _M1)
    r = _remainder(_A21 * state[5] - _A23N * state[3], _M2)
    turned = stacked([state[1], state[2], p, state[4], state[5], r])
    wrapped = p - r + _M1 * (r - p).apply("step")
    # A product could be fused with what follows it, which changes the last bit from machine to machine.
    return turned, wrapped / (_M1 + 1.0)


def _remainder(x: Tensor, m: int) -> Tensor:
    """Remainder of whole numbers x modulo m; corrected where the rounded quotient is one too large."""
    rest = x - (x / float(m)).apply("floor") * float(m)
    return rest + float(m) * (1.0 - rest.apply("step"))
