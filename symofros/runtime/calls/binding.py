"""Hand-written C called from Python: the library of native/, memory that C points to, model functions bound to it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import PurePosixPath
from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.errors import SymofrosError
from symofros.native import HEADERS, amalgamated, native_text
from symofros.runtime.build.prebuilt import machine_library
from symofros.runtime.build.toolchain import DEFAULT_FLAGS
from symofros.runtime.calls.declarations import interface
from symofros.runtime.calls.interpreted import InterpretedFunction
from symofros.runtime.calls.kernel import Array, Kernel
from symofros.runtime.calls.library import CompiledKernel

_ENUMS = (
    "sym_status",
    "sym_method",
    "sym_segment_kind",
    "sym_event_sizes",
    "sym_contact_sizes",
    "sym_instant_kind",
    "sym_instant_sizes",
    "sym_posture_sizes",
    "sym_speed_kind",
)
_FLAGS = (*DEFAULT_FLAGS, "-O3", "-pthread")


@cache
def native_library() -> Any:
    """The integrator of native/, loaded; compiled at the first use on a machine, then taken from the cache.

    Raises:
        CompileError: There is no C compiler, and no library came with the package.
    """
    return interface().dlopen(str(machine_library(native_source(), _FLAGS)))


def native_source() -> str:
    """The integrator's C text: one file, as the cache keeps it; the model's header stays beside it."""
    source = amalgamated("library.c")
    for name in reversed(HEADERS[1:]):
        source = source.replace(f'#include "{PurePosixPath(name).name}"', native_text(name))
    return source


def native_library_is_loaded() -> bool:
    """Whether `native_library` has nothing to wait for."""
    return native_library.cache_info().currsize > 0


@cache
def constants() -> Mapping[str, int]:
    """Name, such as "SYM_FINISHED" -> value of the constants in the enumerations of symofros_stepper.h."""
    ffi = interface()
    return {name: value for enum in _ENUMS for name, value in ffi.typeof(enum).relements.items()}


# Keyed by the type itself, whose name takes NumPy as long as all that is done with it.
_ARRAYS = {
    np.dtype(np.float64): "double[]",
    np.dtype(np.int32): "int32_t[]",
    np.dtype(np.int64): "int64_t[]",
}


class _Lent:
    """Doubles of a memory, as NumPy takes them over; an array made of it keeps it, and so the memory.

    Args:
        memory: What has to live.
        pointer: The doubles.
        size: Number of them.
    """

    def __init__(self, memory: NativeMemory, pointer: Any, size: int) -> None:
        self._memory = memory
        address = int(memory.ffi.cast("uintptr_t", pointer))
        self.__array_interface__ = {
            "data": (address, False),
            "shape": (size,),
            "typestr": np.dtype(np.float64).str,
            "version": 3,
        }


class NativeMemory:
    """Arrays and objects that C holds pointers to. They live as long as this object, which a run keeps."""

    def __init__(self) -> None:
        self.ffi = interface()
        self._kept: list[Any] = []

    def keep(self, thing: Any) -> None:
        """Let a thing live as long as this memory."""
        self._kept.append(thing)

    def doubles(self, values: Any) -> Any:
        """A C array of doubles, a copy of the values in row-major order; of one zero where there are none."""
        array = np.array(values, dtype=np.float64).reshape(-1)
        return self.shared(array if array.size else np.zeros(1))

    def zeros(self, count: int) -> Any:
        """A C array of that many doubles, at least one."""
        return self.shared(np.zeros(max(1, count)))

    def shared(self, values: npt.NDArray[Any]) -> Any:
        """The elements of a contiguous array themselves, as a C array of their type."""
        self._kept.append(values)
        return self.ffi.from_buffer(_ARRAYS[values.dtype], values)

    def table(self, struct: Any, prefix: str, rows: int, **widths: int) -> list[Array]:
        """Arrays (rows, width) behind the pointers `prefix + name` of a struct."""
        array = self.zeros_at(*[(struct, prefix + name, rows * width) for name, width in widths.items()])
        arrays, at = [], 0
        for width in widths.values():
            end = at + rows * width
            arrays.append(array[at:end].reshape(rows, width))
            at = end
        return arrays

    def zeros_at(self, *places: tuple[Any, str, int]) -> Array:
        """Zeros behind pointers of structs, one after the other in one array: struct, name of its field, number."""
        array, at = np.zeros(1 + sum([size for _, _, size in places])), 0
        first = self.shared(array)
        for struct, name, size in places:
            setattr(struct, name, first + at)
            at += size
        return array

    def own(self, kind: str, values: Sequence[Any] | int) -> Any:
        """Owned C array of a type such as "int32_t[]", from values or of a given length; at least one element long."""
        array = self.ffi.new(kind, values or 1)
        self.keep(array)
        return array

    def callback(self, kind: str, function: Any) -> Any:
        """A Python function as a C function pointer of a type; it may not raise."""
        handle = self.ffi.callback(kind, function)
        self.keep(handle)
        return handle

    def view(self, pointer: Any, size: int) -> Array:
        """The doubles behind a pointer (size), not copied; this memory lives as long as the view."""
        return np.asarray(_Lent(self, pointer, size)) if size else np.zeros(0)

    def bytes_at(self, pointer: Any, size: int) -> Any:
        """The doubles behind a pointer (size) as bytes, not copied, to be kept and put back; this memory must live."""
        return self.ffi.buffer(pointer, 8 * size)

    def copy(self, pointer: Any, size: int) -> Array:
        """A copy of the doubles behind a pointer (size)."""
        return np.frombuffer(bytearray(self.bytes_at(pointer, size)), dtype=np.float64) if size else np.zeros(0)

    def raw(self, pointer: Any, kind: str, count: int) -> npt.NDArray[np.uint8]:
        """View of the bytes of `count` structs of a type at a pointer, not copied."""
        size = count * self.ffi.sizeof(kind)
        return np.frombuffer(self.ffi.buffer(pointer, size), dtype=np.uint8) if size else np.zeros(0, dtype=np.uint8)

    def bind(self, call: Any, kernel: Kernel, par: Array, outputs: Mapping[str, Any] | None = None) -> CompiledKernel:
        """Fill a sym_call with a model function, its parameters' part, scratch and outputs; C binds the inputs by name.

        Args:
            call: The sym_call.
            kernel: The function.
            par: Run-time parameters (npar).
            outputs: Name -> C array of outputs that have a place; the others get arrays of their own.

        Returns:
            The kernel, as one that C can call.

        Raises:
            SymofrosError: The function is interpreted.
        """
        compiled = callable_from_c(kernel)
        call.function, call.init = compiled.function, compiled.model.init
        call.pre = self.doubles(compiled.prepare(par.reshape(1, -1)))
        call.work = self.zeros(compiled.work)
        self._place_outputs(call, kernel, outputs or {})
        return compiled

    def bind_interpreted(self, call: Any, kernel: Kernel, par: Array) -> InterpretedFunction:
        """Fill a sym_call with a function that calls back into Python; C binds the inputs by name.

        Args:
            call: The sym_call.
            kernel: The function.
            par: Run-time parameters (npar).
        """
        made = InterpretedFunction(kernel)
        call.function, call.init = made.function, self.ffi.NULL
        call.pre, call.work = self.doubles(made.prepare(par)), self.zeros(1)
        self._place_outputs(call, kernel, {})
        self.keep(made)
        return made

    def _place_outputs(self, call: Any, kernel: Kernel, outputs: Mapping[str, Any]) -> None:
        for i, (name, shape) in enumerate(kernel.signature.outputs):
            call.out[i] = outputs[name] if name in outputs else self.zeros(int(np.prod(shape)))
        self.keep(kernel)


def callable_from_c(kernel: Kernel) -> CompiledKernel:
    """The kernel, if it is compiled.

    Raises:
        SymofrosError: It is interpreted.
    """
    if isinstance(kernel, CompiledKernel):
        return kernel
    raise SymofrosError(
        f"function '{kernel.signature.name}': simulation steps in C",
        "an interpreted model",
        "the integrator calls compiled functions",
        "compile with backend='c'",
    )
