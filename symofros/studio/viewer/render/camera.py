"""Where a picture is taken from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from symofros.base.arrays import Array
from symofros.studio.viewer.drawing.drawing import Drawing

# From the mechanism's middle, in the world: planar mechanisms lie in x-z or in x-y, and are seen well from here.
_FROM = np.array([0.45, -1.0, 0.6])
_FIELD = np.radians(40.0)
_ROOM = 1.4  # Of the size, that fits in the picture's height.


@dataclass(frozen=True)
class Camera:
    """A pinhole camera.

    Attributes:
        position: (3) [m].
        target: Point that it looks at (3) [m].
        up: Direction that is upright in the picture (3).
        fov: Vertical field of view [rad].
    """

    position: Array
    target: Array
    up: Array
    fov: float

    @staticmethod
    def of(drawing: Drawing) -> Camera:
        """One that sees the whole mechanism in its neutral configuration."""
        distance = _ROOM * drawing.size / 2 / np.tan(_FIELD / 2)
        position = drawing.center + distance * _FROM / np.linalg.norm(_FROM)
        return Camera(position, drawing.center, np.array([0.0, 0.0, 1.0]), float(_FIELD))

    @property
    def axes(self) -> Array:
        """Right, down and forward in the world, as rows (3, 3)."""
        forward = self.target - self.position
        forward = forward / np.linalg.norm(forward)
        right = np.cross(forward, self.up)
        right = right / np.linalg.norm(right)
        return np.stack([right, np.cross(forward, right), forward])
