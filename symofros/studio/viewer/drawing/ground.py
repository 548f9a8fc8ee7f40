"""The plane z = 0 of the world as a grid, and which way things fall."""

from __future__ import annotations

import numpy as np

from symofros.base.arrays import Array
from symofros.studio.viewer.drawing.drawing import Color, Drawing

GRAVITY_COLOR: Color = (200, 60, 160)
_ARROW = 0.15  # Of the mechanism's size.


def cell_of(drawing: Drawing) -> tuple[float, int]:
    """Width of a cell [m], 1 or 5 times a power of ten, and how many of them lie on each side of the origin."""
    decade = 10.0 ** np.floor(np.log10(drawing.size))
    cell = float(decade if drawing.size > 5 * decade else decade / 2 if drawing.size > 2 * decade else decade / 5)
    reach = float(np.abs(drawing.center[:2]).max()) + drawing.size
    return cell, int(np.ceil(reach / cell))


def ground_lines(drawing: Drawing) -> list[Array]:
    """The ends of the grid's lines (2, 3) [m]."""
    cell, count = cell_of(drawing)
    far = cell * count
    lines = []
    for k in range(-count, count + 1):
        lines += [
            np.array([[k * cell, -far, 0.0], [k * cell, far, 0.0]]),
            np.array([[-far, k * cell, 0.0], [far, k * cell, 0.0]]),
        ]
    return lines


def gravity_arrow(drawing: Drawing) -> Array | None:
    """Tail and head of the arrow of gravity (2, 3) [m]; None without gravity."""
    pull = float(np.linalg.norm(drawing.gravity))
    if pull == 0.0:
        return None
    size = _ARROW * drawing.size
    tail = drawing.center + np.array([-0.6, 0.5, 0.0]) * drawing.size
    tail[2] = 1.2 * size
    return np.stack([tail, tail + size * drawing.gravity / pull])
