"""`python -m validation timing`: the ratios, as table and report."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from importlib import metadata
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

import symofros as sf
from symofros.atomic import write_atomically
from validation.record import machine
from validation.studies.native_build import FLAGS, BuildError
from validation.studies.timing import REPEATS, STATES, Timing, TimingRun, models, run_timing
from validation.studies.timing_flexible import LABEL, run_flexible
from validation.studies.timing_flexible_report import flexible_lines, show_flexible
from validation.studies.timing_mujoco import time_mujoco
from validation.studies.timing_mujoco_report import mujoco_lines, show_mujoco

_NAMES = {
    "mass_matrix": "M",
    "bias": "h",
    "mass_matrix_and_bias": "M + h",
    "mass_matrix_and_bias_batch": "M + h, batch",
    "inverse_dynamics_derivatives": "derivatives",
}
_LIMITS = (
    "One thread, pinned to one processor, models and states warm in the caches; loops over the states in C on both "
    "sides, in one process, in turn; each side computes the same values to 1e-12, which is checked first. Ours is "
    "generated C, compiled by the system's compiler at -O2 -march=native, one state after the other, or (batch) "
    "several at a time by vectors, in calls of 64 states whose results replace each other as Pinocchio's do; Pinocchio "
    "is its own headers, compiled in the run, crba in the faster of its two conventions. Machines are noisy: quote the "
    "ratio, which is the median over interleaved repeats, rather than a single time."
)


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command("timing")(timing)


def timing(
    chosen: Annotated[list[str] | None, typer.Option("--model", help="Only this model; repeatable.")] = None,
    repeats: Annotated[int, typer.Option(min=3, help="Interleaved repeats.")] = REPEATS,
    report: Annotated[Path, typer.Option(help="Folder for timing.md and timing.json.")] = Path("reports"),
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON, nothing else.")] = False,
) -> None:
    """Time generated C against Pinocchio's C++, built in the run, MuJoCo's C, and a flexible robot against Exudyn."""
    known = models()
    names = [*known, LABEL]
    for name in chosen or ():
        if name not in names:
            raise typer.BadParameter(f"no model '{name}'; there are {', '.join(names)}", param_hint="--model")
    console, load = Console(stderr=True), _load()
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("timing", total=len(chosen or names))
        picked = {name: known[name] for name in chosen or known if name in known}
        run = run_timing(picked, repeats, lambda label: bar.update(task, advance=1))
        _add_mujoco(run, picked, repeats)
        if LABEL in (chosen or names):
            _add_flexible(run, repeats)
    data = as_data(run, repeats, [*load, *_load()])
    report.mkdir(parents=True, exist_ok=True)
    write_atomically(report / "timing.json", json.dumps(data, indent=1) + "\n")
    write_atomically(report / "timing.md", as_markdown(data))
    if as_json:
        typer.echo(json.dumps(data))
    else:
        if run.timings:
            _show(run.timings)
        show_mujoco(run.mujoco)
        show_flexible(run.flexible)
        typer.echo(f"Report: {report / 'timing.md'}")
    for failure in run.failures:
        typer.echo(f"not timed: {failure}", err=True)
    raise typer.Exit(1 if run.failures else 0)


def _add_mujoco(run: TimingRun, picked: Mapping[str, sf.System], repeats: int) -> None:
    for label, system in picked.items():
        try:
            run.mujoco += time_mujoco(label, system, repeats)
        except (BuildError, sf.SymofrosError) as error:
            run.failures.append(str(error))


def _add_flexible(run: TimingRun, repeats: int) -> None:
    try:
        run.flexible += run_flexible(repeats)
    except BuildError as error:
        run.failures.append(str(error))


def _load() -> list[float]:
    """Processes that ran in the last minute, on average; nothing where the system does not say."""
    return [os.getloadavg()[0]] if hasattr(os, "getloadavg") else []


def as_data(run: TimingRun, repeats: int, load: Sequence[float] = ()) -> dict[str, Any]:
    """The result as plain data, with what it depends on; the machine's load before and after."""
    packages = {"symofros": "symofros", "pinocchio": "pin", "mujoco": "mujoco", "exudyn": "exudyn"}
    versions = {name: metadata.version(package) for name, package in packages.items()}
    return {
        "timings": [asdict(timing) for timing in run.timings],
        "mujoco": [asdict(timing) for timing in run.mujoco],
        "flexible": [asdict(timing) for timing in run.flexible], "failures": run.failures, "repeats": repeats,
        "states": STATES, "flags": list(FLAGS), "versions": versions, "machine": machine(), "load": list(load),
    }  # fmt: skip


def as_markdown(data: dict[str, Any]) -> str:
    """The report."""
    lines = ["# Generated C against Pinocchio's C++", "", _LIMITS, "",
             "| model | nv | function | ours, ns (min, median) | Pinocchio, ns (min, median) | ratio | compiled by |",
             "|---|---:|---|---:|---:|---:|---|"]  # fmt: skip
    for row in data["timings"]:
        ours, theirs = (", ".join(f"{x:.0f}" for x in row[side]) for side in ("ours", "theirs"))
        lines.append(f"| {row['model']} | {row['nv']} | {_NAMES[row['function']]} | {ours} | {theirs} | "
                     f"**{row['ratio']:.2f}** | {row['compiler']} |")  # fmt: skip
    lines += mujoco_lines(data["mujoco"])
    lines += flexible_lines(data["flexible"])
    lines += [f"\nNot timed: {failure.splitlines()[0]}" for failure in data["failures"]]
    versions = ", ".join(f"{name} {version}" for name, version in data["versions"].items())
    shared = " and ".join(f"{load:.1f}" for load in data["load"])
    lines += ["", f"Load of the machine before and after: {shared}; alone on it, 0 and 1."] if shared else []
    lines += ["", f"{data['states']} random states, {data['repeats']} repeats; {versions}; flags of Pinocchio's side: "
              f"`{' '.join(data['flags'])}`; {', '.join(data['machine'].values())}.", "",
              "Written by `python -m validation timing`.", ""]  # fmt: skip
    return "\n".join(lines)


def _show(timings: Iterable[Timing]) -> None:
    table = Table("model", "nv", "function", "ours [ns]", "Pinocchio [ns]", "ratio", title="Minimum and median a state")
    for row in timings:
        ours, theirs = (f"{low:.0f}, {middle:.0f}" for low, middle in (row.ours, row.theirs))
        table.add_row(row.model, str(row.nv), _NAMES[row.function], ours, theirs, f"{row.ratio:.2f}")
    Console().print(table)
