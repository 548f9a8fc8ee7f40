"""Configurations whose quaternions are no rotations are refused before a motion starts from them."""

from __future__ import annotations

import numpy as np

from symofros.errors import Problem, ShapeError
from symofros.native import native_number
from symofros.runtime.calls.kernel import Array
from symofros.runtime.record import ModelRecord

# Deviation from unit length up to which a quaternion counts as a rotation written in few digits.
UNIT_TOLERANCE = native_number("stepping/system.c", "SYM_QUATERNION_TOLERANCE")


def refuse_lengths(record: ModelRecord, q: Array) -> None:
    """Refuse first configurations whose quaternions are no rotations; runs make those written in few digits unit ones.

    Args:
        record: What is known of the model.
        q: Configurations (..., nq).

    Raises:
        ShapeError: With the coordinates of the one that is off most.
    """
    for segment in record.segments:
        if segment.kind == "linear":
            continue
        first = segment.q + segment.translations
        lengths = np.linalg.norm(q[..., first : first + 4], axis=-1)
        finite = lengths[np.isfinite(lengths)]  # Others are reported as not finite.
        length = float(finite.flat[np.argmax(np.abs(finite - 1.0))]) if finite.size else 1.0
        if not abs(length - 1.0) <= UNIT_TOLERANCE:
            raise ShapeError(
                Problem(
                    f"model '{record.name}': q0 holds a quaternion that is no rotation",
                    f"length {length:.6g} of {', '.join(record.q_names[first : first + 4])}",
                    f"quaternions are of unit length, to {UNIT_TOLERANCE:g}",
                    "divide it by its length; model.neutral() has those of no rotation",
                )
            )
