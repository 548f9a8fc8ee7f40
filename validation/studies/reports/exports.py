"""The cost of calls in each environment, and their worst case."""

from __future__ import annotations

from ...reporting.figures import Chart, Figure, curves
from ...reporting.numbers import formatted
from ...reporting.record import Data, Fact, Report, Section, Table, Topic
from ..exports import measure

_LIMITS = """The machine runs other work and no real-time kernel: the median and 99.9 % say what the code takes, the
longest call how long the operating system was away. Each call is timed by itself; the clock's own cost is the row
`clock`, subtracted in the first table. M, h, Q from Octave and Python are means over a loop in their own language;
steps from there are those of one call that makes a thousand. FMPy's ctypes call is most of the difference between the
FMU and C. The block for Simulink ran against a stand-in header, not in Simulink."""
_SEE = """Each peak is what the code takes; what lies a decade to the right is the operating system, as with the bare
clock."""


def compose(data: Data) -> Report:
    """The report of its JSON."""
    overheads, latencies, calls = data["overheads"], data["latencies"], f"{data['calls']:,}".replace(",", " ")
    tasks = list(overheads["C"])
    costs = (
        (where, *(formatted(row[task] and row[task] / 1e3, ".2f") for task in tasks))
        for where, row in overheads.items()
    )
    worst = ("{name} | {median:.0f} | {high:.0f} | {worst:.0f}".format_map(row) for row in latencies)
    # Bin i ends at 2^(i + 1) ns.
    used = [i for i, column in enumerate(zip(*(row["bins"] for row in latencies), strict=True)) if any(column)]
    counts = {row["name"]: [row["bins"][i] for i in used] for row in latencies}
    ends = [2 << i for i in used]
    axes = "time of a call, upper end of its bin  [ns]", "calls  [1]"
    chart = Chart("calls by time", *axes, curves(ends, counts), log="xy")
    bins = (map(str, row) for row in zip(ends, *counts.values(), strict=True))
    return Report(
        "Exports: what a call costs",
        f"{data['model']}: the cost of calls from {', '.join(overheads)}.",
        None,
        (_LIMITS,),
        (
            Section("From where", (Table.of(" | ".join(["from", *(f"{task} [µs]" for task in tasks)]), costs),)),
            Section(
                f"Worst case of {calls} calls in C",
                (
                    Table.of("call | median [ns] | 99.9 % [ns] | longest [ns]", worst),
                    Figure(_SEE, (chart,)),
                    Table.of(" | ".join(["below [ns]", *counts]), map(tuple, bins)),
                ),
                "worst_case",
            ),
            Section(
                "Size of the C package",
                (Table.of("part | size [bytes]", (f"{part} | {size:,}" for part, size in data["bytes"].items())),),
            ),
        ),
        facts=(
            *(
                Fact(f"{row['step of 1 ms'] / 1e3:.2g} µs", f"a step of 1 ms from {where}")
                for where, row in overheads.items()
                if row.get("step of 1 ms") is not None
            ),
            Fact(f"{max(row['high'] for row in latencies) / 1e3:.2g} µs", f"99.9 % of {calls} calls in C are below"),
        ),
    )


TOPIC = Topic("exports", "Speed", "What does a call cost, from where?", compose, measure)
