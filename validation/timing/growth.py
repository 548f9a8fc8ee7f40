"""How times, operations, generation and compilation grow with the size of models: exponents of power laws."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .models import CHAINS, ROWS
from .record import Made, Record

# Smaller models are mostly constants: an exponent is that of the upper part.
FROM = 7


@dataclass(frozen=True)
class Family:
    """Models of one kind and many sizes.

    Attributes:
        name: Name in tables.
        models: Labels of the models by size.
        functions: Functions that are timed of all of them.
    """

    name: str
    models: Mapping[int, str]
    functions: tuple[str, ...]


FAMILIES = (
    Family("joints of a chain", {n: f"chain{n}" for n in CHAINS}, ("dynamics", "forward_dynamics")),
    Family("four-bars in a row", {n: f"four_bars{n}" for n in ROWS}, ("forward_dynamics",)),
)


@dataclass(frozen=True)
class Growth:
    """One quantity over the sizes of a family.

    Attributes:
        family: Name of the family.
        function: Generated function.
        quantity: Name of the growing quantity, with its unit.
        who: Generator or engine.
        n: Sizes.
        values: Values of the quantity.
        exponent: Slope on logarithmic axes from FROM on; NaN where two points are not to be had.
    """

    family: str
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
    """Everything that was measured over at least two models of a family."""
    curves = [c for family in FAMILIES for function in family.functions for c in _of(record, family, function)]
    return [curve for curve in curves if len(curve.n) > 1]


def _of(record: Record, family: Family, function: str) -> Iterator[Growth]:
    def curve(quantity: str, who: str, values: Mapping[int, float]) -> Growth:
        known = {n: value for n, value in values.items() if value}
        n, y = tuple(known), tuple(known.values())
        return Growth(family.name, function, quantity, who, n, y, exponent(n, y))

    entries = {(x.model, x.function): x for x in record.entries}
    own = {n: entries[model, function] for n, model in family.models.items() if (model, function) in entries}
    # Where no peer has the function there is no race, and its time stands with its cost.
    costs = {n: record.cost(model, function, "symofros") for n, model in family.models.items()}
    alone = {n: cost.time for n, cost in costs.items() if cost is not None}
    yield curve(
        "time [ns]", "symofros", dict(sorted((alone | {n: x.generated_time[1] for n, x in own.items()}).items()))
    )
    yield curve("time [ns]", "symofros, batch", {n: x.batch[1] for n, x in own.items() if x.batch is not None})
    for peer in ("pinocchio", "mujoco", "casadi"):
        races = {n: record.best(model, function, peer) for n, model in family.models.items()}
        yield curve("time [ns]", peer, {n: x.peer_time[1] for n, x in races.items() if x})
    for by in ("symofros", "casadi"):
        made = {n: record.cost(model, function, by) for n, model in family.models.items()}
        for quantity, cost in _COSTS.items():
            yield curve(quantity, by, {n: cost(x) for n, x in made.items() if x})


_COSTS: dict[str, Callable[[Made], float]] = {
    "operations": lambda cost: float(cost.total),
    "generation [s]": lambda cost: cost.generation,
    "compilation [s]": lambda cost: cost.compilation,
    "machine code [bytes]": lambda cost: float(cost.code),
}
