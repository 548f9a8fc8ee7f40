"""Threads that are a convenience: work goes on without them where a process that ends starts no more of them.

What waits in them, as for a compiler, ends where an exception such as that of Ctrl-C leaves the work that began them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar, copy_context
from threading import Lock, Thread
from typing import Any, TypeVar

T = TypeVar("T")


class _Together:
    """What ends each of the waits of one work, which may be in several threads."""

    def __init__(self) -> None:
        self._lock, self._ends, self._over = Lock(), dict[object, Callable[[], None]](), False

    def add(self, key: object, end: Callable[[], None]) -> None:
        with self._lock:
            self._ends[key] = end
        if self._over:
            end()

    def remove(self, key: object) -> None:
        with self._lock:
            self._ends.pop(key, None)

    def end(self) -> None:
        self._over = True
        with self._lock:
            ends = [*self._ends.values()]
        for end in ends:
            end()


_WORK: ContextVar[_Together | None] = ContextVar("_WORK", default=None)


@contextmanager
def ending_together() -> Iterator[Callable[[], None]]:
    """Work that ends in all of its threads where an exception leaves it; gives what ends it.

    Threads belong to it that are started in a copy of its context, as by `submit`.
    """
    work = _Together()
    with ended_by(work.end):
        token = _WORK.set(work)
        try:
            yield work.end
        except BaseException:
            work.end()
            raise
        finally:
            _WORK.reset(token)


@contextmanager
def ended_by(end: Callable[[], None]) -> Iterator[None]:
    """A wait that another thread ends by a call, where the work is over that it belongs to."""
    work, key = _WORK.get(), object()
    if work is None:
        yield
        return
    work.add(key, end)
    try:
        yield
    finally:
        work.remove(key)


def submit(pool: ThreadPoolExecutor, work: Callable[..., T], *arguments: Any) -> Future[T]:
    """Let a pool do a part of the work that goes on."""
    return pool.submit(copy_context().run, work, *arguments)


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
            end()

    with ending_together() as end:
        threads = [Thread(target=copy_context().run, args=(noted, item)) for item in items[1:]]
        started = [(thread, item) for thread, item in zip(threads, items[1:], strict=True) if try_to_start(thread)]
        for item in (*items[:1], *items[1 + len(started) :]):
            noted(item)
        for thread, _ in started:
            thread.join()
    if raised:
        raise raised[0]
