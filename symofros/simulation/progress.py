"""A progress bar over simulated time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from symofros.simulation.user_functions import check_called_with


@contextmanager
def bar(wanted: bool | Callable[[float], None], t0: float, t_end: float) -> Iterator[Callable[[float], None]]:
    """A function that shows how far a run has come; it does nothing unless wanted, or is the caller's own."""
    if callable(wanted):
        check_called_with("simulate: the function of progress", wanted, "t")
        yield wanted
        return
    if not wanted:
        yield lambda t: None
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn  # Only those who look pay for it.

    columns = (BarColumn(), TextColumn("t = {task.completed:.3f} of {task.total:.3f} s"), TimeRemainingColumn())
    with Progress(*columns) as progress:
        task = progress.add_task("", total=t_end)
        progress.update(task, completed=t0)
        yield lambda t: progress.update(task, completed=t)


def pace_of(seconds: float, cost: float) -> str:
    """How many times faster than the clock so many seconds of motion were computed in that time [s]."""
    times = seconds / max(cost, 1e-9)
    return f"{times:.0f} times real time" if times >= 100.0 else f"{times:.3g} times real time"
