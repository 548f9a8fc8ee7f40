"""Bars that say how large a picture shows things."""

from __future__ import annotations

import numpy as np
import pytest

from reference_models import MODELS
from symofros.studio.viewer.drawing.poses import Mechanism
from symofros.studio.viewer.render.camera import Camera
from symofros.studio.viewer.render.scale_bar import picture_height, scale_bar


@pytest.mark.parametrize(
    ("height", "length", "text"),
    [
        (1.4, 0.2, "20 cm"),
        (10.0, 2.0, "2 m"),
        (17.0, 5.0, "5 m"),
        (0.0034, 0.001, "1 mm"),
        (0.0033, 0.0005, "500 µm"),
        (0.04, 0.01, "1 cm"),
        (9000.0, 2000.0, "2 km"),
    ],
)
def test_a_bar_has_a_round_length_and_takes_that_much_of_the_picture(height: float, length: float, text: str) -> None:
    bar = scale_bar(height)
    assert bar.text == text and bar.length == pytest.approx(length, rel=1e-12)
    assert bar.share == pytest.approx(length / height, rel=1e-12) and 0.3 / 2.5 < bar.share <= 0.3


def test_a_bar_at_the_target_is_as_long_as_what_is_there() -> None:
    """Two points at the target, a bar's length apart across the picture, are that many pixels apart (pinhole)."""
    camera = Camera.of(Mechanism(MODELS["planar_robot"]).drawing())
    height = picture_height(camera.position, camera.target, camera.fov)
    bar, pixels = scale_bar(height), 480
    focus = pixels / 2 / np.tan(camera.fov / 2)
    ends = [camera.target, camera.target + bar.length * camera.axes[0]]
    seen = [camera.axes @ (end - camera.position) for end in ends]
    apart = focus * np.linalg.norm(seen[1][:2] / seen[1][2] - seen[0][:2] / seen[0][2])
    assert apart == pytest.approx(bar.share * pixels, rel=1e-9)
