"""Garbage collection in processes of their own: commands and servers."""

from __future__ import annotations

import gc


def collect_rarely() -> None:
    """Leave modules and other long-lived objects out of garbage collection, and look at new ones less often.

    Graphs and documents are large, and hardly have cycles: to look for these took half the time of an edit and a tenth
    of the generator's.
    """
    gc.collect()
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)
