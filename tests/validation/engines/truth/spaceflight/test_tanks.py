"""Tanks that drain, against what is known of caps of balls and of hollow cylinders."""

from __future__ import annotations

from decimal import Decimal

import numpy as np
import pytest

from validation.engines.interface import Slot, State
from validation.engines.models.single import trees
from validation.engines.proving.pieces import Layout
from validation.engines.truth.dynamics import Point, Truth, digits, random_state
from validation.engines.truth.spaceflight import tanks
from validation.engines.verdicts import expected, judge

_TREE = trees()["rotations"]
_LAYOUT = Layout(4, 3, ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),))
_STATE = random_state(_TREE, _LAYOUT, 3)


def _of(function: object, state: State = _STATE) -> np.ndarray:
    return digits(Truth(_TREE, _LAYOUT).value(function, Point.of(state)))  # type: ignore[arg-type]


@pytest.mark.parametrize("f", ["0.25", "0.5", "0.75"])
def test_a_cap_and_the_rest_of_its_ball_are_the_ball(f: str) -> None:
    part, rest = (np.array(tanks.TANKS["emptying"](Decimal(x)), float) for x in (f, str(1 - Decimal(f))))
    whole = 0.4 * tanks.MASS * tanks.RADIUS**2
    np.testing.assert_allclose(part[1:] + rest[1:], [whole] * 3, rtol=1e-15)
    mass = tanks.MASS * float(f) ** 2 * (3 - 2 * float(f))
    np.testing.assert_allclose(mass * part[0], (tanks.MASS - mass) * rest[0], rtol=1e-13)
    # The moment across is a half of that along, and the sum of m z^2, which is at least that of the mass centre.
    assert part[1] >= part[3] / 2 + mass * part[0] ** 2


def test_a_cylinder_that_has_burnt_nearly_out_is_a_shell() -> None:
    left = Decimal("1e-9")
    moments = np.array(tanks.TANKS["burning_outwards"](left)[1:] / (left * Decimal(tanks.MASS)), float)
    r, length = tanks.RADIUS, tanks.LENGTH
    np.testing.assert_allclose(moments, [r**2 / 2 + length**2 / 12] * 2 + [r**2], rtol=1e-8)


@pytest.mark.parametrize("kind", tanks.TANKS)
def test_rates_are_those_of_what_is_left(kind: str) -> None:
    step, (v0, v1, v2) = 1e-6, _STATE.v
    # f = (1 + v0 / (1 + |v0|)) / 2 has the slope 1 / (2 (1 + |v0|)^2).
    ahead = v0 + step * v1 * 2 * (1 + abs(v0)) ** 2
    there = State(_STATE.q, np.array([ahead, v1, v2]), _STATE.a, _STATE.tau, _STATE.v2, _STATE.q2)
    for now, by_time in ((tanks.centre, tanks.centre_rate), (tanks.moments, tanks.moment_rates)):
        change = (_of(now(kind), there) - _of(now(kind))) / step
        np.testing.assert_allclose(change, _of(by_time(kind)), rtol=1e-4, atol=1e-9)


def test_moments_about_the_mass_centre_are_red() -> None:
    want = expected("tank_moments_emptying", _TREE, _LAYOUT, _STATE)
    f = (1 + _STATE.v[0] / (1 + abs(_STATE.v[0]))) / 2
    shift = tanks.MASS * f**2 * (3 - 2 * f) * float(_of(tanks.centre("emptying"))[0]) ** 2
    own = want.value - np.array([shift, shift, 0.0])
    for answer, verdict in ((want.value, "right"), (own, "wrong")):
        assert judge("planted", _TREE, "tank_moments_emptying", answer, want).verdict == verdict
