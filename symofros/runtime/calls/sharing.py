"""Large batches shared among threads: each evaluates rows of its own, so that no result depends on their number."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial

# States a thread takes at least: waking it takes as long as an arm's equations at a thousand states.
LEAST = 1024

_pools: dict[int, ThreadPoolExecutor] = {}
# A forked process has the pools of its parent, but not their threads.
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_pools.clear)


def share(n: int, threads: int, work: Callable[[int, int], None]) -> None:
    """Call work(first, end) for parts of n rows that cover them all, one part in each thread.

    Args:
        n: Rows.
        threads: Number of threads at most, this one included.
        work: What runs without the interpreter lock for most of its time; what it raises is raised here.
    """
    together([partial(work, first, end) for first, end in parts(n, threads)])


def parts(n: int, threads: int) -> list[tuple[int, int]]:
    """(first, end) of the rows that each thread takes of n."""
    count = max(1, min(threads, n // LEAST))
    bounds = [n * i // count for i in range(count + 1)]
    return list(zip(bounds, bounds[1:], strict=False))


def together(calls: Sequence[Callable[[], object]]) -> None:
    """Run calls concurrently, the first in this thread; their exceptions are raised here."""
    mine, *others = calls
    if not others:
        mine()
        return
    if len(calls) not in _pools:
        _pools[len(calls)] = ThreadPoolExecutor(len(others), thread_name_prefix="symofros")
    running = [_pools[len(calls)].submit(call) for call in others]
    try:
        mine()
    finally:  # The others write into arrays that must not go before they are done.
        for future in running:
            future.result()
