"""Shapes of a compiled MJCF model as they look: primitives, meshes in the frames of their files, textures."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.description.imported.geometry import rotation_of
from symofros.description.mjcf.files import Folder
from symofros.description.mjcf.meshes import (
    SEEN_GROUPS,
    DrawnMesh,
    asset_name,
    asset_path,
    compiler_settings,
    defaults,
    drawn_index,
)
from symofros.description.urdf.values import finite_numbers
from symofros.description.values import Rotation
from symofros.description.visual import MAX_VISUALS, Visual, VisualKind, color_of
from symofros.description.xml_nodes import Element


@dataclass(frozen=True)
class Texture:
    """Factor of a material's color.

    Attributes:
        color: Mean of what MuJoCo makes (3), 0 to 1; ones for a picture.
        squares: Both colors of a cube's checker pattern (3), 0 to 1.
        file: Path of a picture; "" where there is none.
        is_flat: Whether a mesh's places in it are those that its file states: a cube's are not.
    """

    color: Array
    squares: tuple[Array, Array] | None = None
    file: str = ""
    is_flat: bool = False


def textures_of(folder: Folder, stated: Element) -> dict[str, Texture]:
    """Material -> its texture, of those that have one that may be read."""
    settings = compiler_settings(stated)
    base = settings.get("texturedir", settings.get("assetdir", ""))
    classes = defaults(stated, "material")
    assets = list(stated.all("asset"))
    known = {asset_name(each): each for asset in assets for each in asset.all("texture")}
    textures: dict[str, Texture] = {}
    for material in (each for asset in assets for each in asset.all("material")):
        attributes = classes.get(material.attributes.get("class", "main"), {}) | material.attributes
        layers = [layer.attributes for layer in material.all("layer") if layer.attributes.get("role") == "rgb"]
        named = layers[0].get("texture") if layers else attributes.get("texture")
        element = known.get(named or "")
        texture = None if element is None else _texture(folder, element.attributes, base, settings)
        if texture is not None:
            textures[asset_name(material)] = texture
    return textures


def _texture(folder: Folder, stated: dict[str, str], base: str, settings: dict[str, str]) -> Texture | None:
    """A texture by its attributes; None where nothing can be drawn of it."""
    builtin, file = stated.get("builtin", "none"), stated.get("file")
    if builtin in _SHARES:
        colors = (
            finite_numbers(stated.get("rgb1", "0.8 0.8 0.8"), 3),
            finite_numbers(stated.get("rgb2", "0.5 0.5 0.5"), 3),
        )
        if colors[0] is None or colors[1] is None:
            return None
        share, first, second = _SHARES[builtin], np.clip(colors[0], 0.0, 1.0), np.clip(colors[1], 0.0, 1.0)
        is_cube = builtin == "checker" and stated.get("type", "cube") == "cube"
        return Texture((1.0 - share) * first + share * second, (first, second) if is_cube else None)
    path = folder.seen(asset_path(file, base, settings)) if file is not None else ""
    return Texture(np.ones(3), None, path, stated.get("type", "cube") == "2d") if path else None


# Share of rgb2 in the color of what MuJoCo makes, on all sides of a cube but its lower one.
_SHARES = {"flat": 0.0, "gradient": 0.5, "checker": 0.5}


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
            if texture is not None and texture.squares is not None:
                first, second = (color_of((rgba[:3] * square).tolist()) for square in texture.squares)
                visual = replace(visual, color=first, checker=second)
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
