"""Comparisons arranged for people: one line a model or engine, one column a kind of quantity."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence

from ..adapters import in_order
from ..checking import ModelResult
from ..comparison.errors import NOBODY, Comparison
from ..contract.quantities import MOTION_ENERGY, QUANTITIES
from ..reporting.numbers import counted, digits
from ..reporting.record import Cell, Table, verdict
from .record import NO_ENGINE, Record, is_independent

COMPARED = (*QUANTITIES.values(), MOTION_ENERGY)
# Titles of columns -> quantities that share one, in their order, and the drift of our own free motion.
COLUMNS = {
    title: tuple(q.name for q in COMPARED if (q.column or q.symbol) == title)
    for title in dict.fromkeys(q.column or q.symbol for q in COMPARED)
} | {"drift": ("energy_drift",)}
OPINION = "engine | opinion | models | comparisons | disagree | alone | largest error / tolerance | of | verdict"
# Statuses with a verdict on numbers.
_JUDGED = ("agree", "disagree")
# Of a model that only we had an opinion of.
UNJUDGED = "not judged"
# Characters of a place on a line of 80, beside the longest name of our models.
_PLACE = 30
# Depth of the background of a cell whose error is at the tolerance.
_DEEPEST = 0.55
# As problems of missing extras state their remedies.
_INSTALL = re.compile(r"pip install '[^']+'")


def by_model(record: Record) -> Table:
    """One line a model, the worst over all engines in each cell."""
    return _table("engines", ((model, _engines(model), model.comparisons) for model in record.models))


def by_engine(record: Record, engine: str) -> Table:
    """One line a model that an engine has something to say of."""
    return _table("engine", ((model, engine, rows) for model in record.models if (rows := _of(model, engine))))


def nearest(record: Record, each: bool) -> Table:
    """The comparison that is nearest to its tolerance, of each model, or of each engine of each model.

    For terminals: a model is one line of 80 characters, an engine one of 100.
    """
    lines: list[tuple[str, ...]] = []
    for model in record.models:
        named = in_order(row.engine for row in model.comparisons if row.engine not in NO_ENGINE)
        engines = [(name, _of(model, name)) for name in (*named, *NO_ENGINE)]
        for name, rows in engines if each else [(_engines(model), list(model.comparisons))]:
            error: tuple[str, ...] = ("", "", "")
            if (row := worst(rows)) is not None:
                place = f"{row.title}, {row.engine}"
                place = row.title if each or len(place) > _PLACE else place
                error = digits(row.error, 1), digits(row.tolerance, 1), place
            said = _status(rows)
            said = f"{name} agree" if not each and said == "agree" else said
            said = said if _status(rows) in ("agree", "unsupported") else f"**{said}**"
            if each and rows and name != NOBODY:
                lines.append((model.label, name, *error, said))
            elif not each:
                lines.append((model.label, *error, said))
    head = "model | engine | error | of | in | verdict" if each else "model | error | of | in | engines"
    return Table.of(head, lines)


def _engines(model: ModelResult) -> str:
    """Number of engines that a model is compared with, as text."""
    return str(len({row.engine for row in model.comparisons if row.status in _JUDGED} - {*NO_ENGINE}))


def _of(model: ModelResult, engine: str) -> list[Comparison]:
    return [row for row in model.comparisons if row.engine == engine]


def opinion(record: Record, engine: str) -> tuple[str, ...]:
    """An engine's verdict on our C, as a row under `OPINION`.

    One that disagrees is suspect itself where it is alone in that, in most cases, against other independent engines.
    """
    others: dict[tuple[str, str], set[str]] = {}
    for row in record.compared:
        if row.engine != engine and is_independent(row.engine):
            others.setdefault((row.model, row.quantity), set()).add(row.status)
    rows = [row for row in record.compared if row.engine == engine]
    wrong = [row for row in rows if row.status == "disagree"]
    alone, near = sum(others.get((row.model, row.quantity)) == {"agree"} for row in wrong), worst(rows)
    used = "NaN" if near is None or near.error is None else f"{near.error / near.tolerance:.2g}"
    place = f"{near.title} of {near.model}" if near else ""
    said = "agrees" if not wrong else "suspect" if 2 * alone > len(wrong) else "against our C"
    kind, models = "independent" if is_independent(engine) else "our own", len({row.model for row in rows})
    counts = map(str, (models, len(rows), len(wrong), alone))
    return engine, kind, *counts, used, place, verdict(said, not wrong)


def _table(middle: str, lines: Iterable[tuple[ModelResult, str, Sequence[Comparison]]]) -> Table:
    """A line each: the model, whom it is compared with, the worst comparison in each column, the verdict."""
    rows = []
    for model, compared, comparisons in lines:
        cells = [_cell(worst(row for row in comparisons if row.quantity in names)) for names in COLUMNS.values()]
        label = verdict(model.label, _status(comparisons) in ("agree", "unsupported"))
        rows.append((label, str(model.sizes.get("nv", "")), compared, *cells, _result(comparisons)))
    return Table(("model", "nv", middle, *COLUMNS, "verdict"), tuple(rows)).without_empty()


def _status(rows: Sequence[Comparison]) -> str:
    """The worst status of some comparisons; what merely nobody confirms has not failed."""
    statuses = {UNJUDGED if row.unconfirmed else row.status for row in rows}
    return next((status for status in ("failed", "disagree", UNJUDGED, "agree") if status in statuses), "unsupported")


def _result(rows: Sequence[Comparison]) -> str:
    return verdict(_status(rows), _status(rows) in ("agree", "unsupported"))


def _cell(row: Comparison | None) -> str | Cell:
    if row is None:
        return ""
    hint = f"{row.quantity}, {row.engine}; median {digits(row.median)}"
    return Cell(verdict(digits(row.error), row.ok), _DEEPEST * margin_used(row) if row.ok else 0.0, hint)


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
    judged = (row for row in rows if row.status in _JUDGED)
    return max(judged, key=lambda row: math.inf if row.error is None else row.error / row.tolerance, default=None)


def failures(record: Record) -> list[tuple[str, str, str]]:
    """Model, engine and text of each disagreement or failure."""
    return [(row.model, row.engine, failure(row)) for row in record.rows("disagree", "failed")]


def failure(row: Comparison) -> str:
    """Text of a disagreement or failure, with its numbers."""
    if row.unconfirmed:
        return row.note
    if row.status == "failed":
        return f"{row.quantity}: " + "; ".join(" ".join(line.split()) for line in row.note.splitlines())
    error = "not a number" if row.error is None else f"error {digits(row.error)}"
    place = "" if row.worst_state is None else f" in state {row.worst_state} of {row.states}"
    return f"{row.quantity}: {error}{place}, tolerance {digits(row.tolerance)}" + (f"; {row.note}" if row.note else "")


def unsupported(record: Record, unjudged: bool = False) -> list[tuple[str, str, str]]:
    """Models, engine, unsupported quantities and reason; one line for each engine and reason.

    `unjudged`: only of models that no independent engine could be asked about.
    """
    alone = {row.model for row in record.rows("failed") if row.unconfirmed}
    grouped: dict[tuple[str, str], list[Comparison]] = {}
    for row in record.rows("unsupported"):
        if unjudged and row.model not in alone:
            continue
        grouped.setdefault((row.engine, row.note), []).append(row)
    lines = []
    for (engine, reason), rows in grouped.items():
        names = ", ".join(dict.fromkeys(row.quantity for row in rows if row.quantity != "all"))
        lines.append((", ".join(dict.fromkeys(row.model for row in rows)), engine, f"{names}: " * bool(names) + reason))
    return lines


def left_out(record: Record) -> str:
    """Sentence on how many models each engine could not represent at all; "" if there are none."""
    models: dict[str, set[str]] = {}
    for row in record.rows("unsupported"):
        models.setdefault(row.engine, set()).add(row.model)
    counts = sorted(((len(names), engine) for engine, names in models.items()), reverse=True)
    said = ", ".join(f"{engine} {count}" for count, engine in counts)
    return said and f"not represented, or in part (models, by engine): {said}; reasons: in the report, or check of one"


def not_installed(record: Record) -> str:
    """A sentence on how to install missing packages; "" where none is missing."""
    remedies: dict[str, set[str]] = {}
    for row in record.rows("unsupported"):
        for remedy in _INSTALL.findall(row.note):
            remedies.setdefault(remedy, set()).add(row.model)
    said = "; ".join(f"{remedy} ({counted(len(models), 'model')})" for remedy, models in sorted(remedies.items()))
    return said and f"not asked in full, as packages are not installed: {said}"


def headline(record: Record) -> str:
    """The verdict in one sentence, what of it is evidence, and what was cut."""
    silent = f"no engine was asked: {_no_comparison_reason(record)}; " if _no_engine_asked(record) else ""
    models = {row.model for row in record.compared}
    what = f"{counted(len(record.compared), 'comparison')} on {counted(len(models), 'model')}"
    disagreeing = len(record.rows("disagree"))
    failed = len({row.model for row in record.rows("failed") if not row.unconfirmed})
    unjudged = 0 if silent else len({row.model for row in record.rows("failed") if row.unconfirmed})
    what += " between our own ways" if silent else ""
    agreeing = f"all {what} agree" if len(record.compared) > 1 else f"{what} agrees"
    parts = [f"{disagreeing} of {what} disagree" if disagreeing else agreeing] if record.compared else []
    parts += [f"{counted(failed, 'model')} failed"] if failed else []
    parts += [f"{counted(unjudged, 'model')} judged by no independent engine"] if unjudged else []
    said = silent + (", ".join(parts) or "nothing was compared")
    cut = f" Interrupted: {counted(len(record.unfinished), 'model')} not checked." if record.unfinished else ""
    apart = f" {record.independent} of the comparisons are with independent engines." if record.compared else ""
    return f"{said[0].upper()}{said[1:]}.{apart}{cut}"


def _no_engine_asked(record: Record) -> bool:
    """Whether models were compared, or could have been, and none of them with an independent engine."""
    return not record.judged and bool(record.compared or any(row.unconfirmed for row in record.rows("failed")))


def _no_comparison_reason(record: Record) -> str:
    """The reasons why no independent engine was asked."""
    reasons = dict.fromkeys(row.note for row in record.rows("failed") if row.unconfirmed)
    return "; ".join(reasons) or "those that were named are ways of our own"
