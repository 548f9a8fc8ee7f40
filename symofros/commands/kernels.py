"""symofros kernels: what the kernels of a model take of a graphics processor."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Annotated

import typer
from rich.table import Table

import symofros as sf
from symofros.base.functions import FUNCTIONS
from symofros.commands.reading import ReadingOptions, reads_models
from symofros.commands.shared import AsJson, ModelPath, load, names_of, refuse
from symofros.commands.terminal import out
from symofros.runtime.cuda.figures import KernelFigures, figures_of, present

_CAPTION = (
    "stack, spills (stores + loads): bytes of a thread; bytes: of a state, read and written; bound, timed: states/s"
)


@reads_models
def kernels(
    model: ModelPath,
    *,
    reading: ReadingOptions,
    functions: Annotated[str, typer.Option(help="Functions, comma-separated; of the last frame.")] = "dynamics",
    architecture: Annotated[
        str, typer.Option(help="Such as sm_80; this machine's, or sm_90 without a graphics processor.")
    ] = "",
    bandwidth: Annotated[float, typer.Option(help="Bandwidth of the memory [GB/s].")] = 3350.0,
    as_json: AsJson = False,
) -> None:
    """Compile kernels: registers, spills, what the memory bounds them by; timed where there is a graphics processor."""
    device = present()
    wanted = architecture or (device.architecture if device is not None else "sm_90")
    rows: list[KernelFigures] = []
    try:
        compiled = sf.compile(load(model, reading))
        for name in names_of(functions) or []:
            frame = compiled.names.frames[-1] if name in FUNCTIONS and FUNCTIONS[name].of_frame else ""
            for precision in ("double", "single"):
                rows.append(figures_of(compiled.cuda(precision), name, frame, wanted, 1e9 * bandwidth))
    except sf.SymofrosError as error:
        raise refuse(error) from None
    where = device.name if device is not None else "no graphics processor here: nothing is timed"
    if as_json:
        print(json.dumps({"architecture": wanted, "device": where, "kernels": [asdict(row) for row in rows]}, indent=1))
        return
    heads = ("function", "type", "registers", "stack", "spills", "bytes", "bound", "timed")
    table = Table(*heads, caption=_CAPTION, title=f"{wanted}, {bandwidth:g} GB/s; {where}")
    for row in rows:
        use = row.usage
        spills = f"{use.spill_stores} + {use.spill_loads}"
        timed = "-" if row.measured is None else f"{row.measured:.3g}"
        numbers = (use.registers, use.stack, spills, row.bytes_of_state, f"{row.bound:.3g}", timed)
        table.add_row(row.function, row.precision, *map(str, numbers))
    out.print(table)
