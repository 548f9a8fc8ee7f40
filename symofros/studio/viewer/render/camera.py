"""Where a picture is taken from, and the bar that says how large it shows things at the depth of what is looked at."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

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


LONGEST = 0.3  # Of the picture's height.
UNITS = ((1000.0, "km"), (1.0, "m"), (0.01, "cm"), (0.001, "mm"), (1e-6, "µm"))


class ScaleBar(NamedTuple):
    """A bar: its length [m], how much of the picture's height it takes, and what it says."""

    length: float
    share: float
    text: str


def picture_height(position: Array, target: Array, fov: float) -> float:
    """Height of what a camera shows, at the depth of its target [m].

    Args:
        position: Of the camera (3) [m].
        target: Point that it looks at (3) [m].
        fov: Vertical field of view [rad].
    """
    return float(2.0 * np.linalg.norm(target - position) * np.tan(fov / 2.0))


def scale_bar(height: float) -> ScaleBar:
    """The longest bar of 1, 2 or 5 times a power of ten that is at most a third of the picture.

    Args:
        height: Height of the picture at the depth of its target [m], above 0.
    """
    most = LONGEST * height
    power = 10.0 ** np.floor(np.log10(most))
    length = float(max(digit * power for digit in (1.0, 2.0, 5.0) if digit * power <= most))
    unit, name = next((each for each in UNITS if length >= 0.999 * each[0]), UNITS[-1])
    return ScaleBar(length, length / height, f"{length / unit:.6g} {name}")
