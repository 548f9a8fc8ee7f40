"""Truths of lines, planes and screws, and what else the engines at hand don't answer or have otherwise.

What they do answer, `test_asked.py` and `test_mujoco.py` hold against the truth.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm, logm

from validation.engines.functions import FUNCTIONS
from validation.engines.interface import Slot, State
from validation.engines.models import single
from validation.engines.proving.pieces import Layout
from validation.engines.truth.dynamics import Point, Truth, digits, random_state
from validation.engines.truth.geometry.poses import ASIDE, AWAY, BESIDE
from validation.engines.truth.geometry.vectors import FRICTION

Array = NDArray[np.float64]
_TURNS = single.trees()["rotations"]
_LAYOUT = Layout(4, 3, ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),))
_STATE: State = random_state(_TURNS, _LAYOUT, 2)


def _of(name: str, state: State = _STATE) -> Array:
    return digits(Truth(_TURNS, _LAYOUT).value(FUNCTIONS[name].truth, Point.of(state)))


def _matrix(q: Array) -> Array:
    w, x, y, z = q
    S = _cross(np.array([x, y, z]))
    return np.asarray(np.eye(3) + 2 * w * S + 2 * S @ S)


def _cross(x: Array) -> Array:
    return np.array([[0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]])


def _pose(R: Array, p: Array) -> Array:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, p
    return T


_X, _Y = _pose(_matrix(_STATE.q), _STATE.a), _pose(_matrix(_STATE.q2), _STATE.tau)
_TWIST = np.array([*_STATE.v, *_STATE.v2])


def test_what_is_asked_of_draws_and_of_costs() -> None:
    np.testing.assert_allclose(_of("pose_drawn"), _STATE.v)
    turned = np.real(logm(_matrix(_STATE.q).T @ _matrix(_STATE.q2)))
    angle = np.linalg.norm([turned[2, 1], turned[0, 2], turned[1, 0]])
    np.testing.assert_allclose(_of("rotation_cost"), [3 - 2 * np.cos(angle)], rtol=1e-12)


def _about(axis: int, angle: float) -> Array:
    return np.asarray(expm(angle * _cross(np.eye(3)[axis])))


def test_speeds_of_angles_are_of_turns_about_axes() -> None:
    x, y, z = _STATE.v
    size, columns = 1e-6, []
    for unit in np.eye(3):
        moved = [
            _about(2, a) @ _about(1, b) @ _about(2, c) for a, b, c in (_STATE.v + k * size * unit for k in (-1, 1))
        ]
        spin = (moved[1] - moved[0]) @ (_about(2, x) @ _about(1, y) @ _about(2, z)).T / (2 * size)
        columns.append([spin[2, 1], spin[0, 2], spin[1, 0]])
    np.testing.assert_allclose(_of("zyz_speeds"), np.transpose(columns), atol=1e-9)


def _points(line: Array) -> tuple[Array, Array]:
    """A point of a line and its direction."""
    moment, d = line[:3], line[3:]
    return np.cross(d, moment), d


def test_lines_and_planes_are_where_their_points_are() -> None:
    s, first, second = _STATE, _STATE.v + AWAY, _STATE.v2 + ASIDE
    x, d = _points(_of("line"))
    assert np.allclose(np.cross(x - s.a, d), 0.0) and np.allclose(d, first / np.linalg.norm(first))
    x, d = _points(_of("line_placed"))
    there = (_Y @ [*s.a, 1.0])[:3]
    assert np.allclose(np.cross(x - there, d), 0.0) and np.allclose(d, _Y[:3, :3] @ first / np.linalg.norm(first))
    for name, point in (("line_nearest", s.tau), ("line_nearest_to_origin", 0 * s.tau)):
        found = _of(name)
        assert np.allclose(np.cross(found - s.a, first), 0.0) and abs((found - point) @ first) < 1e-12
    # Both lines meet the common perpendicular, whose direction is normal to both.
    x, d = _points(_of("lines_perpendicular"))
    assert abs(d @ first) + abs(d @ second) < 1e-12
    for own, along in ((s.a, first), (s.tau, second)):
        assert abs((own - x) @ np.cross(d, along)) < 1e-12
    assert abs((s.tau - s.a) @ d) == pytest.approx(_of("lines_apart")[0])
    met = _of("line_of_plane")
    assert np.allclose(np.cross(met - s.a, first), 0.0) and abs((met - s.tau) @ (s.v2 + BESIDE)) < 1e-12
    met = _of("planes_meet")
    for across, point in ((AWAY, s.a), (ASIDE, s.tau), (BESIDE, s.v2)):
        assert abs((met - point) @ across) < 1e-12
    x, d = _points(_of("line_of_planes"))
    for across, point in ((AWAY, s.a), (ASIDE, s.tau)):
        assert abs(d @ across) + abs((x - point) @ across) < 1e-12
    for name, second_way in (("plane_of_points", s.tau - s.a), ("plane_of_lines", second)):
        normal = np.cross(first, second_way)
        assert abs(normal @ s.a) / np.linalg.norm(normal) == pytest.approx(_of(name)[0])


def test_screws_turn_about_their_lines() -> None:
    """A point of the line moves along the line, by the pitch for a radian."""
    u, w = _STATE.a, _STATE.v + AWAY
    for x in (_points(_of("screw_line"))[0], _of("screw_pole")):
        assert np.allclose(u + np.cross(w, x), _of("screw_pitch")[0] * w)
    assert abs(_of("screw_pole") @ w) < 1e-12
    unit, sliding = _of("screw_unit"), _of("screw_unit_sliding")
    assert np.allclose(np.linalg.norm(w) * unit, [*u, *w]) and np.linalg.norm(unit[3:]) == pytest.approx(1.0)
    assert np.allclose(sliding, [*unit[3:], 0.0, 0.0, 0.0])
    twist = _of("screw_of_line")
    assert np.allclose(twist[:3] + np.cross(twist[3:], _STATE.a), 0.375 * twist[3:])
    assert np.linalg.norm(twist[3:]) == pytest.approx(1.0)


def test_the_nearer_and_the_same_way() -> None:
    line = _of("pose_halfway_apart")
    assert np.allclose(line[:3], _STATE.a + (_STATE.tau - _STATE.a) / 4)
    assert np.allclose(line[3:], _of("pose_halfway")[3:])
    rotation = _of("rotation_of_two_axes").reshape(3, 3)
    away = _STATE.v + AWAY
    assert np.allclose(rotation[:, 2], away / np.linalg.norm(away)) and np.allclose(rotation.T @ rotation, np.eye(3))
    assert abs(rotation[:, 0] @ (_STATE.v2 + ASIDE)) < 1e-12 < rotation[:, 1] @ (_STATE.v2 + ASIDE)
    assert list(_of("are_rotations")) == [1.0, 0.0, 0.0]


def _placed(axis: int, angle: float, length: float) -> Array:
    return _pose(_about(axis, angle), length * np.eye(3)[axis])


@pytest.mark.parametrize("name", ["pose_by_denavit", "pose_by_modified_denavit"])
def test_parameters_place_along_two_axes(name: str) -> None:
    length, alpha, d = _STATE.v
    x, z = _placed(0, alpha, length), _placed(2, _STATE.a[0], d)
    T = x @ z if "modified" in name else z @ x
    np.testing.assert_allclose(_of(name), [*T[:3, 3], *T[:3, :3].flat], atol=1e-14)


def test_a_body_that_turns_about_a_line_leaves_its_points() -> None:
    u = (_STATE.v + AWAY) / np.linalg.norm(_STATE.v + AWAY)
    twist = _of("twist_about_line")
    np.testing.assert_allclose(twist[3:], u)
    np.testing.assert_allclose(twist[:3] + np.cross(u, _STATE.a), np.zeros(3), atol=1e-14)


def _crossed_momentum(x: Array) -> Array:
    force, moment = np.split(_of("spatial_inertia") @ x, 2)
    return np.r_[np.cross(x[3:], force), np.cross(x[3:], moment) + np.cross(x[:3], force)]


def test_momenta_are_those_of_the_inertia() -> None:
    np.testing.assert_allclose(
        _of("momentum_regressor") @ _of("inertia_parameters"), _of("spatial_inertia") @ _TWIST, rtol=1e-13, atol=1e-14
    )
    steps = 1e-6 * np.eye(6)
    slopes = [(_crossed_momentum(_TWIST + step) - _crossed_momentum(_TWIST - step)) / 2e-6 for step in steps]
    np.testing.assert_allclose(_of("spatial_momentum_cross_dv"), np.transpose(slopes), atol=1e-7)


def test_edges_of_friction_add_up_to_the_force() -> None:
    edges, (normal, *tangents) = _of("friction_edges"), _of("friction_edges_back")
    np.testing.assert_allclose(edges.sum(), normal)
    for mu, tangent, pair in zip(FRICTION, tangents, edges.reshape(2, 2), strict=True):
        np.testing.assert_allclose(mu * (pair[0] - pair[1]), tangent)
