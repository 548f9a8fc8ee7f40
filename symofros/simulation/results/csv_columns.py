"""Columns of numbers from untrusted CSV files: what they may take is known before."""

from __future__ import annotations

import csv
from array import array as packed
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from symofros.base.arrays import Array
from symofros.simulation.results.npz import TooLargeError

# Bytes of a number, with what is beside it.
_WIDEST = 26


class LineError(ValueError):
    """A line that has not a number for each column.

    Args:
        line: Its number, from 1 on.
        content: What it holds.
        columns: Number of columns.
    """

    def __init__(self, line: int, content: Sequence[str], columns: int) -> None:
        super().__init__(f"line {line} is {','.join(content)[:120]}, and not {columns} numbers")
        self.line, self.content, self.columns = line, content, columns


def read_csv(path: Path, most_numbers: int) -> dict[str, Array]:
    """Columns (n) by the names in the first line.

    Raises:
        OSError: The file can't be read.
        TooLargeError: It has more numbers.
        ValueError: It is no text, two columns have one name, or, a LineError, a line does not fit.
        csv.Error: It has no such form.
    """
    if path.stat().st_size > _WIDEST * most_numbers:
        raise TooLargeError(f"{path.stat().st_size} bytes")
    numbers = packed("d")
    with path.open(newline="", encoding="utf-8-sig") as stream:
        rows = csv.reader(stream)
        names = [name.strip() for name in next(rows, [])]
        refuse_doubled(names)
        for row in filter(None, rows):
            try:
                values = list(map(float, row))
            except ValueError:
                values = []
            if len(values) != len(names):
                raise LineError(rows.line_num, row, len(names))
            numbers.extend(values)
            if len(numbers) > most_numbers:
                raise TooLargeError(f"more than {most_numbers} numbers")
    table = np.array(numbers).reshape(-1, len(names) or 1)
    return dict(zip(names, table.T, strict=True)) if names else {}


def refuse_doubled(names: Sequence[str]) -> None:
    """Refuse columns of one name.

    Raises:
        ValueError: With the names.
    """
    doubled = [name for name, count in Counter(names).items() if count > 1]
    if doubled:
        shown = ", ".join(doubled[:8]) + (", …" if len(doubled) > 8 else "")
        raise ValueError(f"several columns are called {shown}")
