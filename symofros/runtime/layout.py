"""How batches lie in memory: row by row, column by column, or otherwise; read in place wherever strides allow it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple, Self

import numpy as np
import numpy.typing as npt

from symofros.runtime.kernel import Numbers


def states(array: Numbers, batch: tuple[int, ...]) -> Numbers:
    """An array (..., size) as (n or 1, size): one row where it has no batch of its own.

    A view, unless the states do not lie at equal distances in the order of the batch; then a copy, row by row.

    Args:
        array: Its leading dimensions broadcast to the batch.
        batch: All leading dimensions.
    """
    size = array.shape[-1]
    if array.size == size:
        return array.reshape(1, size)
    spread = np.broadcast_to(array, (*batch, size))
    *axes, step = spread.strides
    lengths = batch
    # Axes of one state have no say; each other one must go on where the next ends.
    said = [(stride, length) for stride, length in zip(axes, lengths, strict=True) if length > 1]
    even = all(a == b * n for (a, _), (b, n) in zip(said, said[1:], strict=False))
    if not even:
        return np.ascontiguousarray(spread).reshape(-1, size)
    n = int(np.prod(batch))
    stride = said[-1][0] if said else 0
    return np.lib.stride_tricks.as_strided(spread, (n, size), (stride, step), writeable=False)


def by_columns(arrays: Iterable[Numbers]) -> bool:
    """Whether the batch is the fast axis of all arrays (n or 1, size) in which it could be told."""
    found = [x.strides[0] == x.itemsize for x in arrays if len(x) > 1 and x.shape[1] > 1]
    return bool(found) and all(found)


class Strided(NamedTuple):
    """An array (n or 1, size) as C takes it; `array` keeps it alive.

    Attributes:
        array: The numbers.
        step: From one entry to the next, in numbers.
        stride: From one state to the next; 0: one for all.
    """

    array: Numbers
    step: int
    stride: int

    @classmethod
    def of(cls, array: Numbers, dtype: npt.DTypeLike) -> Self:
        """In place, or a copy of what is of another type, or not in steps of whole numbers."""
        if array.dtype != dtype or not array.flags.aligned or any(step % array.itemsize for step in array.strides):
            array = np.ascontiguousarray(array, dtype=dtype)
        stride, step = (by // array.itemsize for by in array.strides)
        return cls(array, step if array.shape[1] > 1 else 1, stride if len(array) > 1 else 0)

    def from_row(self, first: int) -> tuple[int, int, int]:
        """(address, step, stride) from a state on."""
        return self.array.ctypes.data + first * self.stride * self.array.itemsize, self.step, self.stride
