"""Arrays in the memory of a graphics processor: our own, and other libraries' in place.

Others take ours by `__cuda_array_interface__` (CuPy, PyTorch, JAX, Numba). Theirs come by DLPack, whose producer makes
our stream wait for what still writes them, or where they have none by that interface, whose stream is waited for.
"""

from __future__ import annotations

import ctypes
import weakref
from contextlib import suppress
from dataclasses import dataclass
from math import prod
from typing import Any, NoReturn

import numpy as np
import numpy.typing as npt

from symofros.errors import ShapeError, SymofrosError
from symofros.runtime.cuda.driver import DEFAULT_STREAM, Driver

_CUDA, _FLOAT = 2, 2
_NUMBERS = {0: "int", 1: "uint", 2: "float", 4: "bfloat", 5: "complex", 6: "bool"}


class Strided(ctypes.Structure):
    """A batch as kernels take it: sym_strided of native/cuda/kernels.cu.in."""

    _fields_ = (("at", ctypes.c_void_p), ("step", ctypes.c_ssize_t), ("stride", ctypes.c_ssize_t))


class StridedSequence(ctypes.Structure):
    """Records of a batch: sym_sequence of native/cuda/rollout.cu.in."""

    _fields_ = (("batch", Strided), ("next", ctypes.c_ssize_t))


class DeviceArray:
    """An array in the device's memory, freed with it; `numpy()` copies it to the host.

    Args:
        driver: Driver of the device.
        shape: Shape (n, ...), or (records, n, ...), whose states lie side by side.
        dtype: float64 or float32.
        batch: Axis of the states.

    Attributes:
        shape: Shape.
        strides: Distances of entries along each axis [bytes].
        dtype: Type of its numbers.
        stream: Stream whose end its numbers are there at; None where they are there.
    """

    def __init__(self, driver: Driver, shape: tuple[int, ...], dtype: npt.DTypeLike, batch: int = 0) -> None:
        self._driver, self.shape, self.dtype = driver, shape, np.dtype(dtype)
        memory = [*(size for k, size in enumerate(shape) if k != batch), shape[batch]]
        strides = [prod(memory[k + 1 :]) * self.dtype.itemsize for k in range(len(memory))]
        self.strides = (*strides[:batch], strides[-1], *strides[batch:-1])
        self.address = driver.allocate(prod(shape) * self.dtype.itemsize)
        self.stream: int | None = None
        # At the end of the process the driver gives all memory back.
        weakref.finalize(self, _free, driver, self.address).atexit = False

    def __reduce_ex__(self, protocol: Any) -> NoReturn:
        """Neither copied nor pickled: it is the one that frees its memory.

        Raises:
            SymofrosError: Always.
        """
        what, rule = "CUDA: an array of the device is not copied or pickled", "its memory has one owner"
        raise SymofrosError(what, f"a DeviceArray of shape {self.shape}", rule, "take .numpy() of it")

    @property
    def __cuda_array_interface__(self) -> dict[str, Any]:
        """What other libraries read it by, in place, with the stream that it is ready in."""
        return {
            "shape": self.shape,
            "typestr": self.dtype.str,
            "data": (self.address, False),
            "strides": self.strides,
            "version": 3,
            "stream": self.stream or DEFAULT_STREAM,
        }

    def numpy(self) -> npt.NDArray[Any]:
        """A copy in the memory of the host, in the same layout."""
        host = np.empty(prod(self.shape), self.dtype)
        if self.stream not in (None, DEFAULT_STREAM):
            self._driver.wait(self.stream)
        self._driver.read(self.address, host.ctypes.data, host.nbytes)
        return np.lib.stride_tricks.as_strided(host, self.shape, self.strides)

    def write(self, values: npt.NDArray[Any]) -> None:
        """Copy an array of its shape from the host."""
        host = np.empty(prod(self.shape), self.dtype)
        np.lib.stride_tricks.as_strided(host, self.shape, self.strides)[...] = values
        self._driver.write(self.address, host.ctypes.data, host.nbytes)


@dataclass(frozen=True)
class Placed:
    """An array of anybody's in the device's memory.

    Attributes:
        address: Address of its first entry.
        shape: Shape.
        strides: Distances along each axis, in numbers.
        owner: Object that keeps the memory.
    """

    address: int
    shape: tuple[int, ...]
    strides: tuple[int, ...]
    owner: Any


class _DLTensor(ctypes.Structure):
    _fields_ = (
        ("data", ctypes.c_void_p),
        ("device_type", ctypes.c_int32),
        ("device_id", ctypes.c_int32),
        ("ndim", ctypes.c_int32),
        ("code", ctypes.c_uint8),
        ("bits", ctypes.c_uint8),
        ("lanes", ctypes.c_uint16),
        ("shape", ctypes.POINTER(ctypes.c_int64)),
        ("strides", ctypes.POINTER(ctypes.c_int64)),
        ("byte_offset", ctypes.c_uint64),
    )


def placed(
    name: str, array: Any, dtype: npt.DTypeLike, driver: Driver, stream: int = DEFAULT_STREAM, captured: bool = False
) -> Placed:
    """An array where it lies, or a copy on the device of one of the host.

    Args:
        name: Name for messages.
        array: What has `__cuda_array_interface__` or `__dlpack__` on the device, or what NumPy reads.
        dtype: Type that it must have on the device; numbers of the host are converted.
        driver: Driver of the device.
        stream: Stream of the kernels, which waits for what writes the array.
        captured: Whether a graph is captured from it: other streams can't be waited for.

    Raises:
        ShapeError: It is of another type or on another device, or its library does not give it.
    """
    wanted = np.dtype(dtype)
    if isinstance(array, DeviceArray) and array.dtype == wanted:
        if array.stream is not None and not captured:
            driver.order(array.stream, stream)
        return Placed(array.address, array.shape, tuple(x // wanted.itemsize for x in array.strides), array)
    kind, ordinal = map(int, array.__dlpack_device__()) if hasattr(array, "__dlpack_device__") else (0, 0)
    if kind == _CUDA and ordinal != driver.ordinal:
        raise _unfit(name, f"an array on graphics processor {ordinal}; the kernels are on {driver.ordinal}", wanted)
    if kind == _CUDA:
        return _of_dlpack(name, _exchanged(name, array, stream), wanted)
    interface = interface_of(name, array)
    if interface is not None:
        if np.dtype(interface["typestr"]) != wanted:
            raise _unfit(name, interface["typestr"], wanted)
        if interface.get("stream") is not None and not captured:
            driver.order(int(interface["stream"]), stream)
        shape = tuple(interface["shape"])
        stated = interface.get("strides")
        strides = tuple(x // wanted.itemsize for x in stated) if stated is not None else _compact(shape)
        return Placed(interface["data"][0], shape, strides, array)
    host = np.asarray(array, dtype=wanted)
    device = DeviceArray(driver, host.shape or (1,), wanted)
    device.write(host)
    return Placed(device.address, host.shape, tuple(x // wanted.itemsize for x in device.strides[: host.ndim]), device)


def lies_on_device(name: str, array: Any) -> bool:
    """Whether an array says that it lies in the memory of a graphics processor."""
    if hasattr(array, "__dlpack_device__") and int(array.__dlpack_device__()[0]) == _CUDA:
        return True
    return interface_of(name, array) is not None


def interface_of(name: str, array: Any) -> dict[str, Any] | None:
    """The `__cuda_array_interface__` of an array; None of one without.

    Raises:
        ShapeError: Its library does not give it.
    """
    try:
        found = getattr(array, "__cuda_array_interface__", None)
    except Exception as error:  # PyTorch's RuntimeError of a tensor that requires a gradient, and others' of their own.
        raise _withheld(name, array, error) from error
    return found if isinstance(found, dict) else None


def _exchanged(name: str, array: Any, stream: int) -> Any:
    """The capsule of an array, which a stream of ours waits for."""
    try:
        return array.__dlpack__(stream=stream)
    except Exception as error:  # What libraries raise is their own choice.
        raise _withheld(name, array, error) from error


def _free(driver: Driver, address: int) -> None:
    with suppress(SymofrosError):
        driver.free(address)


def _of_dlpack(name: str, capsule: Any, wanted: np.dtype[Any]) -> Placed:
    """The array of a capsule, which frees its memory when nobody holds it."""
    pointer = ctypes.pythonapi.PyCapsule_GetPointer
    pointer.restype, pointer.argtypes = ctypes.c_void_p, (ctypes.py_object, ctypes.c_char_p)
    tensor = ctypes.cast(pointer(capsule, b"dltensor"), ctypes.POINTER(_DLTensor)).contents
    if tensor.device_type != _CUDA:
        raise _unfit(name, f"an array on device {tensor.device_type} of DLPack", wanted)
    if (tensor.code, tensor.bits, tensor.lanes) != (_FLOAT, 8 * wanted.itemsize, 1):
        raise _unfit(name, f"{_NUMBERS.get(tensor.code, f'type {tensor.code} of ')}{tensor.bits}", wanted)
    shape = tuple(tensor.shape[k] for k in range(tensor.ndim))
    strides = tuple(tensor.strides[k] for k in range(tensor.ndim)) if tensor.strides else _compact(shape)
    return Placed((tensor.data or 0) + tensor.byte_offset, shape, strides, capsule)


def _compact(shape: tuple[int, ...]) -> tuple[int, ...]:
    return tuple(prod(shape[k + 1 :]) for k in range(len(shape)))


def _unfit(name: str, found: str, wanted: np.dtype[Any]) -> ShapeError:
    return ShapeError(
        f"CUDA: {name} is not an array of {wanted} on the device",
        found,
        "arrays of the device are read in place, in the precision of the kernels",
        "convert it before, or take kernels of the other precision: model.cuda('single')",
    )


def _withheld(name: str, array: Any, error: Exception) -> ShapeError:
    return ShapeError(
        f"CUDA: {name} is not given by its library",
        f"{type(array).__module__}.{type(array).__name__}: {error!s:.160}",
        "arrays are read in place, without derivatives, while they exist",
        "pass tensor.detach() of one that requires a gradient; symofros.interop.torch and .jax differentiate",
    )
