"""A loaded model library: reads its table of functions and calls them without the interpreter lock."""

from __future__ import annotations

import ctypes
import math
import threading
from collections.abc import Callable, Sequence
from functools import partial
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np

from symofros.errors import CompileError
from symofros.runtime.calls.declarations import interface, model_abi
from symofros.runtime.calls.kernel import (
    DEFAULT_OPTIONS,
    SHARED_PARAMETERS,
    Array,
    BatchOptions,
    Kernel,
    LaneOptions,
    Numbers,
    Precision,
    Signature,
)
from symofros.runtime.calls.layout import Strided
from symofros.runtime.calls.sharing import parts, share, together

# From here on a batch runs by vectors. What decides is the batch alone, so that no result depends on earlier calls;
# below, what vectors would save in a thousand calls is not worth the compilation of their code.
MANY = 64


class ModelUnit:
    """The functions of a sym_model in C.

    Args:
        model: Pointer to the sym_model; what it points to lives as long as this object.
        path: The shared library that it lies in, if it has one of its own.
        in_lanes: Function, and how to use vectors -> the same by vectors, or None; asked for once, at the first large
            batch.
    """

    def __init__(
        self,
        model: Any,
        path: Path | None = None,
        in_lanes: Callable[[tuple[str, str], LaneOptions], CompiledKernel | None] | None = None,
    ) -> None:
        self.model, self.path, self.in_lanes = model, path, in_lanes
        self.ffi = interface()
        self.nowhere = self.ffi.cast("char *", 0)
        self.compiled: dict[tuple[str, str], CompiledKernel] = {}
        lanes = model.lanes if model.size >= self.ffi.sizeof("sym_model") else self.ffi.NULL
        for i in range(model.n_functions):
            by_vectors = lanes[i] if lanes != self.ffi.NULL and lanes[i].batch != self.ffi.NULL else None
            kernel = CompiledKernel(self, model.functions[i], by_vectors)
            self.compiled[kernel.signature.name, kernel.signature.frame] = kernel

    @property
    def kernels(self) -> dict[tuple[str, str], Kernel]:
        """Functions by (name, frame)."""
        return dict(self.compiled)

    def prepare(self, par: Array) -> Array:
        """Run the init function on each parameter set (m, npar) -> (m, npre)."""
        par = np.ascontiguousarray(par, dtype=np.float64)
        pre = np.empty((len(par), self.model.npre))
        if pre.size == 0:
            return pre
        for row_in, row_out in zip(par, pre, strict=True):
            self.model.init(self.ffi.from_buffer("double[]", row_in), self.ffi.from_buffer("double[]", row_out))
        return pre


class CompiledUnit(ModelUnit):
    """The functions of one shared library.

    Args:
        path: Path of the library.
        symbol: Name of its exported function, `NAME_model`.
        expected_hash: Hash that the struct must state.
        in_lanes: As of `ModelUnit`.

    Raises:
        CompileError: It does not load, or is not what it should be.
    """

    def __init__(
        self,
        path: Path,
        symbol: str,
        expected_hash: str,
        in_lanes: Callable[[tuple[str, str], LaneOptions], CompiledKernel | None] | None = None,
    ) -> None:
        ffi = interface()
        try:
            # ctypes finds the symbol, whose name differs from model to model; cffi makes the calls, by one interface.
            self._library = ctypes.CDLL(str(path))
            address = ctypes.cast(self._library[symbol], ctypes.c_void_p).value
            model = ffi.cast("const sym_model *(*)(void)", address)()
        except (OSError, AttributeError) as error:
            raise CompileError(
                "the compiled model does not load",
                str(error),
                "a library in the cache folder is whole and of this machine",
                f"delete {path.name} from the cache folder",
            ) from error
        found_hash = ffi.string(model.hash).decode()
        if model.abi != model_abi() or found_hash != expected_hash:
            raise CompileError(
                "the compiled model is another one",
                f"abi {model.abi}, hash {found_hash}",
                f"abi {model_abi()}, hash {expected_hash}",
                f"delete {path.name} from the cache folder",
            )
        super().__init__(model, path, in_lanes)


class _Scratch(threading.local):
    """Per-thread work arrays, so that threads may call one model at the same time."""

    def __init__(self) -> None:
        self.work: Any = None


class CompiledKernel:
    """One function of a library.

    Args:
        unit: The library.
        function: Its `sym_function` in C.
        by_vectors: Its `sym_lanes` in C, if there is code by vectors.
    """

    def __init__(self, unit: ModelUnit, function: Any, by_vectors: Any = None) -> None:
        self._unit = unit
        self._function = function
        self._by_vectors = by_vectors
        self._scratch = _Scratch()
        self._lanes: dict[LaneOptions, CompiledKernel] = {}
        text = unit.ffi.string

        def array(entry: Any) -> tuple[str, tuple[int, ...]]:
            return text(entry.name).decode(), (entry.rows, entry.cols)[: entry.rank]

        inputs = getattr(function, "in")  # A keyword of Python.
        self.signature = Signature(
            text(function.name).decode(),
            text(function.frame).decode() if function.frame != unit.ffi.NULL else "",
            tuple((name, shape[0]) for name, shape in map(array, inputs[1 : function.n_in])),
            tuple(map(array, function.out[0 : function.n_out])),
        )

    @property
    def function(self) -> Any:
        """Pointer to the sym_function, for calls from C. The library stays loaded as long as this object lives."""
        return self._unit.ffi.addressof(self._function)

    @property
    def vectors(self) -> Any:
        """Pointer to the sym_lanes, for calls from C; NULL where there is no code by vectors."""
        return self._unit.ffi.NULL if self._by_vectors is None else self._unit.ffi.addressof(self._by_vectors)

    @property
    def library(self) -> Path | None:
        """The shared library that it lies in; None of one that is interpreted."""
        return self._unit.path

    @property
    def address(self) -> int:
        """Where its code for one state begins, for callers that keep this object."""
        return int(self._unit.ffi.cast("uintptr_t", self._function.eval))

    @property
    def batch_address(self) -> int:
        """Where its code for rows of states begins."""
        return int(self._unit.ffi.cast("uintptr_t", self._function.batch))

    def for_many(self) -> tuple[int, int, CompiledKernel]:
        """(address of the code for rows of `MANY` states and more, doubles of its scratch, what is to be kept)."""
        lanes = self.in_lanes()
        kernel = lanes if lanes.has(SHARED_PARAMETERS) else self
        return kernel.batch_address, kernel.work, kernel

    @property
    def model(self) -> Any:
        """Pointer to the library's sym_model, for calls from C."""
        return self._unit.model

    @property
    def work(self) -> int:
        """Doubles of scratch that one call needs."""
        return int(self._function.work)

    def prepare(self, par: Array) -> Array:
        """The parameter-only part of the work."""
        return self._unit.prepare(par)

    def in_lanes(self, lanes: LaneOptions = SHARED_PARAMETERS) -> CompiledKernel:
        """The kernel vectorised over states, compiled at the first call; this one where there is no vector code."""
        if lanes not in self._lanes:
            make = self._unit.in_lanes
            key = self.signature.name, self.signature.frame
            self._lanes[lanes] = (make(key, lanes) if make is not None else None) or self
        return self._lanes[lanes]

    def run(
        self,
        n: int,
        pre: Array,
        inputs: list[Numbers],
        options: BatchOptions = DEFAULT_OPTIONS,
        places: Sequence[Numbers | None] = (),
    ) -> list[Numbers]:
        """Evaluate n states in C: by vectors if they are many, or wanted in single precision; else one by one."""
        kernel = self._for_many(n, pre, options.precision)
        if kernel is not None:
            return kernel._by_lanes(n, pre, inputs, options, places)
        rows = [np.ascontiguousarray(x, dtype=np.float64) for x in (pre, *inputs)]
        if options.precision == "double" and not options.columns:
            return self._by_rows(n, rows, options.threads, places)
        return [options.of(output) for output in self._by_rows(n, rows, options.threads)]

    def _for_many(self, n: int, pre: Array, precision: Precision = "double") -> CompiledKernel | None:
        """The same by vectors, where a batch is evaluated so."""
        lanes = LaneOptions(len(pre) > 1 and pre.size > 0, precision)
        if n < MANY and not lanes.single:
            return None
        kernel = self.in_lanes(lanes)
        return kernel if kernel.has(lanes) else None

    def _by_lanes(
        self, n: int, pre: Array, inputs: list[Numbers], options: BatchOptions, places: Sequence[Numbers | None]
    ) -> list[Numbers]:
        """Evaluate by vectors of this library; contiguous rows are passed by their addresses, which costs less."""
        if options.precision == "double" and not options.columns and all(x.flags.c_contiguous for x in inputs):
            return self._by_rows(n, [pre, *inputs], options.threads, places)
        return self._in_place(n, pre, inputs, options, places)

    def has(self, lanes: LaneOptions) -> bool:
        """Whether there is code by such vectors in this library."""
        of = self._by_vectors
        return of is not None and (of.bytes == 4) == lanes.single and bool(of.own or not lanes.own_parameters)

    def _by_rows(self, n: int, arrays: list[Array], threads: int, places: Sequence[Numbers | None] = ()) -> list[Array]:
        """Contiguous arrays through `batch`."""
        ffi = self._unit.ffi
        made = zip_longest(places, self.signature.outputs)
        outputs: list[Array] = [np.empty((n, *shape)) if place is None else place for place, (_, shape) in made]
        # from_buffer keeps each array alive for the duration of the call.
        rows_in = [ffi.from_buffer("double[]", x) for x in arrays]
        rows_out = [ffi.from_buffer("double[]", y) for y in outputs]
        strides = [0 if len(x) == 1 else x.shape[1] for x in arrays]
        steps = [math.prod(shape) for _, shape in self.signature.outputs]
        stride = ffi.new("size_t[]", strides)

        def part(first: int, end: int) -> None:
            self._function.batch(
                end - first,
                ffi.new("double *[]", [x + first * by for x, by in zip(rows_in, strides, strict=True)]),
                stride,
                ffi.new("double *[]", [y + first * by for y, by in zip(rows_out, steps, strict=True)]),
                self._own_work(),
            )

        share(n, threads, part)
        return outputs

    def _in_place(
        self, n: int, pre: Array, inputs: list[Numbers], options: BatchOptions, places: Sequence[Numbers | None]
    ) -> list[Numbers]:
        """Arrays as they lie, by vectors."""
        ffi, nowhere = self._unit.ffi, self._unit.nowhere
        sizes = [math.prod(shape) for _, shape in self.signature.outputs]
        flat = [
            options.empty(n, size) if place is None else place.reshape(n, size)
            for place, size in zip_longest(places, sizes)
        ]
        read = [Strided.of(pre, np.float64), *(Strided.of(x, options.dtype) for x in inputs)]
        written = [Strided.of(y, options.dtype) for y in flat]

        def part(first: int, end: int) -> None:
            # An address is given as a pointer to so many bytes from nowhere on.
            arrays = ([(nowhere + at, *by) for at, *by in (x.from_state(first) for x in of)] for of in (read, written))
            from_, to = (ffi.new("sym_strided[]", of) for of in arrays)
            self._by_vectors.batch(end - first, from_, to, self._own_work())

        share(n, options.threads, part)
        # Splits an axis, so that these are views.
        made = zip_longest(places, flat, self.signature.outputs)
        return [y.reshape(n, *shape) if place is None else place for place, y, (_, shape) in made]

    def _own_work(self) -> Any:
        """Scratch memory of the current thread."""
        if self._scratch.work is None:
            self._scratch.work = self._work()
        return self._scratch.work

    def bind(self, pre: Array, inputs: list[Array], outputs: list[Array]) -> Callable[[], None]:
        """The function on fixed memory, for one state. The caller keeps the arrays."""
        return partial(self._function.eval, self._pointers(pre, *inputs), self._pointers(*outputs), self._work())

    def bind_batch(
        self, n: int, pre: Array, inputs: list[Array], outputs: list[Array], threads: int = 1
    ) -> Callable[[], None]:
        """The same for n states, by the code that `run` takes: by vectors in place, else from and to rows."""
        by_vectors = self._for_many(n, pre)
        if by_vectors is not None and not all(x.flags.c_contiguous for x in (*inputs, *outputs)):
            calls = [by_vectors._part_in_place(pre, inputs, outputs, *part) for part in parts(n, threads)]
            return calls[0] if len(calls) == 1 else partial(together, calls)
        read = [np.ascontiguousarray(x) for x in (pre, *inputs)]
        written = [y if y.flags.c_contiguous else np.empty(y.shape) for y in outputs]
        calls = [(by_vectors or self)._part_by_rows(read, written, *part) for part in parts(n, threads)]
        before = [(to, of) for to, of in zip(read[1:], inputs, strict=True) if to is not of]
        after = [(to, of) for to, of in zip(outputs, written, strict=True) if to is not of]
        if not before and not after and len(calls) == 1:
            return calls[0]

        def evaluate() -> None:
            for to, of in before:
                to[...] = of
            together(calls)
            for to, of in after:
                to[...] = of

        return evaluate

    def _part_by_rows(self, read: list[Array], written: list[Array], first: int, end: int) -> Callable[[], None]:
        """States first to end of contiguous arrays, with scratch of its own."""
        ffi = self._unit.ffi
        strides = [0 if len(x) == 1 else x.shape[1] for x in read]
        from_ = [ffi.from_buffer("double[]", x) + first * by for x, by in zip(read, strides, strict=True)]
        to = [ffi.from_buffer("double[]", y) + first * (y.size // len(y)) for y in written]
        pointers = ffi.new("double *[]", from_), ffi.new("size_t[]", strides), ffi.new("double *[]", to)
        return partial(self._function.batch, end - first, *pointers, self._work())

    def _part_in_place(
        self, pre: Array, inputs: list[Array], outputs: list[Array], first: int, end: int
    ) -> Callable[[], None]:
        """The same of arrays as they lie."""
        pointers = [self._strided(of, first) for of in ([pre, *inputs], outputs)]
        return partial(self._by_vectors.batch, end - first, *pointers, self._work())

    def _strided(self, arrays: list[Array], first: int) -> Any:
        """Arrays from a state on, as C takes them; it does not keep them."""
        described = [Strided.of(x, np.float64).from_state(first) for x in arrays]
        # An address is given as a pointer to so many bytes from nowhere on.
        return self._unit.ffi.new("sym_strided[]", [(self._unit.nowhere + at, *by) for at, *by in described])

    def _pointers(self, *arrays: Array) -> Any:
        """A C array of pointers to arrays, which it does not keep alive."""
        ffi = self._unit.ffi
        return ffi.new("double *[]", [ffi.from_buffer("double[]", array) for array in arrays])

    def _work(self) -> Any:
        return self._unit.ffi.new("double[]", max(1, self._function.work))
