"""Trees of one link that stand for what packages offer beside mechanisms: rotations, mass properties of solids."""

from __future__ import annotations

import numpy as np

from ..interface import Joint, Link, Tree, rows, vector


def _box(name: str, low: tuple[float, ...], high: tuple[float, ...], density: float) -> Tree:
    """A solid between two corners, whose density is its link's mass by its volume."""
    size, middle = np.subtract(high, low), np.add(low, high) / 2.0
    mass = density * float(np.prod(size))
    inertia = np.diag(mass / 12.0 * (size @ size - size**2))
    return Tree(name, (Link("a", -1, (Joint("fixed"),), mass, vector(middle), rows(inertia)),), asked="solids")


def trees() -> dict[str, Tree]:
    """All of them, by name."""
    made = (
        Tree("rotations", (Link("a", -1, (Joint("ball"),)),), asked="turns"),
        _box("box by its sizes", (-0.5, -0.25, -1.0), (0.5, 0.25, 1.0), 2.0),
        _box("box by its corners", (0.5, -0.25, 1.0), (1.5, 0.75, 3.0), 0.5),
        _box("box by its corners, the other way round", (0.5, -0.25, 1.0), (1.5, 0.75, 3.0), 0.5),
        _box("box by its triangles", (0.5, -0.25, 1.0), (1.5, 0.75, 3.0), 0.5),
        _box("box that is moved", (0.5, -0.25, 1.0), (1.5, 0.75, 3.0), 2.0),
    )
    return {tree.name: tree for tree in made}
