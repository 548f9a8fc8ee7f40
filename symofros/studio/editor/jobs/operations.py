"""The operations of worker processes: compile, cross-check, simulate here or in the page, export, import."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import symofros as sf
from symofros.base.functions import exported
from symofros.base.names import quoted, speed_column, symbol_of
from symofros.base.routes import Choice
from symofros.compiler import Compilation, compile_system
from symofros.description.yaml import write_yaml
from symofros.errors import SymofrosError
from symofros.exports.folder import check_same
from symofros.harness import command_line
from symofros.mechanics.topology import SpanningTree, build_tree
from symofros.simulation.simulate import prepare_run
from symofros.studio.editor.jobs.bent_beams import bent_beams
from symofros.studio.editor.jobs.request import Json, Tell, diagram_of, number_of, numbers_for_json, system_of, table
from symofros.studio.editor.jobs.starts import laws_of, stated_start, whole_of
from symofros.studio.editor.jobs.stops import events_of
from symofros.studio.viewer.playing.signals import coordinate_units

POINTS, MAX_POINTS = 1000, 5000
PERIOD = 1.0  # Of the progress that is shown of a long run [s].


def compile_model(request: Json, tell: Tell) -> Json:
    """Derive, generate and compile a model, and count each; a simulation of it then finds all functions compiled."""
    tell(0, 4, "reading")
    system = system_of(request)
    start = time.perf_counter()
    compilation = Compilation(system)
    compilation.request(exported(bool(system.constraints), ("dynamics", "constraints")))
    tell(1, 4, "deriving the equations")
    counted = compilation.operations
    tell(2, 4, "writing C")
    text = compilation.source()
    generated = time.perf_counter()
    tell(3, 4, "compiling C")
    model = compilation.model()
    prepare_run(model)
    _prepare_start(model)
    _prepare_energies(model)
    done = time.perf_counter()
    counts = {
        key[0]: {"mul": n.mul, "add": n.add, "div": n.div, "call": n.call, "total": n.total}
        for key, n in counted.items()
        if key[0] != "init"
    }
    names = model.names
    return {
        "name": system.name,
        "operations": counts,
        "bytes": len(text),
        "generate_s": generated - start,
        "compile_s": done - generated,
        "nq": model.nq,
        "nv": model.nv,
        "nu": model.nu,
        "npar": model.npar,
        "nc": model.nc,
        "q_names": list(names.q),
        "v_names": list(names.v),
        "u_names": list(names.u),
        "par_names": list(names.par),
        "frames": list(names.frames),
        "methods": _methods(model),
        "notes": list(system.notes),
    }


def _methods(model: sf.Model) -> Json:
    """Methods that were chosen where several apply, with what decided."""
    rows = [
        [name, choice.quantity, choice.method, choice.reason, choice.counted, _otherwise(choice)]
        for name, choices in model.routes.items()
        for choice in choices
        if choice.others
    ]
    return table("Methods, where several apply", ["Function", "Of", "Method", "Because", "Figures", "Otherwise"], rows)


def _otherwise(choice: Choice) -> str:
    return ", ".join(f"{route.method} by {route.option}" for route in choice.others if route.option)


def _prepare_start(model: sf.Model) -> None:
    """Compile the constraint functions that close loops at the start of a simulation."""
    if model.nc:
        model.prepare("constraint", "constraint_rate", "constraint_jacobian")


def _prepare_energies(model: sf.Model) -> None:
    """Compile the energies of a simulation's records by evaluating them for as many states at once."""
    q, v = np.tile(model.neutral(), (POINTS + 1, 1)), np.zeros((POINTS + 1, model.nv))
    model.kinetic_energy(q, v), model.potential_energy(q)


def cross_check(request: Json, tell: Tell) -> Json:
    """Compare the compiled model with every engine that can represent it: the command of the harness does it."""
    tell(0, 3, "reading")
    system = system_of(request)
    options = request.get("options", {})
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.yaml"
        file.write_text(write_yaml(system), encoding="utf-8")
        arguments = ["check", str(file), "--json", "--report", folder, "--workers", "1"]
        arguments += ["--states", str(whole_of(options.get("states"), 1, 10_000, 20))]
        tell(1, 3, "engines at work")
        command = command_line(arguments)
        run = subprocess.run(command, capture_output=True, text=True, cwd=folder, env=os.environ, check=False)
    tell(2, 3, "reading the verdict")
    try:
        verdict = json.loads(run.stdout.strip().splitlines()[-1])
    except (ValueError, IndexError):
        raise SymofrosError(
            "cross-check: the harness gave no verdict",
            run.stderr.strip()[-1000:],
            "it prints its comparisons as JSON",
            "run `symofros check` on the saved file",
        ) from None
    rows = [
        {
            "quantity": row["quantity"],
            "engine": row["engine"],
            "worst": row["error"],
            "tolerance": row["tolerance"],
            "states": row["states"],
            "passed": row["ok"],
            "note": row.get("note", ""),
        }
        for row in verdict["comparisons"]
    ]
    return {"ok": verdict["ok"], "rows": rows, "unsupported": _unsupported(verdict["unsupported"])}


def _unsupported(rows: list[Json]) -> list[Json]:
    kept = ("engine", "quantity", "reason")
    return [{key: row[key] for key in kept} for row in rows]


def simulate(request: Json, tell: Tell) -> Json:
    """Move the model; coordinates, speeds, inputs and energies over time."""
    tell(0, 100, "reading")
    system = system_of(request)
    options = request.get("options", {})
    t_end = number_of(options.get("t_end", 1.0), "t_end")
    tell(0, 100, "compiling")
    model = compile_system(system, sf.Options(background=True))  # A first run does not wait for a compiler.
    if model.nc:
        tell(0, 100, "closing the loops")
    start = stated_start(model, options)
    points = whole_of(options.get("points"), 2, MAX_POINTS, POINTS)
    chosen: Json = {key: options[key] for key in ("method", "stabilisation") if options.get(key)}
    chosen |= {key: number_of(options[key], key) for key in ("dt", "rtol", "atol") if options.get(key) is not None}
    inputs = laws_of(options.get("inputs"))
    began = time.perf_counter()
    shown, reported = -1, began

    def progress(t: float) -> None:
        nonlocal shown, reported
        percent, now = int(100 * t / t_end) if t_end else 100, time.perf_counter()
        if percent > shown or now - reported > PERIOD:
            shown, reported = percent, now
            tell(percent, 100, f"t = {t:.3g} s of {t_end:.6g} s")

    run = sf.simulate(
        model,
        start.q,
        start.v,
        t_end,
        u=inputs or None,
        par=start.par,
        events=events_of(model, options) or None,
        output=t_end / points if t_end else None,
        progress=progress,
        **chosen,
    )
    run = replace(run, outcome=replace(run.outcome, notes=(*start.notes, *run.outcome.notes)))
    return {**_motion(run, build_tree(system)), "par": run.par.tolist(), "wall_s": time.perf_counter() - began}


def _motion(run: sf.Trajectory, tree: SpanningTree) -> Json:
    units = coordinate_units(tree)
    names, series = run.model.names, []
    for kind, group, values in (("q", names.q, run.q), ("v", names.v, run.v), ("u", names.u, run.u)):
        for i, name in enumerate(group):
            own = units.get(name, "")
            unit = own if kind == "q" else (f"{own}/s" if own else "") if kind == "v" else ""
            # As in files of trajectories.
            inputs = f"u.{name}" if name in names.q else name
            label = {"q": symbol_of(name), "v": speed_column(name, names.q), "u": inputs}[kind]
            series.append({"name": label, "kind": kind, "unit": unit, "values": numbers_for_json(values[:, i])})
    cost, end = run.statistics, run.outcome
    return {
        "t": numbers_for_json(run.t),
        "series": series,
        "z": [numbers_for_json(row) for row in run.z] if run.model.nz else [],
        "changes": [[first, numbers_for_json(par)] for first, par in run.changes],
        "method": cost.method,
        "steps": cost.steps,
        "rejected": cost.rejected,
        "evaluations": cost.evaluations,
        "loop_s": cost.seconds,
        "energy": {
            "kinetic": numbers_for_json(run.kinetic_energy),
            "potential": numbers_for_json(run.potential_energy),
            "total": numbers_for_json(run.energy),
        },
        "beams": bent_beams(run.bendings),
        "events": table("Events", ["Event", "t [s]"], [[event.name, event.t] for event in run.events]),
        "outcome": {"ok": end.ok, **end.as_data()},
    }


def export(request: Json, tell: Tell) -> Json:
    """Write the model for another environment; a diagram as a C program that steps as its file says."""
    tell(0, 2, "reading")
    options, target, folder = request["options"], request["options"]["target"], request["folder"]
    stated = diagram_of(request) if request["is_diagram"] else system_of(request)
    name = options.get("name") or None
    check_same(Path(folder), target, name if name and not request["is_diagram"] else stated.name)
    tell(1, 2, f"writing {target}")
    done = sf.export(stated, target, folder, name=name)
    root = Path(request["root"])
    files = [os.path.relpath(file.resolve(), root) for file in done.files]
    return {"files": files, "notes": list(done.notes), "target": done.target}


def page(request: Json, tell: Tell) -> Json:
    """A page that simulates the model by itself, from a start, by WebAssembly."""
    tell(0, 2, "reading")
    system, options = system_of(request), request.get("options", {})
    start = {str(name): number_of(x, str(name)) for name, x in (options.get("q0") or {}).items()}
    start |= {f"d{quoted(str(name))}": number_of(x, str(name)) for name, x in (options.get("v0") or {}).items()}
    stepping: Json = {"method": options["method"]} if options.get("method") else {}
    stepping |= {key: number_of(options[key], key) for key in ("dt", "rtol") if options.get(key) is not None}
    tell(1, 2, "compiling for WebAssembly; the first time takes a minute or two")
    with tempfile.TemporaryDirectory() as folder:
        done = sf.export(system, "wasm", folder, start=start, **stepping)
        return {"page": (Path(folder) / "index.html").read_text(encoding="utf-8"), "notes": list(done.notes)}


def import_model(request: Json, tell: Tell) -> Json:
    """A description of another format as the text of a native one."""
    tell(0, 1, "reading")
    system = sf.load(request["file"])
    name = Path(request["file"]).name
    drawn = [f"visual shapes and meshes of {name} are left out: `symofros view {name}` draws them"]
    return {"text": write_yaml(system), "notes": [*system.notes, *(drawn if system.visuals else [])]}


TASKS: dict[str, Callable[[Json, Tell], Any]] = {
    "compile": compile_model,
    "crosscheck": cross_check,
    "simulate": simulate,
    "page": page,
    "export": export,
    "import": import_model,
}
