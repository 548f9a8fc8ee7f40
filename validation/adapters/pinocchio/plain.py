"""A plain call of Pinocchio's from Python, as its users write it, for what a call costs beside its C++."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pinocchio as pin


def mass_matrix_call(file: Path, floating: bool) -> Callable[[], object]:
    """`pin.crba(model, data, q)` at the neutral configuration.

    Args:
        file: URDF file.
        floating: Whether a free joint goes under its root.
    """
    model = pin.buildModelFromUrdf(str(file), *([pin.JointModelFreeFlyer()] if floating else []))
    data, q = model.createData(), pin.neutral(model)
    return lambda: pin.crba(model, data, q)
