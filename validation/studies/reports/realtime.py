"""How late the instants of diagrams begin."""

from __future__ import annotations

import os
from dataclasses import asdict
from typing import Annotated

import numpy as np
import typer

from validation.mechanics.geometry import Array
from validation.reporting.command import Run
from validation.reporting.figures import Chart, Curve, Figure, Mark
from validation.reporting.record import Column, Data, Fact, Report, Section, Table, Topic
from validation.studies import realtime

_LIMITS = (
    "Each diagram runs in real time in the C loop, which sleeps until an instant is due; how late an instant began is "
    "read off the clock afterwards, so it is the operating system's waking plus whatever the instant before took too "
    "long. No core is set apart, and other programs run beside; what the machine does for a loop with nothing in it is "
    "the first row. Ordinary: a thread as any other. First: it comes before those of ordinary programs (SCHED_FIFO, as "
    "by `chrt -f 20 symofros simulate`), where the system permits that. An instant is missed if it began when the next "
    "one was due already. Busy is the loop's processor time an instant, motion included."
)
_SEE = (
    "The further left a curve falls, the more punctual. The body of each lies at tens of microseconds; the tail to the "
    "right is the operating system doing other things. Right of a dashed line the next instant of a loop of that rate "
    "was due already."
)
# Edges of bins of lateness [us], twelve a decade.
_EDGES = np.logspace(-1, 5, 73)


_COLUMNS: dict[str, Column] = {
    "diagram": "{what}",
    "thread": lambda row: _thread(row["first"]),
    "#least": "{minimum:1e6*.1f}",
    "#median": "{median:1e6*.1f}",
    "#99.9 %": "{p999:1e6*.1f}",
    "#worst": "{maximum:1e6*.1f}",
    "#missed": "{missed} of {instants}",
    "#busy": "{busy:1e6*.1f}",
}


def measure(run: Run, seconds: Annotated[float, typer.Option(min=0.01, help="Length of each diagram.")] = 20.0) -> Data:
    """Keep pace with the clock, and say how well."""
    ways = (False, True) if realtime.may_come_first() else (False,)
    run.expect(len(ways) * len(realtime.TIMED_DIAGRAMS), "in real time")
    diagrams = []
    for first in ways:
        for diagram in realtime.TIMED_DIAGRAMS:
            row = realtime.run(seconds, diagram, first)
            stated = {name: getattr(row, name) for name in ("what", "first", "period", "busy")}
            diagrams.append({**stated, **asdict(row.jitter), "late": _share_later(row.late)})
            run.advance()
    return {"diagrams": diagrams, "length": seconds, "cores": os.cpu_count(), "load": os.getloadavg()[0]}


def _share_later(late: Array) -> dict[str, list[float]]:
    """Share of the instants that began later than each of some times [us], as far as there are any."""
    shares = 1.0 - np.searchsorted(np.sort(1e6 * late), _EDGES) / len(late)
    used = int(np.count_nonzero(shares)) + 1
    return {"us": [float(f"{x:.4g}") for x in _EDGES[:used]], "share": [float(f"{x:.4g}") for x in shares[:used]]}


def compose(data: Data) -> Report:
    """The report of its JSON."""
    diagrams = data["diagrams"]
    best = [row for row in diagrams if row["first"]] or diagrams
    medians = [1e6 * row["median"] for row in best]
    machine = f"at load {data['load']:.1f} on {data['cores']} cores"
    charts = [_chart([row for row in diagrams if row["first"] is first], first) for first in (False, True)]
    figure = Figure(_SEE, tuple(chart for chart in charts if chart.curves))
    said = f"{data['length']:g} s each, {machine}; late by, in microseconds:"
    return Report(
        "Diagrams in real time",
        f"Instants of diagrams begin {min(medians):.0f} to {max(medians):.0f} µs late (medians), {machine}.",
        None,
        (_LIMITS,),
        (Section("How late instants begin", (said, Table.of(diagrams, _COLUMNS), figure)),),
        facts=tuple(
            Fact(f"{1e6 * row['median']:.0f} µs", f"median: {row['what']}; {row['missed']} of {row['instants']} missed")
            for row in best
        ),
        highlights=figure.charts[-1:],
    )


def _thread(first: bool) -> str:
    return "first" if first else "ordinary"


def _chart(rows: list[Data], first: bool) -> Chart:
    timed = [row for row in rows if "late" in row]
    drawn = tuple(Curve(row["what"], row["late"]["us"], row["late"]["share"], k) for k, row in enumerate(timed))
    periods = dict.fromkeys(1e6 * row["period"] for row in timed)
    marks = tuple(Mark(f"next instant due at {1e3 / period:g} kHz [us]", period, "x") for period in periods)
    title = f"{_thread(first)} thread: share of instants that began later"
    return Chart(title, "late by  [us]", "share of the instants  [1]", drawn, marks, log="xy")


TOPIC = Topic("realtime", "Speed", "How late do instants of diagrams begin?", compose, measure)
