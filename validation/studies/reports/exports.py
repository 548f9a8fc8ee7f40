"""The cost of calls in each environment, and their worst case."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer

from validation.reporting.command import Run
from validation.reporting.figures import Chart, Curve, Figure
from validation.reporting.provenance import stamp
from validation.reporting.record import Data, Fact, Report, Section, Table, Topic
from validation.studies.exports import CALLS, run_study

_LIMITS = (
    "The machine runs other work and no real-time kernel: the longest of many calls says how long the operating system "
    "was away, the median and 99.9 % what the code takes. Each call is timed by itself; the clock's own cost is the "
    "row `clock`, subtracted in the first table. M, h, Q from Octave and Python are means over a loop in their own "
    "language; steps from there are those of one call that makes a thousand. The FMU is called through FMPy, whose "
    "ctypes call is most of the difference to C. The block for Simulink was compiled and run against a stand-in "
    "header, not in Simulink."
)


def measure(run: Run, calls: Annotated[int, typer.Option(min=1000, help="Calls of each kind in C.")] = CALLS) -> Data:
    """Time calls of an exported seven-joint arm: C, Python, MEX, FMU; and the worst case in C."""
    return {**stamp(), **asdict(run_study(calls)), "seconds": run.seconds}


def compose(data: Data) -> Report:
    """The report of its JSON."""
    overheads, latencies = data["overheads"], data["latencies"]
    columns = list(next(iter(overheads.values())))
    costs = Table(
        ("from", *(f"#{column} [us]" for column in columns)),
        tuple(
            (where, *("-" if row[column] is None else f"{row[column] / 1e3:.2f}" for column in columns))
            for where, row in overheads.items()
        ),
    )
    worst = Table.of(
        latencies,
        {
            "call": "{name}",
            "#median [ns]": "{median:.0f}",
            "#99.9 % [ns]": "{high:.0f}",
            "#longest [ns]": "{worst:.0f}",
        },
    )
    bins = [row["bins"] for row in latencies]
    used = [i for i in range(len(bins[0])) if any(one[i] for one in bins)]
    histogram = Table(
        ("#below [ns]", *(f"#{row['name']}" for row in latencies)),
        tuple((str(2 << i), *(str(one[i]) for one in bins)) for i in used),
    )
    chart = Chart(
        "calls by time",
        "time of a call, upper end of its bin  [ns]",
        "calls  [1]",
        tuple(
            Curve(row["name"], [2 << i for i in used], [row["bins"][i] for i in used], k, "joined", k % 4)
            for k, row in enumerate(latencies)
        ),
        log="xy",
    )
    sizes = Table(("part", "#size [bytes]"), tuple((part, f"{size:,}") for part, size in data["bytes"].items()))
    see = (
        "Each peak is what the code takes; what lies a decade and more to the right of it is the operating system, "
        "and the bare clock has it too."
    )
    steps = {where: row["step of 1 ms"] for where, row in overheads.items() if row.get("step of 1 ms") is not None}
    high = max(row["high"] for row in latencies)
    calls = f"{data['calls']:,}".replace(",", " ")
    return Report(
        "Exports: what a call costs",
        f"{data['model']}: the cost of calls from {', '.join(overheads)}.",
        None,
        (_LIMITS,),
        (
            Section("From where", (costs,)),
            Section(f"Worst case of {calls} calls in C", (worst, Figure(see, (chart,)), histogram)),
            Section("Size of the C package", (sizes,)),
        ),
        (
            *(Fact(f"{time / 1e3:.2g} µs", f"a step of 1 ms from {where}") for where, time in steps.items()),
            Fact(f"{high / 1e3:.2g} µs", f"99.9 % of {calls} calls in C are below"),
        ),
        digest=(costs, worst, sizes),
    )


TOPIC = Topic("exports", "Speed", "What does a call cost, from where?", compose)
