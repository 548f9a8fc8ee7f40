"""Threads that are a convenience: work goes on without them where a process that ends starts no more of them."""

from __future__ import annotations

from threading import Thread


def try_to_start(thread: Thread) -> bool:
    """Start a thread; False where the interpreter shuts down and starts none (from Python 3.12 on)."""
    try:
        thread.start()
    except RuntimeError as error:
        if "interpreter shutdown" not in str(error):
            raise
        return False
    return True
