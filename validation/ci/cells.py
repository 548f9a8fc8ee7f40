"""What the tests of the plug-in share: markers of their tier, and failures that list cells without a traceback."""

from __future__ import annotations

from typing import Any

import pytest


class CellFailure(Exception):
    """Cells that are wrong, worse than before, or were not compared at all; the message lists them."""


class CellItem(pytest.Item):
    """A test of one or several cells.

    Args:
        tier: Name of the tier.
        named: Others that pytest sets.
    """

    def __init__(self, *, tier: str, **named: Any) -> None:
        super().__init__(**named)
        self.add_marker("symofros")
        self.add_marker(f"symofros_{tier}")

    def repr_failure(self, excinfo: Any, style: Any = None) -> Any:
        """The cells alone; another exception with its traceback."""
        return str(excinfo.value) if isinstance(excinfo.value, CellFailure) else super().repr_failure(excinfo, style)
