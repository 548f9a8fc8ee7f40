"""The section `simulation` of a diagram's file."""

from __future__ import annotations

import math
from dataclasses import fields
from typing import Any

from symofros.description.yaml import Node
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.files.entries import Entries
from symofros.diagrams.settings import Plot, RunSettings
from symofros.simulation.stepping.methods import METHODS

SETTINGS = tuple(item.name for item in fields(RunSettings))


def read_settings(entries: Entries, diagram: Diagram, node: Node) -> RunSettings:
    """Read the settings of a run of the diagram; lines of its plots are noted in the diagram."""
    values: dict[str, Any] = {}
    for key, item in entries.mapping(node, "simulation", SETTINGS).items():
        if key == "plots":
            plots = [_plot(entries, diagram, i, one) for i, one in enumerate(entries.listed(item, "simulation: plots"))]
            values[key] = tuple(plots)
        elif key == "method":
            values[key] = entries.one_of(item, "simulation: method", tuple(METHODS))
        else:
            number = entries.number(item, f"simulation: {key}")
            if math.isnan(number):
                continue
            if key != "t0" and number <= 0.0:
                entries.fault(item, f"simulation: {key}", number, "above zero", "leave it out for the default")
            values[key] = int(number) if key == "threads" and number > 0.0 else number
    return RunSettings(**values)


def _plot(entries: Entries, diagram: Diagram, i: int, node: Node) -> Plot:
    """One picture: a signal, a list of them, or these with a title."""
    diagram.origin["plot", str(i)] = entries.where(node)
    what = f"plot {i + 1}"
    if isinstance(node.value, str):
        return Plot(node.value, (node.value,))
    title, signals, xy = "", node, False
    if isinstance(node.value, dict):
        stated = entries.mapping(node, what, ("title", "signals", "xy"))
        xy = "xy" in stated and entries.one_of(stated["xy"], f"{what}: xy", (True, False)) is True
        title = entries.text(stated["title"], f"{what}: title") if "title" in stated else ""
        if entries.missing(node, what, "signals", stated, "a plot shows signals"):
            return Plot(title, ())
        signals = stated["signals"]
    names = tuple(entries.text(item, what) for item in entries.listed(signals, what))
    return Plot(title or ", ".join(names)[:80], names, xy)
