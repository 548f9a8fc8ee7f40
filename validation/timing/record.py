"""What a run measured, as plain data that later runs add to."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from symofros.tools import stored_json

from ..reporting.plain import plain, restored
from .models import Labelled

SCHEMA = 2


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="minutes")


@dataclass(frozen=True)
class Entry(Labelled):
    """One function of one model by the generated C and by one build of one peer, timed in turn.

    Attributes:
        model: Label of the model.
        nv: Degrees of freedom.
        function: Timed function.
        peer: Name of the engine or generator that the generated C is compared with.
        variant: Build of the peer and formulation of the function.
        generated_time: Minimum and median of the generated C, nanoseconds a state, state by state.
        peer_time: Minimum and median of the peer, nanoseconds a state.
        batch: Minimum and median of the generated C by vectors, row by row; None without such code.
        error: Largest relative difference of the results.
        date: Date of the race (UTC).
        columns: The same column by column.
        single: The same column by column in single precision.
    """

    model: str
    nv: int
    function: str
    peer: str
    variant: str
    generated_time: tuple[float, float]
    batch: tuple[float, float] | None
    peer_time: tuple[float, float]
    error: float
    date: str = field(default_factory=_now)
    columns: tuple[float, float] | None = None
    single: tuple[float, float] | None = None

    @property
    def ratio(self) -> float:
        """Ratio of the medians, the peer's to that of the generated C."""
        return self.peer_time[1] / self.generated_time[1]

    @property
    def batch_ratio(self) -> float | None:
        """Ratio of the medians, the peer's to that of the generated C by vectors, row by row."""
        return None if self.batch is None else self.peer_time[1] / self.batch[1]

    @property
    def columns_ratio(self) -> float | None:
        """The same column by column."""
        return None if self.columns is None else self.peer_time[1] / self.columns[1]


@dataclass(frozen=True)
class Cost:
    """What it takes to make a function, and what it takes to run it.

    Attributes:
        generation: Time from the description to C text [s].
        compilation: Time from C text to machine code [s].
        text: Bytes of C.
        code: Bytes of machine code; constants: of constants.
        operations: Executed: "mul", "add", "div", "call".
        memory: Bytes read and written by one call: inputs, constants made in advance, outputs.
    """

    generation: float
    compilation: float
    text: int
    code: int
    constants: int
    operations: Mapping[str, int]
    memory: int

    @property
    def total(self) -> int:
        """Operations of all kinds."""
        return sum(self.operations.values())


@dataclass(frozen=True)
class Made(Labelled, Cost):
    """What a generated function costs to make and to run.

    Attributes:
        model, nv, function: Generated function, with the degrees of freedom of its model.
        by: Who generated it; variant: how it was built.
        time: Median, nanoseconds a state.
    """

    model: str
    nv: int
    function: str
    by: str
    variant: str
    time: float


@dataclass(frozen=True)
class Wait:
    """What a user waits for.

    Attributes:
        what: What is waited for.
        model: Label of the robot; "" where it is of none.
        seconds: Median.
        asked: Seconds at most; None where nothing is asked.
    """

    what: str
    model: str
    seconds: float
    asked: float | None

    @property
    def met(self) -> bool:
        """Whether the target is met; True without one."""
        return self.asked is None or self.seconds <= self.asked


# Model, function, peer, why.
Note = tuple[str, str, str, str]


@dataclass
class Record:
    """Everything measured so far.

    Attributes:
        entries: Pairs of contestants.
        costs: Costs of generated functions.
        skipped: Functions that a peer does not have: (model, function, peer, reason).
        failed: Functions that could not be timed: (model, function, peer, reason).
        machine: Facts of the last run: processor, peak rates, load, versions, flags.
        waits: What a user waits for before the first number, and in plain calls.
    """

    entries: list[Entry] = field(default_factory=list)
    costs: list[Made] = field(default_factory=list)
    skipped: list[Note] = field(default_factory=list)
    failed: list[Note] = field(default_factory=list)
    machine: dict[str, Any] = field(default_factory=dict)
    waits: list[Wait] = field(default_factory=list)

    def forget(self, models: Iterable[str], functions: Iterable[str], peers: Iterable[str]) -> None:
        """Drop entries, costs and notes of what is about to be measured again."""
        M, F, P = set(models), set(functions), set(peers)
        self.entries = [x for x in self.entries if not (x.model in M and x.function in F and x.peer in P)]
        self.costs = [x for x in self.costs if not (x.model in M and x.function in F and x.by in {*P, "symofros"})]
        self.skipped, self.failed = (
            [x for x in notes if not (x[0] in M and x[1] in F and x[2] in {*P, "symofros"})]
            for notes in (self.skipped, self.failed)
        )

    def has(self, model: str, function: str) -> bool:
        """Whether anything was timed of it."""
        return any((x.model, x.function) == (model, function) for x in self.entries)

    def best(self, model: str, function: str, peer: str, family: str = "") -> Entry | None:
        """The peer's fastest way by the median, of a compiler's family if one is named."""
        candidates = [
            x
            for x in self.entries
            if (x.model, x.function, x.peer) == (model, function, peer) and x.variant.startswith(family)
        ]
        return min(candidates, key=lambda x: x.peer_time[1], default=None)

    def fastest(self) -> list[Entry]:
        """Each peer's fastest build of each function of each model."""
        races = dict.fromkeys((row.model, row.function, row.peer) for row in self.entries)
        return [row for race in races if (row := self.best(*race))]

    def cost(self, model: str, function: str, by: str) -> Made | None:
        """Cost of generating and compiling the fastest build."""
        candidates = [x for x in self.costs if (x.model, x.function, x.by) == (model, function, by)]
        return min(candidates, key=lambda x: x.time, default=None)


def as_data(record: Record) -> dict[str, Any]:
    """A record as JSON holds it; ratios are written out for readers."""
    ratios = ("ratio", "batch_ratio", "columns_ratio")
    entries = [{**plain(x), **{name: getattr(x, name) for name in ratios}} for x in record.entries]
    return {"schema": SCHEMA, **plain(record), "entries": entries}


def read(path: Path) -> Record:
    """The record of a file; an empty one where there is none, or one of another kind."""
    return stored_json(path, lambda data: restored(Record, data) if data["schema"] == SCHEMA else None) or Record()
