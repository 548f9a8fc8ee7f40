"""What a campaign found, from its one file, as data."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc

from .sweep import DONE

_GROUP = ["model", "engine", "quantity"]
# Of the batch with the largest error.
_WORST_COLUMNS = ("error", "batch", "worst_state", "scale", "tolerance")
_NULLS = pc.ScalarAggregateOptions(skip_nulls=False)


def effort(journal: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """Effort of a campaign by its journal: sessions, total wall time [s], executions, batches begun more than once."""
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
    counts = checked(rows) if kind == "check" else swept(rows)
    return {"kind": kind, **counts, "rows": rows.num_rows, **provenance}


def checked(rows: pa.Table) -> dict[str, Any]:
    """Summary of a cross-check: for each model, engine and quantity, agreement over all states and the worst error."""
    judged = rows.filter(pc.is_in(rows["status"], pa.array(["agree", "disagree"])))
    # What is not a number comes first: it is the worst.
    ranked = judged.append_column("rank", pc.fill_null(judged["error"], math.inf))
    ordered = ranked.sort_by([("rank", "descending"), ("batch", "ascending")])
    sums = ordered.group_by(_GROUP, use_threads=False).aggregate(
        [("agree", "all"), ("states", "sum"), *((name, "first", _NULLS) for name in _WORST_COLUMNS)]
    )
    groups = [
        {
            **{name: row[name] for name in _GROUP},
            "agree": row["agree_all"],
            "states": row["states_sum"],
            **{name: row[f"{name}_first"] for name in _WORST_COLUMNS},
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
    """Summary of a sweep: range of each result, numbers of failed points by reason and of points with notes."""
    failed = Counter(rows["outcome"].to_pylist())
    done = failed.pop(DONE, 0)
    first = rows.column_names.index("outcome")
    results = [
        name for name in rows.column_names[:first] if name not in ("batch", "point") and not name.startswith("over:")
    ]
    ranges = {name: pc.min_max(rows[name]).as_py() for name in results}
    noted = [text for text in rows["notes"].to_pylist() if text]
    remarks = {"noted": len(noted), "first_note": noted[0].partition("\n")[0] if noted else ""}
    return {
        "ok": not failed,
        "points": rows.num_rows,
        "done": done,
        "failed": dict(failed),
        **remarks,
        "ranges": ranges,
    }
