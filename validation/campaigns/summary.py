"""What a campaign found, from its one file: as data, in words, as a page of Markdown."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc

from validation.campaigns.sweep import DONE

_GROUP = ["model", "engine", "quantity"]
# Of the batch with the largest error.
_OF_WORST = ("error", "batch", "worst_state", "scale", "tolerance")
_NULLS = pc.ScalarAggregateOptions(skip_nulls=False)
_SHOWN = 20


def effort(journal: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """What it took: sessions, seconds on the clock in all of them, executions, batches begun more than once."""
    begun: Counter[int] = Counter()
    sessions: list[list[float]] = []
    for line in journal:
        if line["event"] == "session":
            sessions.append([line["time"]])
        elif sessions:
            sessions[-1].append(line["time"])
        if line["event"] == "begun":
            begun[line["batch"]] += 1
    seconds = sum(max(times) - times[0] for times in sessions)
    return {
        "sessions": len(sessions),
        "seconds": round(seconds, 1),
        "executions": sum(begun.values()),
        "repeated": sorted(batch for batch, times in begun.items() if times > 1),
    }


def summarised(rows: pa.Table, provenance: Mapping[str, Any]) -> dict[str, Any]:
    """The verdict and the figures behind it, for JSON."""
    kind = provenance["plan"]["kind"]
    found = checked(rows) if kind == "check" else swept(rows)
    return {"kind": kind, **found, "rows": rows.num_rows, **provenance}


def checked(rows: pa.Table) -> dict[str, Any]:
    """Of a cross-check: each model, engine and quantity over all states."""
    judged = rows.filter(pc.is_in(rows["status"], pa.array(["agree", "disagree"])))
    # What is not a number comes first: it is the worst.
    ranked = judged.append_column("rank", pc.fill_null(judged["error"], math.inf))
    ordered = ranked.sort_by([("rank", "descending"), ("batch", "ascending")])
    sums = ordered.group_by(_GROUP, use_threads=False).aggregate(
        [("agree", "all"), ("states", "sum"), *((name, "first", _NULLS) for name in _OF_WORST)]
    )
    groups = [
        {
            **{name: row[name] for name in _GROUP},
            "agree": row["agree_all"],
            "states": row["states_sum"],
            **{name: row[f"{name}_first"] for name in _OF_WORST},
        }
        for row in sums.to_pylist()
    ]
    groups.sort(key=lambda row: [row[name] for name in _GROUP])
    failed = rows.filter(pc.equal(rows["status"], "failed"))
    apart = rows.filter(pc.equal(rows["status"], "unsupported")).select([*_GROUP, "note"])
    states = rows.group_by(["batch"]).aggregate([("states_asked", "min")])
    return {
        "ok": bool(groups) and all(row["agree"] for row in groups) and not failed.num_rows,
        "states": pc.sum(states["states_asked_min"]).as_py(),
        "models": len(pc.unique(rows["model"])),
        "comparisons": judged.num_rows,
        "groups": groups,
        "failed": failed.select(["batch", *_GROUP, "note"]).to_pylist(),
        "unsupported": apart.group_by([*_GROUP, "note"]).aggregate([]).to_pylist(),
    }


def swept(rows: pa.Table) -> dict[str, Any]:
    """Of a sweep: the range of each result, and how many points failed, by reason."""
    failed = Counter(rows["outcome"].to_pylist())
    done = failed.pop(DONE, 0)
    first = rows.column_names.index("outcome")
    results = [
        name for name in rows.column_names[:first] if name not in ("batch", "point") and not name.startswith("over:")
    ]
    ranges = {name: pc.min_max(rows[name]).as_py() for name in results}
    return {"ok": not failed, "points": rows.num_rows, "done": done, "failed": dict(failed), "ranges": ranges}


def headline(data: Mapping[str, Any]) -> str:
    """What it comes to, in a sentence or two."""
    if data["kind"] == "sweep":
        rest = "" if data["ok"] else f"; {data['points'] - data['done']} could not be evaluated"
        asked = f"{data['plan']['model']}, {data['plan']['quantity'].replace('_', ' ')}"
        return f"{asked}: {data['done']} of {data['points']} points{rest}."
    groups = data["groups"]
    engines = len({row["engine"] for row in groups})
    wrong = sum(not row["agree"] for row in groups)
    verdict = f"{wrong} of {len(groups)} comparisons disagree" if wrong else f"all {len(groups)} comparisons agree"
    failed = f", {len(data['failed'])} batches could not be compared" if data["failed"] else ""
    return f"{data['states']} states of {data['models']} models against {engines} engines: {verdict}{failed}."


def markdown(data: Mapping[str, Any]) -> str:
    """The page."""
    spent = data["effort"]
    size = data["states" if data["kind"] == "check" else "points"]
    rate = f", {size / spent['seconds']:.0f} a second" if spent["seconds"] else ""
    lines = ["# Campaign", "", f"**{headline(data)}**", ""]
    lines += _checked_lines(data) if data["kind"] == "check" else _swept_lines(data)
    versions = ", ".join(f"{name} {version}" for name, version in data["versions"].items())
    lines += [
        "",
        f"Plan {data['hash']}; sessions: {spent['sessions']}, {spent['seconds']:.0f} s{rate}; "
        f"{spent['executions']} executions, {len(spent['repeated'])} batches begun twice; "
        f"{data['date']}; {', '.join(data['machine'].values())}; flags {data['flags']}; {versions}"
        f"{'; revision ' + data['revision'] if data['revision'] else ''}.",
        "",
        "Every row: results.parquet. Written by `python -m validation campaign`.",
        "",
    ]
    return "\n".join(lines)


def _checked_lines(data: Mapping[str, Any]) -> list[str]:
    lines = [
        "The largest error of each quantity over all models, engines and states, relative to its scale.",
        "",
        "| quantity | comparisons | largest error | tolerance | of | against | batch, state |",
        "|---|---:|---:|---:|---|---|---:|",
    ]
    for quantity in dict.fromkeys(row["quantity"] for row in data["groups"]):
        rows = [row for row in data["groups"] if row["quantity"] == quantity]
        worst = max(rows, key=_share)
        lines.append(
            f"| {quantity} | {len(rows)} | {_error(worst)} | {worst['tolerance']:.1e} | {worst['model']} | "
            f"{worst['engine']} | {_place(worst)} |"
        )
    wrong: Sequence[Mapping[str, Any]] = [row for row in data["groups"] if not row["agree"]]
    failed = data["failed"][:_SHOWN]
    return [
        *lines,
        "" if wrong or failed else "\nNothing disagrees.",
        *(
            f"- disagrees: {row['model']}, {row['engine']}, {row['quantity']}: {_error(row)} in batch {_place(row)}"
            for row in wrong[:_SHOWN]
        ),
        *(f"- failed: batch {row['batch']}, {row['model']}: {' '.join(row['note'].split())}" for row in failed),
    ]


def _place(row: Mapping[str, Any]) -> str:
    return f"{row['batch']}, {'-' if row['worst_state'] is None else row['worst_state']}"


def _share(row: Mapping[str, Any]) -> float:
    """How much of its tolerance an error takes."""
    return float("inf") if row["error"] is None else row["error"] / (row["tolerance"] or 1.0)


def _error(row: Mapping[str, Any]) -> str:
    return "NaN" if row["error"] is None else f"{row['error']:.1e}"


def _swept_lines(data: Mapping[str, Any]) -> list[str]:
    lines = ["| result | smallest | largest |", "|---|---:|---:|"]
    for name, ends in data["ranges"].items():
        shown = ["-" if ends[end] is None else f"{ends[end]:.6g}" for end in ("min", "max")]
        lines.append(f"| {name} | {' | '.join(shown)} |")
    return [*lines, "", *(f"- {number} points: {why}" for why, number in data["failed"].items())]
