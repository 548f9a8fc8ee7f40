"""Plots of runs of models and diagrams, by Matplotlib (the extra `plots`)."""

from __future__ import annotations

import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from symofros.base.arrays import Array
from symofros.base.stored import check_writable, write_atomically
from symofros.errors import SymofrosError, UnknownNameError, did_you_mean
from symofros.runtime.model import Model

MAX_CURVES = 12  # In one panel; more can't be distinguished.
# Matplotlib's ways to draw that have no windows.
_PAPER = ("agg", "cairo", "pdf", "pgf", "ps", "svg", "template")


@dataclass(frozen=True)
class Panel:
    """One panel of a figure: curves over time, or in a plane.

    Attributes:
        label: Label of the vertical axis; over a plane, what both axes measure.
        curves: Name of a curve -> its values (n); over a plane, two columns at least (n, 2).
        title: Above it.
        xy: Whether the second column of each curve is drawn over its first, at one scale, and not over time.
    """

    label: str
    curves: Mapping[str, Array]
    title: str = ""
    xy: bool = False

    def draw(self, t: Array, axis: Any) -> None:
        """Draw the first MAX_CURVES curves over times (n) [s], or in a plane; the title says if there are more."""
        for name, values in list(self.curves.items())[:MAX_CURVES]:
            x, y = (values[:, 0], values[:, 1]) if self.xy else (t, values)
            axis.plot(x, y, label=name)
        left_out = len(self.curves) > MAX_CURVES
        said = f"the first {MAX_CURVES} of {len(self.curves)}; others by their names" if left_out else ""
        axis.set_title(f"{self.title} ({said})" if self.title and said else self.title or said, loc="left")
        axis.set_ylabel(f"y {self.label}" if self.xy else self.label)
        if self.xy:
            axis.set_xlabel(f"x {self.label}")
            axis.set_aspect("equal", adjustable="datalim")
        axis.grid(alpha=0.3)
        axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize="small")


def figure_class() -> Any:
    """Matplotlib's Figure, which needs no window; notebooks show it.

    Raises:
        SymofrosError: Matplotlib is not installed.
    """
    try:
        return import_module("symofros.simulation.results.notebook_figure").NotebookFigure
    except ImportError:
        raise SymofrosError.of_extra(
            "plot: Matplotlib is not installed", "no module matplotlib", "pictures are an extra", "plots"
        ) from None


def draw(t: Array, panels: Sequence[Panel], title: str, figure: Any = None) -> Any:
    """A Matplotlib figure of panels, one below the other; those over time share their axis.

    Args:
        t: Times (n) [s].
        panels: Panels to draw, at least one.
        title: Heading of the figure.
        figure: Figure to draw in; by default one that `savefig` writes.

    Raises:
        SymofrosError: Matplotlib is not installed, or there is nothing to draw.
    """
    if not panels:
        rule, remedy = "a plot shows outputs of blocks", "add a block with an output"
        raise SymofrosError("plot: there is nothing to draw", "no signals", rule, remedy)
    if figure is None:
        figure = figure_class()(figsize=(8.0, 1.0 + 2.2 * len(panels)), layout="constrained")
    axes = figure.subplots(len(panels), 1, squeeze=False)[:, 0]
    over_time = [axis for axis, panel in zip(axes, panels, strict=True) if not panel.xy]
    for axis, panel in zip(axes, panels, strict=True):
        if not panel.xy:
            axis.sharex(over_time[0])
        panel.draw(t, axis)
    for axis in over_time[-1:]:
        axis.set_xlabel("t [s]")
    figure.suptitle(title)
    return figure


def check_picture(path: Path) -> None:
    """Refuse a file that a figure can't be written to; a run is asked before it begins.

    Raises:
        SymofrosError: Matplotlib is not installed, or does not write pictures of this suffix.
        OSError: The file can't be written.
    """
    formats = figure_class()().canvas.get_supported_filetypes()
    if path.suffix[1:].lower() not in formats:
        rule = f"Matplotlib writes {', '.join(sorted(formats))}"
        raise SymofrosError(
            f"plot: can't write '{path.name}'", path.suffix or "no suffix", rule, "choose .png, .svg or .pdf"
        )
    check_writable(path)


def write_picture(figure: Any, path: Path) -> None:
    """Write a figure, whole or not at all; its suffix is one that `check_picture` takes."""
    stream = io.BytesIO()
    figure.savefig(stream, format=path.suffix[1:].lower(), dpi=120)
    write_atomically(path, stream.getvalue())


def check_curves(model: Model, wanted: Iterable[str]) -> None:
    """Refuse names that are none of a model's coordinates, speeds and inputs.

    Raises:
        UnknownNameError: With the nearest name.
    """
    every = [*dict.fromkeys((*model.names.q, *model.names.v, *model.names.u))]
    for name in (name for name in wanted if name not in every):
        rule = "a picture shows coordinates, speeds and inputs by their names"
        missing = f"plot: no coordinate, speed or input '{name}'"
        raise UnknownNameError(missing, ", ".join(every[:12]), rule, did_you_mean(name, every))


def window_figure() -> Any:
    """A figure with a window, which `show_windows` opens.

    Raises:
        SymofrosError: Matplotlib is not installed, or has no screen to draw on.
    """
    figure_class()
    pyplot = import_module("matplotlib.pyplot")
    backend = pyplot.get_backend()
    if backend.lower() in _PAPER:
        raise SymofrosError(
            "plot: no window can be opened",
            f"Matplotlib draws by '{backend}'",
            "a window needs a screen",
            "write a picture: --plot run.png",
        )
    return pyplot.figure(layout="constrained")


def show_windows() -> None:
    """Open the windows, and wait until they are closed."""
    import_module("matplotlib.pyplot").show()
