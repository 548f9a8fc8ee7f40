"""Arrays of the caller's that receive the results of kernels: what they must be for each number to be written once."""

from __future__ import annotations

from collections.abc import Mapping
from math import prod
from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import share_memory
from symofros.errors import ShapeError, UnknownNameError, did_you_mean
from symofros.runtime.cuda.arrays import DeviceArray, Placed, Strided, interface_of, lies_on_device, placed
from symofros.runtime.cuda.driver import DEFAULT_STREAM, Driver

Shape = tuple[int, ...]


def receivers(
    name: str,
    shapes: Mapping[str, Shape],
    out: Mapping[str, Any],
    inputs: Mapping[str, Placed],
    dtype: npt.DTypeLike,
    driver: Driver,
    stream: int = DEFAULT_STREAM,
    captured: bool = False,
) -> dict[str, Strided]:
    """The arrays to write into, as kernels take them, by output.

    Args:
        name: Function, for messages.
        shapes: Shape (n, ...) of each output.
        out: Arrays of the device by output; what is left out is allocated by the caller.
        inputs: Arrays that are read.
        dtype: Type of the numbers.
        driver: Driver of the device.
        stream: Stream of the kernels.
        captured: Whether a graph is captured from it.

    Raises:
        UnknownNameError: There is no such output.
        ShapeError: An array is none of the device, does not fit, can't be written, or shares memory with another one or
            with itself.
    """
    if not isinstance(out, Mapping):
        remedy = f"write out={{'{next(iter(shapes))}': array}}"
        raise ShapeError("CUDA: out is no mapping", type(out).__name__, "out maps outputs to arrays", remedy)
    for label, array in out.items():
        if label not in shapes:
            hint = did_you_mean(label, shapes) or "leave it out"
            raise UnknownNameError(f"CUDA: {name} has no output '{label}'", label, ", ".join(shapes), hint)
        _check_writeable(label, array)
    places = {label: placed(label, array, dtype, driver, stream, captured) for label, array in out.items()}
    batches = {label: strided_result(label, place, shapes[label]) for label, place in places.items()}
    kind = np.dtype(dtype)
    others = {other: (read, _bounds(read, kind)) for other, read in inputs.items()} if places else {}
    for label, place in sorted(places.items()):
        if _overlaps_itself(place):
            raise _shared(label, "with itself: entries of it have one place")
        start, end = _bounds(place, kind)
        for other, (array, (other_start, other_end)) in others.items():
            if start < other_end and other_start < end and share_memory(_outline(place, kind), _outline(array, kind)):
                raise _shared(label, f"with {other}")
        others[label] = place, (start, end)
    return batches


def strided_result(label: str, array: Placed, shape: Shape) -> Strided:
    """A result array as kernels take it: its address, and the distances of its entries and of its rows.

    Raises:
        ShapeError: It has another shape or layout.
    """
    even = all(
        array.strides[k] == array.strides[k + 1] * array.shape[k + 1] or array.shape[k] == 1
        for k in range(1, len(array.shape) - 1)
    )
    if array.shape != shape or not even:
        raise ShapeError(
            f"CUDA: {label} has the wrong shape",
            str(array.shape),
            f"{label} has shape {shape}, its entries at equal distances",
            "reshape it",
        )
    entry = array.strides[-1] if len(shape) > 1 and prod(shape[1:]) > 1 else 1
    return Strided(array.address, entry, array.strides[0])


def _check_writeable(label: str, array: Any) -> None:
    if isinstance(array, DeviceArray):
        return
    if not lies_on_device(label, array):
        raise ShapeError(
            f"CUDA: {label} does not lie on the device",
            f"an object of type {type(array).__name__}",
            "results are written into arrays of the device",
            "leave it out, and call .numpy() on the result",
        )
    interface = interface_of(label, array)
    if interface is not None and interface["data"][1]:
        raise ShapeError(
            f"CUDA: {label} is read only", "an array that refuses writing", "results are written", "copy it"
        )


def _overlaps_itself(array: Placed) -> bool:
    """Whether two entries may have one place: strides do not nest, as those of broadcast arrays."""
    reach = 0
    axes = zip(array.strides, array.shape, strict=True)
    for stride, size in sorted((abs(stride), size) for stride, size in axes if size > 1):
        if stride <= reach:
            return prod(array.shape) > 0
        reach += (size - 1) * stride
    return False


def _bounds(array: Placed, dtype: np.dtype[Any]) -> tuple[int, int]:
    """Addresses of the first byte of an array and of that after its last one."""
    if 0 in array.shape:
        return array.address, array.address
    reaches = [dtype.itemsize * stride * (size - 1) for stride, size in zip(array.strides, array.shape, strict=True)]
    lowest = array.address + sum(reach for reach in reaches if reach < 0)
    return lowest, lowest + sum(map(abs, reaches)) + dtype.itemsize


def _outline(array: Placed, dtype: np.dtype[Any]) -> npt.NDArray[Any]:
    """An array at addresses of the device, for questions about its layout alone: nothing may read it."""
    strides = tuple(dtype.itemsize * stride for stride in array.strides)

    class _Outline:
        __array_interface__ = {
            "shape": array.shape,
            "typestr": dtype.str,
            "data": (array.address, False),
            "strides": strides,
            "version": 3,
        }

    return np.asarray(_Outline())


def _shared(label: str, what: str) -> ShapeError:
    return ShapeError(
        f"CUDA: {label} shares memory",
        what,
        "an output shares no memory with another array: each is written while others are read",
        "pass an array, or a copy, of its own",
    )
