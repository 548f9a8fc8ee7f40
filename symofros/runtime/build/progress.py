"""What is generated and compiled when a function is first asked for: it may take a minute, and says so meanwhile."""

from __future__ import annotations

import logging
import sys
import threading
import time
from types import TracebackType
from typing import Self

from symofros.base.threads import try_to_start

LOGGER = logging.getLogger("symofros")
# What takes less is not worth a line [s].
PATIENCE = 3.0
# Held by the one that has the line on the terminal.
_LINE = threading.Lock()


class Progress:
    """Stages of making one library: reported by the logger "symofros" (INFO), and on a terminal while they last.

    Args:
        model: Name of the model.
        functions: Functions that the library has.
    """

    def __init__(self, model: str, functions: str) -> None:
        self._label = f"{model}: {functions}"
        self._stage = ""
        self._began = 0.0
        self._over = threading.Event()
        self._teller: threading.Thread | None = None

    def begin(self, stage: str) -> None:
        """Enter a stage, such as "compiling"; the first one starts the clock and the progress line."""
        self._stage = stage
        LOGGER.info("%s: %s", self._label, stage)
        if not self._began:
            self._began = time.perf_counter()
            if sys.stderr is not None and sys.stderr.isatty() and _LINE.acquire(blocking=False):
                teller = threading.Thread(target=self._tell, daemon=True)
                if try_to_start(teller):
                    self._teller = teller
                else:
                    _LINE.release()

    def __enter__(self) -> Self:
        """Begin without a report: most libraries are in the cache."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """The library is made, or could not be."""
        self._over.set()
        if self._teller is not None:
            self._teller.join()
            _LINE.release()
        if self._began:
            end = "done" if kind is None else "failed"
            LOGGER.info("%s: %s after %.1f s", self._label, end, time.perf_counter() - self._began)

    def _tell(self) -> None:
        """One line, written over while it lasts, and wiped out at the end."""
        wait, width = PATIENCE, 0
        while not self._over.wait(wait):
            line = f"symofros: {self._label[:60]}: {self._stage}, {time.perf_counter() - self._began:.0f} s"
            width = max(width, len(line))
            sys.stderr.write(f"\r{line:<{width}}")
            sys.stderr.flush()
            wait = 1.0
        if width:
            sys.stderr.write(f"\r{'':<{width}}\r")
            sys.stderr.flush()
