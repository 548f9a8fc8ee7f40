"""What is asked beside mechanisms, by name: rotations, solids, flexible bodies; and lines around surfaces."""

from __future__ import annotations

import math

import numpy as np
import pytest

from validation.engines.interface import Slot, Tree
from validation.engines.matrix import cells
from validation.engines.models import flexible, single
from validation.engines.plugins import OWN
from validation.engines.proving.pieces import Layout
from validation.engines.truth import turns
from validation.engines.truth.arithmetic import Exact, arc, cos_sin, exact, many_digits
from validation.engines.truth.dynamics import Point, Truth, digits, random_state
from validation.engines.truth.kinematics import around

TURNS = single.trees()["rotations"]


def _truth() -> tuple[Truth, Point]:
    layout = Layout(4, 3, ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),))
    return Truth(TURNS, layout), Point.of(random_state(TURNS, layout, 1))


def test_an_angle_comes_back_in_many_digits() -> None:
    with many_digits():
        for angle in exact([0.3, 2.5, -1.25, 3.125]):
            assert abs(arc(*(5 * part for part in cos_sin(angle))) - angle) < exact(1e-100)[()]


def test_rates_of_rotation_vectors_are_those_of_the_rotation() -> None:
    t, s = _truth()
    with many_digits():
        small = exact(1e-12)[()]
        before, after = (turns._exponential(s.tau + sign * small * s.a) for sign in (-1, 1))
        spin = turns._logarithm(before.T @ after) / (2 * small)
    np.testing.assert_allclose(
        digits(t.value(turns.vector_speeds, s)) @ digits(s.a), digits(spin), rtol=1e-14, atol=1e-15
    )


def test_a_logarithm_is_the_way_back() -> None:
    t, s = _truth()
    with many_digits():
        back = turns._exponential(turns.logarithm(t, s)).reshape(9) - turns.matrix(t, s)
    assert np.max(np.abs(digits(back))) < 1e-100


def _points(*values: tuple[float, float, float]) -> list[Exact]:
    return [exact(value) for value in values]


@pytest.mark.parametrize("is_sphere", [True, False])
def test_a_line_around_half_a_circle(is_sphere: bool) -> None:
    with many_digits():
        a, b = _points((-1.0, 0.0, 0.0), (1.0, 0.0, 0.0))
        length = around(a, b, exact(0.5)[()], is_sphere)
    # Two tangents and the arc between them: pi less twice the angle whose cosine is a half.
    assert float(length) == pytest.approx(2 * math.sqrt(0.75) + 0.5 * (math.pi - 2 * math.acos(0.5)), rel=1e-15)


def test_a_line_rises_around_a_cylinder_and_not_around_a_sphere() -> None:
    with many_digits():
        a, b = _points((-1.0, 0.0, 0.0), (1.0, 0.0, 1.0))
        flat = around(a, exact((1.0, 0.0, 0.0)), exact(0.5)[()], False)
        risen = around(a, b, exact(0.5)[()], False)
    assert float(risen) == pytest.approx(math.hypot(float(flat), 1.0), rel=1e-15)


def test_a_line_that_passes_a_surface_or_begins_in_it_is_straight() -> None:
    with many_digits():
        a, b, inside = _points((-1.0, 2.0, 0.0), (1.0, 2.0, 0.0), (0.25, 0.0, 0.0))
        assert float(around(a, b, exact(0.5)[()], True)) == 2.0
        assert float(around(inside, b, exact(0.5)[()], True)) == pytest.approx(math.hypot(0.75, 2.0), rel=1e-15)


def _verdicts(engine: str, tree: Tree) -> dict[str, str]:
    return {cell.function: cell.verdict for cell in cells(OWN[engine], tree)}


@pytest.mark.parametrize("engine", ["pinocchio"])
def test_rotations_are_right(engine: str) -> None:
    verdicts = _verdicts(engine, TURNS)
    assert len(verdicts) > 8 and set(verdicts.values()) == {"right"}


@pytest.mark.parametrize("name", [name for name in flexible.trees() if "implicit" not in name])
def test_flexible_bodies_don_t_feel_their_frames(name: str) -> None:
    assert _verdicts("mujoco", flexible.trees()[name]) == {"flexible_relation": "right"}


def test_who_does_not_know_what_is_asked_is_not_asked() -> None:
    assert _verdicts("exudyn", TURNS) == {}
    assert _verdicts("pinocchio", flexible.trees()["flexible cable: sum of forces"]) == {}
