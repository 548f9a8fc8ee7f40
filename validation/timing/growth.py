"""How times, operations, generation and compilation grow with the number of joints: exponents of power laws."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from validation.timing.models import CHAINS
from validation.timing.record import Made, Record

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
    """Everything that was measured over at least two of the chains."""
    curves = []
    for function in FUNCTIONS:
        own = {n: x for n in CHAINS for x in record.entries if (x.model, x.function) == (f"chain{n}", function)}
        curves.append(_curve(function, "time [ns]", "symofros", {n: x.generated_time[1] for n, x in own.items()}))
        in_batches = {n: x.batch[1] for n, x in own.items() if x.batch is not None}
        curves.append(_curve(function, "time [ns]", "symofros, batch", in_batches))
        for peer in ("pinocchio", "mujoco", "casadi"):
            races = {n: record.best(f"chain{n}", function, peer) for n in CHAINS}
            curves.append(_curve(function, "time [ns]", peer, {n: x.peer_time[1] for n, x in races.items() if x}))
        for by in ("symofros", "casadi"):
            made = {n: record.cost(f"chain{n}", function, by) for n in CHAINS}
            for quantity, cost in _COSTS.items():
                curves.append(_curve(function, quantity, by, {n: cost(x) for n, x in made.items() if x}))
    return [curve for curve in curves if len(curve.n) > 1]


_COSTS: dict[str, Callable[[Made], float]] = {
    "operations": lambda cost: float(cost.total),
    "generation [s]": lambda cost: cost.generation,
    "compilation [s]": lambda cost: cost.compilation,
    "machine code [bytes]": lambda cost: float(cost.code),
}


def _curve(function: str, quantity: str, who: str, values: Mapping[int, float]) -> Growth:
    known = {n: value for n, value in values.items() if value}
    n, y = tuple(known), tuple(known.values())
    return Growth(function, quantity, who, n, y, exponent(n, y))
