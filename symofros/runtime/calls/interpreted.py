"""Functions that NumPy interprets, as C calls them: what a search in C evaluates need not be compiled."""

from __future__ import annotations

from collections.abc import Iterable
from math import prod
from typing import Any

import numpy as np

from symofros.runtime.calls.declarations import interface
from symofros.runtime.calls.kernel import Array, Kernel


class InterpretedFunction:
    """A sym_function that calls back into Python.

    What the function raises can't pass through C: the outputs are NaN then, and `failure` holds it.

    Args:
        kernel: The function.

    Attributes:
        function: The sym_function.
        failure: The last exception that the function raised.
    """

    def __init__(self, kernel: Kernel) -> None:
        self.failure: BaseException | None = None
        self._kernel, self._ffi = kernel, interface()
        self._npre = 0
        self._kept: list[Any] = []
        inputs = self._arrays([("pre", (0,)), *((name, (size,)) for name, size in kernel.signature.inputs)])
        self.function = self._keep(self._ffi.new("sym_function *"))
        self.function.name, self.function.out = (
            self._text(kernel.signature.name),
            self._arrays(kernel.signature.outputs),
        )
        self.function.n_in, self.function.n_out = len(inputs), len(kernel.signature.outputs)
        setattr(self.function, "in", inputs)  # A keyword of Python.
        kind = dict(self._ffi.typeof("sym_function").fields)["eval"].type
        self.function.eval, self.function.work = self._keep(self._ffi.callback(kind, self._evaluate)), 1

    def prepare(self, par: Array) -> Array:
        """The parameter-only part of the work, for all calls that follow.

        Args:
            par: Run-time parameters (npar).
        """
        pre = self._kernel.prepare(par.reshape(1, -1))
        self._npre = pre.size
        return pre

    def _evaluate(self, read: Any, written: Any, _: Any) -> None:
        signature = self._kernel.signature
        places = [self._view(written[i], prod(shape)) for i, (_, shape) in enumerate(signature.outputs)]
        try:
            sizes = [self._npre, *(size for _, size in signature.inputs)]
            pre, *inputs = (np.array(self._view(read[i], size))[None] for i, size in enumerate(sizes))
            for place, result in zip(places, self._kernel.run(1, pre, inputs), strict=True):
                place[...] = np.reshape(result, -1)
        except BaseException as failure:  # Ctrl-C, too: raised again where C has returned.
            self.failure = failure
            for place in places:
                place[...] = np.nan

    def _view(self, pointer: Any, size: int) -> Array:
        return np.frombuffer(self._ffi.buffer(pointer, 8 * size), dtype=np.float64) if size else np.zeros(0)

    def _arrays(self, arrays: Iterable[tuple[str, tuple[int, ...]]]) -> Any:
        rows = [
            (self._text(name), len(shape), *(*shape, 1, 1)[:2])
            for name, shape in arrays  # Both sizes of a scalar are 1.
        ]
        return self._keep(self._ffi.new("sym_array[]", rows))

    def _text(self, text: str) -> Any:
        return self._keep(self._ffi.new("char[]", text.encode()))

    def _keep(self, thing: Any) -> Any:
        self._kept.append(thing)
        return thing
