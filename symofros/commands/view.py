"""`symofros view`: look at a model, play a motion, record it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import symofros as sf
from symofros.commands.reading import ReadingOptions, reads_models
from symofros.commands.shared import ModelPath, load, refuse
from symofros.studio.viewer.drawing.poses import Mechanism
from symofros.studio.viewer.playing.motion import read_motion


@reads_models
def view(
    model: ModelPath,
    *,
    reading: ReadingOptions,
    trajectory: Annotated[
        Path | None, typer.Option("--trajectory", help="A motion to play: .npz, .csv or .parquet.")
    ] = None,
    exaggeration: Annotated[float, typer.Option(help="Multiplies the elastic coordinates.")] = 1.0,
    speed: Annotated[float, typer.Option(help="Seconds of the motion a second.")] = 1.0,
    output: Annotated[
        Path | None,
        typer.Option("--record", help="Write .html (a replay in one page), .mp4, .gif or .png, and serve nothing."),
    ] = None,
    port: Annotated[int, typer.Option(help="Of the page; 0 for any free one.")] = 8080,
    host: Annotated[str, typer.Option(help="Address to serve at; this machine only by default.")] = "127.0.0.1",
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Whether to open the page.")] = True,
) -> None:
    """Show a model in three dimensions in the browser; play or record a motion (docs/view.md)."""
    system = load(model, reading)
    try:
        if output is not None:
            typer.echo(f"wrote {_record(system, trajectory, output, exaggeration, speed)}")
        else:
            _serve(system, trajectory, exaggeration, speed, host, port, browser)
    except (sf.SymofrosError, OSError) as error:
        raise refuse(error) from None


def _record(system: sf.System, trajectory: Path | None, output: Path, exaggeration: float, speed: float) -> Path:
    mechanism = Mechanism(system)
    if trajectory is not None:
        motion = read_motion(trajectory, mechanism.model)
        return sf.record(system, motion, output, exaggeration=exaggeration, speed=speed)
    if output.suffix in (".html", ".mp4", ".gif"):
        raise sf.SymofrosError(
            "record: nothing moves",
            "no --trajectory",
            "a recording is of a motion",
            "simulate one: symofros simulate MODEL T -o FILE.npz; or record a .png",
        )
    state = mechanism.closed(mechanism.state())[0]
    return sf.record(system, ([0.0], [state.q]), output, exaggeration=exaggeration)


def _serve(
    system: sf.System, trajectory: Path | None, exaggeration: float, speed: float, host: str, port: int, browser: bool
) -> None:
    run = None if trajectory is None else read_motion(trajectory, Mechanism(system).model)
    with sf.view(system, run, exaggeration=exaggeration, speed=speed, host=host, port=port, browser=browser) as shown:
        typer.echo(f"{system.name} is at {shown.url} (Ctrl-C ends)")
        shown.wait()
