"""symofros simulate: a model or a diagram through time."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

import symofros as sf
from symofros.commands import view_options
from symofros.commands.reading import ReadingOptions, reads_models
from symofros.commands.shared import (
    NOT_FOR_DIAGRAMS,
    AllowNative,
    AsJson,
    FilePath,
    Network,
    assignments,
    entries_of,
    load,
    names_of,
    numbers,
    refuse,
    shown,
)
from symofros.commands.states import stated_state
from symofros.commands.terminal import err, out
from symofros.compiler import compile_system
from symofros.description import System
from symofros.diagrams.files import command as diagrams
from symofros.diagrams.files.kind import is_diagram
from symofros.simulation.analysis.kinematics.starts import closed_start, stated_names
from symofros.simulation.progress import pace_of
from symofros.simulation.results.ends import INTERRUPTED, UNEXAMINED
from symofros.simulation.results.plots import MAX_CURVES, check_curves, check_picture, write_picture
from symofros.simulation.results.saving import check_file, save_or_keep
from symofros.simulation.stepping.methods import METHODS

# Exit status of a command that Ctrl-C has ended: 128 and the number of the signal, as of shells.
_STOPPED = 130
# Events in a table at most.
_MAX_EVENTS = 20


@reads_models
def simulate(
    model: FilePath,
    t_end: Annotated[float | None, typer.Argument(help="Where to end [s]; 1, or what the diagram says.")] = None,
    *,
    reading: ReadingOptions,
    method: Annotated[str | None, typer.Option(help=f"{', '.join(METHODS)}; rk4 by default.")] = None,
    dt: Annotated[float | None, typer.Option(help="Step [s]; the first one of adaptive methods.")] = None,
    rtol: Annotated[float | None, typer.Option(help="Relative error of a step, adaptive methods.")] = None,
    beam_limit: Annotated[
        float | None, typer.Option(help="Estimated error of a beam's theory at which to end; 0.5 by default, or inf.")
    ] = None,
    given: Annotated[
        list[str],
        typer.Option(
            "--set",
            help="NAME=NUMBER: a first coordinate or speed (dNAME), or a run-time parameter; of a diagram "
            "BLOCK.FIELD=NUMBER or NUMBER,NUMBER: a run-time parameter.",
        ),
    ] = [],  # noqa: B006
    inputs: Annotated[
        list[str],
        typer.Option("--input", help="NAME=FORMULA of coordinates, speeds and t; of a diagram INLET=FORMULA,... of t."),
    ] = [],  # noqa: B006
    every: Annotated[
        float | None, typer.Option("--record", "--every", help="Record at this interval [s]; each step by default.")
    ] = None,
    signals: Annotated[
        str, typer.Option(help="What to plot: NAME,... of a model; of a diagram BLOCK.PORT,..., to save as well.")
    ] = "",
    output: Annotated[Path | None, typer.Option("--output", "-o", help="Write .npz, .csv or .parquet.")] = None,
    picture: Annotated[
        str, typer.Option("--plot", "--picture", help="Write a picture: .png, .svg, .pdf; of a diagram also 'window'.")
    ] = "",
    realtime: Annotated[bool, typer.Option("--realtime", help="Keep pace with the clock.")] = False,
    speed: Annotated[
        float | None, typer.Option(min=1e-6, help="Seconds of motion a second; keeps pace with the clock.")
    ] = None,
    jitter: Annotated[Path | None, typer.Option(help="Of a diagram: picture of how late instants were.")] = None,
    view: Annotated[
        bool,
        typer.Option(
            "--view",
            help="Play the run in three dimensions in the browser; of a diagram that keeps pace, show it as it goes.",
        ),
    ] = False,
    view_block: Annotated[str, typer.Option(help="Of a diagram with several mechanisms: whose is shown.")] = "",
    record_view: Annotated[
        Path | None, typer.Option(help="Write what --view shows: .html (a replay in one page), .mp4, .gif or .png.")
    ] = None,
    interactive: Annotated[
        bool, typer.Option("--interactive", help="The page of --record-view simulates on, too; of a model, needs zig.")
    ] = False,
    exaggeration: Annotated[float, typer.Option(help="Multiplies the elastic coordinates in the picture.")] = 1.0,
    network: Network = False,
    allow_native: AllowNative = False,
    as_json: AsJson = False,
) -> None:
    """Move a model or a diagram through time, and say how it went."""
    pace = speed or float(realtime)
    settings = {"method": method, "dt": dt, "rtol": rtol, "beam_limit": beam_limit}
    stated: dict[str, Any] = {name: value for name, value in settings.items() if value is not None}
    wanted = not as_json and err.is_terminal
    viewing = view_options.ViewOptions(view, view_block, record_view, exaggeration, interactive)
    try:
        if is_diagram(model):
            reading.require_none(NOT_FOR_DIAGRAMS)
            stated |= {"record": every} if every is not None else {}
            stated |= {"parameters": {name: numbers(name, text) for name, text in assignments(given, "--set").items()}}
            names = tuple(names_of(signals) or ())
            formulas = {name: entries_of(text) for name, text in assignments(inputs, "--input").items()}
            request = diagrams.RunRequest(t_end, formulas, stated, pace, names, output, picture, jitter)
            diagram = sf.load_diagram(model, network=network, allow_native=allow_native)
            diagram, live = view_options.with_live_view(diagram, viewing, bool(pace or diagram.simulation.realtime))
            diagram_run = diagrams.run_diagram(diagram, request, wanted)
            files = diagrams.write_files(diagram_run, request) + view_options.record_run(diagram_run, viewing)
            diagrams.print_run(diagram_run, files, as_json, out)
            view_options.show_run(diagram_run, viewing, live=live)
            outcome = diagram_run.outcome
        else:
            if picture == diagrams.WINDOW:
                raise sf.SymofrosError(
                    "--plot window: the file is a model",
                    str(model),
                    "windows are of diagrams only, whose plots they show",
                    "write a picture: --plot run.png",
                )
            viewing.check()
            if output:
                check_file(output, "trajectory")
            if picture:
                check_picture(Path(picture))
            system, curves = load(model, reading), names_of(signals) or []
            run = _simulated(system, t_end, given, inputs, curves, every, pace, stated, wanted)
            saved = [str(save_or_keep(run.save, output))] if output else []
            files = saved + view_options.record_run(run, viewing, system)
            if picture:
                files.append(_drawn(run, curves, picture))
            _tell(run, files, as_json)
            view_options.show_run(run, viewing, system)
            outcome = run.outcome
    except (sf.SymofrosError, ValueError, OSError) as error:
        raise refuse(error) from None
    if not outcome.ok:
        raise typer.Exit(_STOPPED if outcome.reason in (INTERRUPTED.reason, UNEXAMINED.reason) else 1)


def _simulated(
    system: System,
    t_end: float | None,
    given: list[str],
    inputs: list[str],
    curves: list[str],
    every: float | None,
    pace: float,
    settings: dict[str, Any],
    progress: bool,
) -> sf.Trajectory:
    """The run of one model."""
    stated = assignments(given, "--set")
    compiled, q, v = stated_state(compile_system(system), stated)
    check_curves(compiled, curves)
    start = closed_start(compiled, q, v, *stated_names(compiled.names.q, compiled.names.v, stated))
    run = sf.simulate(
        compiled,
        start.q,
        start.v,
        1.0 if t_end is None else t_end,
        u=assignments(inputs, "--input") or None,
        output=every,
        realtime=pace,
        progress=progress,
        **settings,
    )
    return replace(run, outcome=replace(run.outcome, notes=(*start.notes, *run.outcome.notes)))


def _drawn(run: sf.Trajectory, names: list[str], picture: str) -> str:
    """Write a plot of a run to a file and return its path; report it if only the first curves are shown."""
    write_picture(run.plot(*names), Path(picture))
    count = len(names or run.model.names.q)
    if count > MAX_CURVES:
        note = f"{picture} shows the first {MAX_CURVES} of {count} coordinates: --signals NAME,... chooses others"
        err.print(note, markup=False, highlight=False, soft_wrap=True)
    return picture


def _tell(run: sf.Trajectory, files: list[str], as_json: bool) -> None:
    """Outcome, cost and last state of a run."""
    cost, drift = run.statistics, float(run.energy[-1] - run.energy[0])
    last = {name: float(column[-1]) for name, column in run.columns().items()}
    if as_json:
        print(
            json.dumps(
                {
                    "ok": run.outcome.ok,
                    "outcome": run.outcome.as_data(),
                    "statistics": asdict(cost),
                    "last": last,
                    "energy_change": drift,
                    "events": [
                        {"name": found.name, "t": float(found.t), "energy_lost": float(found.energy_lost)}
                        for found in run.events
                    ],
                    "files": files,
                },
                indent=1,
            )
        )
        return
    out.print(str(run.outcome), markup=False, highlight=False, soft_wrap=True)
    table = Table("name", "first", "last", title=f"{len(run)} states, t = {run.t[0]:g} to {run.t[-1]:g} s")
    for name, column in run.columns().items():
        table.add_row(name, shown(column[0]), shown(column[-1]))
    out.print(table)
    if run.events:
        count = len(run.events)
        first = f", the first {_MAX_EVENTS} of {count} (--json lists them)" if count > _MAX_EVENTS else ""
        met = Table("event", "t [s]", "energy lost [J]", title=f"Events{first}")
        for found in run.events[:_MAX_EVENTS]:
            met.add_row(found.name, f"{found.t:.9g}", shown(found.energy_lost))
        out.print(met)
    out.print(
        f"{cost.steps} steps, {cost.rejected} rejected, {cost.evaluations} evaluations; {cost.seconds:.3g} s,"
        f" {pace_of(run.t[-1] - run.t[0], cost.seconds)}; energy changed by {drift + 0.0:.3g} J",
        markup=False,
    )
    for file in files:
        out.print(f"wrote {file}", markup=False)
