"""Comparison with SymPy's derivations, as a command."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer

from ..reporting.command import Run, known
from ..reporting.record import Data


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
