"""Generated equations against SymPy's, digit by digit."""

from __future__ import annotations

from ...reporting.numbers import counted
from ...reporting.record import Data, Fact, Report, Section, Table, Topic, verdict
from ..oracle import measure

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
