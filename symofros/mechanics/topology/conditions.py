"""Conditions on the numbers of a description: margins that are not negative, as formulas of its parameters.

Each is stated once. A description is judged at its parameters' defaults, run-time parameters at their values, whole
batches of them at once, and exported C by the same formulas.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.description.values import Value, symbols
from symofros.errors import Problem
from symofros.expr.expression import CONSTANTS, Expression
from symofros.expr.ops import OPS
from symofros.mechanics.topology.numbers import Numbers

# What a margin must be, besides finite.
Sign = Literal["positive", "not negative", "any"]
# A number, a symbol, or the kind of an operation with the places of its operands.
Step = float | str | tuple[str, list[int]]


class Condition(NamedTuple):
    """A condition on numbers of a description.

    Attributes:
        margins: Formulas of parameters, each of which has the sign.
        sign: Sign of the margins.
        problem: What is wrong where a margin does not have it, from the numbers.
    """

    margins: tuple[Value, ...]
    sign: Sign
    problem: Callable[[Numbers], Problem]

    @property
    def symbols(self) -> frozenset[str]:
        """Parameters that the margins depend on."""
        return frozenset[str]().union(*map(symbols, self.margins))


class Formulas:
    """Formulas evaluated for many states at once, a part that several of them share as one object only once.

    Args:
        formulas: Numbers and formulas.

    Attributes:
        steps: Numbers, symbols, and operations with the places of their operands among the steps, in order.
        results: Place of each formula among the steps.
    """

    def __init__(self, formulas: Sequence[Value]) -> None:
        self.steps: list[Step] = []
        self._places: dict[float | str, int] = {}
        self.results = [self._place(formula) for formula in formulas]
        self._rules = [
            _ARITHMETIC.get(step[0]) or OPS[step[0]].rule if isinstance(step, tuple) else None for step in self.steps
        ]

    def _place(self, formula: Value) -> int:
        """The place of a formula among the steps; without recursion, as sums over a mechanism are nested deeply."""
        pending = [formula]
        while pending:
            stated = pending.pop()
            key = _key(stated)
            if key in self._places:
                continue
            step: Step = key
            if isinstance(stated, Expression) and stated.args:
                missing = [arg for arg in stated.args if _key(arg) not in self._places]
                if missing:
                    pending += [stated, *missing]
                    continue
                step = stated.kind, [self._places[_key(arg)] for arg in stated.args]
            self._places[key] = len(self.steps)
            self.steps.append(step)
        return self._places[_key(formula)]

    @property
    def symbols(self) -> frozenset[str]:
        """Names that the formulas depend on."""
        return frozenset(step for step in self.steps if isinstance(step, str))

    def __call__(self, values: Mapping[str, Array | float]) -> list[Array | float]:
        """The values; NaN or infinite outside a formula's domain.

        Args:
            values: Number of each symbol, or an array of one for each state.
        """
        known: list[Any] = []
        with np.errstate(all="ignore"):
            for step, rule in zip(self.steps, self._rules, strict=True):
                if isinstance(step, tuple) and rule is not None:
                    known.append(rule(*[known[i] for i in step[1]]))
                else:
                    known.append(values[step] if isinstance(step, str) else step)
        return [known[i] for i in self.results]


def _key(formula: Value) -> float | str:
    """What a step is found by: a number, a symbol, or an operation as an object."""
    if not isinstance(formula, Expression) or formula.kind == "number":
        return formula.number if isinstance(formula, Expression) else formula
    return CONSTANTS.get(formula.name, formula.name) if formula.kind == "symbol" else f"operation {id(formula)}"


class Conditions:
    """Several conditions, judged together.

    Args:
        conditions: Conditions.
    """

    def __init__(self, conditions: Iterable[Condition]) -> None:
        self.conditions = tuple(conditions)
        self.formulas = Formulas([margin for condition in self.conditions for margin in condition.margins])
        signs = [condition.sign for condition in self.conditions for _ in condition.margins]
        self._positive = np.array([[sign == "positive"] for sign in signs], dtype=bool).reshape(-1, 1)
        self._any = np.array([[sign == "any"] for sign in signs], dtype=bool).reshape(-1, 1)
        self._first = np.cumsum([0, *(len(condition.margins) for condition in self.conditions)])[:-1]

    def violated(self, values: Mapping[str, Array | float], states: int = 1) -> npt.NDArray[np.bool_]:
        """Where a margin lacks its sign, or is not finite: (conditions, states)."""
        if not self.conditions:
            return np.zeros((0, states), dtype=bool)
        margins = np.empty((len(self._any), states))
        for row, margin in zip(margins, self.formulas(values), strict=True):
            row[:] = margin
        with np.errstate(invalid="ignore"):
            holds = np.isfinite(margins) & (self._any | np.where(self._positive, margins > 0.0, margins >= 0.0))
        return np.logical_or.reduceat(~holds, self._first, axis=0)


def violations(conditions: Iterable[Condition], numbers: Numbers) -> Iterator[Problem]:
    """The problems of conditions that do not hold; those of names that have no value are passed over."""
    judged = Conditions(conditions)
    if not judged.formulas.symbols <= numbers.parameters.keys():
        judged = Conditions(c for c in judged.conditions if c.symbols <= numbers.parameters.keys())
    for condition, violated in zip(judged.conditions, judged.violated(numbers.parameters), strict=True):
        if violated[0]:
            yield condition.problem(numbers)


_ARITHMETIC: dict[str, Callable[..., Any]] = {
    "add": np.add,
    "sub": np.subtract,
    "mul": np.multiply,
    "div": np.divide,
    "neg": np.negative,
    "sqrt": np.sqrt,
}
