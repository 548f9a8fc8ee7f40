"""Shapes of a compiled MJCF model as they look: primitives, and meshes in the frames of their files."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.description.imported.geometry import rotation_of
from symofros.description.mjcf.meshes import SEEN_GROUPS, DrawnMesh, drawn_index
from symofros.description.mjcf.textures import Texture
from symofros.description.values import Rotation
from symofros.description.visual import MAX_VISUALS, Visual, VisualKind, color_of

_MESH = 7  # mjGEOM_MESH
_UNSTATED = np.array([0.5, 0.5, 0.5, 1.0], dtype=np.float32)  # MuJoCo's colour of what states none.
# mjtGeom -> our kind, and which of its three sizes that has, by what factor: MuJoCo states half lengths.
_KINDS: dict[int, tuple[VisualKind, tuple[tuple[int, float], ...]]] = {
    2: ("sphere", ((0, 1.0),)),
    3: ("capsule", ((0, 1.0), (1, 2.0))),
    4: ("ellipsoid", ((0, 1.0), (1, 1.0), (2, 1.0))),
    5: ("cylinder", ((0, 1.0), (1, 2.0))),
    6: ("box", ((0, 2.0), (1, 2.0), (2, 2.0))),
}


def visuals_of(
    model: Any,
    name: Callable[[int], str],
    drawn: Sequence[DrawnMesh],
    by_name: Mapping[str, DrawnMesh],
    textures: Mapping[str, Texture],
) -> dict[str, tuple[Visual, ...]]:
    """Body -> how it looks.

    Args:
        model: An MjModel.
        name: Name of a body by its index.
        drawn: Meshes that shapes stand for whose names say so (`drawn_index`).
        by_name: Meshes that MuJoCo has read.
        textures: Textures of materials, by the materials' names.
    """
    visuals: dict[str, tuple[Visual, ...]] = {}
    for i in range(min(model.ngeom, MAX_VISUALS)):
        rgba = np.array(model.geom_rgba[i], dtype=float)
        material = int(model.geom_matid[i])
        texture = textures.get(model.mat(material).name) if material >= 0 else None
        if material >= 0 and np.array_equal(rgba, _UNSTATED):
            rgba = np.array(model.mat_rgba[material], dtype=float)
        pose = np.concatenate([model.geom_pos[i], model.geom_quat[i], rgba])
        if int(model.geom_group[i]) not in SEEN_GROUPS or not np.all(np.isfinite(pose)) or rgba[3] <= 0.0:
            continue
        index = drawn_index(model.geom(i).name)
        if 0 <= index < len(drawn):
            visual = _mesh(drawn[index], model.geom_pos[i], rotation_of(model.geom_quat[i]))
        elif int(model.geom_type[i]) == _MESH:
            visual = _realigned(model, i, by_name)
        else:
            visual = _primitive(model, i)
        if visual is not None:
            body = name(int(model.geom_bodyid[i]))
            is_unstated = visual.kind == "mesh" and texture is None and np.array_equal(rgba, _UNSTATED)
            color = None if is_unstated else color_of((rgba[:3] * (1.0 if texture is None else texture.color)).tolist())
            picture = "" if texture is None else texture.file
            is_mapped = texture is not None and texture.is_flat
            visual = replace(visual, color=color, picture=picture, is_mapped=is_mapped)
            visuals[body] = (*visuals.get(body, ()), visual)
    return visuals


def _primitive(model: Any, i: int) -> Visual | None:
    """A shape of _KINDS; None of any other, and of one without a size."""
    shape, sizes = _KINDS.get(int(model.geom_type[i]), ("box", ()))
    size = tuple(factor * float(model.geom_size[i][k]) for k, factor in sizes)
    if not size or not all(map(math.isfinite, size)) or min(size) <= 0.0:
        return None
    x, y, z = (float(p) for p in model.geom_pos[i])
    return Visual(shape, size, (x, y, z), Rotation.matrix(rotation_of(model.geom_quat[i]).tolist()))


def _realigned(model: Any, i: int, by_name: Mapping[str, DrawnMesh]) -> Visual | None:
    """A mesh that MuJoCo has moved: from the frame of the file to its own it has turned and shifted the corners."""
    index = int(model.geom_dataid[i])
    drawn = by_name.get(model.mesh(index).name)
    if drawn is None:
        return None
    R_BM, R_SM = rotation_of(model.geom_quat[i]), rotation_of(model.mesh_quat[index])
    R_BS = R_BM @ R_SM.T
    return _mesh(drawn, model.geom_pos[i] - R_BS @ model.mesh_pos[index], R_BS)


def _mesh(drawn: DrawnMesh, p_BS: Array, R_BS: Array) -> Visual | None:
    """A file in the frame S of its shape; None where it is turned and then stretched, which no visual does.

    Its corner p is at S R^T (p - r) there: a visual F of it, with the factors s, has the corners s p.
    """
    R_SF, scale = rotation_of(drawn.refquat).T, np.array(drawn.scale)
    if np.allclose(R_SF, np.eye(3), atol=1e-12):
        p_SF = -scale * drawn.refpos
    elif np.ptp(scale) == 0.0:
        p_SF = -scale * (R_SF @ drawn.refpos)
    else:
        return None
    x, y, z = (p_BS + R_BS @ p_SF).tolist()
    return Visual("mesh", drawn.scale, (x, y, z), Rotation.matrix((R_BS @ R_SF).tolist()), file=drawn.file)
