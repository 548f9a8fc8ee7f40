"""How batches lie in memory: row by row, column by column, or otherwise; read in place wherever strides allow it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple, Self

import numpy as np
import numpy.typing as npt

# Of a batch: doubles, or floats where that was asked for.
Numbers = npt.NDArray[Any]
# Bytes of a line of the cache; lines of a column from which on a line more of it is little.
_LINE, _MANY = 64, 16


def columns(n: int, size: int, dtype: type[np.float32] | type[np.float64]) -> Numbers:
    """Uninitialised memory for n states (n, size) whose batch is the fast axis.

    Each entry's column begins at a line of the cache; the next one, of long columns, an odd number of lines further:
    columns a power of two apart would share a few places in the first cache (1024 states of 22 joints took four times
    as long). Short ones lie close, so that no more memory is used than must be.
    """
    line = _LINE // (4 if dtype is np.float32 else 8)
    lines = -(-n // line)
    step = (lines | 1 if lines >= _MANY else lines) * line
    buffer = np.empty(size * step + line, dtype)
    start = -_address(buffer) % _LINE // buffer.itemsize
    return buffer[start : start + size * step].reshape(size, step)[:, :n].T


def _address(array: Numbers) -> int:
    address: int = array.__array_interface__["data"][0]
    return address


def states(array: Numbers, batch: tuple[int, ...]) -> Numbers:
    """An array (..., size) as (n or 1, size): one row where it has no batch of its own.

    A view, unless the states do not lie at equal distances in the order of the batch; then a copy, row by row.

    Args:
        array: Array whose leading dimensions broadcast to the batch.
        batch: All leading dimensions.
    """
    size = array.shape[-1]
    if array.size == size:
        return array.reshape(1, size)
    if array.ndim == 2 and array.shape[:1] == batch:
        return array
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


def flat(array: Numbers, batch: tuple[int, ...]) -> Numbers:
    """An array as contiguous rows (n or 1, size): one row where the array has no batch of its own."""
    size = array.shape[-1]
    if array.size == size:
        return np.ascontiguousarray(array.reshape(1, size))
    return np.ascontiguousarray(np.broadcast_to(array, (*batch, size))).reshape(-1, size)


def by_columns(arrays: Iterable[Numbers]) -> bool:
    """Whether the batch is the fast axis of all arrays (n or 1, size) in which that makes a difference."""
    contiguous = [x.strides[0] == x.itemsize for x in arrays if len(x) > 1 and x.shape[1] > 1]
    return bool(contiguous) and all(contiguous)


class Strided(NamedTuple):
    """An array (n or 1, size) as C takes it.

    Attributes:
        array: The numbers, kept alive.
        address: Address of the first.
        step: Distance from one entry to the next, in numbers.
        stride: Distance from one state to the next, in numbers; 0: one for all.
    """

    array: Numbers
    address: int
    step: int
    stride: int

    @classmethod
    def of(cls, array: Numbers, dtype: npt.DTypeLike) -> Self:
        """The array in place, or a contiguous copy if its type, alignment or strides do not fit."""
        by, to = array.strides
        size = array.itemsize
        if array.dtype != dtype or by % size or to % size or not array.flags.aligned:
            array = np.ascontiguousarray(array, dtype=dtype)
            (by, to), size = array.strides, array.itemsize
        n, entries = array.shape
        return cls(array, _address(array), to // size if entries > 1 else 1, by // size if n > 1 else 0)

    def from_state(self, first: int) -> tuple[int, int, int]:
        """(address, step, stride) from a state on."""
        return self.address + first * self.stride * self.array.itemsize, self.step, self.stride
