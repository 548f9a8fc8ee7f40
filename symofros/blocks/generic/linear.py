"""Linear systems, continuous and sampled: state space, transfer function."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.blocks.checks import numbers, refuse
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Values
from symofros.diagrams.tensor import Tensor

# States of one block, whose formula has as many squared terms.
MOST_STATES = 200


@dataclass(frozen=True, kw_only=True)
class _Linear(Block, ABC):
    """Base class of linear blocks; x is a continuous state, or stored from sample to sample."""

    @abstractmethod
    def matrices(self) -> tuple[Array, Array, Array, Array]:
        """A (n, n), B (n, m), C (p, n), D (p, m)."""

    def first(self) -> Any:
        """The first x (n)."""
        return np.zeros(len(self.matrices()[0]))

    def states(self, environment: Environment) -> dict[str, Any]:
        """Continuous: x."""
        return {"x": self.first()} if self.period is None else {}

    def memory(self, environment: Environment) -> dict[str, Any]:
        """Sampled: x."""
        return {} if self.period is None else {"x": self.first()}

    def _next(self, context: EvaluationContext) -> Values:
        A, B, _, _ = self.matrices()
        return {"x": context.numbers(A) @ self._x(context) + context.numbers(B) @ context.inputs["u"].reshape(-1)}

    def _x(self, context: EvaluationContext) -> Tensor:
        return context.states["x"] if self.period is None else context.memory["x"]

    def compute(self, context: EvaluationContext) -> Values:
        """C x + D u."""
        _, _, C, D = self.matrices()
        y = context.numbers(C) @ self._x(context) + context.numbers(D) @ context.inputs["u"].reshape(-1)
        return {"y": y.reshape(*(len(C),) if context.inputs["u"].shape else ())}

    def rates(self, context: EvaluationContext) -> Values:
        """Continuous: A x + B u."""
        return self._next(context) if self.period is None else {}

    def update(self, context: EvaluationContext) -> Values:
        """Sampled: A x + B u."""
        return {} if self.period is None else self._next(context)


@dataclass(frozen=True, kw_only=True)
class StateSpace(_Linear):
    """x' = A x + B u, y = C x + D u; sampled, x[k + 1] = A x[k] + B u[k].

    Attributes:
        A: (n, n).
        B: (n, m).
        C: (p, n).
        D: (p, m), zero if None.
        start: First x (n), or one number.
    """

    A: Any
    B: Any
    C: Any
    D: Any = None
    start: Any = 0.0

    def __post_init__(self) -> None:
        """Matrices that fit each other."""
        n = len(numbers(self.name, "A", self.A, (None, None)))
        m = numbers(self.name, "B", self.B, (n, None)).shape[1]
        p = len(numbers(self.name, "C", self.C, (None, n)))
        numbers(self.name, "A", self.A, (n, n))
        if self.D is not None:
            numbers(self.name, "D", self.D, (p, m))
        if np.ndim(self.start):
            numbers(self.name, "start", self.start, (n,))
        if n > MOST_STATES:
            raise refuse(self.name, "too many states", n, f"at most {MOST_STATES}", "reduce the system")

    def matrices(self) -> tuple[Array, Array, Array, Array]:
        """The matrices A, B, C, D as given; D is zero if left out."""
        A, B, C = (np.asarray(matrix, dtype=np.float64) for matrix in (self.A, self.B, self.C))
        return A, B, C, np.zeros((len(C), B.shape[1])) if self.D is None else np.asarray(self.D, dtype=np.float64)

    def first(self) -> Any:
        """The initial x (n)."""
        return np.zeros(len(self.A)) + np.asarray(self.start, dtype=np.float64)

    def ports(self, environment: Environment) -> Ports:
        """Input u (m), output y (p)."""
        p, m = self.matrices()[3].shape
        return Ports((Port("u", (m,)),), (Port("y", (p,)),))


@dataclass(frozen=True, kw_only=True)
class TransferFunction(_Linear):
    """y = num / den u of one signal, in s; sampled, in z. It starts from rest.

    Attributes:
        num: Coefficients of the numerator, highest power first.
        den: Coefficients of the denominator, of no lower degree.
    """

    num: Any
    den: Any

    def __post_init__(self) -> None:
        """A proper fraction."""
        num, den = (numbers(self.name, field, getattr(self, field), (None,)) for field in ("num", "den"))
        if not len(den) or den[0] == 0.0 or not 0 < len(num) <= len(den) or len(den) > MOST_STATES:
            raise refuse(
                self.name,
                "num / den is no proper fraction",
                f"{num} / {den}",
                "den begins with its highest power, not zero; num has no higher degree",
                "drop leading zeros, or add a pole",
            )

    def matrices(self) -> tuple[Array, Array, Array, Array]:
        """The controller canonical form."""
        den = np.asarray(self.den, dtype=np.float64)
        num = np.concatenate([np.zeros(len(den) - len(self.num)), np.asarray(self.num, dtype=np.float64)]) / den[0]
        a, n = den[1:] / den[0], len(den) - 1
        A, B = np.eye(n, k=-1), np.eye(n, 1)
        if n:
            A[0] = -a
        return A, B, (num[1:] - num[0] * a).reshape(1, n), num[:1].reshape(1, 1)

    def ports(self, environment: Environment) -> Ports:
        """Input u and output y, scalars."""
        return Ports((Port("u", ()),), (Port("y", ()),))
