"""Generated equations against SymPy's, digit by digit."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer

from validation.reporting.command import Run, known
from validation.reporting.numbers import counted
from validation.reporting.provenance import stamp
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
    return {
        "ok": all(result.ok for result in results),
        "points": points,
        "seed": seed,
        "seconds": run.seconds,
        "comparisons": [asdict(result) for result in results],
        **stamp("sympy"),
    }


def compose(data: Data) -> Report:
    """The report of its JSON."""
    rows, ok = data["comparisons"], bool(data["ok"])
    least = min((digits for row in rows for digits in row["digits"].values()), default=0.0)
    required = min((row["required"] for row in rows), default=0.0)
    functions = list(rows[0]["digits"]) if rows else []

    def agreeing(function: str) -> Column:
        return lambda row: Cell(f"{row['digits'][function]:.0f}", row["digits"][function] >= row["required"])

    by_function = {f"#{function.replace('_', ' ')}": agreeing(function) for function in functions}
    columns = {"model": "{model}", "derivation": "{derivation}", **by_function, "#required": "{required:.0f}"}
    table = Table.of(rows, columns)
    failed = [row for row in rows if any(x < row["required"] for x in row["digits"].values())]
    names = ", ".join(f"{row['model']} ({row['derivation']})" for row in failed)
    verdict = "all agree" if ok else f"not all agree{': ' if names else ''}{names}"
    models = len({row["model"] for row in rows})
    text = (
        "Decimal digits that agree at the worst of the points, relative to the largest entry: our generated equations "
        f"and those that SymPy derives by Lagrange's or Kane's method, at {data['points']} rational points a model "
        f"(seed {data['seed']}), both in extended precision."
    )
    return Report(
        "Generated equations against SymPy's",
        f"{counted(len(rows), 'derivation')} by SymPy of {counted(models, 'model')}: {verdict}.",
        ok,
        (),
        (Section("Digits that agree", (text, table)),),
        (Fact(f"{least:.0f}", f"digits agree at the least; {required:.0f} and more are asked for", ok),),
        digest=(table,),
    )


TOPIC = Topic("oracle", "Correctness", "Do SymPy's derivations give the same digits?", compose)
