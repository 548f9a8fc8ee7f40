"""Names of single entries of signals: "pd.effort[1]"."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import product

from symofros.diagrams.block import Shape
from symofros.errors import DescriptionError

_ENTRY = re.compile(r"(?P<name>.*)\[(?P<index>\d{1,9}(?:,\d{1,9})*)\]$")


def split(text: str) -> tuple[str, tuple[int, ...] | None]:
    """The signal of "block.port[i]" or "block.port", and which entry of it; None for all."""
    match = _ENTRY.match(text)
    return (match["name"], tuple(map(int, match["index"].split(",")))) if match else (text, None)


def entries(name: str, shape: Shape) -> Iterator[tuple[str, tuple[int, ...]]]:
    """(name, index) of each entry of a signal, row by row; a scalar's name is the signal's."""
    for index in product(*map(range, shape)):
        yield (f"{name}[{','.join(map(str, index))}]" if index else name), index


def check_entry(text: str, index: tuple[int, ...] | None, shape: Shape) -> None:
    """Refuse an entry that a signal does not have.

    Raises:
        DescriptionError: With its shape.
    """
    if index is not None and (len(index) != len(shape) or any(i >= n for i, n in zip(index, shape, strict=True))):
        raise DescriptionError(
            f"signal '{text:.80}': no such entry",
            f"[{','.join(map(str, index))}]",
            f"the signal has shape {shape}",
            "entries count from 0",
        )
