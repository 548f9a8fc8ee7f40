"""The drawn axis of a beam: at its tip where the model has it, as long as the beam, tangent to its sections."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from symofros.description.beams.shapes import FAMILIES
from symofros.mechanics.beams.second_order.deformation import small_coordinates
from symofros.mechanics.beams.second_order.theory import FieldShape
from symofros.studio.viewer.drawing.drawing import STATIONS

LENGTH = 1.5


def beam(family: str = "spline", **more: object) -> sf.Beam:
    counts = {"bend_y": 2, "bend_z": 2, "twist": 1}
    return sf.Beam("b", sf.Joint("clamp"), LENGTH, 1.0, 10.0, 20.0, 5.0, 0.1, family=family, **(counts | more))


@pytest.mark.parametrize("family", [family for family in FAMILIES if family != "user"])
@pytest.mark.parametrize("more", [{}, {"foreshortening": False, "retain": "zeroth_order"}], ids=["all", "linear"])
def test_the_tip_of_the_field_shape_matches_the_model(family: str, more: dict, rng: np.random.Generator) -> None:
    stated = beam(family, **more)
    model = sf.compile(sf.System("s", [stated]), sf.Options(("frame_pose",), ("tip",), backend="interpreter"))
    q = 3 * rng.uniform(-1, 1, (4, stated.modes)) * small_coordinates(stated, LENGTH)
    p, R = model.frame_pose("tip", q)
    line = FieldShape(stated, STATIONS)
    assert np.allclose(line.points(LENGTH, q)[:, -1], p, atol=1e-13)
    assert np.allclose(line.axes(LENGTH, q)[:, -1], R, atol=1e-13)


def test_the_axis_starts_at_the_root_and_is_straight_at_rest() -> None:
    line = FieldShape(beam(), STATIONS)
    expected = np.zeros((len(STATIONS), 3))
    expected[:, 0] = LENGTH * np.array(STATIONS)
    assert np.allclose(line.points(LENGTH, np.zeros(5)), expected)
    assert np.allclose(line.axes(LENGTH, np.zeros(5)), np.eye(3))
