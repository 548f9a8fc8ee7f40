"""Shapes of UsdGeom as visuals: solids that the viewer draws; meshes live in layers, from which it reads none."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.description.frames import Pose
from symofros.description.imported.geometry import stated_rotation
from symofros.description.usd.placement import Affine
from symofros.description.visual import Visual, color_of

# Rotation that lays z along an axis.
_TO_AXIS: dict[str, Array] = {
    "X": np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]),
    "Y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
    "Z": np.eye(3),
}
# Factors across the axis of a round shape that differ by more make it no round shape.
_ROUND = 1e-6


def visual(shape: Mapping[str, Any], body: Pose, placed: Affine) -> Visual | None:
    """Visual of a shape on its body; None if it can't be drawn.

    Args:
        shape: What the stage states of it.
        body: The body's frame in the world.
        placed: The shape's placement in the world.
    """
    kind, sizes = shape["kind"], shape["sizes"]
    if not placed.is_rigid:
        return None
    pose = body.inverse() @ placed.pose
    scale, turned = placed.scale, _TO_AXIS.get(sizes.get("axis", "Z"), np.eye(3))
    x, y, z = map(float, np.abs(turned.T) @ scale)  # Along the shape's own axes once z is its axis.
    is_round = abs(x - y) <= _ROUND * x
    if kind == "Cube":
        edge = float(sizes["size"])
        drawn = Visual("box", (x * edge, y * edge, z * edge))
    elif kind == "Sphere":
        r = float(sizes["radius"])
        same = is_round and abs(x - z) <= _ROUND * x
        drawn = Visual("sphere", (x * r,)) if same else Visual("ellipsoid", (x * r, y * r, z * r))
    elif kind in ("Cylinder", "Capsule") and is_round:
        name = "cylinder" if kind == "Cylinder" else "capsule"
        drawn = Visual(name, (x * float(sizes["radius"]), z * float(sizes["height"])))  # type: ignore[arg-type]
    else:
        return None
    R = pose.R @ turned
    color = shape["color"]
    px, py, pz = map(float, pose.p)
    return Visual(
        drawn.kind,
        drawn.size,
        (px, py, pz),
        stated_rotation(R),
        None if color is None else color_of(color),
    )
