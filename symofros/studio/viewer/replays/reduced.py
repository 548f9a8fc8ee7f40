"""Drawings for replays: what no layer of them shows is left out, and shapes have the corners that can be seen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from symofros.studio.viewer.drawing.decimation import decimated
from symofros.studio.viewer.drawing.drawing import Drawing
from symofros.studio.viewer.drawing.meshes import Mesh

_TOLERANCE = 1 / 2500  # Of the mechanism's size; a picture has fewer rows.
_DECIMATION = 0.5  # Of the tolerance; the rest is that of the grid that corners are put on, and reserve.


def tolerance_of(drawing: Drawing) -> float:
    """How far shapes of files may be from what they are [m]."""
    return drawing.size * _TOLERANCE


def reducing(layers: frozenset[str], tolerance: float) -> Callable[[Drawing], Drawing]:
    """Reduces the drawings of one replay; a mesh that several have is decimated once.

    Args:
        layers: Layers that are shown.
        tolerance: How far shapes of files may be from what they are [m].
    """
    known: dict[int, tuple[Mesh, Mesh]] = {}  # With the mesh itself, so that its number stays its own.

    def reduced(drawing: Drawing) -> Drawing:
        parts = []
        for part in drawing.parts:
            if part.kind in layers:
                mesh = part.mesh
                if part.kind == "visuals":
                    mesh = _once(known, mesh, tolerance)
                parts.append(replace(part, mesh=mesh))
        return replace(
            drawing,
            parts=tuple(parts),
            beams=drawing.beams if "bodies" in layers else (),
            connectors=tuple(item for item in drawing.connectors if item.kind in layers),
            triads=drawing.triads if layers & {"frames", "labels"} else (),
        )

    return reduced


def _once(known: dict[int, tuple[Mesh, Mesh]], mesh: Mesh, tolerance: float) -> Mesh:
    if id(mesh) not in known:
        known[id(mesh)] = mesh, decimated(mesh, _DECIMATION * tolerance)
    return known[id(mesh)][1]
