"""Layers of a drawing, which can be shown or hidden each."""

from __future__ import annotations

from symofros.errors import Problem, UnknownNameError, did_you_mean
from symofros.studio.viewer.drawing.arrows import ARROWS
from symofros.studio.viewer.drawing.drawing import KINDS, Drawing

# What can be shown or hidden: kinds of pieces, and what is not of the mechanism itself.
LAYERS = (*KINDS, "frames", "labels", "ground", *ARROWS)


def initial_layers(drawing: Drawing) -> frozenset[str]:
    """The layers of a drawing that are shown initially: those that hide no others."""
    dressed, bare = ({part.link for part in drawing.parts if part.kind == kind} for kind in ("visuals", "bodies"))
    hidden = {"frames", "labels", *ARROWS}
    if dressed or not drawing.inertias_fit:
        hidden.add("inertias")
    if dressed and not bare - dressed and not drawing.beams:
        hidden |= {"bodies", "joints"}
    return frozenset(LAYERS) - hidden


def check_layer(what: str, layer: str) -> None:
    """Refuse a layer that there is none of.

    Args:
        what: What asks, such as "view".
        layer: Name of the layer.

    Raises:
        UnknownNameError: It is none of LAYERS.
    """
    if layer not in LAYERS:
        rule, remedy = f"one of {', '.join(LAYERS)}", did_you_mean(layer, LAYERS)
        raise UnknownNameError(Problem(f"{what}: no layer '{layer}'", f"'{layer}'", rule, remedy))
