"""A run as a file of columns over time: CSV or Parquet, each column with its unit."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from symofros.errors import SymofrosError
from symofros.simulation.results.saving import write_columns
from symofros.studio.editor.editing.data_edits import EditError

Json = dict[str, Any]

MEDIA_TYPES = {"csv": "text/csv", "parquet": "application/vnd.apache.parquet"}


def table_of(kind: str, result: Any, suffix: str) -> bytes:
    """The file of a run.

    Args:
        kind: Kind of the job.
        result: Result of the job.
        suffix: "csv" or "parquet".

    Raises:
        EditError: The job has no curves, the format is none of these, or Parquet is not installed.
    """
    if kind not in _COLUMNS or not isinstance(result, dict):
        raise EditError("no curves to save", kind, "simulations and runs of diagrams have curves", "run it first")
    if suffix not in MEDIA_TYPES:
        raise EditError("no such format", f"'{suffix[:20]}'", f"one of {', '.join(MEDIA_TYPES)}", "choose one of them")
    curves = {"t": ("s", result["t"]), **_COLUMNS[kind](result)}
    columns = {name: np.array(values, dtype=np.float64) for name, (_, values) in curves.items()}
    # A simulation's CSV is read again by `symofros view`, whose columns are names alone, as of Trajectory.save.
    units = None if (kind, suffix) == ("simulate", "csv") else {name: unit for name, (unit, _) in curves.items()}
    with TemporaryDirectory() as folder:
        file = Path(folder) / f"run.{suffix}"
        try:
            write_columns(file, columns, "run", units)
        except SymofrosError as error:
            raise EditError(error.problem) from None
        return file.read_bytes()


def _simulation_columns(result: Json) -> dict[str, tuple[str, list[float]]]:
    """Coordinates, speeds, inputs (named u.NAME as in files of trajectories) and energies."""
    series = {
        f"u.{item['name'].removeprefix('u.')}" if item["kind"] == "u" else item["name"]: (item["unit"], item["values"])
        for item in result["series"]
    }
    return series | {f"energy.{name}": ("J", values) for name, values in result["energy"].items()}


def _diagram_columns(result: Json) -> dict[str, tuple[str, list[float]]]:
    """Each signal that a plot shows."""
    curves = [curve for plot in result["plots"] for curve in plot["curves"]]
    return {curve["name"]: (curve["unit"], curve["values"]) for curve in curves}


_COLUMNS = {"simulate": _simulation_columns, "run": _diagram_columns}
