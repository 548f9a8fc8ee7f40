"""Parts of spacecraft: a tank and a particle of its fuel lose the same, a source pulls towards itself."""

from __future__ import annotations

import numpy as np

from validation.engines.interface import STEP, Slot
from validation.engines.models.single import trees
from validation.engines.proving.pieces import Layout
from validation.engines.truth.dynamics import Point, Truth, digits, random_state
from validation.engines.truth.geometry.poses import AWAY
from validation.engines.truth.spaceflight import parts

_TREE = trees()["rotations"]
_LAYOUT = Layout(4, 3, ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),))
_STATE = random_state(_TREE, _LAYOUT, 5)


def _of(function: object) -> np.ndarray:
    return digits(Truth(_TREE, _LAYOUT).value(function, Point.of(_STATE)))  # type: ignore[arg-type]


def test_what_leaks_is_shared_by_the_parts_of_the_fuel() -> None:
    tank, particle, leak = np.abs(_STATE.v) + 0.5
    left = _of(parts.shared_fuel)
    np.testing.assert_allclose([left.sum(), left[0] / left[1]], [tank + particle - leak * STEP, tank / particle])


def test_a_source_pulls_towards_itself_by_the_inverse_square() -> None:
    force, way = _of(parts.pull), -parts.LENGTH * (_STATE.v2 + AWAY)
    np.testing.assert_allclose(np.cross(force, way), np.zeros(3), atol=1e-6)
    np.testing.assert_allclose(force @ way * np.linalg.norm(way), parts.MU)


def test_of_four_wheels_two_have_angles() -> None:
    angles, speeds = np.split(_of(parts.wheels), [2])
    np.testing.assert_array_equal([speeds[1], speeds[3]], angles)
    np.testing.assert_array_equal(_of(parts.sensed_first), np.ones(3))
