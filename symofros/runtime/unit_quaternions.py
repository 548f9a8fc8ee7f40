"""Quaternions in states and inputs: near unit length they are taken at it, others are no rotations and refused.

The equations hold for unit quaternions: results would err by twice the deviation of a length. So every function that
takes a state looks at them here, and gives what it gives for the quaternion divided by its length.
"""

from __future__ import annotations

from math import hypot

import numpy as np
import numpy.typing as npt

from symofros.errors import Problem, ShapeError
from symofros.native import native_number
from symofros.runtime.calls.extension import UNIT_ROUNDING, begin, type_at_hand
from symofros.runtime.calls.kernel import Numbers
from symofros.runtime.record import ModelRecord

# Deviation from unit length up to which a quaternion counts as a rotation written in few digits.
UNIT_TOLERANCE = native_number("stepping/system.c", "SYM_QUATERNION_TOLERANCE")
# Numbers of a batch from which on another thread makes what looks at the next one faster than NumPy does.
_MANY = 1024


def at_unit_length(record: ModelRecord, group: str, given: Numbers, name: str = "") -> Numbers:
    """Coordinates or inputs with their quaternions at unit length, in a copy where one was off by more than rounding.

    What is not finite stays as it is: it propagates to what depends on it.

    Args:
        record: What is known of the model.
        group: What they are: "q" or "u"; of others there are no quaternions.
        given: Coordinates (..., nq) or inputs (..., nu).
        name: What messages call them.

    Raises:
        ShapeError: A quaternion is no rotation: its length is not 1 to UNIT_TOLERANCE. With the one that is off most.
    """
    firsts = record.quaternions.get(group, ())
    if not firsts or are_unit(given, firsts):
        return given
    result = given
    for first in firsts:
        quaternions = given[..., first : first + 4]
        squares = _squared_lengths(quaternions)
        off = (np.abs(squares - 1.0) > _rounding(given)) & np.isfinite(quaternions).all(axis=-1)
        if not off.any():
            continue
        lengths = np.sqrt(squares[off])
        deviations = np.abs(lengths - 1.0)
        worst = int(np.argmax(deviations))
        if not deviations[worst] <= UNIT_TOLERANCE:
            raise _no_rotation(record, group, first, name or group, quaternions, np.argwhere(off)[worst])
        if result is given:
            result = given.copy(order="K")
        result[..., first : first + 4][off] /= lengths[:, np.newaxis]
    return result


def normalized(record: ModelRecord, q: Numbers) -> Numbers:
    """Configurations (..., nq) with each quaternion divided by its length.

    Raises:
        ShapeError: A quaternion is zero.
    """
    result = np.array(q, order="K")
    for first in record.quaternions.get("q", ()):
        quaternions = result[..., first : first + 4]
        largest = np.abs(quaternions).max(axis=-1, keepdims=True)
        if (largest == 0.0).any():
            raise _no_rotation(record, "q", first, "q", quaternions, np.argwhere(largest[..., 0] == 0.0)[0])
        with np.errstate(invalid="ignore"):  # Of what is not finite.
            quaternions /= largest  # Squares of the quotients neither overflow nor vanish.
            quaternions /= np.linalg.norm(quaternions, axis=-1, keepdims=True)
    return result


def are_unit(numbers: Numbers, firsts: tuple[int, ...]) -> bool:
    """Whether quaternions are known to be of unit length, up to rounding.

    Args:
        numbers: Arrays of coordinates or inputs (..., n).
        firsts: First index of each quaternion.
    """
    by_extension = type_at_hand()
    if by_extension is not None and numbers.dtype == np.float64:
        return bool(by_extension.are_unit(numbers, firsts))
    if numbers.size >= _MANY:
        begin()
    deviations = [np.abs(_squared_lengths(numbers[..., first : first + 4]) - 1.0) for first in firsts]
    return not any(bool((deviation > _rounding(numbers)).any()) for deviation in deviations)


def _squared_lengths(quaternions: Numbers) -> Numbers:
    wide = quaternions.astype(np.float64, copy=False)
    with np.errstate(over="ignore", invalid="ignore"):
        return np.asarray(np.einsum("...i,...i->...", wide, wide))


def _rounding(numbers: Numbers) -> float:
    """Deviation of squared lengths that is rounding, in the precision of these numbers."""
    return UNIT_ROUNDING * float(np.finfo(numbers.dtype).eps / np.finfo(np.float64).eps)


def _no_rotation(
    record: ModelRecord, group: str, first: int, name: str, quaternions: Numbers, place: npt.NDArray[np.intp]
) -> ShapeError:
    """The quaternion at a place of some (..., 4) is none."""
    length = hypot(*quaternions[tuple(place)].tolist())
    of_batch = f" in row {', '.join(map(str, place))}" if len(place) else ""
    divide = "model.normalized(q) divides by it" if group == "q" else "divide by it"
    return ShapeError(
        Problem(
            f"model '{record.name}': {name} holds a quaternion that is no rotation",
            f"length {length:.6g} of {', '.join(record.vectors[group][first : first + 4])}{of_batch}",
            f"quaternions are of unit length, to {UNIT_TOLERANCE:g}",
            divide if length else "a body that is not turned has (0, 0, 0, 1), as in model.neutral()",
        )
    )
