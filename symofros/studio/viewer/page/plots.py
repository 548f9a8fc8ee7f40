"""Plots beside the picture: signals over time, of which a click moves the time, and section forces over a span."""

from __future__ import annotations

import html
import json
from collections.abc import Sequence
from importlib import import_module
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.simulation.results.section_forces import COMPONENTS, SectionForces
from symofros.simulation.results.trajectory import Trajectory
from symofros.studio.viewer.playing.signals import Signal

_POINTS = 500  # Of a curve; a panel has fewer pixels.


class SignalPlot:
    """A plot of one of the signals, chosen in the panel.

    Args:
        gui: Panel of viser.
        signals: Signals of the motion.
    """

    def __init__(self, gui: Any, signals: Sequence[Signal]) -> None:
        self.choices = {signal.name: signal for signal in signals}
        with gui.add_folder("Plot", expand_by_default=False):
            chosen = gui.add_dropdown("over time", (_NOTHING, *self.choices), initial_value=_NOTHING)
            self._plot = gui.add_html("", visible=False)
        chosen.on_update(lambda event: self.choose(event.target.value))

    def choose(self, name: str) -> None:
        """Show a signal by its name, or nothing."""
        signal = self.choices.get(name)
        self._plot.content = "" if signal is None else plot_html(signal)
        self._plot.visible = signal is not None


def plot_html(signal: Signal) -> str:
    """A signal as the page's script plots it."""
    t = signal.t
    if len(t) > _POINTS:
        t = np.linspace(t[0], t[-1], _POINTS)
    values = signal.at(t) if t is not signal.t else signal.values
    curves = [{"name": name, "values": rounded(column)} for name, column in zip(signal.curves, values.T, strict=True)]
    data = json.dumps({"name": signal.name, "t": rounded(t), "curves": curves}, separators=(",", ":"))
    return f'<div style="padding: 0 0.5em" data-plot="{html.escape(data)}"></div>'


def rounded(values: Any) -> list[float]:
    """Numbers with as many digits as a plot shows."""
    return [float(f"{value:.6g}") for value in values]


_NOTHING = "none"
_COLORS = {"smallest": "#7a7a7a", "largest": "#7a7a7a", "now": "#1f77b4"}


class ForcePlot:
    """A plot of one component of the forces in one beam, chosen in the panel; formed when it is first asked for.

    Args:
        gui: Panel of viser.
        run: Run that is played.
    """

    def __init__(self, gui: Any, run: Trajectory) -> None:
        self._gui, self._run = gui, run
        self._time = float(run.t[0])
        self._forces: dict[str, SectionForces] = {}
        self._shown: tuple[SectionForces, str] | None = None
        self._plot: Any = None
        beams = dict.fromkeys(beam for beam, _ in run.model.names.sections)
        self.choices = {f"{beam}: {component}": (beam, component) for beam in beams for component in COMPONENTS}
        with gui.add_folder("Section forces", expand_by_default=False) as self._folder:
            chosen = gui.add_dropdown("over x [m]", (_NOTHING, *self.choices), initial_value=_NOTHING)
        chosen.on_update(lambda event: self.choose(event.target.value))

    def choose(self, choice: str) -> None:
        """Show a component of a beam, or nothing."""
        if self._plot is not None:
            self._plot.remove()
        self._plot = self._shown = None
        if choice not in self.choices:
            return
        beam, component = self.choices[choice]
        if beam not in self._forces:
            self._forces[beam] = self._run.section_forces(beam)
        self._shown = self._forces[beam], component
        uplot = import_module("viser.uplot")
        series = tuple(uplot.Series(label=name, stroke=color) for name, color in _COLORS.items())
        with self._folder:
            self._plot = self._gui.add_uplot(self._curves(), (uplot.Series(label="x"), *series), aspect=1.4)

    def follow(self, time: float) -> None:
        """Show the forces at a time of the run [s]."""
        self._time = time
        if self._plot is not None:
            self._plot.data = self._curves()

    def _curves(self) -> tuple[Array, ...]:
        """Stations, then the smallest, the largest and the present value there."""
        assert self._shown is not None
        forces, component = self._shown
        k = COMPONENTS.index(component)
        low, high = forces.envelope
        return tuple(map(np.ascontiguousarray, (forces.x, low[:, k], high[:, k], forces.at(self._time)[:, k])))
