"""What the fields of blocks must be; what is wrong is said in four parts."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from os import PathLike
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.errors import DescriptionError, did_you_mean


def refuse(name: str, what: str, found: object, rule: str, remedy: str) -> DescriptionError:
    """An error about a block; texts of any length are cut."""
    return DescriptionError(f"block '{name}': {what}", f"{found!s:.120}", rule, remedy)


def numbers(name: str, field: str, values: Any, shape: Sequence[int | None] | None = None) -> Array:
    """The finite numbers of a field.

    Args:
        name: Name of the block.
        field: Field of the block.
        values: Value as given.
        shape: Shape that it must have; None for any length, or for any shape.

    Raises:
        DescriptionError: They are none, or too few or too many.
    """
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise refuse(
            name,
            f"{field} is not numbers",
            repr(values),
            "an array of finite numbers",
            "write numbers, rows of equal length",
        ) from None
    if not np.all(np.isfinite(array)):
        raise refuse(name, f"{field} is not finite", array, "an array of finite numbers", "replace inf and nan")
    if shape is not None:
        fits = array.ndim == len(shape) and all(n in (None, m) for n, m in zip(shape, array.shape, strict=True))
        if not fits:
            stated = ", ".join("any" if n is None else str(n) for n in shape)
            raise refuse(name, f"{field} has the wrong shape", array.shape, f"shape ({stated})", "give it that shape")
    return array


def number(
    name: str, field: str, value: Any, low: float = -math.inf, high: float = math.inf, exclusive: bool = False
) -> float:
    """A number of a field within bounds.

    Args:
        name: Name of the block.
        field: Field of the block.
        value: Value as given.
        low: Lower bound.
        high: Upper bound.
        exclusive: Whether the lower bound itself is refused.

    Raises:
        DescriptionError: It is none, or out of bounds.
    """
    given = float(numbers(name, field, value, ()))
    if not low <= given <= high or (exclusive and given == low):
        above = "" if low == -math.inf else f"above {low:g}" if exclusive else f"at least {low:g}"
        below = "" if high == math.inf else f"at most {high:g}"
        rule = " and ".join(filter(None, (above, below)))
        raise refuse(name, f"{field} is out of bounds", given, f"{field} is {rule}", "choose a number within")
    return given


def path_text(name: str, field: str, path: Any) -> str:
    """A path as text.

    Raises:
        DescriptionError: It is none.
    """
    if not isinstance(path, (str, PathLike)):
        raise refuse(name, f"{field} is no path", repr(path), "a path, as text or of pathlib", "state where it lies")
    return str(path)


def whole(name: str, field: str, value: Any, low: int, high: int) -> int:
    """A whole number of a field within bounds.

    Raises:
        DescriptionError: It is none, or out of bounds.
    """
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or not low <= value <= high:
        raise refuse(
            name, f"{field} is out of bounds", repr(value), f"a whole number from {low} to {high}", "choose one"
        )
    return int(value)


def increasing(name: str, field: str, values: Any, least: int = 2) -> Array:
    """Increasing numbers (n) of a field.

    Raises:
        DescriptionError: They are none, too few, or don't increase.
    """
    array = numbers(name, field, values, (None,))
    if len(array) < least or not np.all(np.diff(array) > 0.0):
        raise refuse(
            name,
            f"{field} does not increase",
            array,
            f"{least} numbers or more, each above the one before",
            "sort them and drop what is repeated",
        )
    return array


def choice(name: str, field: str, value: Any, known: Iterable[str]) -> str:
    """One of some names.

    Raises:
        DescriptionError: It is another.
    """
    names = list(known)
    if value not in names:
        raise refuse(
            name,
            f"unknown {field}",
            repr(value),
            f"{field} is one of {', '.join(names)}",
            did_you_mean(str(value), names),
        )
    return str(value)


def known_name(name: str, what: str, value: object, known: Collection[str]) -> str:
    """A name that exists.

    Raises:
        DescriptionError: It does not.
    """
    if value not in known:
        raise refuse(
            name,
            f"no {what} '{value!s:.60}'",
            repr(value),
            f"known: {', '.join(list(known)[:12]) or 'none'}",
            did_you_mean(str(value), known) or "see model.names",
        )
    return str(value)


def weights(name: str, field: str, values: Any, size: int, *, positive: bool = False) -> Array:
    """Weights, or covariances, as a matrix (size, size).

    Args:
        name: Name of the block.
        field: Field of the block.
        values: One number, one an entry, or a matrix.
        size: Entries.
        positive: Whether zero is none.

    Raises:
        DescriptionError: They are not symmetric, or negative.
    """
    given = np.asarray(values, dtype=np.float64)
    numbers(name, field, given, ((), (size,), (size, size))[min(given.ndim, 2)])
    matrix = given if given.ndim == 2 else np.diag(np.broadcast_to(given, size))
    least = np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min(initial=np.inf)
    symmetric = np.allclose(matrix, matrix.T)
    if not symmetric or least < 0.0 or (positive and least == 0.0):
        rule = f"symmetric and {'positive' if positive else 'not negative'}"
        found = f"least eigenvalue {least:g}"
        if not symmetric:
            found = f"entries that differ from the mirrored ones by up to {np.abs(matrix - matrix.T).max():g}"
        raise refuse(name, f"{field} are not weights", found, rule, "choose others")
    return matrix
