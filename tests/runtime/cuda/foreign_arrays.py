"""Arrays of other libraries, as they give them; their memory is the host's."""

from __future__ import annotations

import ctypes

import numpy as np


class OnDevice:
    """An array of another library, in place."""

    def __init__(self, array: np.ndarray) -> None:
        self.array = array
        self.__cuda_array_interface__ = {
            "shape": array.shape,
            "typestr": array.dtype.str,
            "data": (array.ctypes.data, False),
            "strides": array.strides,
            "version": 3,
        }


class Exchanged:
    """An array of another library, by DLPack; NumPy's, said to be of the device."""

    def __init__(self, array: np.ndarray, device_type: int = 2, ordinal: int = 0) -> None:
        self.array, self.device_type, self.ordinal = array, device_type, ordinal

    def __dlpack_device__(self) -> tuple[int, int]:
        return 2, self.ordinal

    def __dlpack__(self, stream: int) -> object:
        self.asked = stream
        capsule = self.array.__dlpack__()
        pointer = ctypes.pythonapi.PyCapsule_GetPointer
        pointer.restype, pointer.argtypes = ctypes.c_void_p, (ctypes.py_object, ctypes.c_char_p)
        ctypes.c_int32.from_address(pointer(capsule, b"dltensor") + 8).value = self.device_type
        return capsule


class WithGradient:
    """A tensor of PyTorch that requires a gradient."""

    @property
    def __cuda_array_interface__(self) -> object:
        raise RuntimeError("Can't get __cuda_array_interface__ on Variable that requires grad.")


class WithGradientExchanged(WithGradient):
    def __dlpack_device__(self) -> tuple[int, int]:
        return 2, 0

    def __dlpack__(self, stream: int) -> object:
        raise BufferError("Can't export tensors that require gradient, use tensor.detach()")


def states(n: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    return rng.uniform(-3, 3, (n, 2)), rng.standard_normal((n, 2))


# Three states of two joints.
STATES = {"q": np.zeros((3, 2)), "v": np.zeros((3, 2))}
