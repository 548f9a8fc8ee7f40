"""Columns and arrays over time as files: CSV, NumPy's .npz, Parquet; whole or not at all."""

from __future__ import annotations

import csv
import io
import os
import tempfile
from collections.abc import Callable, Mapping
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from symofros.base.arrays import Array
from symofros.base.stored import check_writable, write_atomically
from symofros.errors import SymofrosError

T = TypeVar("T")

SUFFIXES = (".npz", ".csv", ".parquet")


def check_file(path: Path, what: str) -> None:
    """Refuse a file that columns and arrays can't be saved to; a run is asked before it begins.

    Raises:
        SymofrosError: Another suffix than SUFFIXES; or Parquet without pyarrow.
        OSError: The file can't be written.
    """
    if path.suffix not in SUFFIXES:
        raise SymofrosError(
            f"{what}: can't save as '{path.name}'",
            path.suffix or "no suffix",
            ".npz, .csv or .parquet",
            "choose one of them",
        )
    if path.suffix == ".parquet":
        _pyarrow(what)
    check_writable(path)


def save_or_keep(save: Callable[[Path], T], path: Path) -> T:
    """Save a result; where its file can't be written, such as on a full disk, keep it in another folder.

    Raises:
        SymofrosError: The file can't be written; it says where the result is kept.
        OSError: The file can't be written, and no other folder takes the result.
    """
    try:
        return save(path)
    except OSError as error:
        for folder in (Path.cwd(), Path.home(), Path(tempfile.gettempdir())):
            kept = folder / f"{path.stem}-kept-{os.getpid()}{path.suffix}"
            with suppress(OSError):
                save(kept)
                rule = "files are written where there is room, and the right to write"
                found = error.strerror or str(error)
                raise SymofrosError(
                    f"'{path}' can't be written", found, rule, f"the run is kept: move '{kept}'"
                ) from None
        raise


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


def _pyarrow(what: str) -> tuple[Any, Any]:
    """The modules pyarrow and pyarrow.parquet."""
    try:
        return import_module("pyarrow"), import_module("pyarrow.parquet")  # An extra: 40 MB that only this needs.
    except ImportError:
        raise SymofrosError(
            f"{what}: Parquet needs pyarrow",
            "it is not installed",
            "pyarrow writes Parquet",
            "pip install pyarrow, or save as .npz",
        ) from None


def _parquet(columns: Mapping[str, Array], what: str, units: Mapping[str, str]) -> bytes:
    pyarrow, parquet = _pyarrow(what)
    fields = [
        pyarrow.field(name, pyarrow.float64(), metadata={"unit": units[name]} if units.get(name) else None)
        for name in columns
    ]
    stream = io.BytesIO()
    parquet.write_table(pyarrow.table(list(columns.values()), schema=pyarrow.schema(fields)), stream)
    return stream.getvalue()
