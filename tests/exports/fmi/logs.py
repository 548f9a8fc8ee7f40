"""What units say, by way of FMPy."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from fmpy import fmi2

# Said by units of FMI 2 that were given no logger of their own, after one that was.
lasting_log: list[str] = []
_LASTING = fmi2.fmi2CallbackLoggerTYPE(lambda *given: lasting_log.append(given[-1].decode()))


@contextmanager
def heard() -> Iterator[tuple[Callable[..., None], list[str]]]:
    """A logger to hand to FMPy, and the messages that it gets.

    FMPy 0.3.32 holds one logger for all units of FMI 2 in a process, the pointer `s_logger` in its logging.so, which
    `addLoggerProxy` points at the logger of the latest unit that was given one, and nothing sets back. When that logger
    is collected, the next message of a unit without its own, as of a step that is refused, is a call of freed memory
    and ends in a segmentation fault; hence one that is never collected takes its place here.
    """
    log: list[str] = []

    def logger(*given: Any) -> None:
        log.append(" ".join(x.decode() if isinstance(x, bytes) else str(x) for x in given))

    try:
        yield logger, log
    finally:
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = _LASTING
        if hasattr(fmi2, "addLoggerProxy"):  # FMPy has no such library for some machines, and no proxy there.
            fmi2.addLoggerProxy(ctypes.byref(callbacks))
