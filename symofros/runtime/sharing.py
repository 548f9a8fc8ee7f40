"""Large batches shared among threads: each evaluates rows of its own, so that no result depends on their number."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

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
        threads: At most; this one is one of them.
        work: What runs without the interpreter lock for most of its time; what it raises is raised here.
    """
    parts = max(1, min(threads, n // LEAST))
    if parts == 1:
        work(0, n)
        return
    bounds = [n * i // parts for i in range(parts + 1)]
    if parts not in _pools:
        _pools[parts] = ThreadPoolExecutor(parts - 1, thread_name_prefix="symofros")
    running = [_pools[parts].submit(work, first, end) for first, end in zip(bounds[1:], bounds[2:], strict=False)]
    try:
        work(0, bounds[1])
    finally:  # The others write into arrays that must not go before they are done.
        for future in running:
            future.result()
