"""`python -m validation exports`: the cost of calls in each environment, and their worst case, as report."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from symofros.atomic import write_atomically
from validation.reporting.page import versions
from validation.reporting.provenance import stamp
from validation.reporting.record import machine
from validation.studies.exports import CALLS, ExportStudy, run_study

_LIMITS = (
    "The machine runs other work and no real-time kernel: the longest of many calls says how long the operating system "
    "was away, the median and 99.9 % what the code takes. Each call is timed by itself; the clock's own cost is the "
    "row `clock`, subtracted in the first table. M, h, Q from Octave and Python are means over a loop in their own "
    "language; steps from there are those of one call that makes a thousand. The FMU is called through FMPy, whose "
    "ctypes call is most of the difference to C. The block for Simulink was compiled and run against a stand-in "
    "header, not in Simulink."
)


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command("exports")(command)


def command(
    calls: Annotated[int, typer.Option(min=1000, help="Calls of each kind in C.")] = CALLS,
    report: Annotated[Path, typer.Option(help="Folder for exports.md and exports.json.")] = Path("reports"),
) -> None:
    """Time calls of an exported seven-joint arm: C, Python, MEX, FMU; and the worst case in C."""
    study = run_study(calls)
    data = {"versions": versions(), **stamp(), **asdict(study)}
    report.mkdir(parents=True, exist_ok=True)
    write_atomically(report / "exports.json", json.dumps(data, indent=1) + "\n")
    text = "\n".join(_lines(study)) + "\n"
    write_atomically(report / "exports.md", text)
    typer.echo(text)


def _lines(study: ExportStudy) -> Iterator[str]:
    yield "# Exports: what a call costs"
    yield ""
    yield f"`python -m validation exports`; {study.model}."
    yield f"Machine: {', '.join(f'{key} {value}' for key, value in machine().items())}."
    yield ""
    yield _LIMITS
    yield ""
    columns = list(next(iter(study.overheads.values())))
    yield f"| from | {' | '.join(f'{column} [us]' for column in columns)} |"
    yield f"|---|{'---:|' * len(columns)}"
    for where, times in study.overheads.items():
        shown = ["-" if times[column] is None else f"{times[column] / 1e3:.2f}" for column in columns]  # type: ignore[operator]
        yield f"| {where} | {' | '.join(shown)} |"
    yield ""
    yield f"## Worst case of {study.calls:,} calls in C [ns]"
    yield ""
    yield "| call | median | 99.9 % | longest |"
    yield "|---|---:|---:|---:|"
    for latency in study.latencies:
        yield f"| {latency.name} | {latency.median:.0f} | {latency.high:.0f} | {latency.worst:.0f} |"
    yield ""
    yield "Calls by time:"
    yield ""
    used = [i for i in range(len(study.latencies[0].bins)) if any(latency.bins[i] for latency in study.latencies)]
    yield f"| below [ns] | {' | '.join(latency.name for latency in study.latencies)} |"
    yield f"|---:|{'---:|' * len(study.latencies)}"
    for i in used:
        yield f"| {2 << i} | {' | '.join(str(latency.bins[i]) for latency in study.latencies)} |"
    yield ""
    yield "## Size of the C package [bytes]"
    yield ""
    yield "| part | size |"
    yield "|---|---:|"
    for part, size in study.bytes.items():
        yield f"| {part} | {size:,} |"
