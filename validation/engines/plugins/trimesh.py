"""trimesh: mass properties of solids whose surfaces are triangles; no mechanics."""

from __future__ import annotations

import numpy as np

from ..interface import Convention, Tree, Unsupported
from .writing.source import Source, SourcePlugin, Way

_SOLIDS = {
    "box by its sizes": "trimesh.creation.box(extents={size})",
    "box by its corners": "trimesh.creation.box(bounds=[{low}, {high}])",
    "box by its corners, the other way round": "trimesh.creation.box(bounds=[{high}, {low}])",
    "box by its triangles": "trimesh.Trimesh(*triangles({low}, {high}))",
    "box that is moved": "trimesh.creation.box(extents={size}).apply_translation({middle})",
}
_TRIANGLES = (
    "def triangles(low, high):",
    "    corners = [[(low, high)[k >> j & 1][j] for j in range(3)] for k in range(8)]",
    "    squares = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]",
    "    return corners, [t for a, b, c, d in squares for t in ((a, b, c), (a, c, d))]",
)
WAYS = {
    "solid_inertia": Way(
        "mass_properties",
        "I = solid.moment_inertia\nvalue = [solid.mass, *solid.center_mass, *np.diag(I), I[0, 1], I[0, 2], I[1, 2]]",
    ),
    "solid_inertia:volume": Way(
        "volume, moment_inertia_frame",
        "I = solid.moment_inertia_frame(np.eye(4)).copy()\nc = solid.center_mass\nm = density * solid.volume\n"
        "I -= m * (c @ c * np.eye(3) - np.outer(c, c))\n"
        "value = [m, *c, *np.diag(I), I[0, 1], I[0, 2], I[1, 2]]",
    ),
}


def write(tree: Tree) -> Source | Unsupported:
    """Text that makes a solid."""
    if tree.name not in _SOLIDS:
        return Unsupported("no such solid", offered=False)
    (body,) = tree.links
    moments = np.diag(np.array(body.inertia))
    # Of a box: the squares of its sizes follow from its moments.
    size = np.sqrt(6.0 / body.mass * (moments.sum() - 2.0 * moments))
    low, high = body.com - size / 2.0, body.com + size / 2.0
    parts = {"size": size, "low": low, "high": high, "middle": np.array(body.com)}
    solid = _SOLIDS[tree.name].format(**{name: np.round(value, 12).tolist() for name, value in parts.items()})
    density = body.mass / float(np.prod(size))
    lines = (
        "import numpy as np",
        "import trimesh",
        *_TRIANGLES,
        f"density = {round(density, 12)!r}",
        f"solid = {solid}",
    )
    return Source((*lines, "solid.density = density"), ((),), 0, 0)


PLUGIN = SourcePlugin(
    name="trimesh",
    package="trimesh",
    extra="trimesh",
    conventions=(Convention("moments", "about the mass centre, along the axes of the file"),),
    kinds={},
    ways=WAYS,
    write=write,
    demands={"solids": "box, Trimesh"},
)
