"""How times, operations, generation and compilation grow with the number of joints: exponents of power laws."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from validation.timing.models import CHAINS
from validation.timing.record import Entry, Made, Record

FUNCTIONS = ("dynamics", "forward_dynamics")
# Shorter chains are mostly constants: an exponent is that of the upper part.
FROM = 7


@dataclass(frozen=True)
class Growth:
    """One quantity over the lengths of chains.

    Attributes:
        function: Generated function.
        quantity: Name of the growing quantity, with its unit.
        who: Generator or engine.
        n: Numbers of joints.
        values: Values of the quantity.
        exponent: Slope on logarithmic axes from FROM joints on; NaN where two points are not to be had.
    """

    function: str
    quantity: str
    who: str
    n: tuple[int, ...]
    values: tuple[float, ...]
    exponent: float


def exponent(n: Sequence[float], values: Sequence[float]) -> float:
    """The slope of log(values) over log(n), by least squares from FROM on; of all points where too few are there."""
    upper = [(x, y) for x, y in zip(n, values, strict=True) if x >= FROM]
    pairs = upper if len(upper) > 1 else list(zip(n, values, strict=True))
    if len(pairs) < 2:
        return float("nan")
    x, y = np.log(np.array(pairs)).T
    return float(np.polyfit(x, y, 1)[0])


def growth(record: Record) -> list[Growth]:
    """Everything that was measured over the chains."""
    curves = []
    for function in FUNCTIONS:
        for who, value in _times().items():
            curves.append(_curve(record, function, "time [ns]", who, value))
        for who in ("symofros", "casadi"):
            for quantity, cost in _COSTS.items():
                curves.append(_curve(record, function, quantity, who, _of_cost(who, cost)))
    return [curve for curve in curves if len(curve.n) > 1]


_Value = Callable[[Record, str, str], float | None]
_COSTS: dict[str, Callable[[Made], float]] = {
    "operations": lambda cost: float(cost.total),
    "generation [s]": lambda cost: cost.generation,
    "compilation [s]": lambda cost: cost.compilation,
    "machine code [bytes]": lambda cost: float(cost.code),
}


def _times() -> dict[str, _Value]:
    def ours(record: Record, model: str, function: str) -> float | None:
        entry = _any(record, model, function)
        return None if entry is None else entry.ours[1]

    def batch(record: Record, model: str, function: str) -> float | None:
        entry = _any(record, model, function)
        return None if entry is None or entry.batch is None else entry.batch[1]

    def theirs(peer: str) -> _Value:
        def value(record: Record, model: str, function: str) -> float | None:
            entry = record.best(model, function, peer)
            return None if entry is None else entry.theirs[1]

        return value

    return {
        "symofros": ours,
        "symofros, batch": batch,
        **{peer: theirs(peer) for peer in ("pinocchio", "mujoco", "casadi")},
    }


def _any(record: Record, model: str, function: str) -> Entry | None:
    return next((x for x in record.entries if (x.model, x.function) == (model, function)), None)


def _of_cost(who: str, quantity: Callable[[Made], float]) -> _Value:
    def value(record: Record, model: str, function: str) -> float | None:
        cost = record.cost(model, function, who)
        return None if cost is None else quantity(cost)

    return value


def _curve(record: Record, function: str, quantity: str, who: str, value: _Value) -> Growth:
    values = {n: value(record, f"chain{n}", function) for n in CHAINS}
    known = {n: x for n, x in values.items() if x}
    n, y = tuple(known), tuple(known.values())
    return Growth(function, quantity, who, n, y, exponent(n, y))
