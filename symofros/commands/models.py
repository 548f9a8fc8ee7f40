"""symofros info, symofros compile: what a model or a diagram is, and its C."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table
from rich.tree import Tree

import symofros as sf
from symofros.base.atomic import write_atomically
from symofros.base.functions import DEFAULT_FRAME_FUNCTIONS, DEFAULT_FUNCTIONS
from symofros.commands.details import details, frames_line, tables
from symofros.commands.shared import AsJson, FilePath, Floating, ModelPath, Network, load, out, refuse
from symofros.compiler import Compilation
from symofros.diagrams.files.kind import is_diagram
from symofros.generator.codegen.names import identifier
from symofros.generator.passes.count import Operations, count_program
from symofros.mechanics.topology.tree import BASE, SpanningTree
from symofros.native import native_text


def info(
    model: FilePath,
    floating_base: Floating = False,
    network: Network = False,
    operations: Annotated[
        bool, typer.Option("--operations", help="Also derive every function and count its operations.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Show a model: tree, sizes, masses, limits, parameters; or a diagram: blocks, rates, order."""
    if is_diagram(model):
        from symofros.diagrams.files import command as diagrams  # Diagrams load the library of blocks.

        try:
            diagrams.tell_diagram(sf.load_diagram(model, network=network), as_json, out)
        except sf.SymofrosError as error:
            raise refuse(error) from None
        return
    system = load(model, floating_base)
    compilation = Compilation(system, sf.Options(functions=DEFAULT_FUNCTIONS))
    tree, counts = compilation.tree, dict[str, Operations]()
    if operations:
        compilation.request(DEFAULT_FRAME_FUNCTIONS, [tree.frames[-1].name])
        counts = {" of ".join(filter(None, key)): count for key, count in count_program(compilation.program).items()}
    names = tree.coordinates
    sizes = {"nq": len(names.q), "nv": len(names.v), "nu": len(names.u), "npar": len(names.par)}
    facts = details(tree)
    if as_json:
        stated = {"name": system.name, **sizes, **facts, "notes": list(system.notes)}
        if operations:
            stated["operations"] = {name: vars_of(count) for name, count in counts.items()}
        print(json.dumps(stated, indent=1))
        return
    out.print(_draw(tree))
    out.print(", ".join(f"{key} {value}" for key, value in sizes.items()), markup=False)
    if facts["frames"]:
        out.print(frames_line(facts), markup=False, highlight=False, soft_wrap=True)
    for shown in tables(facts):
        out.print(shown)
    if operations:
        out.print(_operations(counts))
    for note in system.notes:
        out.print(f"note: {note}", markup=False, highlight=False, soft_wrap=True)


def _operations(counts: dict[str, Operations]) -> Table:
    table = Table("function", "mul", "add", "div", "call", "total", title="Operations per call")
    for name, count in counts.items():
        table.add_row(name, *map(str, (count.mul, count.add, count.div, count.call, count.total)))
    return table


def vars_of(count: Operations) -> dict[str, int]:
    """Counts by kind."""
    return {"mul": count.mul, "add": count.add, "div": count.div, "call": count.call}


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


def compile_command(
    model: ModelPath,
    floating_base: Floating = False,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Also write NAME.c and symofros_model.h to this folder.")
    ] = None,
    functions: Annotated[
        str,
        typer.Option(
            help="Functions of one library, comma-separated, as Options(functions=...) has them. By default all of"
            " first order without reverse mode, each in a library of its own, as a model calls them in Python."
        ),
    ] = "",
    frames: Annotated[str, typer.Option(help="Frames of frame functions, comma-separated; all by default.")] = "",
    as_json: AsJson = False,
) -> None:
    """Generate and compile a model; it is then in the cache."""
    system = load(model, floating_base)
    names = tuple(functions.split(",")) if functions else DEFAULT_FUNCTIONS
    compilation = Compilation(system, sf.Options(names, tuple(frames.split(",")) if frames else None))
    start = time.perf_counter()
    try:
        if functions or frames:
            compilation.model()
        else:
            sf.compile(system).prepare(*names)
        done = time.perf_counter()
        text = compilation.source() if output is not None else ""
    except sf.SymofrosError as error:
        raise refuse(error) from None
    result: dict[str, Any] = {"name": system.name, "functions": names, "seconds": done - start}
    if output is not None:
        output.mkdir(parents=True, exist_ok=True)
        name = identifier(system.name)
        write_atomically(output / f"{name}.c", text)
        write_atomically(output / "symofros_model.h", native_text("model/symofros_model.h"))
        counts = count_program(compilation.program)
        result["operations"] = sum(count.total for key, count in counts.items() if key[0] != "init")
        result["bytes"] = len(text)
        result["files"] = [str(output / f"{name}.c"), str(output / "symofros_model.h")]
    if as_json:
        print(json.dumps(result, indent=1))
        return
    out.print(
        f"{system.name}: {len(names)} function{'s' * (len(names) != 1)} generated and compiled, or found in the cache,"
        f" in {result['seconds']:.2f} s",
        markup=False,
    )
    if output is not None:
        out.print(f"{result['operations']} operations, {len(text) / 1024:.0f} KiB of C", markup=False)
    for file in result.get("files", ()):
        out.print(f"wrote {file}", markup=False)
