"""symofros diff: whether files are the same mechanism, and in which entry they first differ."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

import symofros as sf
from symofros.commands.reading import ReadingOptions, reads_models
from symofros.commands.shared import AsJson, refuse, refusing_descriptions
from symofros.commands.terminal import out
from symofros.studio.differences.diff import TOLERANCE, MechanismDiff, compare, read_fully


@reads_models
def diff(
    files: Annotated[list[str], typer.Argument(help="Two models or more: each is compared with the first.")],
    *,
    reading: ReadingOptions,
    tolerance: Annotated[float, typer.Option(help="Relative difference of numbers that is rounding.")] = TOLERANCE,
    strict: Annotated[
        bool,
        typer.Option("--strict", help="Exit with 1 for other limits, dissipation, springs or coordinates, too."),
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Tell whether files are the same mechanism, and in which entry they first differ.

    Links and joints are matched by structure where names differ. Exit code: 0 the same mechanism, 1 another one, 2 a
    file that can't be read.
    """
    paths = [Path(name) for name in files]
    if len(paths) < 2:
        found, remedy = f"'{files[0]}' alone", f"symofros diff {files[0]} other.xml"
        raise refuse(sf.SymofrosError("diff: one file", found, "files are compared with the first", remedy))
    try:
        used = {name for path in paths for name in reading.fit_for(path).keywords}
        reading.without(used).require_none("none of the files has a use for them")
        compared = _compared(paths, reading, tolerance)
    except sf.SymofrosError as error:
        raise refuse(error) from None
    ok = all(item.identical if strict else item.same for item in compared)
    if as_json:
        print(json.dumps({"ok": ok, "comparisons": [item.to_json() for item in compared]}, indent=1))
    else:
        for item in compared:
            out.print(str(item), markup=False, highlight=False, soft_wrap=True)
    raise typer.Exit(0 if ok else 1)


def _compared(paths: list[Path], reading: ReadingOptions, tolerance: float) -> list[MechanismDiff]:
    systems = []
    for path in paths:
        with refusing_descriptions(path):
            systems.append(read_fully(path, **reading.fit_for(path).keywords))
    (first, *others), (label, *labels) = systems, map(str, paths)
    return [
        compare(first, system, names=(label, name), tolerance=tolerance)
        for system, name in zip(others, labels, strict=True)
    ]
