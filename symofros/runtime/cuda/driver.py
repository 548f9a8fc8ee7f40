"""The driver of graphics processors (libcuda.so.1), which comes with the system, by ctypes."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from functools import cache
from typing import Any

from symofros.errors import SymofrosError

# Attributes of devices: the two numbers of the compute capability.
_MAJOR, _MINOR = 75, 76
# The default stream's handle, as arrays' interfaces and the driver (CU_STREAM_LEGACY) have it.
DEFAULT_STREAM = 1
# An event without times; and what is said of the default stream where a stream that waits for it captures a graph.
_EVENT_WITHOUT_TIMES, _CAPTURED_BESIDE = 2, 906
_REMEDY = "export the kernels (sf.export(system, 'cuda', folder)), or run on a machine that has one"


class Driver:
    """One graphics processor, its primary context shared with PyTorch, JAX and CuPy.

    Args:
        library: The driver's library.

    Attributes:
        ordinal: Number of the processor.

    Raises:
        SymofrosError: There is no such processor.
    """

    ordinal = 0

    def __init__(self, library: ctypes.CDLL) -> None:
        self._library = library
        count, context, self._device = ctypes.c_int(), ctypes.c_void_p(), ctypes.c_int()
        status = library.cuInit(0) or library.cuDeviceGetCount(ctypes.byref(count))
        if status or not count.value:
            raise _absent(f"the driver finds none (error {status})")
        self._check("cuDeviceGet", ctypes.byref(self._device), self.ordinal)
        self._check("cuDevicePrimaryCtxRetain", ctypes.byref(context), self._device)
        self._context = context

    @property
    def name(self) -> str:
        """The processor's name."""
        text = ctypes.create_string_buffer(256)
        self._check("cuDeviceGetName", text, len(text), self._device)
        return text.value.decode(errors="replace")

    @property
    def architecture(self) -> str:
        """The processor's architecture, such as "sm_90"."""
        return f"sm_{self._attribute(_MAJOR)}{self._attribute(_MINOR)}"

    def _attribute(self, which: int) -> int:
        value = ctypes.c_int()
        self._check("cuDeviceGetAttribute", ctypes.byref(value), which, self._device)
        return value.value

    def load(self, image: bytes) -> ctypes.c_void_p:
        """Load machine code; it stays until the process ends."""
        module = ctypes.c_void_p()
        self._call("cuModuleLoadData", ctypes.byref(module), image)
        return module

    def function(self, module: ctypes.c_void_p, name: str) -> ctypes.c_void_p:
        """A kernel of loaded code."""
        function = ctypes.c_void_p()
        self._call("cuModuleGetFunction", ctypes.byref(function), module, name.encode())
        return function

    def launch(
        self,
        function: ctypes.c_void_p,
        threads: int,
        block: int,
        arguments: Sequence[Any],
        stream: int = DEFAULT_STREAM,
    ) -> None:
        """Start a kernel on so many threads, in a stream."""
        addresses = (ctypes.c_void_p * len(arguments))(*(ctypes.addressof(x) for x in arguments))
        blocks = -(-threads // block)
        in_stream = ctypes.c_void_p(stream)
        self._call("cuLaunchKernel", function, blocks, 1, 1, block, 1, 1, 0, in_stream, addresses, None)

    def wait(self, stream: int = DEFAULT_STREAM) -> None:
        """Return when everything that was started in a stream has ended; of the default stream, in all of them."""
        if stream == DEFAULT_STREAM:
            self._call("cuCtxSynchronize")
        else:
            self._call("cuStreamSynchronize", ctypes.c_void_p(stream))

    def order(self, first: int, then: int) -> None:
        """Make later work in stream `then` wait for earlier work in stream `first`."""
        if first == then:
            return
        event = ctypes.c_void_p()
        self._call("cuEventCreate", ctypes.byref(event), _EVENT_WITHOUT_TIMES)
        try:
            self._call("cuEventRecord", event, ctypes.c_void_p(first))
            self._call("cuStreamWaitEvent", ctypes.c_void_p(then), event, 0)
        finally:
            self._call("cuEventDestroy_v2", event)

    def captures(self, stream: int) -> bool | None:
        """Whether a graph is captured from a stream; None of the default one beside a stream that waits for it."""
        status = ctypes.c_int()
        self._check("cuCtxSetCurrent", self._context)
        failed = self._library.cuStreamIsCapturing(ctypes.c_void_p(stream), ctypes.byref(status))
        return None if failed == _CAPTURED_BESIDE else bool(status.value)

    def allocate(self, size: int) -> int:
        """The address of so many bytes of the device's memory."""
        at = ctypes.c_void_p()
        self._call("cuMemAlloc_v2", ctypes.byref(at), ctypes.c_size_t(max(1, size)))
        return at.value or 0

    def free(self, address: int) -> None:
        """Give memory back."""
        self._call("cuMemFree_v2", ctypes.c_void_p(address))

    def write(self, address: int, source: int, size: int) -> None:
        """Copy from the memory of the host; it is there for all streams afterwards."""
        self._call("cuMemcpyHtoD_v2", ctypes.c_void_p(address), ctypes.c_void_p(source), ctypes.c_size_t(size))
        # Of memory that may be paged out, the copy returns when it is staged.
        self._call("cuStreamSynchronize", ctypes.c_void_p(DEFAULT_STREAM))

    def read(self, address: int, target: int, size: int) -> None:
        """Copy device memory to the host, after pending work."""
        self._call("cuMemcpyDtoH_v2", ctypes.c_void_p(target), ctypes.c_void_p(address), ctypes.c_size_t(size))

    def _call(self, name: str, *arguments: Any) -> None:
        """A call in the context, which other libraries may have put aside."""
        self._check("cuCtxSetCurrent", self._context)
        self._check(name, *arguments)

    def _check(self, name: str, *arguments: Any) -> None:
        status = getattr(self._library, name)(*arguments)
        if status:
            text = ctypes.c_char_p()
            self._library.cuGetErrorString(status, ctypes.byref(text))
            raise SymofrosError(
                f"CUDA: {name} failed",
                f"error {status}: {(text.value or b'unknown').decode(errors='replace')}",
                "the driver does what it is asked for",
                "less states at a time where memory ran out; else look at nvidia-smi",
            )


@cache
def driver() -> Driver:
    """The first graphics processor of this machine.

    Raises:
        SymofrosError: There is none, or no driver.
    """
    try:
        library = ctypes.CDLL("libcuda.so.1")
    except OSError:
        raise _absent("no driver: libcuda.so.1 does not load") from None
    return Driver(library)


def _absent(found: str) -> SymofrosError:
    return SymofrosError("CUDA: no graphics processor", found, "kernels run on a graphics processor of NVIDIA", _REMEDY)
