"""Truths of points of links: differences of where they are, and of how they move."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal

import numpy as np
import pytest

from validation.engines.functions import FUNCTIONS
from validation.engines.models import kinds, sensed
from validation.engines.plugins import OWN
from validation.engines.truth import points
from validation.engines.truth.arithmetic import Exact, exact, many_digits
from validation.engines.truth.dynamics import Point, Truth, random_state

pytest.importorskip("pinocchio")
_SIZE = Decimal(10) ** -12


def _places(truth: Truth, q: Exact) -> Exact:
    return np.array([p + R @ exact(points.POINT) for R, p in truth.kinematics.poses(q)])


@pytest.mark.parametrize("kind", ["revolute oblique", "ball", "free"])
def test_motions_of_points_are_differences_of_their_places(kind: str) -> None:
    tree = kinds.tree_of(kind)
    model = OWN["pinocchio"].build(tree)
    truth, s = Truth(tree, model), Point.of(random_state(tree, model, 3))

    def along(of: Callable[[Exact], Exact], direction: Exact) -> Exact:
        step = truth.kinematics.rates(s.q) @ direction
        return (of(s.q + _SIZE * step) - of(s.q - _SIZE * step)) / (2 * _SIZE)

    with many_digits():
        velocities = along(lambda q: _places(truth, q), s.v)
        turning = along(lambda q: points.velocities_at(truth, q, s.v), s.v)
        tilted = along(lambda q: points.accelerations_at(truth, q, s.v, s.a), s.v2)
        expected = {
            "point_velocities": velocities,
            "point_velocity_products": turning,
            "point_accelerations": turning + points.jacobians(truth, s) @ s.a,
        }
        for name, value in expected.items():
            np.testing.assert_allclose(np.array(FUNCTIONS[name].truth(truth, s) - value, dtype=float), 0.0, atol=1e-15)
        for name, value in (
            ("point_jacobians", velocities),
            ("point_velocities_dq", turning),
        ):
            column = FUNCTIONS[name].truth(truth, s) @ s.v
            np.testing.assert_allclose(np.array(column - value, dtype=float), 0.0, atol=1e-15)
        column = FUNCTIONS["point_accelerations_dq"].truth(truth, s) @ s.v2
        np.testing.assert_allclose(np.array(column - tilted, dtype=float), 0.0, atol=1e-15)
        # Accelerations are quadratic in the speeds.
        column = FUNCTIONS["point_accelerations_dv"].truth(truth, s) @ s.v
        np.testing.assert_allclose(np.array(column - 2 * turning, dtype=float), 0.0, atol=1e-15)


def test_the_derivative_of_applied_wrenches_is_their_difference() -> None:
    tree = sensed.trees()["sensors on hinges"]
    model = OWN["pinocchio"].build(tree)
    truth, s = Truth(tree, model), Point.of(random_state(tree, model, 3))
    with many_digits():
        of = FUNCTIONS["applied_wrenches"].truth
        there, back = (of(truth, s._replace(q=s.q + sign * _SIZE * s.v2)) for sign in (1, -1))
        column = FUNCTIONS["applied_wrenches_dq"].truth(truth, s) @ s.v2
        np.testing.assert_allclose(np.array(column - (there - back) / (2 * _SIZE), dtype=float), 0.0, atol=1e-15)


def test_motions_of_sensors_are_differences_of_their_places() -> None:
    tree = sensed.trees()["sensors beyond a ball"]
    model = OWN["pinocchio"].build(tree)
    truth, s = Truth(tree, model), Point.of(random_state(tree, model, 3))

    def of(name: str, at: Point = s) -> Exact:
        return FUNCTIONS[name].truth(truth, at)

    with many_digits():
        step = _SIZE * (truth.kinematics.rates(s.q) @ s.v)
        there, back = (s._replace(q=s.q + sign * step) for sign in (1, -1))
        for places, motions, way in (
            ("frame_poses", "frame_velocities", 1),
            ("frame_poses_seen", "frame_velocities_seen", 1),
            ("frame_velocities", "frame_velocity_products", 2),
        ):
            rate = (of(places, there) - of(places, back))[:, : 3 * way] / (2 * _SIZE)
            np.testing.assert_allclose(np.array(rate - of(motions)[:, : 3 * way], dtype=float), 0.0, atol=1e-15)
        moved = of("frame_velocity_products") + of("frame_jacobians") @ s.a
        np.testing.assert_allclose(np.array(moved - of("frame_accelerations"), dtype=float), 0.0, atol=1e-15)
