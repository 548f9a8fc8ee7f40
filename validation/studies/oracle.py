"""Comparison with SymPy's derivations, digit by digit: the command and its report."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer

from ..reporting.command import Run, known
from ..reporting.numbers import counted
from ..reporting.record import Data, Fact, Report, Section, Table, Topic, verdict


def measure(
    run: Run,
    chosen: Annotated[list[str] | None, typer.Option("--model", help="Only this model; repeatable.")] = None,
    points: Annotated[int, typer.Option(min=1, help="Rational points a model.")] = 2,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the points.")] = 0,
) -> Data:
    """Compare with SymPy's derivations by Kane's method, in extended precision.

    With --model, the report is that of these models alone, in the subfolder oracle.
    """
    from ..oracle.compare import check  # SymPy's mechanics take a second, from this command alone.
    from ..oracle.models import MODELS  # As above.

    models = known(chosen, MODELS, "--model", "model")
    if chosen:
        run.folder = run.folder / "oracle"
    run.expect(len(models), "deriving")
    results = []
    for name in models:
        results.append(check(name, points, seed))
        run.advance()
    ok = all(result.ok for result in results)
    return {"ok": ok, "points": points, "seed": seed, "comparisons": [asdict(result) for result in results]}


_TEXT = """Decimal digits that agree at the worst of the points, relative to the largest entry: our generated equations
and those that SymPy derives by Kane's method, at {points} rational points a model (seed {seed}), both in
extended precision."""


def compose(data: Data) -> Report:
    """The report of its JSON."""
    rows, ok = data["comparisons"], bool(data["ok"])
    least = min((digits for row in rows for digits in row["digits"].values()), default=0.0)
    required = min((row["required"] for row in rows), default=0.0)
    failed = [row for row in rows if min(row["digits"].values()) < row["required"]]
    names = ", ".join(f"{row['model']} ({row['derivation']})" for row in failed)
    functions = list(dict.fromkeys(function for row in rows for function in row["digits"]))
    lines = []
    for row in rows:
        digits = (verdict(f"{row['digits'][name]:.0f}", row["digits"][name] >= row["required"]) for name in functions)
        lines.append((row["model"], row["derivation"], *digits, f"{row['required']:.0f}"))
    head = " | ".join(["model | derivation", *(name.replace("_", " ") for name in functions), "required"])
    return Report(
        "Generated equations against SymPy's",
        f"{counted(len(rows), 'derivation')} by SymPy of {counted(len({row['model'] for row in rows}), 'model')}: "
        f"{'all agree' if ok else f'not all agree: {names}'}.",
        ok,
        (),
        (Section("Digits that agree", (_TEXT.format_map(data), Table.of(head, lines))),),
        facts=(Fact(f"{least:.0f}", f"digits agree at the least; {required:.0f} and more are asked for", ok),),
    )


TOPIC = Topic("oracle", "Correctness", "Do SymPy's derivations give the same digits?", compose, measure)
