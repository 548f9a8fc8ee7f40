"""The report of a campaign: a cross-check over many states, or a sweep."""

from __future__ import annotations

import math
from typing import Any

from ..reporting.numbers import counted, digits, formatted, short
from ..reporting.record import Bullets, Data, Fact, Report, Section, Table, Topic, verdict

_SHOWN = 20
_HEAD = "quantity | comparisons | largest error | tolerance | of | against | batch, state"


def compose(data: Data) -> Report:
    """The report of its JSON."""
    return _swept(data) if data["kind"] == "sweep" else _checked(data)


def _checked(data: Data) -> Report:
    groups, spent, failed = data["groups"], data["effort"], data["failed"]
    wrong = [row for row in groups if not row["agree"]]
    cut = f"; {counted(len(failed), 'comparison')} could not be made" if failed else ""
    stated = f"{len(wrong)} do not agree" if wrong else "all agree" if data["ok"] else "not all agree"
    disagreeing = "disagrees: {model}, {engine}, {quantity}: {} in batch {batch}, {}"
    bad = [disagreeing.format(digits(row["error"]), _state(row), **row) for row in wrong[:_SHOWN]]
    bad += [f"failed: batch {row['batch']}, {row['model']}: {row['note']}" for row in failed[:_SHOWN]]
    share = max(map(_share, groups), default=0.0)
    worst = (_worst([row for row in groups if row["quantity"] == q]) for q in {row["quantity"]: 0 for row in groups})
    blocks = (Table.of(_HEAD, worst), Bullets(tuple(bad)) if bad else "Nothing disagrees.")
    said = "The largest error of each quantity over all models, engines and states, relative to its scale."
    apart = ((row["engine"], row["model"], row["quantity"], row["note"]) for row in data.get("unsupported", ()))
    return Report(
        "Campaign",
        f"{counted(data['states'], 'state')} of {counted(data['models'], 'model')}, "
        f"{counted(len(groups), 'comparison')}: {stated}{cut}.",
        bool(data["ok"]),
        (),
        (
            Section("How close", (said, *blocks)),
            Section(
                "What an engine could not represent",
                (Table.of("engine | model | quantity | reason", apart),),
                "gaps",
                page_only=True,
            ),
            _effort(data),
        ),
        facts=(
            Fact(_rate(data, "states"), f"states, {counted(spent['sessions'], 'session')}"),
            Fact(str(len(spent["repeated"])), f"of {counted(spent['executions'], 'execution')} of batches repeated"),
            Fact(f"{short(float(f'{100 * share:.2g}'))} %", "of its tolerance, the largest error", not wrong),
        ),
        digest=blocks,
    )


def _worst(rows: list[dict[str, Any]]) -> tuple[str, ...]:
    """The comparison of a quantity that takes most of its tolerance; how many there are, and whether all agree."""
    worst = max(rows, key=_share)
    error = verdict(digits(worst["error"]), all(row["agree"] for row in rows))
    place = worst["model"], worst["engine"], f"{worst['batch']}, {_state(worst)}"
    return worst["quantity"], str(len(rows)), error, f"{worst['tolerance']:.1e}", *place


def _state(row: Data) -> str:
    return "-" if row["worst_state"] is None else str(row["worst_state"])


def _share(row: Data) -> float:
    """Error as a share of its tolerance; infinite if there is no error to judge."""
    return math.inf if row["error"] is None else row["error"] / (row["tolerance"] or 1.0)


def _swept(data: Data) -> Report:
    plan, ranges = data["plan"], data["ranges"].items()
    rest = "" if data["ok"] else f"; {data['points'] - data['done']} could not be evaluated"
    remarks = {f"{data['first_note']} (the first of column `notes`)": data["noted"]} if data["noted"] else {}
    counts = [*data["failed"].items(), *remarks.items()]
    reasons = Bullets(tuple(f"{counted(number, 'point')}: {why}" for why, number in counts))
    rows = ((name, *(formatted(one[end], ".6g") for end in ("min", "max"))) for name, one in ranges)
    return Report(
        "Campaign",
        f"{plan['model']}, {plan['quantity'].replace('_', ' ')}: {data['done']} of {data['points']} points{rest}.",
        bool(data["ok"]),
        (),
        (Section("Range of each result", (Table.of("result | smallest | largest", rows), reasons)), _effort(data)),
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
    return Section("What it took", (said,), "effort")


# What writes it at the everyday size.
_ARGUMENTS = "campaign run --models all --report reports -o campaign"
TOPIC = Topic(
    "campaign", "Correctness", "Do engines agree at a hundred thousand states?", compose, arguments=_ARGUMENTS
)
