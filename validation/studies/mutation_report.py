"""`python -m validation mutation`: the score of the mutation test, as table and report."""

from __future__ import annotations

import json
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import track
from rich.table import Table

import reference_models
from symofros.atomic import write_atomically
from validation.inputs.cases import standard_set
from validation.reporting.page import versions
from validation.reporting.provenance import stamp
from validation.studies.mutation import MutationScore, mutate

# Models that an independent engine can represent whole, small and large, fixed and floating.
MODELS = (
    "pendulum",
    "double_pendulum",
    "cart_pole",
    "open_chain_5r",
    "space_arm",
    "rx90",
    "chain7",
    "mss",
    "ur5",
    "panda",
    "solo12",
    "bolt",
)
PER_MODEL = 700
_FATES = ("planted", "caught", "silent", "too_small")


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command("mutation")(mutation)


def mutation(
    faults: Annotated[int, typer.Option(min=1, help="Faults a model, at most.")] = PER_MODEL,
    seed: Annotated[int, typer.Option(min=0, help="Of the choice of faults and of the states.")] = 0,
    report: Annotated[Path, typer.Option(help="Folder for mutation.md and mutation.json.")] = Path("reports"),
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON, nothing else.")] = False,
) -> None:
    """Plant single faults in generated programs; the cross-check must catch every one that matters."""
    start = time.perf_counter()
    scores = score_all(faults, seed)
    data = as_data(scores, faults, seed, time.perf_counter() - start)
    report.mkdir(parents=True, exist_ok=True)
    write_atomically(report / "mutation.json", json.dumps(data, indent=1) + "\n")
    write_atomically(report / "mutation.md", as_markdown(data))
    if as_json:
        typer.echo(json.dumps(data))
    else:
        _show(data)
        typer.echo(f"Report: {report / 'mutation.md'}")
    raise typer.Exit(0 if data["ok"] else 1)


def score_all(faults: int, seed: int, models: Sequence[str] = MODELS) -> list[MutationScore]:
    """The score of each model."""
    cases = {case.label: case for case in standard_set()}
    scores = []
    console = Console(stderr=True)
    for name in track(models, "planting faults", console=console, transient=True, disable=not console.is_terminal):
        system = cases[name].load().system if name in cases else reference_models.MODELS[name]
        scores.append(mutate(name, system, faults, seed))
    return scores


def as_data(scores: Sequence[MutationScore], faults: int, seed: int, seconds: float) -> dict[str, Any]:
    """The result as plain data."""
    rows = [
        {
            "model": score.model,
            "engine": score.engine,
            "planted": sum(score.planted.values()),
            "caught": sum(score.caught.values()),
            "silent": sum(score.silent.values()),
            "too_small": sum(score.too_small.values()),
            "largest_too_small": score.largest_small,
            "survived": [{"kind": f.kind, "node": f.node, "error": error} for f, error in score.survivors],
        }
        for score in scores
    ]
    kinds: dict[str, dict[str, int]] = {}
    for name in _FATES:
        total: Counter[str] = sum((getattr(score, name) for score in scores), Counter())
        for kind, number in total.items():
            kinds.setdefault(kind, dict.fromkeys(_FATES, 0))[name] = number
    return {
        "ok": all(score.ok for score in scores),
        "faults_per_model": faults,
        "seed": seed,
        "seconds": round(seconds, 1),
        "planted": sum(row["planted"] for row in rows),
        "models": rows,
        "kinds": dict(sorted(kinds.items())),
        "versions": versions("pin"),
        **stamp(),
    }


def as_markdown(data: dict[str, Any]) -> str:
    """The report."""
    survived = sum(len(row["survived"]) for row in data["models"])
    silent = sum(row["silent"] for row in data["models"])
    small = sum(row["too_small"] for row in data["models"])
    largest = max((row["largest_too_small"] for row in data["models"]), default=0.0)
    matter = data["planted"] - silent - small
    share = 100.0 * (matter - survived) / max(1, matter)
    lines = [
        "# Mutation test of the cross-check",
        "",
        f"**{data['planted']} single faults planted in {len(data['models'])} models; of the {matter} that matter "
        f"{share:.6g} % were caught.** {silent} are silent: the program with the fault computes the same outputs to 40 "
        f"digits, so there is nothing to catch. {small} are too small: they change no output by more than "
        f"its tolerance (largest change {largest:.1e}, which only forward dynamics tolerates). {survived} survived.",
        "",
        "A fault replaces one operation of the generated program. It is caught if any output then differs from the "
        "independent engine's by more than the cross-check's own tolerance over 60 random states.",
        "",
        "| model | reference | planted | caught | silent | too small | survived |",
        "|---|---|---:|---:|---:|---:|---:|",
        *(
            f"| {r['model']} | {r['engine']} | {r['planted']} | {r['caught']} | {r['silent']} | {r['too_small']} | "
            f"{len(r['survived'])} |"
            for r in data["models"]
        ),
        "",
        "| kind of fault | planted | caught | silent | too small |",
        "|---|---:|---:|---:|---:|",
        *(f"| {kind} | {' | '.join(str(n[fate]) for fate in _FATES)} |" for kind, n in data["kinds"].items()),
        "",
        f"Seed {data['seed']}; {data['seconds']} s. Written by `python -m validation mutation`.",
        "",
    ]
    return "\n".join(lines)


def _show(data: dict[str, Any]) -> None:
    table = Table("model", "reference", "planted", "caught", "silent", "too small", "survived", title="Mutation test")
    for row in data["models"]:
        numbers = (row["planted"], row["caught"], row["silent"], row["too_small"], len(row["survived"]))
        table.add_row(row["model"], row["engine"], *map(str, numbers))
    Console().print(table)
    for row in data["models"]:
        for fault in row["survived"]:
            Console().print(f"survived: {row['model']}: {fault['kind']} at node {fault['node']}: {fault['error']:.1e}")
