"""Shapes of a compiled MJCF model as they look: primitives, as meshes are cut out before MuJoCo reads the model."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from symofros.description.imported.geometry import rotation_of
from symofros.description.values import Rotation
from symofros.description.visual import MAX_VISUALS, Visual, VisualKind, color_of

_SEEN = 3  # Groups that MuJoCo's own viewer shows at first are those below.
# mjtGeom -> our kind, and which of its three sizes that has, by what factor: MuJoCo states half lengths.
_KINDS: dict[int, tuple[VisualKind, tuple[tuple[int, float], ...]]] = {
    2: ("sphere", ((0, 1.0),)),
    3: ("capsule", ((0, 1.0), (1, 2.0))),
    4: ("ellipsoid", ((0, 1.0), (1, 1.0), (2, 1.0))),
    5: ("cylinder", ((0, 1.0), (1, 2.0))),
    6: ("box", ((0, 2.0), (1, 2.0), (2, 2.0))),
}


def visuals_of(model: Any, name: Callable[[int], str]) -> dict[str, tuple[Visual, ...]]:
    """Body -> how it looks.

    Args:
        model: An MjModel.
        name: Name of a body by its index.
    """
    visuals: dict[str, tuple[Visual, ...]] = {}
    for i in range(min(model.ngeom, MAX_VISUALS)):
        kind, rgba = int(model.geom_type[i]), np.array(model.geom_rgba[i], dtype=float)
        if kind not in _KINDS or int(model.geom_group[i]) >= _SEEN or rgba[3] <= 0.0:
            continue
        shape, sizes = _KINDS[kind]
        size = tuple(factor * float(model.geom_size[i][k]) for k, factor in sizes)
        numbers = np.concatenate([size, model.geom_pos[i], model.geom_quat[i], rgba])
        if not np.all(np.isfinite(numbers)) or min(size) <= 0.0:
            continue
        x, y, z = (float(p) for p in model.geom_pos[i])
        body = name(int(model.geom_bodyid[i]))
        turned = Rotation.matrix(rotation_of(model.geom_quat[i]).tolist())
        visual = Visual(shape, size, (x, y, z), turned, color_of(rgba.tolist()))
        visuals[body] = (*visuals.get(body, ()), visual)
    return visuals
