"""Plots of a run of a diagram as panels: their curves and labels."""

from __future__ import annotations

from collections.abc import Sequence

from symofros.diagrams.run.recording import Records
from symofros.diagrams.run.saving import columns
from symofros.diagrams.settings import Plot
from symofros.diagrams.signals import split
from symofros.diagrams.wiring import Wired
from symofros.simulation.results.plots import Panel


def plots_of(wired: Wired) -> list[Plot]:
    """Plots of a diagram: those that it lists, then those of its scopes."""
    plots = list(wired.plots)
    for name, block in wired.blocks.items():
        outputs = [port.name for port in wired.ports[name].outputs]
        for plot in block.shown():
            own = [(name, port) if port in outputs else wired.sources.get((name, port)) for port in plot.signals]
            plots.append(Plot(plot.title or name, tuple(".".join(source) for source in own if source)))
    return [plot for plot in plots if plot.signals]


def panels_of(run: Records, plots: Sequence[Plot]) -> list[Panel]:
    """The panels of plots of a run, one each; their signals are computed together.

    Raises:
        DescriptionError: There is no such signal.
    """
    run.compute([run.compiled.resolved.wired.output(split(text)[0]) for plot in plots for text in plot.signals])
    panels = []
    for plot in plots:
        units = {run.unit(split(text)[0]) for text in plot.signals} - {""}
        curves = {name: run[name] for name in plot.signals} if plot.xy else columns(run, plot.signals)
        curves.pop("t", None)
        panels.append(Panel(", ".join(f"[{unit}]" for unit in sorted(units)), curves, plot.title, plot.xy))
    return panels
