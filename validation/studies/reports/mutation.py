"""The score of the mutation test: planted faults, and how many of them the cross-check catches."""

from __future__ import annotations

from ...reporting.numbers import counted
from ...reporting.record import Bullets, Data, Fact, Report, Section, Table, Topic, verdict
from ..mutation import measure

_TEXT = """A fault replaces one operation of the generated program. It is caught if any output then differs from the
independent engine's by more than the cross-check's own tolerance over 60 random states. {} are silent: the program with
the fault computes the same outputs to 40 digits, so there is nothing to catch. {} are too small: they change no output
by more than its tolerance (largest change {:.1e}, which only forward dynamics tolerates)."""
_COUNTS = "{planted} | {caught} | {silent} | {too_small}"


def compose(data: Data) -> Report:
    """The report of its JSON."""
    models = data["models"]
    alive = [(row["model"], fault) for row in models for fault in row["survived"]]
    silent, small = (sum(row[fate] for row in models) for fate in ("silent", "too_small"))
    matter = data["planted"] - silent - small
    caught = matter - len(alive)
    text = _TEXT.format(silent, small, max((row.get("largest_too_small", 0.0) for row in models), default=0.0))
    listed = tuple(f"{model}: {f['kind']} at node {f['node']}: {f['error']:.1e}" for model, f in alive[:99])
    by_model = (
        f"{row['model']} | {row['engine']} | {_COUNTS.format_map(row)} | "
        f"{verdict(len(row['survived']), not row['survived'])}"
        for row in models
    )
    kinds = (f"{kind} | {_COUNTS.format_map(row)}" for kind, row in data["kinds"].items())
    counts = "planted | caught | silent | too small"
    return Report(
        "Mutation test of the cross-check",
        f"{caught} of {matter} faults that matter are caught ({100.0 * caught / max(1, matter):.6g} %), "
        f"in {counted(len(models), 'model')}.",
        bool(data["ok"]),
        (text,),
        (
            Section("By model", (Table.of(f"model | reference | {counts} | survived", by_model),)),
            Section("By kind of fault", (Table.of(f"kind of fault | {counts}", kinds),)),
            Section("What survived", (Bullets(listed),)),
        ),
        facts=(
            Fact(str(data["planted"]), "single faults planted"),
            Fact(str(len(alive)), "survived; none may", not alive),
            Fact(str(silent + small), "change nothing, or less than a tolerance"),
        ),
    )


TOPIC = Topic("mutation", "Correctness", "Would the cross-check see a fault?", compose, measure)
