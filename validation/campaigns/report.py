"""The report of a campaign: a cross-check over many states, or a sweep."""

from __future__ import annotations

import math
from typing import Any

from validation.reporting.numbers import counted, digits, short
from validation.reporting.record import Bullets, Data, Fact, Report, Section, Table, Topic

_SHOWN = 20
_WORST = """quantity; #comparisons; #largest error = {error:digits} ? all_agree; #tolerance = {tolerance:.1e};
    of = {model}; against = {engine}; #batch, state = {batch}, {worst_state}"""


def compose(data: Data) -> Report:
    """The report of its JSON."""
    return _swept(data) if data["kind"] == "sweep" else _checked(data)


def _checked(data: Data) -> Report:
    groups, spent, failed = data["groups"], data["effort"], data["failed"]
    wrong = [row for row in groups if not row["agree"]]
    cut = f"; {counted(len(failed), 'comparison')} could not be made" if failed else ""
    verdict = f"{len(wrong)} do not agree" if wrong else "all agree" if data["ok"] else "not all agree"
    bad = [
        f"disagrees: {row['model']}, {row['engine']}, {row['quantity']}: {digits(row['error'])} in batch "
        f"{row['batch']}, {'-' if row['worst_state'] is None else row['worst_state']}"
        for row in wrong[:_SHOWN]
    ]
    bad += [f"failed: batch {row['batch']}, {row['model']}: {row['note']}" for row in failed[:_SHOWN]]
    share = max(map(_share, groups), default=0.0)
    worst = [_worst(data, quantity) for quantity in dict.fromkeys(row["quantity"] for row in groups)]
    blocks = (Table.of(worst, _WORST), Bullets(tuple(bad)) if bad else "Nothing disagrees.")
    said = "The largest error of each quantity over all models, engines and states, relative to its scale."
    apart = Table.of(data.get("unsupported", ()), "engine; model; quantity; reason = {note}")
    return Report(
        "Campaign",
        f"{counted(data['states'], 'state')} of {counted(data['models'], 'model')}, "
        f"{counted(len(groups), 'comparison')}: {verdict}{cut}.",
        bool(data["ok"]),
        (),
        (
            Section("How close", (said, *blocks)),
            Section("What an engine could not represent", (apart,), page_only=True),
            _effort(data),
        ),
        facts=(
            Fact(_rate(data, "states"), f"states, {counted(spent['sessions'], 'session')}"),
            Fact(str(len(spent["repeated"])), f"of {counted(spent['executions'], 'execution')} of batches repeated"),
            Fact(f"{short(float(f'{100 * share:.2g}'))} %", "of its tolerance, the largest error", not wrong),
        ),
        digest=blocks,
    )


def _worst(data: Data, quantity: str) -> dict[str, Any]:
    """The comparison of a quantity that takes most of its tolerance; how many there are, and whether all agree."""
    rows = [row for row in data["groups"] if row["quantity"] == quantity]
    counts = {"comparisons": len(rows), "all_agree": all(row["agree"] for row in rows)}
    worst = max(rows, key=_share)
    return {
        "model": "",
        "engine": "",
        **worst,
        **counts,
        "error": math.nan if worst["error"] is None else worst["error"],
    }


def _share(row: Data) -> float:
    """How much of its tolerance an error takes."""
    return float("inf") if row["error"] is None else row["error"] / (row["tolerance"] or 1.0)


def _swept(data: Data) -> Report:
    plan = data["plan"]
    rest = "" if data["ok"] else f"; {data['points'] - data['done']} could not be evaluated"
    reasons = Bullets(tuple(f"{number} points: {why}" for why, number in data["failed"].items()))
    ranges = Table.of(data["ranges"].items(), "result = {0}; #smallest = {1[min]:.6g}; #largest = {1[max]:.6g}")
    return Report(
        "Campaign",
        f"{plan['model']}, {plan['quantity'].replace('_', ' ')}: {data['done']} of {data['points']} points{rest}.",
        bool(data["ok"]),
        (),
        (Section("Range of each result", (ranges, reasons)), _effort(data)),
        facts=(Fact(_rate(data, "points"), f"points, {counted(data['effort']['sessions'], 'session')}"),),
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
_ARGUMENTS = tuple("campaign run --models all --report reports -o campaign".split())
TOPIC = Topic("campaign", "Correctness", "And over a hundred thousand states?", compose, arguments=_ARGUMENTS)
