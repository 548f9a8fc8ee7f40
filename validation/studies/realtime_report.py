"""`python -m validation realtime`: how late the instants of diagrams begin, as table, report and histograms."""

from __future__ import annotations

import io
import json
import os
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from matplotlib.figure import Figure
from rich.console import Console
from rich.table import Table

from symofros.atomic import write_atomically
from validation.reporting.provenance import stamp, versions
from validation.studies import realtime
from validation.studies.realtime import Timed

_LIMITS = (
    "Each scene runs in real time in the C loop, which sleeps until an instant is due; how late an instant began is "
    "read off the clock afterwards, so it is the operating system's waking plus whatever the instant before took too "
    "long. No core is set apart, and other programs run beside (see the load); what the machine does for a loop with "
    "nothing in it is the first row. Ordinary: a thread as any other. First: it comes before those of ordinary "
    "programs (SCHED_FIFO, as by `chrt -f 20 symofros simulate`), where the system permits that. An instant is missed "
    "if it began when the next one was due already. Busy is the loop's processor time an instant, motion included."
)
_REPORTS = Path("reports")
_COLORS = ("tab:gray", "tab:blue", "tab:orange", "tab:green")


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command("realtime")(realtime_command)


def realtime_command(
    seconds: Annotated[float, typer.Option(min=0.01, help="Of each scene.")] = 20.0,
    report: Annotated[Path, typer.Option(help="Folder for realtime.md, realtime.png, realtime.json.")] = Path(
        "reports"
    ),
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON, nothing else.")] = False,
) -> None:
    """Keep pace with the clock, and say how well."""
    ways = (False, True) if realtime.may_come_first() else (False,)
    rows = [realtime.run(seconds, scene, first) for first in ways for scene in realtime.SCENES]
    data: dict[str, Any] = {
        "scenes": [
            {"what": row.what, "first": row.first, "period": row.period, "busy": row.busy, **asdict(row.jitter)}
            for row in rows
        ],
        "seconds": seconds,
        "cores": os.cpu_count(),
        "load": os.getloadavg()[0],
        "versions": versions(),
        **stamp(),
    }
    report.mkdir(parents=True, exist_ok=True)
    write_atomically(report / "realtime.json", json.dumps(data, indent=1) + "\n")
    write_atomically(report / "realtime.md", as_markdown(data))
    write_atomically(report / "realtime.png", picture(rows))
    if as_json:
        typer.echo(json.dumps(data))
        return
    table = Table("scene", "thread", "least", "median", "99.9 %", "worst", "missed", "busy", title="late by [us]")
    for row in rows:
        table.add_row(
            row.what,
            _way(row.first),
            *(f"{1e6 * value:.1f}" for value in _numbers(row)),
            f"{row.jitter.missed} of {row.jitter.instants}",
            f"{1e6 * row.busy:.1f}",
        )
    Console().print(table)
    typer.echo(f"Report: {report / 'realtime.md'}")


def _way(first: bool) -> str:
    return "first" if first else "ordinary"


def _numbers(row: Timed) -> tuple[float, float, float, float]:
    return row.jitter.minimum, row.jitter.median, row.jitter.p999, row.jitter.maximum


def picture(rows: list[Timed]) -> bytes:
    """For each way a row: how many instants began how late, and the share that began later, all on powers of ten."""
    ways = sorted({row.first for row in rows})
    figure = Figure(figsize=(12.0, 1.0 + 3.8 * len(ways)), layout="constrained")
    grid = figure.subplots(len(ways), 2, sharex=True, sharey="col", squeeze=False)
    everything = np.concatenate([1e6 * row.late for row in rows])
    low, high = np.floor(np.log10(max(everything.min(), 0.1))), np.ceil(np.log10(everything.max()))
    bins = np.logspace(low, high, 121)
    for first, (left, right) in zip(ways, grid, strict=True):
        for row, color in zip((row for row in rows if row.first == first), _COLORS, strict=True):
            late = np.sort(np.maximum(1e6 * row.late, bins[0]))
            left.hist(late, bins=bins, histtype="step", color=color, label=row.what, linewidth=1.3)
            right.step(late, 1.0 - np.arange(len(late)) / len(late), where="post", color=color)
            right.axvline(1e6 * row.period, color=color, linewidth=0.8, linestyle=":")
        left.set_title(f"{_way(first)} thread", loc="left")
        left.set_ylabel("instants")
        right.set_ylabel("share that began later")
    for axis in grid.flat:
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.grid(alpha=0.3)
    grid[0, 0].legend(fontsize="small")
    grid[-1, 0].set_xlabel("instants began late by [us]")
    grid[-1, 1].set_xlabel("late by [us]; dotted: when the next instant was due")
    stream = io.BytesIO()
    figure.savefig(stream, dpi=100, metadata={"Software": None})
    return stream.getvalue()


def as_markdown(data: dict[str, Any]) -> str:
    """The report."""
    lines = [
        "# Diagrams in real time",
        "",
        _LIMITS,
        "",
        f"{data['seconds']:g} s each; late by, in microseconds:",
        "",
        "| scene | thread | least | median | 99.9 % | worst | missed | busy |",
        "|---|---|---:|---:|---:|---:|---:|---:|",
    ]
    for row in data["scenes"]:
        least, median, most, worst, busy = (
            f"{1e6 * row[name]:.1f}" for name in ("minimum", "median", "p999", "maximum", "busy")
        )
        missed = f"{row['missed']} of {row['instants']}"
        values = f"{least} | **{median}** | {most} | {worst} | {missed} | {busy}"
        lines.append(f"| {row['what']} | {_way(row['first'])} | {values} |")
    said = ", ".join(f"{name} {version}" for name, version in data["versions"].items())
    lines += [
        "",
        "![Histograms](realtime.png)",
        "",
        f"{data['cores']} cores, load {data['load']:.1f}; {said}; {', '.join(data['machine'].values())}; "
        f"{data['date']}.",
        "",
        "Written by `python -m validation realtime`.",
        "",
    ]
    return "\n".join(lines)
