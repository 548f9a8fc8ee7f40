"""Command line: symofros info | compile | simulate | advise | export | view | edit; info and simulate take diagrams."""

from __future__ import annotations

import json
import time
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any, cast

import numpy as np
import typer
from rich.console import Console
from rich.table import Table
from rich.tree import Tree

import symofros as sf
from symofros import watching
from symofros.advice.report import table_of
from symofros.atomic import write_atomically
from symofros.codegen.names import identifier
from symofros.codegen.templates import template
from symofros.compiler import compile_system, describe, generate, plan, requested
from symofros.description.system import System
from symofros.diagram_files import command as diagrams
from symofros.errors import did_you_mean
from symofros.exporting import TARGETS
from symofros.options import FRAME_FUNCTIONS, MODEL_FUNCTIONS
from symofros.passes.count import Operations, count_program
from symofros.runtime.kernel import Array
from symofros.simulation.methods import METHODS
from symofros.topology.tree import BASE, SpanningTree
from symofros.viewing.command import add_view

app = typer.Typer(no_args_is_help=True, add_completion=False, help="Symbolic multibody models as fast C code.")
_out = Console()
_err = Console(stderr=True)

ModelPath = Annotated[Path, typer.Argument(help="A model: .yaml, .urdf or .xml (MJCF)", show_default=False)]
FilePath = Annotated[Path, typer.Argument(help="A model, or a diagram's .yaml.", show_default=False)]
Network = Annotated[bool, typer.Option("--network", help="Let a diagram's blocks reach other machines.")]
Floating = Annotated[bool, typer.Option("--floating-base", help="Put a free joint under a URDF's root link.")]
AsJson = Annotated[bool, typer.Option("--json", help="Machine-readable output.")]
BAD_INPUT = 2


def _load(path: Path, floating_base: bool) -> System:
    try:
        return sf.load(path, floating_base=floating_base)
    except sf.DescriptionError as error:
        count = len(error.problems)
        _err.print(str(error), markup=False, highlight=False, soft_wrap=True)
        _err.print(f"{path.name}: {count} problem{'s' * (count > 1)}", markup=False, highlight=False, soft_wrap=True)
        raise typer.Exit(BAD_INPUT) from None


def _refuse(error: Exception) -> typer.Exit:
    """Say what is wrong with the input."""
    _err.print(str(error), markup=False, highlight=False, soft_wrap=True)
    return typer.Exit(BAD_INPUT)


@app.command()
def info(model: FilePath, floating_base: Floating = False, network: Network = False, as_json: AsJson = False) -> None:
    """Show a model: its tree, its sizes, the operations of each function; or a diagram: blocks, rates, order."""
    if diagrams.is_diagram(model):
        try:
            diagrams.tell_diagram(sf.load_diagram(model, network=network), as_json, _out)
        except sf.SymofrosError as error:
            raise _refuse(error) from None
        return
    system = _load(model, floating_base)
    tree = plan(system)
    counts = _counts(tree)
    names = tree.coordinates
    sizes = {"nq": len(names.q), "nv": len(names.v), "nu": len(names.u), "npar": len(names.par)}
    if as_json:
        operations = {name: vars_of(count) for name, count in counts.items()}
        frames = [frame.name for frame in tree.frames]
        print(json.dumps({"name": system.name, **sizes, "frames": frames, "operations": operations,
                          "notes": list(system.notes)}, indent=1))  # fmt: skip
        return
    _out.print(_draw(tree))
    _out.print(", ".join(f"{key} {value}" for key, value in sizes.items()), markup=False)
    table = Table("function", "mul", "add", "div", "call", "total", title="Operations per call")
    for name, count in counts.items():
        table.add_row(name, *map(str, (count.mul, count.add, count.div, count.call, count.total)))
    _out.print(table)
    for note in system.notes:
        _out.print(f"note: {note}", markup=False, highlight=False, soft_wrap=True)


def vars_of(count: Operations) -> dict[str, int]:
    """Counts by kind."""
    return {"mul": count.mul, "add": count.add, "div": count.div, "call": count.call}


def _counts(tree: SpanningTree) -> dict[str, Operations]:
    """Operations of each model function, and of each frame function at the last frame."""
    frame = tree.frames[-1].name
    keys = [(name, "") for name in MODEL_FUNCTIONS] + [(name, frame) for name in FRAME_FUNCTIONS]
    program, _ = generate(tree, keys, describe(tree, sf.Options()))
    return {" of ".join(filter(None, key)): count for key, count in count_program(program).items()}


def _draw(tree: SpanningTree) -> Tree:
    base = next((body.name for body in tree.system.bodies if body.joint is None), "world")
    root = Tree(f"{tree.system.name}: {base}", highlight=False)
    branches = {BASE: root}
    for i, link in enumerate(tree.links):
        start, size = link.v
        speeds = f"v[{start}]" if size == 1 else f"v[{start}:{start + size}]"
        frames = sum(frame.link == i for frame in tree.frames)
        text = f"{link.name}  ({link.joint.kind} {link.joint.name}, {speeds}, {frames} frame{'s' * (frames != 1)})"
        branches[i] = branches[link.parent].add(text)
    return root


@app.command("compile")
def compile_command(
    model: ModelPath,
    floating_base: Floating = False,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Also write NAME.c and symofros_model.h to this folder.")
    ] = None,
    functions: Annotated[
        str, typer.Option(help="Functions to generate, comma-separated; all of the model's by default.")
    ] = ",".join(MODEL_FUNCTIONS),
    frames: Annotated[str, typer.Option(help="Frames of frame functions, comma-separated; all by default.")] = "",
    as_json: AsJson = False,
) -> None:
    """Generate and compile a model; it is then in the cache."""
    system = _load(model, floating_base)
    options = sf.Options(functions=tuple(functions.split(",")), frames=tuple(frames.split(",")) if frames else None)
    start = time.perf_counter()
    try:
        tree = plan(system)
        program, source = generate(tree, requested(tree, options), describe(tree, options))
        text = source()
        generated = time.perf_counter()
        compile_system(system, options)
    except sf.SymofrosError as error:
        _err.print(str(error), markup=False, highlight=False, soft_wrap=True)
        raise typer.Exit(BAD_INPUT) from None
    done = time.perf_counter()
    total = sum(count.total for key, count in count_program(program).items() if key[0] != "init")
    result: dict[str, Any] = {
        "name": system.name, "operations": total, "bytes": len(text),
        "generate_s": generated - start, "compile_s": done - generated,
    }  # fmt: skip
    if output is not None:
        output.mkdir(parents=True, exist_ok=True)
        name = identifier(system.name)
        write_atomically(output / f"{name}.c", text)
        write_atomically(output / "symofros_model.h", template("symofros_model.h"))
        result["files"] = [str(output / f"{name}.c"), str(output / "symofros_model.h")]
    if as_json:
        print(json.dumps(result, indent=1))
        return
    _out.print(
        f"{system.name}: {total} operations, {len(text) / 1024:.0f} KiB of C; "
        f"generated in {result['generate_s']:.2f} s, compiled or found in {result['compile_s']:.2f} s",
        markup=False,
    )
    for file in result.get("files", ()):
        _out.print(f"wrote {file}", markup=False)


def _assignments(given: list[str], what: str) -> dict[str, str]:
    """NAME=TEXT options as a mapping."""
    found = {}
    for item in given:
        name, sign, text = item.partition("=")
        if not sign or not name or not text:
            _err.print(f"{what} '{item}'\n  rule:   NAME=VALUE\n  remedy: for example q1=0.5", markup=False)
            raise typer.Exit(BAD_INPUT)
        found[name.strip()] = text.strip()
    return found


def _number(name: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        _err.print(f"'{name}': '{text}' is not a number", markup=False)
        raise typer.Exit(BAD_INPUT) from None


def _numbers(name: str, text: str) -> float | list[float]:
    """One number, or some between commas."""
    parts = text.strip("[]").split(",")
    return _number(name, parts[0]) if len(parts) == 1 else [_number(name, part) for part in parts]


def _first_state(model: sf.Model, given: dict[str, str]) -> tuple[Array, Array]:
    """The neutral state, with what --set gives; closed where the model has loops."""
    q, v = model.neutral(), np.zeros(model.nv)
    for name, text in given.items():
        value = _number(name, text)
        if name in model.names.q:
            q[model.names.q.index(name)] = value
        elif name.removeprefix("d") in model.names.v:
            v[model.names.v.index(name.removeprefix("d"))] = value
        elif name in model.names.v:
            v[model.names.v.index(name)] = value
        else:
            known = (*model.names.q, *(f"d{speed}" for speed in model.names.v))
            _err.print(f"--set: no coordinate or speed '{name}'\n  remedy: {did_you_mean(name, known)}", markup=False)
            raise typer.Exit(BAD_INPUT)
    if not model.nc:
        return q, v
    closed = sf.assemble(model, q, v)
    return closed.q, closed.v


@app.command()
def simulate(
    model: FilePath,
    t_end: Annotated[float | None, typer.Argument(help="Where to end [s]; 1, or what the diagram says.")] = None,
    floating_base: Floating = False,
    method: Annotated[str | None, typer.Option(help=f"{', '.join(METHODS)}; rk4 by default.")] = None,
    dt: Annotated[float | None, typer.Option(help="Step [s]; the first one of adaptive methods.")] = None,
    rtol: Annotated[float | None, typer.Option(help="Relative error of a step, adaptive methods.")] = None,
    given: Annotated[
        list[str], typer.Option("--set", help="NAME=NUMBER: a first coordinate or speed (dNAME); of a diagram "
                                "BLOCK.FIELD=NUMBER or NUMBER,NUMBER: a run-time parameter.")
    ] = [],  # noqa: B006
    inputs: Annotated[list[str], typer.Option("--input", help="NAME=FORMULA of coordinates, speeds and t.")] = [],  # noqa: B006
    every: Annotated[
        float | None, typer.Option("--record", "--every", help="Record at this interval [s]; each step by default.")
    ] = None,
    signals: Annotated[str, typer.Option(help="Of a diagram: BLOCK.PORT,... to save and plot.")] = "",
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
        bool, typer.Option("--view", help="Play the run in three dimensions in the browser; of a diagram that keeps "
                           "pace, show it as it goes.")
    ] = False,
    view_block: Annotated[str, typer.Option(help="Of a diagram with several mechanisms: whose is shown.")] = "",
    record_view: Annotated[
        Path | None, typer.Option(help="Write what --view shows: .html (a replay in one page), .mp4, .gif or .png.")
    ] = None,
    exaggeration: Annotated[float, typer.Option(help="Multiplies the elastic coordinates in the picture.")] = 1.0,
    network: Network = False,
    as_json: AsJson = False,
) -> None:  # fmt: skip
    """Move a model or a diagram through time, and say how it went."""
    pace = speed or float(realtime)
    settings = {"method": method, "dt": dt, "rtol": rtol}
    stated: dict[str, Any] = {name: value for name, value in settings.items() if value is not None}
    wanted = not as_json and _err.is_terminal
    look = watching.Look(view, view_block, record_view, exaggeration)
    try:
        if diagrams.is_diagram(model):
            if inputs:
                raise sf.SymofrosError(f"--input: a diagram's inputs are blocks\n  found:  {inputs[0]}")
            stated |= {"record": every} if every is not None else {}
            stated |= {
                "parameters": {name: _numbers(name, text) for name, text in _assignments(given, "--set").items()}
            }
            names = tuple(_names(signals) or ())
            wishes = diagrams.Wishes(t_end, stated, pace, names, output, picture, jitter)
            diagram = sf.load_diagram(model, network=network)
            diagram, live = watching.prepared(diagram, look, bool(pace or diagram.simulation.realtime))
            found = diagrams.run_diagram(diagram, wishes, wanted)
            files = diagrams.write_files(found, wishes) + watching.recorded(found, look)
            diagrams.tell_run(found, files, as_json, _out)
            watching.shown(found, look, live=live)
            ok = found.outcome.ok
        else:
            if picture == diagrams.WINDOW:
                raise sf.SymofrosError("--plot window: of diagrams only\n  remedy: write a picture: --plot run.png")
            look.check()
            system = _load(model, floating_base)
            run = _simulated(system, t_end, given, inputs, every, pace, stated, wanted)
            files = ([str(run.save(output))] if output else []) + watching.recorded(run, look, system)
            if picture:
                run.plot().savefig(picture, dpi=120)
                files.append(picture)
            _tell(run, files, as_json)
            watching.shown(run, look, system)
            ok = run.outcome.ok
    except (sf.SymofrosError, ValueError, OSError) as error:
        raise _refuse(error) from None
    if not ok:
        raise typer.Exit(1)


def _simulated(
    system: System, t_end: float | None, given: list[str], inputs: list[str], every: float | None, pace: float,
    settings: dict[str, Any], progress: bool,
) -> sf.Trajectory:  # fmt: skip
    """The run of one model."""
    compiled = compile_system(system)
    q, v = _first_state(compiled, _assignments(given, "--set"))
    return sf.simulate(
        compiled, q, v, 1.0 if t_end is None else t_end, u=_assignments(inputs, "--input") or None, output=every,
        realtime=pace, progress=progress, **settings,
    )  # fmt: skip


@app.command()
def advise(
    model: ModelPath,
    scene: Annotated[Path, typer.Option(help="The scene, a YAML file (docs/advise.md).", show_default=False)],
    floating_base: Floating = False,
    tolerance: Annotated[
        list[str], typer.Option(help="NUMBER for every output, or OUTPUT=NUMBER; in place of the scene's.")
    ] = [],  # noqa: B006
    output: Annotated[Path | None, typer.Option("--output", "-o", help="Write the reduced model: .yaml.")] = None,
    as_json: AsJson = False,
) -> None:
    """Find the cheapest model that keeps a scene's tolerance, each choice verified by simulation."""
    system = _load(model, floating_base)
    try:
        found = sf.advise(system, sf.load_scene(scene), _tolerances(tolerance))
        if output:
            found.write(output)
    except sf.SymofrosError as error:
        _err.print(str(error), markup=False, highlight=False, soft_wrap=True)
        raise typer.Exit(BAD_INPUT) from None
    if as_json:
        print(json.dumps(found.to_json(), indent=1))
    else:
        _out.print(table_of(found))
        if output:
            _out.print(f"wrote {output}", markup=False)
    if not found.ok:
        raise typer.Exit(1)


def _tolerances(given: list[str]) -> float | dict[str, float] | None:
    """What --tolerance gives: one number, or some by name."""
    if len(given) == 1 and "=" not in given[0]:
        return _number("--tolerance", given[0])
    return {name: _number(name, text) for name, text in _assignments(given, "--tolerance").items()} or None


@app.command("export")
def export_command(
    model: ModelPath,
    target: Annotated[str, typer.Option("--target", "-t", help=", ".join(TARGETS))],
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder: new, empty, or of an earlier export.")],
    floating_base: Floating = False,
    name: Annotated[str | None, typer.Option(help="Of files and functions; made of the model's by default.")] = None,
    frames: Annotated[str | None, typer.Option(help="Frames of kinematics, comma-separated; all by default.")] = None,
    outputs: Annotated[str | None, typer.Option(help="Frames whose positions an FMU gives, comma-separated.")] = None,
    given: Annotated[list[str], typer.Option("--set", help="NAME=NUMBER: a first coordinate or speed (dNAME).")] = [],  # noqa: B006
    method: Annotated[str, typer.Option(help="How it steps by itself.")] = "rk4",
    dt: Annotated[float, typer.Option(help="Step [s].")] = 1e-3,
    as_json: AsJson = False,
) -> None:
    """Write a model for C, Matlab, Octave, Simulink, FMI, or as URDF or MJCF."""
    system = _load(model, floating_base)
    start = {key: _number(key, text) for key, text in _assignments(given, "--set").items()}
    try:
        done = sf.export(
            system, cast(Any, target), output, name=name, frames=_names(frames), outputs=_names(outputs), start=start,
            method=method, dt=dt,
        )  # fmt: skip
    except sf.SymofrosError as error:
        _err.print(str(error), markup=False, highlight=False, soft_wrap=True)
        raise typer.Exit(BAD_INPUT) from None
    if as_json:
        print(json.dumps({"target": done.target, "name": done.name, "files": [str(file) for file in done.files],
                          "notes": list(done.notes)}, indent=1))  # fmt: skip
        return
    for file in done.files:
        _out.print(f"wrote {file}", markup=False, highlight=False, soft_wrap=True)
    for note in done.notes:
        _out.print(f"note: {note}", markup=False, highlight=False, soft_wrap=True)


@app.command()
def edit(
    model: Annotated[Path | None, typer.Argument(help="A model; a new one if not given.")] = None,
    port: Annotated[int, typer.Option(help="Of the local page; any free one by default.")] = 0,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page.")] = True,
    token: Annotated[str | None, typer.Option(help="A fixed one, for tests; drawn at random by default.")] = None,
) -> None:
    """Draw, edit, check, compile and simulate a model in the browser."""
    try:
        from symofros.gui.command import serve
    except ModuleNotFoundError as error:
        if error.name not in ("starlette", "uvicorn", "anyio"):
            raise
        _err.print(f"the editor needs the package '{error.name}'\n  remedy: pip install 'symofros\\[gui]'")
        raise typer.Exit(BAD_INPUT) from None
    try:
        serve(model, port, token, browser, lambda url: _out.print(url, markup=False, highlight=False, soft_wrap=True))
    except (sf.SymofrosError, OSError) as error:
        _err.print(str(error), markup=False, highlight=False, soft_wrap=True)
        raise typer.Exit(BAD_INPUT) from None


add_view(app, _load, BAD_INPUT)


def _names(text: str | None) -> list[str] | None:
    return None if text is None else [name for name in text.split(",") if name]


def _tell(run: sf.Trajectory, files: list[str], as_json: bool) -> None:
    """Outcome, cost and last state of a run."""
    cost, drift = run.statistics, float(run.energy[-1] - run.energy[0])
    last = {name: float(column[-1]) for name, column in run.columns().items()}
    if as_json:
        outcome = {"kind": run.outcome.kind, "t": run.outcome.t, "reason": run.outcome.reason,
                   "advice": run.outcome.advice, "notes": list(run.outcome.notes)}  # fmt: skip
        print(json.dumps({"ok": run.outcome.ok, "outcome": outcome, "statistics": asdict(cost), "last": last,
                          "energy_change": drift, "files": files}, indent=1))  # fmt: skip
        return
    _out.print(str(run.outcome), markup=False, highlight=False, soft_wrap=True)
    table = Table("name", "first", "last", title=f"{len(run)} states, t = {run.t[0]:g} to {run.t[-1]:g} s")
    for name, column in run.columns().items():
        table.add_row(name, f"{column[0]:.6g}", f"{column[-1]:.6g}")
    _out.print(table)
    speed = (run.t[-1] - run.t[0]) / max(cost.seconds, 1e-9)
    _out.print(f"{cost.steps} steps, {cost.rejected} rejected, {cost.evaluations} evaluations; {cost.seconds:.3g} s,"
               f" {speed:.3g} times real time; energy changed by {drift:.3g} J", markup=False)  # fmt: skip
    for file in files:
        _out.print(f"wrote {file}", markup=False)


if __name__ == "__main__":
    app()
