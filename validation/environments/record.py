"""What a run says: times and differences of each side, and who was not there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import nan
from statistics import median

from ..contract.quantities import SOLVE
from ..reporting.plain import Number
from ..timing.models import Labelled

OURS = "symofros"
NATIVE = "C"
# Of the largest entry of a state's result, by anyone from our C: rounding, amplified by the condition of M.
TOLERANCE = SOLVE


@dataclass(frozen=True)
class Row(Labelled):
    """One side of one function.

    Attributes:
        environment: Name of the environment.
        model: Label of the model.
        function: Name of the function, as of our generated ones.
        states: States in a call.
        who: `OURS`, `NATIVE`, or the peer.
        least: Least time over the turns [ns a state]; median: their median.
        ratio: Median over the turns of this side's time over ours [1]; NaN where ours could not be raced.
        error: Largest difference from native C, relative to the largest entry of a state's result [1].
    """

    environment: str
    model: str
    function: str
    states: int
    who: str
    least: float
    median: float
    ratio: Number
    error: float

    @classmethod
    def of(
        cls,
        environment: str,
        model: str,
        function: str,
        states: int,
        who: str,
        times: Sequence[float],
        ours: Sequence[float] | None,
        error: float,
    ) -> Row:
        """A row from the times of the turns of a side and of ours [ns a state]."""
        ratio = median(x / y for x, y in zip(times, ours, strict=True)) if ours else nan
        return cls(environment, model, function, states, who, min(times), median(times), ratio, error)


@dataclass(frozen=True)
class Absent:
    """An environment or a peer that has no numbers here.

    Attributes:
        environment: Name of the environment.
        who: The peer; `OURS` where the environment itself is missing.
        reason: Why, in words.
        remedy: What to do: a command where one helps.
    """

    environment: str
    who: str
    reason: str
    remedy: str = ""


@dataclass
class Record:
    """Everything of a run.

    Attributes:
        rows: What was measured.
        absent: What was not.
        failed: Environment, function, side, and what went wrong: it could not be computed, or differs.
        packages: Package -> version.
    """

    rows: list[Row] = field(default_factory=list)
    absent: list[Absent] = field(default_factory=list)
    failed: list[tuple[str, str, str, str]] = field(default_factory=list)
    packages: dict[str, str] = field(default_factory=dict)

    @property
    def ok(self) -> bool:
        """Whether something was measured, and all of it agrees with native C."""
        return bool(self.rows) and not self.failed and all(row.error <= TOLERANCE for row in self.rows)
