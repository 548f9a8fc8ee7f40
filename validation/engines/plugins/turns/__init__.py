"""What engines offer of rotations and placements, beside mechanisms."""

from __future__ import annotations

from ...interface import Slot
from ..writing.source import Source


def source(*imports: str, scalar_last: bool = False) -> Source:
    """Text that imports an engine: a turn is a quaternion, and nothing is built."""
    chart = "quaternion xyzw, body speeds" if scalar_last else "quaternion wxyz, body speeds"
    slots = ((Slot(chart, (0, 1, 2, 3), (0, 1, 2)),),)
    return Source(("import numpy as np", *imports), slots, 4, 3)
