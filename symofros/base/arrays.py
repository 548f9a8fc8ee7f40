"""What counts as an array of numbers."""

from __future__ import annotations

import numbers
from typing import Any

import numpy as np
import numpy.typing as npt
from numpy.typing import ArrayLike

from symofros.errors import ShapeError

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

# Of NumPy's search for an element that two arrays share: of rows or columns of one array it takes a few steps.
_OVERLAP_WORK = 100_000


def real_array(values: ArrayLike | None, dtype: npt.DTypeLike = np.float64) -> npt.NDArray[Any] | None:
    """The values as an array of real numbers; None where some are not: texts, dates, masked ones, ...

    NumPy would read texts and dates, make NaN of None, and drop imaginary parts and masks.
    """
    try:
        if _is_masked(values):
            return None
        array = np.asarray(values)
        if array.dtype.kind == "O" and not all(isinstance(value, numbers.Real) for value in array.flat):
            return None
        return np.asarray(array, dtype=dtype) if array.dtype.kind in "fiubO" else None
    except (TypeError, ValueError, OverflowError):  # Rows of unequal length, for instance.
        return None


def _is_masked(values: Any) -> bool:
    """Whether a value, or an entry of a list, is left out by a mask, which NumPy would drop."""
    parts = values if isinstance(values, list | tuple) else (values,)
    return any(isinstance(part, np.ma.MaskedArray) and bool(np.ma.getmaskarray(part).any()) for part in parts)


def numeric(what: str, values: ArrayLike) -> Array:
    """The values as a new array of real numbers of any shape.

    Raises:
        ShapeError: Some are no real numbers.
    """
    array = real_array(values)
    if array is None:
        raise ShapeError(
            f"{what} is not an array of numbers",
            f"{type(values).__name__} {values!r:.60}",
            f"{what} is an array of real numbers",
            "convert texts, dates and complex numbers, fill in masked ones before",
        )
    return np.array(array)


def vector(what: str, values: ArrayLike, size: int) -> Array:
    """The values as a new array (size) of real numbers.

    Raises:
        ShapeError: They are no numbers, or another number of them.
    """
    array = numeric(what, values)
    if array.shape != (size,):
        rule = f"{what} has shape ({size},): one state, no batch"
        raise ShapeError(f"{what} has the wrong shape", str(array.shape), rule, f"give {size} numbers")
    return array


def share_memory(a: npt.NDArray[Any], b: npt.NDArray[Any]) -> bool:
    """Whether two arrays have an element in common; where that takes long to find out, they are taken to."""
    try:
        # NumPy's stub knows two of the numbers that max_work may be.
        return bool(np.shares_memory(a, b, max_work=_OVERLAP_WORK))  # type: ignore[arg-type]
    except np.exceptions.TooHardError:
        return True


# Instants that differ by less, relative to themselves, are one, and zero is one with less than that [s]; as in
# native/stepping/state/system.c.
_SAME_INSTANT, _SAME_AS_ZERO = 2e-15, 1e-300


def rounding_of(t: Array | float) -> Array:
    """Largest distance [s] at which instants count as equal to t."""
    return np.asarray(_SAME_INSTANT * np.abs(t) + _SAME_AS_ZERO)
