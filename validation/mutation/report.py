"""Faults in the source before two judges: what each saw, by folder, kind and module."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence

from validation.mutation.fault import KINDS
from validation.mutation.measure import BOTH, CHECK_ALONE, measure
from validation.mutation.study import ARGUED, CAUGHT, HALTED, OPEN, STILLBORN, SURVIVED, UNCHANGED
from validation.reporting.numbers import counted
from validation.reporting.record import Bullets, Data, Fact, Fold, Report, Section, Table, Topic

_TEXT = (
    "A fault is one change of a source file, in Python by the syntax tree, in C by tokens: an operator, a sign, an "
    "index, a frame or a transpose, a dropped term, the edge of a comparison, a constant, swapped arguments. The "
    "package with the fault is judged by `check` over a few small models, and by the tests of the module. **No "
    "result changed**: neither judge sees it, and the C text, the values of functions, motions and analyses of a "
    "battery are those of the sound package but for rounding; or a person has argued that no result depends on it, "
    "with the reason below. **Does not end**: the process of `check` crashes or runs on, which is no verdict; such "
    "faults count neither as seen nor as missed. **Open**: the tests were not asked yet, "
    "or their time was over before all had run. {} that the C compiler refuses are left out. Of the tests alone: "
    "{:.1%} of the {} faults that they were asked about."
)
_COLUMNS = """#planted; #check; #tests alone = {tests}; #neither = {survived} ? no survived;
    #no result changed = {unchanged}; #does not end = {halted}; #open"""


def _row(rows: Sequence[Data], label: str = "") -> Data:
    fates = Counter(row["fate"] for row in rows)
    valid = [row for row in rows if row["fate"] != STILLBORN]
    check = sum(row["seen_by_check"] for row in valid)
    counts = {"survived": fates[SURVIVED], "unchanged": fates[UNCHANGED] + fates[ARGUED]}
    counts |= {"halted": fates[HALTED], "open": fates[OPEN]}
    return {"label": label, "planted": len(valid), "check": check, "tests": fates[CAUGHT] - check, **counts}


def _table(title: str, rows: Sequence[Data], group: Callable[[Data], str], labels: Sequence[str] = ()) -> Table:
    """A line a group of faults."""
    labels = labels or sorted({group(row) for row in rows})
    lines = (_row([row for row in rows if group(row) == label], label) for label in labels)
    return Table.of(lines, f"{title} = {{label}}; {_COLUMNS}")


def compose(data: Data) -> Report:
    """The report of its JSON."""
    rows, scores, total = data["faults"], data["scores"], _row(data["faults"])
    seconds = sum(row["seconds"] for row in rows) / max(1, len(rows))
    survivors = tuple(f"`{row['id']}`: {row['said']}" for row in rows if row["fate"] == SURVIVED)
    unchanged = tuple(f"`{row['id']}`: the same outputs" for row in rows if row["fate"] == UNCHANGED)
    unchanged += tuple(f"`{row['id']}`: {row['argued']}" for row in rows if row["fate"] == ARGUED)
    halts = tuple(f"`{row['id']}`: {row['said']}" for row in rows if row["fate"] == HALTED)
    refused = counted(len(rows) - total["planted"], "fault")
    seen = f"{scores['check']:.1%} of those known to change a result, `check` and tests {scores['both']:.1%}"
    modules = counted(len({row["module"] for row in rows}), "module")
    return Report(
        "Faults planted in the source",
        f"{counted(total['planted'], 'fault')} in {modules}: `check` alone sees {seen}; {total['open']} open.",
        bool(data["ok"]),
        (_TEXT.format(refused, scores["tests"], scores["tests_asked"]),),
        (
            Section("By folder", (_table("folder", rows, lambda row: str(row["module"].rpartition("/")[0])),)),
            Section("By kind of fault", (_table("kind of fault", rows, lambda row: str(row["kind"]), tuple(KINDS)),)),
            Section("By module", (Fold("All modules", (_table("module", rows, lambda row: str(row["module"])),)),)),
            Section("What survived", (Bullets(survivors),)),
            Section("What makes check crash, or not end", (Bullets(halts),)),
            Section("What changed no result", (Fold("All", (Bullets(unchanged),)),)),
        ),
        facts=(
            Fact(str(total["planted"]), "single faults planted"),
            Fact(f"{scores['check']:.1%}", f"seen by check alone, of at least {CHECK_ALONE:.0%}"),
            Fact(f"{scores['both']:.1%}", f"seen by check or tests, of at least {BOTH:.0%}", scores["both"] >= BOTH),
            Fact(str(total["open"]), "open: a judge is still to be asked", not total["open"]),
            Fact(str(total["survived"]), "change a result and are seen by neither", not total["survived"]),
            Fact(f"{seconds:.1f} s", "a fault, all judges together"),
        ),
        unfinished=tuple(data.get("unfinished", ())),
    )


TOPIC = Topic("mutants", "Correctness", "Would check or the tests see a fault in the source?", compose, measure)
