"""symofros info: what a model or a diagram is; its tree, masses, coordinates with limits, parameters, frames."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.table import Table
from rich.tree import Tree

import symofros as sf
from symofros.base.functions import DEFAULT_FRAME_FUNCTIONS, DEFAULT_FUNCTIONS, FUNCTIONS
from symofros.base.routes import ROUTES, Choice
from symofros.commands.reading import ReadingOptions, reads_models
from symofros.commands.shared import NOT_FOR_DIAGRAMS, AsJson, FilePath, Network, load, refuse
from symofros.commands.terminal import out
from symofros.description import Beam, event_text
from symofros.diagrams.files.kind import is_diagram
from symofros.mechanics.topology import BASE, Numbers, SpanningTree, beam_mass, build_tree

if TYPE_CHECKING:
    from symofros.generator import Operations

# Frames of a model that are named; the rest are counted.
_FRAMES = 20
# Limits of a coordinate: of where it is, and sizes, of its speed and effort.
_BOUNDS, _SIZES = ("lower", "upper"), ("velocity", "effort")


def details(tree: SpanningTree) -> dict[str, Any]:
    """The same as plain data, for JSON: numbers at the parameters' defaults; None where there is none."""
    system, numbers = tree.system, Numbers(tree.system)
    bodies = []
    for body in system.bodies:
        stated: dict[str, Any] = {
            "name": body.name,
            "kind": "beam" if isinstance(body, Beam) else "rigid",
            "mass": None,
        }
        inertia = body.inertia
        if isinstance(body, Beam):
            stated["mass"] = _finite(beam_mass(body, numbers))
        elif inertia is not None:
            stated["mass"] = _finite(numbers.value(inertia.mass))
            stated["center_of_mass"] = [_finite(x) for x in numbers.values(inertia.center_of_mass)]
        bodies.append(stated)
    limits = {body.joint.name: body.joint.limits for body in system.bodies if body.joint is not None}
    coordinates = []
    for name in tree.coordinates.q:
        bound = limits.get(name)
        # Zero is no limit of speed or effort, as in files that leave it open.
        sizes = {label: getattr(bound, label, None) or None for label in _SIZES}
        coordinates.append({"name": name, **{label: getattr(bound, label, None) for label in _BOUNDS}, **sizes})
    parameters = [
        {"name": item.name, "value": item.value, "unit": item.unit, "constant": item.constant}
        for item in system.parameters
    ]
    frames = [frame.name for frame in tree.frames]
    events = [{"name": name, "states": event_text(event)} for name, event in system.events.items()]
    return {"bodies": bodies, "coordinates": coordinates, "parameters": parameters, "events": events, "frames": frames}


def tables(facts: dict[str, Any]) -> list[Table]:
    """Tables for a terminal, without those that would be empty."""
    masses = Table("body", "mass [kg]", "center of mass [m]", title="Bodies")
    for body in facts["bodies"]:
        if body["mass"] is not None:
            center = ", ".join(map(_number, body.get("center_of_mass", ())))
            masses.add_row(body["name"], _number(body["mass"]), center or "(beam)")
    stated = [label for label in (*_BOUNDS, *_SIZES) if any(item[label] is not None for item in facts["coordinates"])]
    bounds = Table("coordinate", *stated, title="Limits [rad, m; N m, N]" if "effort" in stated else "Limits [rad, m]")
    for item in facts["coordinates"]:
        if any(item[label] is not None for label in stated):
            bounds.add_row(item["name"], *(_number(item[label]) for label in stated))
    parameters = Table("parameter", "value", "unit", "", title="Parameters")
    for item in facts["parameters"]:
        parameters.add_row(item["name"], _number(item["value"]), item["unit"], "constant" if item["constant"] else "")
    events = Table("event", "zero of ...; what happens", title="Events")
    for item in facts["events"]:
        events.add_row(item["name"], item["states"])
    return [table for table in (masses, bounds, parameters, events) if table.row_count]


def frames_line(facts: dict[str, Any]) -> str:
    """The first frames by name, and how many there are."""
    names = facts["frames"]
    rest = f", … ({len(names)} in all; --json lists them)" if len(names) > _FRAMES else ""
    return f"frames: {', '.join(names[:_FRAMES])}{rest}"


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _number(value: float | None) -> str:
    return "" if value is None else f"{value + 0.0:.6g}"


@reads_models
def info(
    model: FilePath,
    *,
    reading: ReadingOptions,
    network: Network = False,
    operations: Annotated[
        bool, typer.Option("--operations", help="Also derive every function and count its operations.")
    ] = False,
    routes: Annotated[
        bool, typer.Option("--routes", help="Also derive every function and tell by which methods, and why.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Show a model: tree, sizes, masses, limits, parameters; or a diagram: blocks, rates, order."""
    if is_diagram(model):
        reading.require_none(NOT_FOR_DIAGRAMS)
        _show_diagram(model, network, as_json)
        return
    system = load(model, reading)
    tree = build_tree(system)
    counts = _counts(system, tree.frames[-1].name) if operations else {}
    choices = _choices(system) if routes else {}
    names = tree.coordinates
    sizes = {"nq": len(names.q), "nv": len(names.v), "nu": len(names.u), "npar": len(names.par)}
    facts = details(tree)
    if as_json:
        stated = {"name": system.name, **sizes, **facts, "notes": list(system.notes)}
        if operations:
            stated["operations"] = {name: _by_kind(count) for name, count in counts.items()}
        if routes:
            stated["routes"] = {name: [choice.as_dict() for choice in of] for name, of in choices.items()}
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
    if routes:
        out.print(_routes(choices))
    for note in system.notes:
        out.print(f"note: {note}", markup=False, highlight=False, soft_wrap=True)


def _show_diagram(path: FilePath, network: bool, as_json: bool) -> None:
    from symofros.diagrams.files import command as diagrams  # Diagrams load the library of blocks.

    try:
        diagrams.print_diagram(sf.load_diagram(path, network=network), as_json, out)
    except sf.SymofrosError as error:
        raise refuse(error) from None


def _counts(system: sf.System, frame: str) -> dict[str, Operations]:
    """Operations of every function, keyed by its name, and the frame of frame functions."""
    from symofros.compiler import Compilation  # The generator takes as long to import as all that is shown without it.

    compilation = Compilation(system, sf.Options(functions=DEFAULT_FUNCTIONS))
    compilation.request(DEFAULT_FRAME_FUNCTIONS, [frame])
    return {" of ".join(filter(None, key)): count for key, count in compilation.operations.items()}


def _choices(system: sf.System) -> dict[str, tuple[Choice, ...]]:
    """Methods of every function, as a model has them that makes each when it is first called."""
    of_trees = (name for name in DEFAULT_FUNCTIONS if system.constraints or not FUNCTIONS[name].constrained_only)
    methods = sf.compile(system).routes
    return {name: methods[name] for name in of_trees}


def _routes(choices: dict[str, tuple[Choice, ...]]) -> Table:
    """The choices among several methods, and which functions they are for."""
    functions: dict[tuple[str, str, str], dict[str, list[str]]] = {}
    for name, of in choices.items():
        for choice in of:
            if choice.others:
                others = [f"{route.method}:\n{route.option}" for route in choice.others if route.option]
                key = choice.quantity, choice.method, "\n".join([choice.reason, *(f"else {other}" for other in others)])
                functions.setdefault(key, {}).setdefault(choice.counted, []).append(name)
    table = Table(title="Methods where there are several (--json tells all)")
    table.add_column("method", width=39, overflow="fold")  # Options stand in one line.
    table.add_column("functions: figures", overflow="fold")
    for key in sorted(functions, key=lambda key: [*ROUTES].index(key[0])):
        quantity, method, reason = key
        lines = (", ".join(names) + (f": {counted}" if counted else "") for counted, names in functions[key].items())
        table.add_row(f"{quantity}: {method}\n{reason}", "\n".join(lines), end_section=True)
    return table


def _operations(counts: dict[str, Operations]) -> Table:
    table = Table("function", "mul", "add", "div", "call", "total", title="Operations per call")
    for name, count in counts.items():
        table.add_row(name, *map(str, (count.mul, count.add, count.div, count.call, count.total)))
    return table


def _by_kind(count: Operations) -> dict[str, int]:
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
