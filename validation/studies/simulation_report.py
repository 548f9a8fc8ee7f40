"""`python -m validation simulation`: times of motions, as table and report."""

from __future__ import annotations

import json
from dataclasses import asdict
from importlib import metadata
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from symofros.atomic import write_atomically
from validation.reporting.provenance import stamp
from validation.studies import simulation

_SCENES = {
    "arm": simulation.arm,
    "four_bar": simulation.four_bar,
    "planar_robot": simulation.planar_robot,
    "spinning_beam": simulation.spinning_beam,
}
_LIMITS = (
    "Loops in C on both sides, one thread, in turn; seconds are those of the stepping alone for us and for MuJoCo, and "
    "of building and solving for Exudyn, whose models take milliseconds to build. Errors are against the reference "
    "named. Exudyn has the coarsest mesh and longest step, of those tried, that err no more than ours; MuJoCo and we "
    "step the arm by the same method, and the four-bar by steps that leave ours the more accurate. The ratio is the "
    "median over interleaved repeats."
)

_IFTOMM = (
    "Thresholds: the library's for A01 (5e-5 J) and A02 (0.1 J); eight digits of the IVP test set for A03; for A04 and "
    "A05 what the references are asked for. Whole motions are compared in tests/reference/test_iftomm.py. Milliseconds "
    "are the least of the repeats, of the stepping alone."
)


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command("simulation")(simulate)


def simulate(
    chosen: Annotated[list[str] | None, typer.Option("--scene", help=f"Only this: {', '.join(_SCENES)}.")] = None,
    repeats: Annotated[int, typer.Option(min=1, help="Interleaved repeats.")] = 7,
    report: Annotated[Path, typer.Option(help="Folder for simulation.md and simulation.json.")] = Path("reports"),
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON, nothing else.")] = False,
) -> None:
    """Time motions: times real time, and against MuJoCo and Exudyn at equal accuracy."""
    for name in chosen or ():
        if name not in _SCENES:
            raise typer.BadParameter(f"no scene '{name}'; there are {', '.join(_SCENES)}", param_hint="--scene")
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        rows = [_SCENES[name](repeats) for name in bar.track(chosen or list(_SCENES), description="motions")]
    benchmarks = [] if chosen else simulation.iftomm(repeats)
    versions = {name: metadata.version(name) for name in ("symofros", "mujoco", "exudyn")}
    data: dict[str, Any] = {
        "races": [asdict(row) | {"real_time": row.real_time} for row in rows],
        "iftomm": [asdict(row) for row in benchmarks],
        "repeats": repeats,
        "versions": versions,
        **stamp(),
    }
    report.mkdir(parents=True, exist_ok=True)
    write_atomically(report / "simulation.json", json.dumps(data, indent=1) + "\n")
    write_atomically(report / "simulation.md", as_markdown(data))
    if as_json:
        typer.echo(json.dumps(data))
        return
    table = Table("scene", "ours", "error", "x real time", "other", "error", "ratio")
    for row in rows:
        other = (f"{row.engine}: {row.theirs.how}", f"{row.theirs.error:.1e}") if row.theirs else ("", "")
        ratio = f"{row.ratio:.1f}" if row.theirs else ""
        table.add_row(row.scene, row.ours.how, f"{row.ours.error:.1e}", f"{row.real_time:.0f}", *other, ratio)
    Console().print(table)
    if benchmarks:
        table = Table("IFToMM benchmark", "ours", "error of", "error", "threshold", "ms")
        for one in benchmarks:
            table.add_row(
                one.name, one.how, one.measure, f"{one.error:.1e}", f"{one.threshold:.0e}", f"{1e3 * one.seconds:.3g}"
            )
        Console().print(table)
    typer.echo(f"Report: {report / 'simulation.md'}")
    raise typer.Exit(int(any(not one.error <= one.threshold for one in benchmarks)))


def as_markdown(data: dict[str, Any]) -> str:
    """The report."""
    lines = [
        "# Motions: times real time, and against engines at equal accuracy",
        "",
        _LIMITS,
        "",
        "| scene | seconds of motion | error of | ours | error | ms (min, median) | times real time | other | "
        "error | ms (min, median) | ratio |",
        "|---|---:|---|---|---:|---:|---:|---|---:|---:|---:|",
    ]
    for row in data["races"]:
        ours, theirs = row["ours"], row["theirs"]
        other = (
            [
                f"{row['engine']}: {theirs['how']}",
                f"{theirs['error']:.1e}",
                _milliseconds(theirs["seconds"]),
                f"**{row['ratio']:.1f}**",
            ]
            if theirs
            else [""] * 4
        )
        cells = [
            row["scene"],
            f"{row['span']:g}",
            row["measure"],
            ours["how"],
            f"{ours['error']:.1e}",
            _milliseconds(ours["seconds"]),
            f"**{row['real_time']:.0f}**",
            *other,
        ]
        lines.append("| " + " | ".join(cells) + " |")
    if data["iftomm"]:
        lines += [
            "",
            "# Multibody benchmarks of the IFToMM library",
            "",
            _IFTOMM,
            "",
            "| benchmark | seconds of motion | ours | error of | error | threshold | ms |",
            "|---|---:|---|---|---:|---:|---:|",
        ]
    for row in data["iftomm"]:
        lines.append(
            f"| {row['name']} | {row['span']:g} | {row['how']} | {row['measure']} | {row['error']:.1e} | "
            f"{row['threshold']:.0e} | {1e3 * row['seconds']:.3g} |"
        )
    versions = ", ".join(f"{name} {version}" for name, version in data["versions"].items())
    lines += [
        "",
        f"{data['repeats']} repeats; {versions}; {', '.join(data['machine'].values())}.",
        "",
        "Written by `python -m validation simulation`.",
        "",
    ]
    return "\n".join(lines)


def _milliseconds(seconds: list[float] | tuple[float, float]) -> str:
    return ", ".join(f"{1e3 * x:.3g}" for x in seconds)
