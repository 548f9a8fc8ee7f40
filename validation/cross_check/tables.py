"""Comparisons arranged for people: one line a model or engine, one column a kind of quantity."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

from validation.adapters import ROUTES
from validation.check import ModelResult
from validation.comparison.errors import Comparison
from validation.contract.quantities import MOTION_ENERGY, QUANTITIES
from validation.cross_check.record import Record
from validation.procedures.catalogue import ENGINE as FORMULAS
from validation.reporting.numbers import counted, digits
from validation.reporting.record import Cell, Column, Table


def _columns() -> dict[str, tuple[str, ...]]:
    """Titles of columns -> quantities that share one, in their order, and the drift of our own free motion."""
    columns: dict[str, tuple[str, ...]] = {}
    for quantity in (*QUANTITIES.values(), MOTION_ENERGY):
        title = quantity.column or quantity.symbol
        columns[title] = (*columns.get(title, ()), quantity.name)
    return columns | {"drift": ("energy_drift",)}


COLUMNS = _columns()
# Engines of rows that no other engine is behind: our own drift, and what was asked of any of them.
_OURS = ("symofros", "any", FORMULAS)
# Statuses with a verdict on numbers.
_JUDGED = ("agree", "disagree")
# Depth of the background of a cell whose error is at the tolerance.
_DEEPEST = 0.55


Line = tuple[ModelResult, str, Sequence[Comparison]]


def by_model(record: Record) -> Table:
    """One line a model, the worst over all engines in each cell."""
    return _table(_models(record), "#engines")


def by_engine(record: Record, engine: str) -> Table:
    """One line a model that an engine has something to say of."""
    return _table(_engines(record, (engine,)), "engine")


def nearest(record: Record, each: bool) -> Table:
    """The comparison that is nearest to its tolerance, of each model, or of each engine of each model."""

    def shown(line: Line) -> tuple[str | Cell, ...]:
        row = worst(line[2])
        error: tuple[str | Cell, ...] = ("", "", "")
        if row is not None:
            place = row.words if each else f"{row.words}, {row.engine}"
            error = Cell(digits(row.error, 1), row.ok), digits(row.tolerance, 1), place
        return line[0].label, line[1], *error, _verdict(line[2])

    lines = _engines(record, (*ROUTES, *_OURS)) if each else _models(record)
    head = ("model", "engine" if each else "#engines", "#error", "#of", "in", "verdict")
    return Table(head, tuple(map(shown, lines)))


def _models(record: Record) -> list[Line]:
    compared = ({row.engine for row in m.comparisons if row.status in _JUDGED} - {*_OURS} for m in record.models)
    return [(m, str(len(names)), m.comparisons) for m, names in zip(record.models, compared, strict=True)]


def _engines(record: Record, engines: Sequence[str]) -> list[Line]:
    lines = [(m, name, [row for row in m.comparisons if row.engine == name]) for m in record.models for name in engines]
    return [line for line in lines if line[2]]


def opinions(record: Record) -> Table:
    """One line an engine: whether it agrees, and if not, whether it is alone in that, against other engines."""
    against, witnesses = (
        {
            (row.model, row.quantity, row.engine)
            for row in rows
            if row.engine in ROUTES and ROUTES[row.engine].independent
        }
        for rows in (record.rows("disagree"), record.rows("agree"))
    )

    def is_alone(row: Comparison) -> bool:
        place = row.model, row.quantity
        others = [name for name in ROUTES if name != row.engine]
        return any((*place, name) in witnesses for name in others) and all(
            (*place, name) not in against for name in others
        )

    def line(engine: str) -> dict[str, Any]:
        rows = [row for row in record.compared if row.engine == engine]
        disagreeing = [row for row in rows if row.status == "disagree"]
        alone = sum(map(is_alone, disagreeing))
        nearest = worst(rows)
        used = nearest.error / nearest.tolerance if nearest and nearest.error is not None else math.nan
        return {
            "engine": engine,
            "opinion": "independent" if ROUTES[engine].independent else "our own",
            "models": len({row.model for row in rows}),
            "comparisons": len(rows),
            "disagree": len(disagreeing),
            "alone": alone,
            "used": used,
            "where": f"{nearest.words} of {nearest.model}" if nearest else "",
            "verdict": "agrees" if not disagreeing else "suspect" if 2 * alone > len(disagreeing) else "against our C",
        }

    columns = """engine; opinion; #models; #comparisons; #disagree; #alone; #largest error / tolerance = {used:.2g};
        of = {where}; verdict ? no disagree"""
    return Table.of((line(name) for name in ROUTES if any(row.engine == name for row in record.compared)), columns)


def _table(lines: Sequence[Line], middle: str) -> Table:
    """A line each: the model, whom it is compared with, the worst comparison in each column, the verdict."""

    def cell(quantities: tuple[str, ...]) -> Column:
        return lambda line: _cell(worst(row for row in line[2] if row.quantity in quantities))

    shown: dict[str, Column] = {
        "model": lambda line: Cell(line[0].label, None if _status(line[2]) in ("agree", "unsupported") else False),
        "#nv": lambda line: str(line[0].sizes.get("nv", "")),
        middle: lambda line: line[1],
        **{f"#{title}": cell(quantities) for title, quantities in COLUMNS.items()},
        "verdict": lambda line: _verdict(line[2]),
    }
    return Table.of(lines, shown).without_empty()


def _status(rows: Sequence[Comparison]) -> str:
    """The worst status of some comparisons."""
    statuses = {row.status for row in rows}
    return next((status for status in ("failed", "disagree", "agree") if status in statuses), "unsupported")


def _verdict(rows: Sequence[Comparison]) -> Cell:
    status = _status(rows)
    return Cell(status, False if status in ("failed", "disagree") else None)


def _cell(row: Comparison | None) -> str | Cell:
    if row is None:
        return ""
    hint = f"{row.quantity}, {row.engine}; median {digits(row.median)}"
    return Cell(digits(row.error), row.ok, _DEEPEST * margin_used(row) if row.ok else 0.0, hint)


def margin_used(row: Comparison) -> float:
    """Share of the tolerance that is used, on a logarithmic scale: 0 at rounding (1e-16), 1 at the tolerance."""
    if row.error == 0.0:
        return 0.0
    if row.error is None or row.error >= row.tolerance:
        return 1.0
    whole = math.log10(row.tolerance) + 16.0
    return min(max((math.log10(row.error) + 16.0) / whole, 0.0), 1.0) if whole > 0.0 else 1.0


def worst(rows: Iterable[Comparison]) -> Comparison | None:
    """The row nearest to its tolerance, or farthest beyond; one without a number is worst of all."""

    def badness(row: Comparison) -> float:
        return float("inf") if row.error is None else row.error / row.tolerance

    return max((row for row in rows if row.status in _JUDGED), key=badness, default=None)


def failures(record: Record) -> list[tuple[str, str, str]]:
    """Model, engine and what disagrees or failed, with its numbers."""
    return [(row.model, row.engine, failure(row)) for row in record.rows("disagree", "failed")]


def failure(row: Comparison) -> str:
    """What disagrees or failed, with its numbers."""
    if row.status == "failed":
        return f"{row.quantity}: {row.note}"
    error = "not a number" if row.error is None else f"error {digits(row.error)}"
    place = "" if row.worst_state is None else f" in state {row.worst_state} of {row.states}"
    return f"{row.quantity}: {error}{place}, tolerance {digits(row.tolerance)}" + (f"; {row.note}" if row.note else "")


def unsupported(record: Record) -> list[tuple[str, str, str]]:
    """Models, engine, and what it could not represent and why; the same reason is told once."""
    grouped: dict[tuple[str, str], list[Comparison]] = {}
    for row in record.rows("unsupported"):
        grouped.setdefault((row.engine, row.note), []).append(row)
    return [
        (", ".join(dict.fromkeys(row.model for row in rows)), engine, _quantities(rows) + reason)
        for (engine, reason), rows in grouped.items()
    ]


def _quantities(rows: Sequence[Comparison]) -> str:
    """Which quantities, where it is not all."""
    names = dict.fromkeys(row.quantity for row in rows if row.quantity != "all")
    return f"{', '.join(names)}: " if names else ""


def headline(record: Record) -> str:
    """The verdict in one sentence, or two."""
    what = f"{counted(len(record.compared), 'comparison')} on {counted(len(record.models), 'model')}"
    disagreeing = len(record.rows("disagree"))
    failed = len({row.model for row in record.rows("failed")})
    parts = [f"{disagreeing} of {what} disagree" if disagreeing else f"all {what} agree"] if record.compared else []
    parts += [f"{counted(failed, 'model')} failed"] if failed else []
    said = ", ".join(parts) or "nothing was compared"
    cut = f" Interrupted: {counted(len(record.unfinished), 'model')} not checked." if record.unfinished else ""
    return f"{said[0].upper()}{said[1:]}.{cut}"
