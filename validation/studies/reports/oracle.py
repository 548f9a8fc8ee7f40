"""Generated equations against SymPy's, digit by digit."""

from __future__ import annotations

from validation.reporting.numbers import counted
from validation.reporting.record import Cell, Column, Data, Fact, Report, Section, Table, Topic
from validation.studies.oracle import measure


def compose(data: Data) -> Report:
    """The report of its JSON."""
    rows, ok = data["comparisons"], bool(data["ok"])
    least = min((digits for row in rows for digits in row["digits"].values()), default=0.0)
    required = min((row["required"] for row in rows), default=0.0)
    failed = [row for row in rows if min(row["digits"].values()) < row["required"]]
    names = ", ".join(f"{row['model']} ({row['derivation']})" for row in failed)
    text = (
        "Decimal digits that agree at the worst of the points, relative to the largest entry: our generated equations "
        f"and those that SymPy derives by Lagrange's or Kane's method, at {data['points']} rational points a model "
        f"(seed {data['seed']}), both in extended precision."
    )

    def digits(function: str) -> Column:
        return lambda row: Cell(f"{row['digits'][function]:.0f}", row["digits"][function] >= row["required"])

    functions = dict.fromkeys(function for row in rows for function in row["digits"])
    titles = "".join(f"#{name.replace('_', ' ')} = {name}(); " for name in functions)
    columns = f"model; derivation; {titles}#required = {{required:.0f}}"
    return Report(
        "Generated equations against SymPy's",
        f"{counted(len(rows), 'derivation')} by SymPy of {counted(len({row['model'] for row in rows}), 'model')}: "
        f"{'all agree' if ok else f'not all agree: {names}'}.",
        ok,
        (),
        (Section("Digits that agree", (text, Table.of(rows, columns, **{name: digits(name) for name in functions}))),),
        facts=(Fact(f"{least:.0f}", f"digits agree at the least; {required:.0f} and more are asked for", ok),),
    )


TOPIC = Topic("oracle", "Correctness", "Do SymPy's derivations give the same digits?", compose, measure)
