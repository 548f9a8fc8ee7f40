"""`python -m validation fuzz`: what became of a hundred thousand hostile inputs, as table and report."""

from __future__ import annotations

import json
import platform
import resource
import sys
import time
from dataclasses import asdict
from importlib import metadata
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import Progress

import symofros as sf
from symofros.atomic import write_atomically
from validation.reporting.provenance import stamp
from validation.studies.fuzz import COMPILED, SLOWEST, FuzzResult, fuzz

INPUTS = 120_000

_READERS = ("numpy", "pydantic", "ruamel.yaml")
_FAULTS_SHOWN = 20


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command("fuzz")(command)


def command(
    count: Annotated[int, typer.Option(min=1, help="Inputs, all kinds together.")] = INPUTS,
    seed: Annotated[int, typer.Option(min=0, help="Of the mutations.")] = 0,
    report: Annotated[Path, typer.Option(help="Folder for fuzz.md and fuzz.json.")] = Path("reports"),
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON, nothing else.")] = False,
) -> None:
    """Feed mutated, hostile files and formulas to the readers: none may crash or hang them."""
    start = time.perf_counter()
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("feeding", total=count)
        result = fuzz(count, seed, lambda done: bar.update(task, completed=done))
    data = as_data(result, seed, time.perf_counter() - start)
    report.mkdir(parents=True, exist_ok=True)
    write_atomically(report / "fuzz.json", json.dumps(data, indent=1) + "\n")
    write_atomically(report / "fuzz.md", as_markdown(data))
    if as_json:
        typer.echo(json.dumps(data))
    else:
        typer.echo(as_markdown(data))
        typer.echo(f"Report: {report / 'fuzz.md'}")
    raise typer.Exit(0 if data["ok"] else 1)


def as_data(result: FuzzResult, seed: int, seconds: float) -> dict[str, Any]:
    """The result as plain data."""
    kinds = {kind: {"inputs": 0, **asdict(answers)} for kind, answers in result.answers.items()}
    for kind, row in kinds.items():
        row["faults"] = sum(fault.kind == kind for fault in result.faults)
        row["inputs"] = row["read"] + row["refused"] + row["faults"]
        row["slowest"] = round(row["slowest"], 4)
    faults = [
        {"kind": f.kind, "number": f.number, "what": f.what, "input": f.data.decode("latin-1")} for f in result.faults
    ]
    # Linux counts kilobytes, macOS bytes.
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1 << (20 if sys.platform == "darwin" else 10))
    return {
        "ok": not faults,
        "inputs": sum(row["inputs"] for row in kinds.values()),
        "seed": seed,
        "seconds": round(seconds, 1),
        "peak_memory_mib": round(peak),
        "kinds": kinds,
        "faults": faults,
        "versions": {
            "symofros": sf.__version__,
            "python": platform.python_version(),
            **{name: metadata.version(name) for name in _READERS},
        },
        **stamp(),
    }


def as_markdown(data: dict[str, Any]) -> str:
    """The report."""
    faults = data["faults"]
    read, refused = (sum(row[answer] for row in data["kinds"].values()) for answer in ("read", "refused"))
    versions = ", ".join(f"{name} {version}" for name, version in data["versions"].items())
    lines = [
        "# Fuzz test of the readers",
        "",
        f"**{data['inputs']} hostile inputs: {refused} refused with a description of their faults, {read} read, "
        f"{len(faults)} crashed or hung a reader.**",
        "",
        "An input is one of the package's own descriptions with one to four random changes: of bytes, words, numbers, "
        "pieces, lines, or a hostile snippet (code, bombs, document types, endless numbers) put in. A fault is any "
        f"exception but the refusal, a warning, an input that takes longer than {SLOWEST:g} s, or an accepted input "
        "that is another one after it was written and read again. Of the accepted files, one in "
        f"{COMPILED} is also compiled, to the interpreter, and its mass matrix evaluated.",
        "",
        "| kind | inputs | refused | read | compiled | faults | slowest [ms] |",
        "|---|---:|---:|---:|---:|---:|---:|",
        *(
            f"| {kind} | {row['inputs']} | {row['refused']} | {row['read']} | {row['compiled']} | {row['faults']} | "
            f"{1e3 * row['slowest']:.0f} (no. {row['slowest_input']}) |"
            for kind, row in data["kinds"].items()
        ),
        "",
        *(f"- {fault['kind']} no. {fault['number']}: `{fault['what']}`" for fault in faults[:_FAULTS_SHOWN]),
        *([""] if faults else []),
        f"Seed {data['seed']}; {data['seconds']} s; peak memory of the process {data['peak_memory_mib']} MiB; "
        f"{versions}; {data['machine']['processor']}. Written by `python -m validation fuzz`.",
        "",
    ]
    return "\n".join(lines)
