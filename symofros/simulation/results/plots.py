"""Pictures of a trajectory, by Matplotlib (the extra `plots`)."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

from symofros.base.arrays import Array
from symofros.errors import Problem, SymofrosError

MOST_CURVES = 12  # In one panel; more can't be distinguished.


def figure_class() -> Any:
    """Matplotlib's Figure, which needs no window; notebooks show it.

    Raises:
        SymofrosError: Matplotlib is not installed.
    """
    try:
        return import_module("symofros.simulation.results.notebook_figure").NotebookFigure
    except ImportError:
        missing = Problem.of_extra(
            "plot: Matplotlib is not installed", "no module matplotlib", "pictures are an extra", "plots"
        )
        raise SymofrosError(missing) from None


def draw(t: Array, panels: Mapping[str, Mapping[str, Array]], title: str) -> Any:
    """A Matplotlib figure of panels, one below the other, over one axis of time.

    Args:
        t: Times (n) [s].
        panels: Label of the vertical axis -> name of a curve -> values (n).
        title: Heading of the figure.

    Raises:
        SymofrosError: Matplotlib is not installed.
    """
    figure = figure_class()(figsize=(8.0, 2.2 * len(panels)), layout="constrained")
    axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    for axis, (label, curves) in zip(axes, panels.items(), strict=True):
        for name, values in list(curves.items())[:MOST_CURVES]:
            axis.plot(t, values, label=name)
        if len(curves) > MOST_CURVES:
            axis.set_title(f"the first {MOST_CURVES} of {len(curves)}; others by their names", fontsize="small")
        axis.set_ylabel(label)
        axis.grid(alpha=0.3)
        axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize="small")
    axes[-1].set_xlabel("t [s]")
    figure.suptitle(title)
    return figure
