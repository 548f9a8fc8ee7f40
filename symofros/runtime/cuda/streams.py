"""Streams: the one that kernels go into, and graphs that are captured from one."""

from __future__ import annotations

import sys
from typing import Any

from symofros.errors import ArgumentError, SymofrosError
from symofros.runtime.cuda.driver import DEFAULT_STREAM, Driver


def stream_handle(stream: Any) -> int:
    """The driver's handle of a stream: a number, or an object of PyTorch, CuPy or any that has `__cuda_stream__`.

    Args:
        stream: The stream; None is the default stream.

    Raises:
        ArgumentError: It is no stream.
    """
    if stream is None:
        return DEFAULT_STREAM
    handle = stream
    if hasattr(stream, "__cuda_stream__"):
        handle = stream.__cuda_stream__()[1]
    for name in ("cuda_stream", "ptr"):
        handle = getattr(stream, name, handle)
    if isinstance(handle, bool) or not isinstance(handle, int) or handle < 0:
        raise ArgumentError(
            "CUDA: stream is no stream",
            f"{type(stream).__name__} {stream!r:.60}",
            "a stream is its handle, or an object of PyTorch, CuPy or with __cuda_stream__",
            "pass torch.cuda.current_stream(), or leave it out for the default stream",
        )
    return handle or DEFAULT_STREAM


def is_captured(device: Driver, stream: int) -> bool:
    """Whether work in a stream is being captured in a graph instead of running.

    Raises:
        SymofrosError: A graph is captured from another stream, the current one of PyTorch or CuPy, or one that waits
            for the default stream: what is started would run at once, and be no part of the graph.
    """
    other, captures = _capturing_stream(), device.captures(stream)
    if captures is None or (other is not None and other != stream):
        capturing = "another stream" if other is None else f"stream {other:#x}"
        raise SymofrosError(
            "CUDA: a graph is captured from another stream",
            f"{capturing} captures, the call is for {_shown(stream)}",
            "a graph consists of what is started in the stream that it is captured from",
            "pass stream=torch.cuda.current_stream(), or what your library has in its place",
        )
    return captures


def refused_in_capture(what: str, found: str, remedy: str) -> SymofrosError:
    """Error for a call that can't be captured in a graph."""
    rule = "while a graph is captured nothing is allocated, copied from the host or waited for"
    return SymofrosError(f"CUDA: {what} can't be captured in a graph", found, rule, remedy)


def _capturing_stream() -> int | None:
    """The current stream of PyTorch or CuPy where it captures a graph."""
    torch, cupy = (sys.modules.get(name) for name in ("torch", "cupy"))
    if torch is not None and torch.cuda.is_initialized() and torch.cuda.is_current_stream_capturing():
        return int(torch.cuda.current_stream().cuda_stream)
    if cupy is not None:
        current = cupy.cuda.get_current_stream()
        if current.is_capturing():
            return int(current.ptr)
    return None


def _shown(stream: int) -> str:
    return "the default stream" if stream == DEFAULT_STREAM else f"stream {stream:#x}"
