"""The bar that says how large a picture shows things: of a round length, at the depth of what the camera looks at."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array

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
