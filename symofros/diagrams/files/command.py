"""Diagrams at the command line: what `symofros info` and `symofros simulate` do with a diagram's file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from symofros.diagrams.conditional import unconditional
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.files.registry import kind_of
from symofros.diagrams.program.compiled import Resolved
from symofros.diagrams.result import DiagramRun
from symofros.diagrams.run.jitter import Jitter, histogram, jitter_of
from symofros.diagrams.run.simulate import run_compiled
from symofros.diagrams.simulation import Simulation
from symofros.errors import SymofrosError
from symofros.simulation.progress import pace_of
from symofros.simulation.results.plots import check_picture, write_picture
from symofros.simulation.results.saving import check_file, save_or_keep

WINDOW = "window"


@dataclass(frozen=True)
class RunRequest:
    """Settings of a run from the command line; None and "" where it leaves them to the diagram.

    Attributes:
        t_end: End time [s].
        inputs: Inlet -> what is given for it.
        settings: Settings of `run_compiled`.
        speed: Seconds of motion a second; 0: as fast as can be.
        signals: Outputs that are saved and plotted.
        output: File to save to.
        plot: Picture to write, or WINDOW.
        jitter: Picture of how late instants were.
    """

    t_end: float | None
    inputs: Mapping[str, Any]
    settings: dict[str, Any]
    speed: float
    signals: tuple[str, ...]
    output: Path | None
    plot: str
    jitter: Path | None

    @property
    def pictures(self) -> list[Path]:
        """Pictures to write."""
        plot = Path(self.plot) if self.plot not in ("", WINDOW) else None
        return [path for path in (self.jitter, plot) if path]


def run_diagram(diagram: Diagram, request: RunRequest, progress: bool) -> DiagramRun:
    """Run a diagram as the command line asks.

    Raises:
        SymofrosError: The diagram, a setting, a file or a signal's name is wrong; nothing has run then.
        OSError: A file can't be written; nothing has run then.
    """
    simulation = Simulation(diagram)
    t_end = request.t_end if request.t_end is not None else diagram.simulation.t_end
    stated = diagram.simulation.keywords_with(request.settings)
    if request.speed:
        stated["realtime"] = request.speed
    if request.jitter and not stated.get("realtime"):
        raise SymofrosError(
            "--jitter: the run keeps no pace", "no --realtime", "jitter is measured in real time", "add --realtime"
        )
    if request.output:
        check_file(request.output, "run")
    for picture in request.pictures:
        check_picture(picture)
    compiled = simulation.compiled_with(request.inputs)
    for name in request.signals:
        compiled.resolved.wired.check_signal(name)
    return run_compiled(compiled, 1.0 if t_end is None else t_end, progress=progress, **stated)


def write_files(run: DiagramRun, request: RunRequest) -> list[str]:
    """Write the requested files, and return their paths; a window opens last and waits until it is closed."""
    files: list[Path] = []
    if request.output:
        files = save_or_keep(lambda path: run.save(path, *request.signals), request.output)
    if request.jitter:
        write_picture(histogram(run.cost.late, run.compiled.resolved.wired.name), request.jitter)
        files.append(request.jitter)
    if request.plot == WINDOW:
        run.show(*request.signals)
    elif request.plot:
        write_picture(run.plot(*request.signals), Path(request.plot))
        files.append(Path(request.plot))
    return list(map(str, files))


def print_run(run: DiagramRun, files: list[str], as_json: bool, out: Console) -> None:
    """Print outcome, cost, jitter, counts of blocks, crossings and the files that were written."""
    cost, outcome = run.cost, run.outcome
    jitter = jitter_of(cost) if cost.late.size else None
    counts = {
        f"{block}.{name}": float(value)
        for block, kept in run.kept.items()
        if "t" not in kept
        for name, value in kept.items()
    }
    if as_json:
        costs = {key: value for key, value in asdict(cost).items() if key not in ("late", "spacing")}
        print(
            json.dumps(
                {
                    "ok": outcome.ok,
                    "outcome": outcome.as_data(),
                    "statistics": costs,
                    "jitter": asdict(jitter) if jitter else None,
                    "counts": counts,
                    "files": files,
                    "crossings": [list(crossing) for crossing in run.crossings],
                },
                indent=1,
            )
        )
        return
    out.print(str(outcome), markup=False, highlight=False, soft_wrap=True)
    span = float(run.t[-1] - run.t[0])
    out.print(
        f"{len(run.t)} records; {cost.steps} steps, {cost.rejected} rejected, {cost.evaluations} evaluations; "
        f"{cost.seconds:.3g} s, {pace_of(span, cost.seconds)}",
        markup=False,
        soft_wrap=True,
    )
    _print_details(run, jitter, counts, files, out)


def _print_details(
    run: DiagramRun, jitter: Jitter | None, counts: dict[str, float], files: list[str], out: Console
) -> None:
    lines = [str(jitter)] if jitter else []
    lines += [f"{name}: {value:g}" for name, value in counts.items()]
    lines += [f"{crossing.block}: {crossing.crossing} at t = {crossing.t:.6g} s" for crossing in run.crossings[:20]]
    lines += [f"wrote {file}" for file in files]
    for line in lines:
        out.print(line, markup=False, highlight=False, soft_wrap=True)


def print_diagram(diagram: Diagram, as_json: bool, out: Console) -> None:
    """Print the blocks with their ports, rates and states, their order of evaluation, models and parameters.

    Raises:
        DescriptionError: With what is wrong with the diagram.
    """
    data = as_data(Simulation(diagram).resolved)
    if as_json:
        print(json.dumps(data, indent=1))
        return
    table = Table("block", "kind", "samples", "inputs", "outputs", "states", title=data["name"])
    for name, block in data["blocks"].items():
        inputs = [f"{port} <- {source}" for port, source in block["inputs"].items()]
        outputs = [f"{port} {tuple(of['shape'])} {of['unit']}".strip() for port, of in block["outputs"].items()]
        rows = ("\n".join(inputs), "\n".join(outputs), ", ".join(block["states"]))
        table.add_row(name, block["kind"], _samples(block), *rows)
    out.print(table)
    order = " -> ".join(dict.fromkeys(name.rpartition(".")[0] for name in data["order"]))
    lines = [
        f"model {name}: nq {of['nq']}, nv {of['nv']}, nc {of['nc']}, {of['npar']} parameters"
        for name, of in data["models"].items()
    ]
    lines += [f"order: {order}", f"{len(data['parts'])} parts move apart: {'; '.join(map(', '.join, data['parts']))}"]
    lines += [f"parameter {name} = {value}" for name, value in data["parameters"].items()]
    for line in lines:
        out.print(line, markup=False, highlight=False, soft_wrap=True)


def _samples(block: dict[str, Any]) -> str:
    if block["period"] is None:
        return "continuous"
    return f"every {block['period']:g} s" + (f" from {block['offset']:g} s" if block["offset"] else "")


def as_data(resolved: Resolved) -> dict[str, Any]:
    """A diagram that holds together, as plain data."""
    wired, layout = resolved.wired, resolved.layout
    blocks: dict[str, Any] = {}
    for name, block in wired.blocks.items():
        piece, ports = resolved.pieces[name], wired.ports[name]
        blocks[name] = {
            "kind": kind_of(type(unconditional(block))),
            "period": block.period,
            "offset": block.offset,
            "inputs": {
                port.name: ".".join(wired.sources[name, port.name])
                if (name, port.name) in wired.sources
                else f"{np.asarray(port.default).tolist()}"
                for port in ports.inputs
            },
            "outputs": {port.name: {"shape": list(port.shape or ()), "unit": port.unit} for port in ports.outputs},
            "states": [f"q ({len(piece.q)}), v ({len(piece.v)})"] * bool(block.mechanism())
            + [f"{key} {values.shape}" for key, values in piece.states.items()]
            + [f"{key} {values.shape} at samples" for key, values in piece.memory.items()],
        }
    records = {name: wired.models.record(name) for name in wired.models.names}
    models = {
        name: {"nq": len(r.q_names), "nv": len(r.v_names), "nc": r.nc, "npar": len(r.par_names)}
        for name, r in records.items()
    }
    return {
        "name": wired.name,
        "blocks": blocks,
        "models": models,
        "order": [".".join(one) for one in resolved.order],
        "parts": [list(part.blocks) for part in layout.parts],
        "outlets": {k: ".".join(v) for k, v in wired.outlets.items()},
        "parameters": {
            name: value for name, value in zip(layout.par_names[: layout.settable], layout.par, strict=False)
        },
    }
