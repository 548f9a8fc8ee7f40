"""Threads that are a convenience: work goes on without them where a process that ends starts no more of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from threading import Thread
from typing import TypeVar

T = TypeVar("T")


def try_to_start(thread: Thread) -> bool:
    """Start a thread; False where the interpreter shuts down and starts none (from Python 3.12 on)."""
    try:
        thread.start()
    except RuntimeError as error:
        if "interpreter shutdown" not in str(error):
            raise
        return False
    return True


def beside_each_other(work: Callable[[T], None], items: Sequence[T]) -> None:
    """Do something with each item, in a thread each; one after another where no threads start.

    Raises:
        BaseException: The first of what `work` raised, after all have ended.
    """
    raised: list[BaseException] = []

    def noted(item: T) -> None:
        try:
            work(item)
        except BaseException as error:  # Raised below, in the caller's thread.
            raised.append(error)

    threads = [Thread(target=noted, args=(item,)) for item in items[1:]]
    started = [(thread, item) for thread, item in zip(threads, items[1:], strict=True) if try_to_start(thread)]
    for item in (*items[:1], *items[1 + len(started) :]):
        noted(item)
    for thread, _ in started:
        thread.join()
    if raised:
        raise raised[0]
