"""Visual: how a body looks, where its file says so. It has no part in the equations, nor in what is compiled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from symofros.description.values import IDENTITY, Rotation

VisualKind = Literal["box", "sphere", "cylinder", "capsule", "ellipsoid", "mesh"]

MAX_VISUALS = 10_000  # That are kept of one file.


@dataclass(frozen=True)
class Visual:
    """A shape S that moves with a body B.

    Attributes:
        kind: Kind of shape.
        size: Sizes: edges of a box, half-axes of an ellipsoid, (radius,) of a sphere, (radius, length) of a cylinder or
            a capsule along z, the capsule's without its caps [m]; factors along the axes of a mesh.
        position: p_BS [m].
        rotation: R_BS.
        color: Red, green, blue, 0 to 255; None where it is not stated.
        file: Path of a mesh.
        picture: Path of a picture, the colors of which, times `color`, it has; "" where none is stated.
        checker: Second of the two colors of a checker pattern, of octants around the frame's axes, a mesh's around its
            principal axes of inertia; None where all of it has `color`, which is the first.
        is_mapped: Whether the mesh's file says which place of the picture each corner has; else it has its mean color.
    """

    kind: VisualKind
    size: tuple[float, ...]
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation: Rotation = IDENTITY
    color: tuple[int, int, int] | None = None
    file: str = ""
    picture: str = ""
    checker: tuple[int, int, int] | None = None
    is_mapped: bool = False


def color_of(shares: Sequence[float]) -> tuple[int, int, int]:
    """Red, green and blue, 0 to 255, from fractions, clipped to 0 to 1; further entries are ignored."""
    red, green, blue = (round(255 * min(max(float(share), 0.0), 1.0)) for share in shares[:3])
    return red, green, blue
