"""Linear systems, continuous and sampled: state space, transfer function, notch, Kalman filter."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.blocks.checks import number, numbers, refuse, weights
from symofros.blocks.controllers.riccati import continuous_gain, filter_gain
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Values
from symofros.diagrams.tensor import Tensor, joined

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
        return {"x": context.numbers(A) @ self._x(context) + context.numbers(B) @ self.inputs_of(context)}

    def inputs_of(self, context: EvaluationContext) -> Tensor:
        """What B multiplies."""
        return context.inputs["u"].reshape(-1)

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
        return _controller_form(*(np.asarray(x, dtype=np.float64) for x in (self.num, self.den)))

    def ports(self, environment: Environment) -> Ports:
        """Input u and output y, scalars."""
        return Ports((Port("u", ()),), (Port("y", ()),))


def _controller_form(num: Array, den: Array) -> tuple[Array, Array, Array, Array]:
    """A, B, C, D of num / den in controller canonical form."""
    num = np.concatenate([np.zeros(len(den) - len(num)), num]) / den[0]
    a, n = den[1:] / den[0], len(den) - 1
    A, B = np.eye(n, k=-1), np.eye(n, 1)
    if n:
        A[0] = -a
    return A, B, (num[1:] - num[0] * a).reshape(1, n), num[:1].reshape(1, 1)


@dataclass(frozen=True, kw_only=True)
class Notch(_Linear):
    """(s^2 + 2 depth damping w s + w^2) / (s^2 + 2 damping w s + w^2) of one signal: one frequency is taken out.

    Sampled, by the bilinear transform that keeps what it is at w.

    Attributes:
        frequency: w / (2 pi) [Hz]; sampled, below half of the rate.
        damping: Of the poles: a band of about 2 damping w is taken out.
        depth: Gain at the frequency itself, 0 to 1.
    """

    frequency: float
    damping: float = 0.5
    depth: float = 0.0

    def __post_init__(self) -> None:
        """A frequency below half of the rate, a band, a gain."""
        number(self.name, "frequency", self.frequency, 0.0, exclusive=True)
        number(self.name, "damping", self.damping, 0.0, exclusive=True)
        number(self.name, "depth", self.depth, 0.0, 1.0)
        if self.period and 2.0 * self.frequency * self.period >= 1.0:
            rule = "below half of the rate of samples"
            raise refuse(self.name, "frequency is out of reach", self.frequency, rule, "sample more often")

    def matrices(self) -> tuple[Array, Array, Array, Array]:
        """The controller canonical form."""
        w = 2.0 * math.pi * self.frequency
        num, den = (np.array([1.0, 2.0 * share * self.damping * w, w * w]) for share in (self.depth, 1.0))
        if self.period is not None:  # s = k (z - 1) / (z + 1), with k such that z = exp(i w T) is s = i w.
            k = w / math.tan(0.5 * w * self.period)
            powers = np.array([[k * k, -2.0 * k * k, k * k], [k, 0.0, -k], [1.0, 2.0, 1.0]])
            num, den = num @ powers, den @ powers
        return _controller_form(num, den)

    def ports(self, environment: Environment) -> Ports:
        """Input u and output y, scalars."""
        return Ports((Port("u", ()),), (Port("y", ()),))


@dataclass(frozen=True, kw_only=True)
class KalmanFilter(_Linear):
    """The best linear estimate of x from u and y in the long run: x' = A x + B u + w, y = C x + e.

    Sampled, x[k + 1] = A x[k] + B u[k] + w[k]; the estimate is of the sample, its y included.

    Attributes:
        A: (n, n).
        B: (n, m).
        C: (p, n).
        Q: Intensity of the noise w, sampled its covariance: one, one an entry (n), or a matrix (n, n), not negative.
        R: Of the noise e: one, one an entry (p), or a matrix (p, p), positive.
        start: First x (n), or one number.
    """

    A: Any
    B: Any
    C: Any
    Q: Any
    R: Any
    start: Any = 0.0

    def __post_init__(self) -> None:
        """Matrices that fit each other, and an estimate that settles."""
        n = len(numbers(self.name, "A", self.A, (None, None)))
        numbers(self.name, "A", self.A, (n, n))
        numbers(self.name, "B", self.B, (n, None))
        p = len(numbers(self.name, "C", self.C, (None, n)))
        weights(self.name, "Q", self.Q, n)
        weights(self.name, "R", self.R, p, positive=True)
        if np.ndim(self.start):
            numbers(self.name, "start", self.start, (n,))
        if n > MOST_STATES:
            raise refuse(self.name, "too many states", n, f"at most {MOST_STATES}", "reduce the system")
        self._gain()

    def _given(self) -> tuple[Array, Array, Array]:
        A, B, C = (np.asarray(matrix, dtype=np.float64) for matrix in (self.A, self.B, self.C))
        return A, B, C

    def _gain(self) -> Array:
        """L (n, p)."""
        A, _, C = self._given()
        Q, R = weights(self.name, "Q", self.Q, len(A)), weights(self.name, "R", self.R, len(C), positive=True)
        K = continuous_gain(A.T, C.T, Q, R) if self.period is None else filter_gain(A, C, Q, R)
        if K is None:
            rule = "y sees every motion that does not die out, and noise reaches those"
            raise refuse(
                self.name, "no estimate that settles", "no gain", rule, "measure more, or say where noise enters"
            )
        return np.asarray(K.T if self.period is None else K)

    def matrices(self) -> tuple[Array, Array, Array, Array]:
        """Matrices A, B, C, D of the estimate, driven by (u; y)."""
        (A, B, C), L = self._given(), self._gain()
        n, m, p = len(A), B.shape[1], len(C)
        if self.period is None:
            return A - L @ C, np.hstack([B, L]), np.eye(n), np.zeros((n, m + p))
        kept = np.eye(n) - L @ C  # The state is the prediction before y is known.
        return A @ kept, np.hstack([B, A @ L]), kept, np.hstack([np.zeros((n, m)), L])

    def first(self) -> Any:
        """The initial x (n)."""
        return np.zeros(len(self.A)) + np.asarray(self.start, dtype=np.float64)

    def ports(self, environment: Environment) -> Ports:
        """Inputs u (m), y (p); output x (n)."""
        A, B, C = self._given()
        return Ports((Port("u", B.shape[1:]), Port("y", (len(C),))), (Port("x", (len(A),)),))

    def inputs_of(self, context: EvaluationContext) -> Tensor:
        """u, then y."""
        return joined([context.inputs["u"], context.inputs["y"]])

    def compute(self, context: EvaluationContext) -> Values:
        """The estimate."""
        _, _, C, D = self.matrices()
        return {"x": context.numbers(C) @ self._x(context) + context.numbers(D) @ self.inputs_of(context)}
