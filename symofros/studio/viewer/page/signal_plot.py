"""Signals of the motion over time, chosen in the panel; a click into the plot moves the time."""

from __future__ import annotations

import html
import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from symofros.studio.viewer.playing.signals import Signal

_NOTHING = "none"
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
