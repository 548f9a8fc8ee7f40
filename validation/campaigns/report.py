"""The report of a campaign: a cross-check over many states, or a sweep."""

from __future__ import annotations

from collections.abc import Sequence

from validation.reporting.numbers import counted, short
from validation.reporting.record import Block, Bullets, Cell, Data, Fact, Report, Section, Table, Text, Topic

_SHOWN = 20


def compose(data: Data) -> Report:
    """The report of its JSON."""
    return _swept(data) if data["kind"] == "sweep" else _checked(data)


def _checked(data: Data) -> Report:
    groups, spent = data["groups"], data["effort"]
    wrong = [row for row in groups if not row["agree"]]
    failed = data["failed"]
    cut = f"; {counted(len(failed), 'comparison')} could not be made" if failed else ""
    verdict = f"{len(wrong)} do not agree" if wrong else "all agree" if data["ok"] else "not all agree"
    table = Table(
        ("quantity", "#comparisons", "#largest error", "#tolerance", "of", "against", "#batch, state"),
        tuple(_worst_row(quantity, groups) for quantity in dict.fromkeys(row["quantity"] for row in groups)),
    )
    bad = [
        f"disagrees: {row['model']}, {row['engine']}, {row['quantity']}: {_error(row)} in batch {_place(row)}"
        for row in wrong[:_SHOWN]
    ]
    bad += [f"failed: batch {row['batch']}, {row['model']}: {' '.join(row['note'].split())}" for row in failed[:_SHOWN]]
    share = max(map(_share, groups), default=0.0)
    blocks: tuple[Block, ...] = (
        "The largest error of each quantity over all models, engines and states, relative to its scale.",
        table,
        Bullets(tuple(bad)) if bad else "Nothing disagrees.",
    )
    return Report(
        "Campaign",
        f"{counted(data['states'], 'state')} of {counted(data['models'], 'model')}, "
        f"{counted(len(groups), 'comparison')}: {verdict}{cut}.",
        bool(data["ok"]),
        (),
        (Section("How close", blocks), _unsupported(data), _effort(data)),
        (
            Fact(_rate(data, "states"), f"states, {counted(spent['sessions'], 'session')}"),
            Fact(str(len(spent["repeated"])), f"of {counted(spent['executions'], 'execution')} of batches repeated"),
            Fact(f"{short(float(f'{100 * share:.2g}'))} %", "of its tolerance, the largest error", not wrong),
        ),
        digest=(table, Text("\n".join(bad) or "Nothing disagrees.", "bad" if bad else "plain")),
    )


def _worst_row(quantity: str, groups: Sequence[Data]) -> tuple[str | Cell, ...]:
    rows = [row for row in groups if row["quantity"] == quantity]
    worst = max(rows, key=_share)
    agree = all(row["agree"] for row in rows)
    error = Cell(_error(worst), agree)
    of = (worst.get("model", ""), worst.get("engine", ""))
    return quantity, str(len(rows)), error, f"{worst['tolerance']:.1e}", *of, _place(worst)


def _place(row: Data) -> str:
    return f"{row['batch']}, {'-' if row['worst_state'] is None else row['worst_state']}"


def _share(row: Data) -> float:
    """How much of its tolerance an error takes."""
    return float("inf") if row["error"] is None else row["error"] / (row["tolerance"] or 1.0)


def _error(row: Data) -> str:
    return "NaN" if row["error"] is None else f"{row['error']:.1e}"


def _unsupported(data: Data) -> Section:
    rows = tuple((row["engine"], row["model"], row["quantity"], row["note"]) for row in data.get("unsupported", ()))
    return Section(
        "What an engine could not represent", (Table(("engine", "model", "quantity", "reason"), rows),), page_only=True
    )


def _swept(data: Data) -> Report:
    plan = data["plan"]
    rest = "" if data["ok"] else f"; {data['points'] - data['done']} could not be evaluated"
    rows = [
        (name, *("-" if ends[end] is None else f"{ends[end]:.6g}" for end in ("min", "max")))
        for name, ends in data["ranges"].items()
    ]
    table = Table(("result", "#smallest", "#largest"), tuple(rows))
    failed = Bullets(tuple(f"{number} points: {why}" for why, number in data["failed"].items()))
    blocks: tuple[Block, ...] = (table, failed) if data["failed"] else (table,)
    return Report(
        "Campaign",
        f"{plan['model']}, {plan['quantity'].replace('_', ' ')}: {data['done']} of {data['points']} points{rest}.",
        bool(data["ok"]),
        (),
        (Section("Range of each result", blocks), _effort(data)),
        (Fact(_rate(data, "points"), f"points, {counted(data['effort']['sessions'], 'session')}"),),
        digest=blocks,
    )


def _rate(data: Data, size: str) -> str:
    seconds = data["effort"]["seconds"]
    return f"{data[size] / seconds:.0f}/s" if seconds else "-"


def _effort(data: Data) -> Section:
    spent = data["effort"]
    said = (
        f"Plan {data.get('hash', '')}; {counted(spent['sessions'], 'session')}, {spent['seconds']:.0f} s; "
        f"{counted(spent['executions'], 'execution')}, {len(spent['repeated'])} batches begun twice. "
        "Every row: results.parquet."
    )
    return Section("What it took", (said,))


# What writes it at the everyday size.
TOPIC = Topic(
    "campaign",
    "Correctness",
    "And over a hundred thousand states?",
    compose,
    ("campaign", "run", "--models", "all", "--report", "reports", "-o", "campaign"),
    everyday=False,
)
