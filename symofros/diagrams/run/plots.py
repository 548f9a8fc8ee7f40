"""Pictures of a run of a diagram, by Matplotlib (the extra `plots`)."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any

from symofros.diagrams.run.recording import Recording
from symofros.diagrams.run.saving import columns
from symofros.diagrams.settings import Plot
from symofros.diagrams.signals import split
from symofros.diagrams.wiring import Wired
from symofros.errors import Problem, SymofrosError
from symofros.simulation.results.plots import figure_class

# Matplotlib's ways to draw that have no windows.
_PAPER = ("agg", "cairo", "pdf", "pgf", "ps", "svg", "template")
_MOST = 12  # Curves in one picture; more can't be distinguished.


def plots_of(wired: Wired) -> list[Plot]:
    """What a diagram asks to be shown: what it lists, then its scopes."""
    plots = list(wired.plots)
    for name, block in wired.blocks.items():
        outputs = [port.name for port in wired.ports[name].outputs]
        for plot in block.shown():
            own = [(name, port) if port in outputs else wired.sources.get((name, port)) for port in plot.signals]
            plots.append(Plot(plot.title or name, tuple(".".join(source) for source in own if source)))
    return [plot for plot in plots if plot.signals]


def draw(run: Recording, plots: Sequence[Plot], figure: Any = None) -> Any:
    """A Matplotlib figure with a diagram below the other for each plot, over one axis of time.

    Args:
        run: Run to show.
        plots: Plots to draw, at least one.
        figure: Figure to draw in; by default one that `savefig` writes.

    Raises:
        SymofrosError: Matplotlib is not installed, or there is no such signal.
    """
    if not plots:
        raise SymofrosError(
            Problem(
                "plot: there is nothing to draw",
                "no signals",
                "a plot shows outputs of blocks",
                "add a block with an output",
            )
        )
    if figure is None:
        figure = figure_class()(figsize=(8.0, 1.0 + 2.2 * len(plots)), layout="constrained")
    run.compute([run.compiled.resolved.wired.output(split(text)[0]) for plot in plots for text in plot.signals])
    grid = figure.subplots(len(plots), 1, squeeze=False)[:, 0]
    over_time = [axis for axis, plot in zip(grid, plots, strict=True) if not plot.xy]
    for axis, plot in zip(grid, plots, strict=True):
        if plot.xy:
            _draw_plane(run, plot, axis)
        else:
            axis.sharex(over_time[0])
            _draw_over_time(run, plot, axis)
        axis.grid(alpha=0.3)
        axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize="small")
    for axis in over_time[-1:]:
        axis.set_xlabel("t [s]")
    figure.suptitle(f"{run.compiled.resolved.wired.name}: {run.outcome.kind} at t = {run.outcome.t:.4g} s")
    return figure


def _draw_over_time(run: Recording, plot: Plot, axis: Any) -> None:
    """All entries of the signals over time."""
    shown = columns(run, plot.signals)
    for name in list(shown)[1 : _MOST + 1]:
        axis.plot(run.t, shown[name], label=name)
    left_out = len(shown) - 1 - _MOST
    axis.set_title(plot.title + (f" (first {_MOST} of {len(shown) - 1})" if left_out > 0 else ""), loc="left")
    axis.set_ylabel(_units(run, plot))


def _draw_plane(run: Recording, plot: Plot, axis: Any) -> None:
    """The second entry of each signal over its first."""
    for name in plot.signals[:_MOST]:
        values = run[name]
        axis.plot(values[:, 0], values[:, 1], label=name)
    axis.set_title(plot.title, loc="left")
    axis.set_xlabel(f"x {_units(run, plot)}")
    axis.set_ylabel(f"y {_units(run, plot)}")
    axis.set_aspect("equal", adjustable="datalim")


def _units(run: Recording, plot: Plot) -> str:
    units = {run.unit(split(text)[0]) for text in plot.signals} - {""}
    return ", ".join(f"[{unit}]" for unit in sorted(units))


def window_figure() -> Any:
    """A figure in a window, which `show_windows` opens.

    Raises:
        SymofrosError: Matplotlib is not installed, or has no screen to draw on.
    """
    figure_class()
    pyplot = import_module("matplotlib.pyplot")
    backend = pyplot.get_backend()
    if backend.lower() in _PAPER:
        raise SymofrosError(
            Problem(
                "plot: no window can be opened",
                f"Matplotlib draws by '{backend}'",
                "a window needs a screen",
                "write a picture: --plot run.png",
            )
        )
    return pyplot.figure(layout="constrained")


def show_windows() -> None:
    """Open the windows, and wait until they are closed."""
    import_module("matplotlib.pyplot").show()
