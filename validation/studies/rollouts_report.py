"""`python -m validation rollouts`: thousands of motions at once, as table and report."""

from __future__ import annotations

import json
import os
from dataclasses import asdict
from importlib import metadata
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from symofros.atomic import write_atomically
from validation.reporting.provenance import stamp
from validation.studies import rollouts

_LIMITS = (
    "Loops in C on both sides, in turn, from the same starts; times are the processor's, so that other programs do not "
    "lengthen them, and the loops' alone, without compiling, loading or copying the starts. MuJoCo keeps the state "
    "after each step, we the last one (some nanoseconds a step). The arm's joints are free of friction and of limits "
    "on both sides, and nothing touches; springs and dampers of the joints are the PD control. The ratio is the median "
    "over interleaved repeats of the whole times, so that of an adaptive method is one of time to the end, at the "
    "errors shown."
)


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command("rollouts")(rollouts_command)


def rollouts_command(
    trajectories: Annotated[int, typer.Option(min=1, help="How many.")] = rollouts.TRAJECTORIES,
    steps: Annotated[int, typer.Option(min=1, help="Of a millisecond each.")] = rollouts.STEPS,
    repeats: Annotated[int, typer.Option(min=1, help="Interleaved repeats.")] = 7,
    threads: Annotated[int, typer.Option(min=1, help="Of each side.")] = 1,
    report: Annotated[Path, typer.Option(help="Folder for rollouts.md and rollouts.json.")] = Path("reports"),
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON, nothing else.")] = False,
) -> None:
    """Time thousands of motions of an arm, against mujoco.rollout."""
    rows = rollouts.run(repeats, trajectories, steps, threads)
    versions = {name: metadata.version(name) for name in ("symofros", "mujoco")}
    data: dict[str, Any] = {
        "rollouts": [asdict(row) for row in rows],
        "trajectories": trajectories,
        "repeats": repeats,
        "load": os.getloadavg()[0],
        "versions": versions,
        **stamp(),
    }
    report.mkdir(parents=True, exist_ok=True)
    write_atomically(report / "rollouts.json", json.dumps(data, indent=1) + "\n")
    write_atomically(report / "rollouts.md", as_markdown(data))
    if as_json:
        typer.echo(json.dumps(data))
        return
    table = Table("scene", "who", "how", "error [rad]", "ns a step", "M steps/s/core", "MuJoCo's time over it")
    for row in rows:
        table.add_row(
            row.scene,
            row.who,
            row.how,
            f"{row.error:.1e}",
            f"{row.nanoseconds[0]:.0f}",
            f"{1e3 / row.nanoseconds[0]:.2f}",
            f"{row.ratio:.1f}",
        )
    Console().print(table)
    typer.echo(f"Report: {report / 'rollouts.md'}")


def as_markdown(data: dict[str, Any]) -> str:
    """The report."""
    lines = [
        f"# {data['trajectories']} motions of a 7-joint arm at once",
        "",
        _LIMITS,
        "",
        "| scene | who | how | threads | error [rad] | steps | ns a step (min, median) | million steps a second "
        "and core | MuJoCo's time over it |",
        "|---|---|---|---:|---:|---:|---:|---:|---:|",
    ]
    for row in data["rollouts"]:
        least, middle = row["nanoseconds"]
        lines.append(
            f"| {row['scene']} | {row['who']} | {row['how']} | {row['threads']} | {row['error']:.1e} | "
            f"{row['steps']} | {least:.0f}, {middle:.0f} | {1e3 / least:.2f} | **{row['ratio']:.1f}** |"
        )
    versions = ", ".join(f"{name} {version}" for name, version in data["versions"].items())
    lines += [
        "",
        f"{data['repeats']} repeats; load {data['load']:.1f}; {versions}; {', '.join(data['machine'].values())}.",
        "",
        "Written by `python -m validation rollouts`.",
        "",
    ]
    return "\n".join(lines)
