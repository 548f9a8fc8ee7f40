"""The cost of calls in each environment, and their worst case."""

from __future__ import annotations

from typing import Annotated

import typer

from validation.reporting.command import Run
from validation.reporting.figures import Chart, Figure, curves
from validation.reporting.plain import plain
from validation.reporting.record import Column, Data, Fact, Report, Section, Table, Topic
from validation.studies.exports import CALLS, run_study

_LIMITS = (
    "The machine runs other work and no real-time kernel: the median and 99.9 % say what the code takes, the longest "
    "call how long the operating system was away. Each call is timed by itself; the clock's own cost is the row "
    "`clock`, subtracted in the first table. M, h, Q from Octave and Python are means over a loop in their own "
    "language; steps from there are those of one call that makes a thousand. FMPy's ctypes call is most of the "
    "difference between the FMU and C. The block for Simulink ran against a stand-in header, not in Simulink."
)
_SEE = (
    "Each peak is what the code takes; what lies a decade to the right is the operating system, as with the bare clock."
)
_WORST: dict[str, Column] = {
    "call": "{name}",
    "#median [ns]": "{median:.0f}",
    "#99.9 % [ns]": "{high:.0f}",
    "#longest [ns]": "{worst:.0f}",
}


def measure(run: Run, calls: Annotated[int, typer.Option(min=1000, help="Calls of each kind in C.")] = CALLS) -> Data:
    """Time calls of an exported seven-joint arm: C, Python, MEX, FMU; and the worst case in C."""
    return dict(plain(run_study(calls)))


def compose(data: Data) -> Report:
    """The report of its JSON."""
    overheads, latencies = data["overheads"], data["latencies"]
    calls = f"{data['calls']:,}".replace(",", " ")
    costs = Table.of(
        overheads.items(), {"from": "{0}", **{f"#{name} [us]": f"{{1[{name}]:1e-3*.2f}}" for name in overheads["C"]}}
    )
    # Bin i ends at 2^(i + 1) ns.
    used = [i for i in range(len(latencies[0]["bins"])) if any(row["bins"][i] for row in latencies)]
    counts = {row["name"]: [row["bins"][i] for i in used] for row in latencies}
    ends = [2 << i for i in used]
    bins = zip(map(str, ends), *(map(str, column) for column in counts.values()), strict=True)
    chart = Chart(
        "calls by time", "time of a call, upper end of its bin  [ns]", "calls  [1]", curves(ends, counts), log="xy"
    )
    steps = {where: row["step of 1 ms"] for where, row in overheads.items() if row.get("step of 1 ms") is not None}
    worst = (
        Table.of(latencies, _WORST),
        Figure(_SEE, (chart,)),
        Table(("#below [ns]", *(f"#{name}" for name in counts)), tuple(bins)),
    )
    sizes = Table(("part", "#size [bytes]"), tuple((part, f"{size:,}") for part, size in data["bytes"].items()))
    return Report(
        "Exports: what a call costs",
        f"{data['model']}: the cost of calls from {', '.join(overheads)}.",
        None,
        (_LIMITS,),
        (
            Section("From where", (costs,)),
            Section(f"Worst case of {calls} calls in C", worst),
            Section("Size of the C package", (sizes,)),
        ),
        facts=(
            *(Fact(f"{time / 1e3:.2g} µs", f"a step of 1 ms from {where}") for where, time in steps.items()),
            Fact(f"{max(row['high'] for row in latencies) / 1e3:.2g} µs", f"99.9 % of {calls} calls in C are below"),
        ),
    )


TOPIC = Topic("exports", "Speed", "What does a call cost, from where?", compose, measure)
