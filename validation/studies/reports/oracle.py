"""Generated equations against SymPy's, digit by digit."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer

from validation.reporting.command import Run, known
from validation.reporting.numbers import counted
from validation.reporting.record import Cell, Column, Data, Fact, Report, Section, Table, Topic


def measure(
    run: Run,
    chosen: Annotated[list[str] | None, typer.Option("--model", help="Only this model; repeatable.")] = None,
    points: Annotated[int, typer.Option(min=1, help="Rational points a model.")] = 2,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the points.")] = 0,
) -> Data:
    """Compare with SymPy's derivations by Lagrange and by Kane, in extended precision.

    With --model, the report is that of these models alone, in the subfolder oracle.
    """
    # SymPy's mechanics cost a second to import; only this command pays.
    from validation.oracle.compare import check
    from validation.oracle.models import MODELS

    models = known(chosen, MODELS, "--model", "model")
    if chosen:
        run.folder = run.folder / "oracle"
    wanted = [(name, by) for name in models for by in MODELS[name].derivations]
    run.expect(len(wanted), "deriving")
    results = []
    for name, by in wanted:
        results.append(check(name, by, points, seed))
        run.advance()
    ok = all(result.ok for result in results)
    return {"ok": ok, "points": points, "seed": seed, "comparisons": [asdict(result) for result in results]}


def compose(data: Data) -> Report:
    """The report of its JSON."""
    rows, ok = data["comparisons"], bool(data["ok"])
    least = min((digits for row in rows for digits in row["digits"].values()), default=0.0)
    required = min((row["required"] for row in rows), default=0.0)
    functions = dict.fromkeys(function for row in rows for function in row["digits"])
    failed = [row for row in rows if min(row["digits"].values()) < row["required"]]
    names = ", ".join(f"{row['model']} ({row['derivation']})" for row in failed)
    verdict = "all agree" if ok else f"not all agree{': ' if names else ''}{names}"
    derived = f"{counted(len(rows), 'derivation')} by SymPy of {counted(len({row['model'] for row in rows}), 'model')}"
    text = (
        "Decimal digits that agree at the worst of the points, relative to the largest entry: our generated equations "
        f"and those that SymPy derives by Lagrange's or Kane's method, at {data['points']} rational points a model "
        f"(seed {data['seed']}), both in extended precision."
    )
    columns: dict[str, Column] = {
        "model": "{model}",
        "derivation": "{derivation}",
        **{f"#{function.replace('_', ' ')}": _agreeing(function) for function in functions},
        "#required": "{required:.0f}",
    }
    return Report(
        "Generated equations against SymPy's",
        f"{derived}: {verdict}.",
        ok,
        (),
        (Section("Digits that agree", (text, Table.of(rows, columns))),),
        facts=(Fact(f"{least:.0f}", f"digits agree at the least; {required:.0f} and more are asked for", ok),),
    )


def _agreeing(function: str) -> Column:
    """Digits of one function."""
    return lambda row: Cell(f"{row['digits'][function]:.0f}", row["digits"][function] >= row["required"])


TOPIC = Topic("oracle", "Correctness", "Do SymPy's derivations give the same digits?", compose, measure)
