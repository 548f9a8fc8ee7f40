"""Garbage collection while graphs grow, and in processes of their own: commands and servers."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def without_collection() -> Iterator[None]:
    """Look for no cycles meanwhile: a graph of 500,000 nodes has none, and to look took a third of its making."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


def collect_rarely() -> None:
    """Leave modules and other long-lived objects out of garbage collection, and look at new ones less often.

    Graphs and documents are large, and hardly have cycles: to look for these took half the time of an edit and a tenth
    of the generator's.
    """
    gc.collect()
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)
