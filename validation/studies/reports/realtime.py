"""How late the instants of diagrams begin."""

from __future__ import annotations

from collections.abc import Sequence

from ...reporting.figures import Chart, Curve, Figure, Mark
from ...reporting.record import Data, Fact, Report, Section, Table, Topic
from ..realtime import measure

_LIMITS = """Each diagram runs in real time in the C loop, which sleeps until an instant is due; how late an instant
began is read off the clock afterwards, so it is the operating system's waking plus whatever the instant before took too
long. No core is set apart, and other programs run beside; what the machine does for a loop with nothing in it is the
first row. Ordinary: a thread as any other. First: it comes before those of ordinary programs (SCHED_FIFO, as by `chrt
-f 20 symofros simulate`), where the system permits that. An instant is missed if it began when the next one was due
already. Busy is the loop's processor time an instant, motion included."""
_SEE = """The further left a curve falls, the more punctual. The body of each lies at tens of microseconds; the tail to
the right is the operating system doing other things. Right of a dashed line the next instant of a loop of that rate was
due already."""


def compose(data: Data) -> Report:
    """The report of its JSON."""
    rows = [{"thread": "first" if row["first"] else "ordinary", **row} for row in data["diagrams"]]
    best = [row for row in rows if row["first"]] or rows
    machine = f"at load {data['load']:.1f} on {data['cores']} cores"
    medians = sorted(1e6 * row["median"] for row in best)
    charts = tuple(_chart(rows, thread) for thread in dict.fromkeys(row["thread"] for row in rows if "late" in row))
    said = f"{data['length']:g} s each, {machine}; late by, in microseconds:"
    lines = []
    for row in rows:
        late = " | ".join(f"{1e6 * row[name]:.1f}" for name in ("minimum", "median", "p999", "maximum"))
        missed = f"{row['missed']} of {row['instants']}"
        lines.append(f"{row['what']} | {row['thread']} | {late} | {missed} | {1e6 * row['busy']:.1f}")
    table = Table.of("diagram | thread | least | median | 99.9 % | worst | missed | busy", lines)
    return Report(
        "Diagrams in real time",
        f"Instants of diagrams begin {medians[0]:.0f} to {medians[-1]:.0f} µs late (medians), {machine}.",
        None,
        (_LIMITS,),
        (Section("How late instants begin", (said, table, Figure(_SEE, charts))),),
        facts=tuple(
            Fact(f"{1e6 * row['median']:.0f} µs", f"median: {row['what']}; {row['missed']} of {row['instants']} missed")
            for row in best
        ),
    )


def _chart(rows: Sequence[Data], thread: str) -> Chart:
    timed = [row for row in rows if row["thread"] == thread and "late" in row]
    drawn = tuple(Curve(row["what"], row["late"]["us"], row["late"]["share"], k) for k, row in enumerate(timed))
    periods = dict.fromkeys(1e6 * row["period"] for row in timed)
    marks = tuple(Mark(f"next instant due at {1e3 / period:g} kHz [us]", period, "x") for period in periods)
    title = f"{thread} thread: share of instants that began later"
    return Chart(title, "late by  [us]", "share of the instants  [1]", drawn, marks, log="xy")


TOPIC = Topic("realtime", "Speed", "How late do instants of diagrams begin?", compose, measure)
