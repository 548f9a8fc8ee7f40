"""Inputs and outputs of functions by vectors: blocks of states, column by column."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from symofros.tools import Numbers, Strided, columns

from ...mechanics.geometry import Array
from .arrays import aligned_zeros, loops


class Blocks:
    """Inputs and outputs of one function at all states, the batch as the fast axis of each block.

    Args:
        inputs: Each (n, size), or (size,) where all states share it; the parameters' part first.
        sizes: Sizes of the outputs.
        work: Doubles of scratch.
        block: States of a call.
        dtype: Type of inputs, but for the parameters' part, and of outputs.
    """

    def __init__(
        self,
        inputs: Sequence[Array],
        sizes: Sequence[int],
        work: int,
        block: int,
        dtype: type[np.float32] | type[np.float64],
    ) -> None:
        self._ffi, self._kept = loops()[0], []  # type: tuple[Any, list[Any]]
        n = max(len(array) for array in inputs if array.ndim == 2)
        self._bounds = [(first, min(first + block, n)) for first in range(0, n, block)]
        self._sizes, self._dtype = tuple(sizes), dtype
        self._work = aligned_zeros(work)
        pre, *others = inputs
        shared = [Strided.of(pre[None], np.float64), *(self._one(x) if x.ndim == 1 else None for x in others)]
        self._inputs = [
            [one or self._block(x, first, end) for one, x in zip(shared, inputs, strict=True)]
            for first, end in self._bounds
        ]

    def _one(self, values: Array) -> Strided:
        return Strided.of(values[None].astype(self._dtype), self._dtype)

    def _block(self, rows: Array, first: int, end: int) -> Strided:
        block = columns(end - first, rows.shape[1], self._dtype)
        block[...] = rows[first:end]
        return Strided.of(block, self._dtype)

    def _room(self, n: int) -> list[Numbers]:
        results = [columns(n, size, self._dtype) for size in self._sizes]
        for array in results:
            array[...] = 0.0
        return results

    def overwritten(self) -> Any:
        """Blocks of a race: the results of each lie over those before."""
        return self._filled([self._room(self._bounds[0][1])], False)

    def results(self, run: Callable[[Any], None], shared: int | None = None) -> Array:
        """The first outputs of every state (n, size), of a run that gets blocks in which they are kept."""
        outputs = [self._room(end - first) for first, end in self._bounds]
        run(self._filled(outputs, True))
        return np.concatenate([np.concatenate(block[:shared], axis=1) for block in outputs]).astype(np.float64)

    def _filled(self, outputs: Sequence[Sequence[Numbers]], keep: bool) -> Any:
        ffi, filled = self._ffi, self._ffi.new("loop_blocks *")
        written = [[Strided.of(y, self._dtype) for y in block] for block in outputs]
        filled.n, filled.n_in, filled.n_out, filled.keep = (
            len(self._bounds),
            len(self._inputs[0]),
            len(self._sizes),
            int(keep),
        )
        filled.states = self._keep(ffi.new("size_t[]", [end - first for first, end in self._bounds]))
        setattr(filled, "in", self._arrays(self._inputs))  # A keyword of Python.
        filled.out = self._arrays(written)
        filled.work = self._keep(ffi.from_buffer("double[]", self._work))
        return self._keep(filled)

    def _arrays(self, blocks: Sequence[Sequence[Strided]]) -> Any:
        self._keep(blocks)
        rows = [x.from_state(0) for block in blocks for x in block]
        return self._keep(self._ffi.new("sym_strided[]", [(self._ffi.cast("void *", a), *by) for a, *by in rows]))

    def _keep(self, value: Any) -> Any:
        self._kept.append(value)
        return value
