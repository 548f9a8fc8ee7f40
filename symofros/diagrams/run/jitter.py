"""How well a run kept pace with the clock."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.run.recording import Cost
from symofros.errors import SymofrosError
from symofros.simulation.results.plots import figure_class


@dataclass(frozen=True)
class Jitter:
    """How late instants began [s].

    Attributes:
        minimum: The least.
        median: The middle.
        p999: 99.9 of 100 were no later.
        maximum: The worst.
        instants: Number of instants.
        missed: Number of instants that began when the next was due already, or later.
        spacing: Shortest time between two instants.
    """

    minimum: float
    median: float
    p999: float
    maximum: float
    instants: int
    missed: int
    spacing: float

    def __str__(self) -> str:
        """Human-readable summary: lateness of instants [microseconds], and number of missed ones."""
        values = (self.minimum, self.median, self.p999, self.maximum)
        least, middle, most, worst = (f"{1e6 * value:.1f}" for value in values)
        return (
            f"{self.instants} instants began late by: least {least}, median {middle}, 99.9 % {most}, worst {worst}"
            f" microseconds; {self.missed} missed the next instant, {1e3 * self.spacing:g} ms later"
        )


def jitter_of(cost: Cost) -> Jitter:
    """The jitter of a run that kept pace.

    Raises:
        SymofrosError: The run did not keep pace.
    """
    late = cost.late
    if not late.size:
        raise SymofrosError(
            "jitter: no instants were timed", "0", "a run in real time times its instants", "run with realtime=True"
        )
    missed = int(np.sum(late >= cost.spacing))
    low, middle, high, worst = (float(value) for value in np.quantile(late, [0.0, 0.5, 0.999, 1.0]))
    return Jitter(low, middle, high, worst, len(late), missed, cost.spacing)


def histogram(late: Array, title: str = "") -> Any:
    """A Matplotlib figure: how many instants began how late, both on scales of powers of ten.

    Args:
        late: Lateness of each instant (n) [s].
        title: Above it.

    Raises:
        SymofrosError: Matplotlib is not installed.
    """
    figure = figure_class()(figsize=(8.0, 4.0), layout="constrained")
    axis = figure.subplots()
    microseconds = np.maximum(1e6 * late, 1e-2)
    low, high = np.floor(np.log10(microseconds.min())), np.ceil(np.log10(microseconds.max()) + 1e-9)
    axis.hist(microseconds, bins=np.logspace(low, max(high, low + 1), 81), color="tab:blue")
    heights = {"median": 0.5, "99.9 %": 0.999, "worst": 1.0}
    for (name, share), color in zip(heights.items(), ("tab:green", "tab:orange", "tab:red"), strict=True):
        at = float(np.quantile(microseconds, share))
        axis.axvline(at, color=color, label=f"{name}: {at:.3g} us")
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel("an instant began late by [us]")
    axis.set_ylabel("instants")
    axis.set_title(title)
    axis.grid(alpha=0.3)
    axis.legend()
    return figure
