"""Where commands print what Rich lays out: tables, trees, progress."""

from __future__ import annotations

import os
from typing import Any

from rich.console import Console, ConsoleDimensions

# Width of tables in a pipe or file [characters], which no window bounds: cells are as wide as what is in them.
_PIPED = 400


class _Output(Console):
    """A console that lays out as wide as its window, or as its text where there is none."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._width = None  # COLUMNS counts as it is when something is printed, not when this module is imported.

    @property
    def size(self) -> ConsoleDimensions:
        """Columns and rows: those of the window, or as the environment has them."""
        window, stated = super().size, os.environ.get("COLUMNS", "")
        if stated.isdigit():
            return ConsoleDimensions(int(stated), window.height)
        return window if self.is_terminal else ConsoleDimensions(_PIPED, window.height)

    @size.setter
    def size(self, new_size: tuple[int, int]) -> None:
        self._width, self._height = new_size


# Names and units have brackets, which markup would take for styles.
out = _Output(markup=False)
err = _Output(stderr=True, markup=False)
