"""Comparisons arranged for people: one line a model or engine, one column a kind of quantity."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from validation.adapters import ROUTES
from validation.check import ModelResult
from validation.comparison.errors import Comparison
from validation.contract.quantities import FRAME_QUANTITIES
from validation.reporting.record import Record

# Engines of rows that no other engine is behind: our own drift, and what was asked of any of them.
OURS = ("symofros", "any")


@dataclass(frozen=True)
class Column:
    """Quantities that share a column.

    Attributes:
        title: Of the column.
        quantities: Their names.
    """

    title: str
    quantities: tuple[str, ...]


COLUMNS = (
    Column("M", ("mass_matrix",)),
    Column("h", ("bias",)),
    Column("gravity", ("gravity",)),
    Column("Q", ("generalized_force",)),
    Column("T, V", ("kinetic_energy", "potential_energy")),
    Column("inverse", ("inverse_dynamics",)),
    Column("forward", ("forward_dynamics",)),
    Column("poses", ("frame_pose",)),
    Column("twists", ("frame_velocity", "frame_acceleration")),
    Column("J, dJ/dt", ("frame_jacobian", "frame_jacobian_rate")),
    Column("motion", ("motion_energy",)),
    Column("drift", ("energy_drift",)),
)


# The same with fewer columns, for a terminal.
BRIEF = (
    Column("M", ("mass_matrix",)),
    Column("h", ("bias",)),
    Column("gravity", ("gravity",)),
    Column("Q", ("generalized_force",)),
    Column("energy", ("kinetic_energy", "potential_energy", "motion_energy")),
    Column("inverse", ("inverse_dynamics",)),
    Column("forward", ("forward_dynamics",)),
    Column("frames", tuple(sorted(FRAME_QUANTITIES))),
    Column("drift", ("energy_drift",)),
)


@dataclass(frozen=True)
class Cell:
    """The worst comparison of those that fall into one cell.

    Attributes:
        row: That comparison; None where nothing was compared.
    """

    row: Comparison | None = None

    @property
    def text(self) -> str:
        """The error, short."""
        if self.row is None:
            return ""
        return "NaN" if self.row.error is None else short(self.row.error)

    @property
    def share(self) -> float:
        """Of the tolerance that is used, on a logarithmic scale: 0 at rounding, 1 at the tolerance and beyond."""
        return margin_used(self.row)


@dataclass(frozen=True)
class Line:
    """One line of a table.

    Attributes:
        model: Its label.
        engine: Whom it is compared with; "" for all.
        cells: One a column.
        status: "agree", "disagree", "failed" or "unsupported".
        engines: How many engines took part.
        nv: Speeds of the model.
    """

    model: str
    engine: str
    cells: tuple[Cell, ...]
    status: str
    engines: int
    nv: int | None


def short(number: float) -> str:
    """Two digits: 3.2e-15; exact agreement is a bare 0."""
    return "0" if number == 0.0 else f"{number:.1e}"


def margin_used(row: Comparison | None) -> float:
    """See `Cell.share`; an error of one rounding (1e-16) or less counts as none."""
    if row is None or row.error == 0.0:
        return 0.0
    if row.error is None or row.error >= row.tolerance:
        return 1.0
    whole = math.log10(row.tolerance) + 16.0
    return min(max((math.log10(row.error) + 16.0) / whole, 0.0), 1.0) if whole > 0.0 else 1.0


def worst(rows: Iterable[Comparison]) -> Comparison | None:
    """The row nearest to its tolerance, or farthest beyond; one without a number is worst of all."""

    def badness(row: Comparison) -> float:
        return float("inf") if row.error is None else row.error / row.tolerance

    return max((row for row in rows if row.status in ("agree", "disagree")), key=badness, default=None)


Columns = Sequence[Column]


def by_model(record: Record, columns: Columns = COLUMNS) -> list[Line]:
    """One line a model, the worst over all engines in each cell."""
    return [_line(model, "", model.comparisons, columns) for model in record.models]


def by_engine(record: Record, columns: Columns = COLUMNS, engines: Sequence[str] = (*ROUTES, *OURS)) -> list[Line]:
    """One line for each engine of each model that it has something to say of."""
    return [line for model in record.models for line in _engine_lines(model, columns, engines)]


def _engine_lines(model: ModelResult, columns: Columns, engines: Sequence[str]) -> Iterator[Line]:
    for engine in engines:
        rows = [row for row in model.comparisons if row.engine == engine]
        if rows:
            yield _line(model, engine, rows, columns)


def _line(model: ModelResult, engine: str, rows: Sequence[Comparison], columns: Columns) -> Line:
    cells = tuple(Cell(worst(row for row in rows if row.quantity in column.quantities)) for column in columns)
    found = {row.status for row in rows}
    status = next((status for status in ("failed", "disagree", "agree") if status in found), "unsupported")
    compared = {row.engine for row in rows if row.status in ("agree", "disagree")} - {"symofros"}
    return Line(model.label, engine, cells, status, len(compared), model.sizes.get("nv"))


@dataclass(frozen=True)
class Remark:
    """Something that a table can't say in a number.

    Attributes:
        model: Its label, or several.
        engine: Whose.
        text: In words.
    """

    model: str
    engine: str
    text: str


def failures(record: Record) -> list[Remark]:
    """What disagrees or failed, each with its numbers."""
    return [Remark(row.model, row.engine, _failure(row)) for row in record.rows("disagree", "failed")]


def _failure(row: Comparison) -> str:
    if row.status == "failed":
        return f"{row.quantity}: {row.note}"
    error = "not a number" if row.error is None else f"error {short(row.error)}"
    place = "" if row.worst_state is None else f" in state {row.worst_state} of {row.states}"
    return f"{row.quantity}: {error}{place}, tolerance {short(row.tolerance)}" + (f"; {row.note}" if row.note else "")


def unsupported(record: Record) -> list[Remark]:
    """Who could not represent what, with the same reason told once."""
    grouped: dict[tuple[str, str], list[Comparison]] = {}
    for row in record.rows("unsupported"):
        grouped.setdefault((row.engine, row.note), []).append(row)
    return [
        Remark(", ".join(dict.fromkeys(row.model for row in rows)), engine, _quantities(rows) + reason)
        for (engine, reason), rows in grouped.items()
    ]


def _quantities(rows: Sequence[Comparison]) -> str:
    """Which quantities, where it is not all."""
    names = dict.fromkeys(row.quantity for row in rows if row.quantity != "all")
    return f"{', '.join(names)}: " if names else ""


def headline(record: Record) -> str:
    """The verdict in one sentence, or two."""
    what = f"{len(record.compared)} comparisons on {_count(len(record.models), 'model')}"
    disagreeing = len(record.rows("disagree"))
    failed = len({row.model for row in record.rows("failed")})
    parts = [f"{disagreeing} of {what} disagree" if disagreeing else f"all {what} agree"] if record.compared else []
    parts += [f"{_count(failed, 'model')} failed"] if failed else []
    said = ", ".join(parts) or "nothing was compared"
    cut = f" Interrupted: {_count(len(record.unfinished), 'model')} not checked." if record.unfinished else ""
    return f"{said[0].upper()}{said[1:]}.{cut}"


def _count(n: int, what: str) -> str:
    return f"{n} {what}" if n == 1 else f"{n} {what}s"
