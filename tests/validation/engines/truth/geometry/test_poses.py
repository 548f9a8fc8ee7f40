"""Truths of placements, screws, lines and planes, and spatial inertia: by matrix exponentials, by points, by powers."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm, logm

from validation.engines.functions.beside import TURNS
from validation.engines.functions.poses import POSES
from validation.engines.interface import Slot, State
from validation.engines.models import single
from validation.engines.proving.pieces import Layout
from validation.engines.truth.dynamics import Point, Truth, digits, random_state
from validation.engines.truth.geometry.poses import ASIDE, AWAY, BACK, BESIDE, CENTRE, MASS, MOMENTS, SEQUENCES

Array = NDArray[np.float64]
_TURNS = single.trees()["rotations"]
_LAYOUT = Layout(4, 3, ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),))
_STATE: State = random_state(_TURNS, _LAYOUT, 2)


def _of(name: str, state: State = _STATE) -> Array:
    return digits(Truth(_TURNS, _LAYOUT).value((POSES | TURNS)[name].truth, Point.of(state)))


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


def _flat(T: Array) -> Array:
    return np.array([*T[:3, 3], *T[:3, :3].flat])


def _hat(twist: Array) -> Array:
    T = np.zeros((4, 4))
    T[:3, :3], T[:3, 3] = _cross(twist[3:]), twist[:3]
    return T


def _vee(T: Array) -> Array:
    return np.array([*T[:3, 3], T[2, 1], T[0, 2], T[1, 0]])


_X, _Y = _pose(_matrix(_STATE.q), _STATE.a), _pose(_matrix(_STATE.q2), _STATE.tau)
_APART = np.linalg.inv(_X) @ _Y
_TWIST = np.array([*_STATE.v, *_STATE.v2])
_EXPECTED = {
    "pose_composed": _flat(_X @ _Y),
    "pose_unset": _flat(np.eye(4)),
    "pose_drawn": _STATE.v,
    "rotation_cost": 3 - 2 * np.cos([np.linalg.norm(_vee(np.real(logm(_APART)))[3:])]),
    "pose_inverse": _flat(np.asarray(np.linalg.inv(_X), dtype=float)),
    "pose_relative": _flat(_APART),
    "pose_of_point": (_X @ [*_STATE.v, 1.0])[:3],
    "pose_logarithm": _vee(np.real(logm(_X))),
    "pose_difference": _vee(np.real(logm(_APART))),
    "pose_exponential": _flat(expm(_hat(_TWIST))),
    "pose_halfway": _flat(_X @ expm(np.real(logm(_APART)) / 4)),
}


@pytest.mark.parametrize("name", _EXPECTED)
def test_placements_are_of_the_matrix_exponential(name: str) -> None:
    np.testing.assert_allclose(_of(name), _EXPECTED[name], rtol=1e-12, atol=1e-12)


def test_rates_of_twists_are_differences_of_exponentials() -> None:
    size, found = 1e-6, []
    for unit in np.eye(6):
        before, after = (expm(_hat(_TWIST + sign * size * unit)) for sign in (-1, 1))
        found.append(_vee(np.linalg.inv(expm(_hat(_TWIST))) @ (after - before)) / (2 * size))
    np.testing.assert_allclose(_of("pose_exponential_speeds"), np.transpose(found), atol=1e-9)
    step = np.array([0.5, -0.25, 0.125, 0.25, 0.75, -0.5])
    rates = _vee(np.real(logm(_X @ expm(size * _hat(step)))) - np.real(logm(_X @ expm(-size * _hat(step))))) / (
        2 * size
    )
    np.testing.assert_allclose(_of("pose_logarithm_rates") @ step, rates, atol=1e-8)


def test_wrenches_have_the_power_that_twists_give_them() -> None:
    there = _of("wrench_transform")
    np.testing.assert_allclose(there.T @ np.linalg.inv(_of("twist_transform_back")), np.eye(6), atol=1e-12)
    moved = _X @ _hat(_TWIST) @ np.linalg.inv(_X)
    np.testing.assert_allclose(np.linalg.solve(_of("twist_transform_back"), _TWIST), _vee(moved), atol=1e-12)


def test_products_of_twists_are_of_their_matrices() -> None:
    other = np.array([0.5, -0.25, 0.125, 0.25, 0.75, -0.5])
    A, B = _hat(_TWIST), _hat(other)
    np.testing.assert_allclose(_of("twist_cross") @ other, _vee(A @ B - B @ A), atol=1e-14)


def test_quaternions_move_as_their_matrices() -> None:
    size = 1e-6
    for name, turns_before in (("quaternion_rates", False), ("quaternion_rates_fixed", True)):
        rates = _of(name)
        moving = (_matrix(_STATE.q + size * rates) - _matrix(_STATE.q - size * rates)) / (2 * size)
        spin = moving @ _matrix(_STATE.q).T if turns_before else _matrix(_STATE.q).T @ moving
        np.testing.assert_allclose(spin, _cross(_STATE.v), atol=1e-9)


def _about(axis: int, angle: float) -> Array:
    return np.asarray(expm(angle * _cross(np.eye(3)[axis])))


def test_angles_are_of_turns_about_axes() -> None:
    x, y, z = _STATE.v
    np.testing.assert_allclose(_of("rotation_of_rpy"), (_about(2, z) @ _about(1, y) @ _about(0, x)).flat, atol=1e-14)
    np.testing.assert_allclose(_of("rotation_of_zyz"), (_about(2, x) @ _about(1, y) @ _about(2, z)).flat, atol=1e-14)
    roll, pitch, yaw = _of("rotation_to_rpy")
    np.testing.assert_allclose(_about(2, yaw) @ _about(1, pitch) @ _about(0, roll), _matrix(_STATE.q), atol=1e-14)
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


def test_a_body_has_the_energy_of_its_parts() -> None:
    """Point masses at the ends of principal axes have the same mass, centre and moments."""
    moments, axes = np.linalg.eigh(np.array(MOMENTS))
    spread = np.sqrt((moments.sum() / 2 - moments) * 3 / MASS)
    points = [
        np.array(CENTRE) + sign * size * axis for size, axis in zip(spread, axes.T, strict=True) for sign in (-1, 1)
    ]
    each = MASS / 6

    def energy(T: Array, twist: Array) -> float:
        moved = [(T @ [*x, 1.0])[:3] for x in points]
        return float(sum(each / 2 * np.sum((twist[:3] + np.cross(twist[3:], x)) ** 2) for x in moved))

    assert _TWIST @ _of("spatial_inertia") @ _TWIST / 2 == pytest.approx(energy(np.eye(4), _TWIST))
    assert _TWIST @ _of("spatial_inertia_placed") @ _TWIST / 2 == pytest.approx(energy(_X, _TWIST))
    assert np.allclose(_of("spatial_inertia_sum"), _of("spatial_inertia") + _of("spatial_inertia_placed"))
    assert np.allclose(_of("spatial_momentum"), _of("spatial_inertia") @ _TWIST)
    # A body that moves has the energy of its parts as they move; its momentum changes with it.
    size, other = 1e-6, np.array([0.5, -0.25, 0.125, 0.25, 0.75, -0.5])
    before, after = (energy(expm(sign * size * _hat(_TWIST)), other) for sign in (-1, 1))
    assert other @ _of("spatial_inertia_rate") @ other / 2 == pytest.approx((after - before) / (2 * size), rel=1e-7)
    assert np.allclose(_of("spatial_momentum_cross"), _of("spatial_inertia_rate") @ _TWIST)


def test_the_nearer_and_the_same_way() -> None:
    line = _of("pose_halfway_apart")
    assert np.allclose(line[:3], _STATE.a + (_STATE.tau - _STATE.a) / 4)
    assert np.allclose(line[3:], _of("pose_halfway")[3:])
    rotation = _of("rotation_of_two_axes").reshape(3, 3)
    away = _STATE.v + AWAY
    assert np.allclose(rotation[:, 2], away / np.linalg.norm(away)) and np.allclose(rotation.T @ rotation, np.eye(3))
    assert abs(rotation[:, 0] @ (_STATE.v2 + ASIDE)) < 1e-12 < rotation[:, 1] @ (_STATE.v2 + ASIDE)
    assert list(_of("are_rotations")) == [1.0, 0.0, 0.0]


def test_three_angles_are_of_turns_about_axes() -> None:
    for axes, row in zip(SEQUENCES, _of("rotations_of_three_angles"), strict=True):
        one, two, three = (_about("xyz".index(axis), angle) for axis, angle in zip(axes, _STATE.v, strict=True))
        np.testing.assert_allclose(row, (one @ two @ three).flat, atol=1e-14)


def test_rotations_on_end_have_a_pitch_of_a_quarter_turn() -> None:
    x, _, z = _STATE.v
    for sign, row in zip((1, -1), _of("rotations_on_end"), strict=True):
        np.testing.assert_allclose(row, (_about(2, z) @ _about(1, sign * np.pi / 2) @ _about(0, x)).flat, atol=1e-14)


@pytest.mark.parametrize(
    ("name", "u"), [("rotation_of_z", _STATE.v + AWAY), ("rotation_of_z_back", _STATE.v / 64 + BACK)]
)
def test_the_shortest_turn_is_about_the_normal_of_both(name: str, u: Array) -> None:
    R, normal = _of(name).reshape(3, 3), np.cross([0.0, 0.0, 1.0], u)
    np.testing.assert_allclose(R[:, 2], u / np.linalg.norm(u), atol=1e-14)
    np.testing.assert_allclose(R @ normal, normal, atol=1e-12)
