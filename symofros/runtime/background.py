"""Functions that a C compiler makes in another process, while their model answers on tape."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
from collections.abc import Callable, Sequence
from typing import Any

_CHILD = "from symofros.runtime.background import compile_received; compile_received()"


class BackgroundCompilation:
    """Compilations that fill the cache for the next model of one description.

    A process that has been started ends by itself: one whose parent is gone first still fills the cache.

    Args:
        origin: Makes the model (`Functions`) whose functions are compiled.
    """

    def __init__(self, origin: Callable[[], Any]) -> None:
        self.origin = origin
        self.keys: list[tuple[str, str]] = []
        self._processes: list[subprocess.Popen[bytes]] = []

    def start(self, keys: Sequence[tuple[str, str]]) -> None:
        """Compile functions that are generated together."""
        self.keys += keys
        # The description goes through a pipe of our own: nobody else can have written what is loaded.
        path = json.dumps(sys.path)
        child = f"import json, sys; sys.path[:] = json.loads({path!r}); {_CHILD}"
        process = subprocess.Popen(
            [sys.executable, "-c", child],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        assert process.stdin is not None
        process.stdin.write(pickle.dumps((self.origin, list(keys))))
        process.stdin.close()
        self._processes.append(process)

    @property
    def is_running(self) -> bool:
        """Whether something is being compiled."""
        return any(process.poll() is None for process in self._processes)

    def wait(self) -> None:
        """Wait for what is being compiled. A failure is raised when the same is compiled again."""
        for process in self._processes:
            process.wait()


def compile_received() -> None:
    """The other process: compile what standard input asks for."""
    origin, keys = pickle.load(sys.stdin.buffer)
    model = origin()
    for name, frame in keys:
        model.kernel(name, frame)
