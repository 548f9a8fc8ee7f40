"""A run of a diagram, with the ways to show it and to write it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from symofros.base.arguments import checked
from symofros.diagrams.run.plots import draw, plots_of, show_windows, window_figure
from symofros.diagrams.run.recording import Recording
from symofros.diagrams.run.saving import save_run
from symofros.diagrams.settings import Plot


class DiagramRun(Recording):
    """A recording that can be plotted and saved."""

    @checked
    def save(self, path: str | Path, *signals: str) -> list[Path]:
        """Write signals, "block.port" or "block.port[i]"; all by default: .npz (arrays), .csv or .parquet (columns).

        Raises:
            SymofrosError: As `save_run`.
        """
        return save_run(self, Path(path), signals)

    def plot(self, *signals: str, figure: Any = None) -> Any:
        """A Matplotlib figure of signals; by default what the diagram asks to be shown, or else every output.

        Raises:
            SymofrosError: Matplotlib is not installed, or there is no such signal.
        """
        wired = self.compiled.resolved.wired
        return draw(self, [Plot(s, (s,)) for s in signals] or plots_of(wired) or [Plot(s, (s,)) for s in self], figure)

    def show(self, *signals: str) -> None:
        """Draw signals, as `plot` does, in a window, and wait until it is closed.

        Raises:
            SymofrosError: Matplotlib is not installed, or has no screen to draw on.
        """
        self.plot(*signals, figure=window_figure())
        show_windows()
