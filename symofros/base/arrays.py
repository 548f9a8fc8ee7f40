"""What counts as an array of numbers."""

from __future__ import annotations

import numbers
from typing import Any

import numpy as np
import numpy.typing as npt
from numpy.typing import ArrayLike

from symofros.errors import Problem, ShapeError

# Of NumPy's search for an element that two arrays share: of rows or columns of one array it takes a few steps.
_OVERLAP_WORK = 100_000


def real_array(values: ArrayLike | None, dtype: npt.DTypeLike = np.float64) -> npt.NDArray[Any] | None:
    """The values as an array of real numbers; None where some are not: texts, dates, complex numbers, None.

    NumPy would read texts and dates, make NaN of None, and drop imaginary parts.

    Args:
        values: Values.
        dtype: Type of the array's numbers.
    """
    try:
        array = np.asarray(values)
        if array.dtype.kind == "O" and not all(isinstance(value, numbers.Real) for value in array.flat):
            return None
        return np.asarray(array, dtype=dtype) if array.dtype.kind in "fiubO" else None
    except (TypeError, ValueError, OverflowError):  # Rows of unequal length, for instance.
        return None


def numeric(what: str, values: ArrayLike) -> npt.NDArray[np.float64]:
    """The values as a new array of real numbers of any shape.

    Args:
        what: Name of the values in the message.
        values: Values.

    Raises:
        ShapeError: Some are no real numbers.
    """
    array = real_array(values)
    if array is None:
        raise ShapeError(
            Problem(
                f"{what} is not an array of numbers",
                f"{type(values).__name__} {values!r:.60}",
                f"{what} is an array of real numbers",
                "convert texts, dates and complex numbers before",
            )
        )
    return np.array(array)


def share_memory(a: npt.NDArray[Any], b: npt.NDArray[Any]) -> bool:
    """Whether two arrays have an element in common; where that takes long to find out, they are taken to."""
    try:
        # NumPy's stub knows two of the numbers that max_work may be.
        return bool(np.shares_memory(a, b, max_work=_OVERLAP_WORK))  # type: ignore[arg-type]
    except np.exceptions.TooHardError:
        return True
