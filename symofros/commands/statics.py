"""symofros equilibrium: where a model rests, and what holds it there."""

from __future__ import annotations

import json
from typing import Annotated, Any

import typer
from rich.table import Table

import symofros as sf
from symofros.commands.reading import ReadingOptions, reads_models
from symofros.commands.shared import AsJson, ModelPath, assignments, load, number, refuse, shown
from symofros.commands.states import stated_state
from symofros.commands.terminal import err, out
from symofros.compiler import compile_system
from symofros.runtime.beams import BEAM_LIMIT
from symofros.simulation.analysis.equilibrium import Equilibrium


@reads_models
def equilibrium(
    model: ModelPath,
    *,
    reading: ReadingOptions,
    given: Annotated[
        list[str],
        typer.Option(
            "--set", help="NAME=NUMBER: a coordinate of the guess, a speed that stays (dNAME), or a run-time parameter."
        ),
    ] = [],  # noqa: B006
    inputs: Annotated[list[str], typer.Option("--input", help="NAME=NUMBER: an input.")] = [],  # noqa: B006
    held: Annotated[list[str], typer.Option("--hold", help="Name of a speed whose coordinate stays.")] = [],  # noqa: B006
    beam_limit: Annotated[
        float, typer.Option(help="Estimated error of a beam's theory beyond which there is no result; or inf.")
    ] = BEAM_LIMIT,
    as_json: AsJson = False,
) -> None:
    """Find where a model rests, or moves steadily, and the inputs and efforts that hold it there."""
    system = load(model, reading)
    try:
        compiled, q, v = stated_state(compile_system(system), assignments(given, "--set"))
        u = {name: number(name, text) for name, text in assignments(inputs, "--input").items()}
        rest = sf.equilibrium(compiled, q, v, u or None, held=held, beam_limit=beam_limit)
    except sf.EquilibriumError as error:
        if as_json:
            print(json.dumps({"ok": False, "error": str(error)}, indent=1))
        else:
            err.print(str(error), markup=False, highlight=False, soft_wrap=True)
        raise typer.Exit(1) from None
    except (sf.SymofrosError, ValueError, OSError) as error:
        raise refuse(error) from None
    result: dict[str, Any] = {
        "coordinates": dict(zip(compiled.names.q, rest.q.tolist(), strict=True)),
        "speeds": dict(zip(compiled.names.v, rest.v.tolist(), strict=True)),
        "states": dict(zip(compiled.names.z, rest.z.tolist(), strict=True)),
        "inputs": None if rest.inputs is None else dict(rest.inputs),
        "efforts": dict(rest.efforts),
        "multipliers": dict(zip(compiled.names.constraints, rest.lam.tolist(), strict=True)),
    }
    if as_json:
        facts = {"residual": rest.residual, "iterations": rest.iterations, "notes": list(rest.notes)}
        print(json.dumps({"ok": True, **result, **facts}, indent=1))
        return
    _tell(result, rest)


def _tell(result: dict[str, Any], rest: Equilibrium) -> None:
    """A table, and the notes."""
    table = Table("what", "name", "value", title=f"Equilibrium, {rest.iterations} steps, residual {rest.residual:.1g}")
    kinds = {
        "coordinates": "coordinate",
        "states": "state of a force",
        "efforts": "effort held by",
        "inputs": "input",
        "multipliers": "multiplier",
    }
    for key, kind in kinds.items():
        for name, value in (result[key] or {}).items():
            table.add_row(kind, name, shown(value))
    out.print(table)
    if rest.inputs is None:
        out.print("no inputs hold this state by themselves", markup=False)
    for note in rest.notes:
        out.print(f"note: {note}", markup=False, highlight=False, soft_wrap=True)
