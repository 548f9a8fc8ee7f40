"""Layers of a drawing, which can be shown or hidden each."""

from __future__ import annotations

from symofros.studio.viewer.drawing.drawing import KINDS, Drawing

# What can be shown or hidden: kinds of pieces, and what is not of the mechanism itself.
LAYERS = (*KINDS, "frames", "labels", "ground")


def initial_layers(drawing: Drawing) -> frozenset[str]:
    """The layers of a drawing that are shown initially: those that hide no others."""
    dressed, bare = ({part.link for part in drawing.parts if part.kind == kind} for kind in ("visuals", "bodies"))
    hidden = {"frames", "labels"}
    if dressed or not drawing.inertias_fit:
        hidden.add("inertias")
    if dressed and not bare - dressed and not drawing.beams:
        hidden |= {"bodies", "joints"}
    return frozenset(LAYERS) - hidden
