"""Columns and arrays over time as files: CSV, NumPy's .npz, Parquet; whole or not at all."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.base.atomic import write_atomically
from symofros.errors import Problem, SymofrosError

SUFFIXES = (".npz", ".csv", ".parquet")


def refuse_suffix(path: Path, what: str) -> None:
    """Refuse a suffix that is not in SUFFIXES.

    Raises:
        SymofrosError: Another suffix than SUFFIXES.
    """
    if path.suffix not in SUFFIXES:
        raise SymofrosError(
            Problem(
                f"{what}: can't save as '{path.name}'",
                path.suffix or "no suffix",
                ".npz, .csv or .parquet",
                "choose one of them",
            )
        )


def write_npz(path: Path, arrays: Mapping[str, Any]) -> None:
    """Arrays by name, compressed."""
    stream = io.BytesIO()
    np.savez_compressed(stream, **arrays)
    write_atomically(path, stream.getvalue())


def write_columns(path: Path, columns: Mapping[str, Array], what: str, units: Mapping[str, str] | None = None) -> None:
    """Columns (n) by name as .csv or .parquet.

    Args:
        path: Path of the file; its suffix chooses the format.
        columns: Columns of one length.
        what: Is saved, for messages.
        units: Units of the columns: in CSV after the name, "pd.effort[0] [N m]"; in Parquet the field's metadata
            "unit".

    Raises:
        SymofrosError: Parquet without pyarrow.
    """
    if path.suffix == ".parquet":
        write_atomically(path, _parquet(columns, what, units or {}))
        return
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow(f"{name} [{units[name]}]" if units and units.get(name) else name for name in columns)
    writer.writerows(zip(*(map(repr, column.tolist()) for column in columns.values()), strict=True))
    write_atomically(path, text.getvalue())


def _parquet(columns: Mapping[str, Array], what: str, units: Mapping[str, str]) -> bytes:
    try:
        pyarrow = import_module("pyarrow")  # An extra: 40 MB that only this needs.
        parquet = import_module("pyarrow.parquet")
    except ImportError:
        raise SymofrosError(
            Problem(
                f"{what}: Parquet needs pyarrow",
                "it is not installed",
                "pyarrow writes Parquet",
                "pip install pyarrow, or save as .npz",
            )
        ) from None
    fields = [
        pyarrow.field(name, pyarrow.float64(), metadata={"unit": units[name]} if units.get(name) else None)
        for name in columns
    ]
    stream = io.BytesIO()
    parquet.write_table(pyarrow.table(list(columns.values()), schema=pyarrow.schema(fields)), stream)
    return stream.getvalue()
