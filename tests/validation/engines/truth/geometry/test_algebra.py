"""Truths of spatial algebra: by points of mass, by differences in doubles, by matrix exponentials."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm, logm
from scipy.spatial.transform import Rotation

from validation.engines.functions.algebra import ALGEBRA
from validation.engines.functions.poses import POSES
from validation.engines.interface import Slot, State
from validation.engines.models import single
from validation.engines.proving.pieces import Layout
from validation.engines.truth.dynamics import Point, Truth, digits, random_state
from validation.engines.truth.geometry.poses import AWAY, CENTRE, MASS, MOMENTS

Array = NDArray[np.float64]
_TURNS = single.trees()["rotations"]
_LAYOUT = Layout(4, 3, ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),))
_STATE: State = random_state(_TURNS, _LAYOUT, 3)
_TRUTH = Truth(_TURNS, _LAYOUT)
_STEP = 1e-6


def _of(name: str) -> Array:
    return digits(_TRUTH.value((ALGEBRA | POSES)[name].truth, Point.of(_STATE)))


def _turn(q: Array) -> Array:
    return np.asarray(Rotation.from_quat(np.roll(q, -1)).as_matrix())


def _cross(x: Array) -> Array:
    return np.asarray(np.cross(np.eye(3), x))


def _hat(twist: Array) -> Array:
    T = np.zeros((4, 4))
    T[:3, :3], T[:3, 3] = _cross(twist[3:]), twist[:3]
    return T


def _vee(T: Array) -> Array:
    return np.array([*T[:3, 3], T[2, 1], T[0, 2], T[1, 0]])


def _derivative(function: Callable[[Array], Array], x: Array) -> Array:
    steps = _STEP * np.eye(len(x))
    return np.stack([(function(x + step) - function(x - step)) / (2 * _STEP) for step in steps], axis=-1)


_R, _Q = _turn(_STATE.q), _turn(_STATE.q2)
_TWIST, _WRENCH = np.r_[_STATE.v, _STATE.v2], np.r_[_STATE.a, _STATE.tau]


def _pose(R: Array, p: Array) -> Array:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, p
    return T


_X, _Y = _pose(_R, _STATE.a), _pose(_Q, _STATE.tau)


def test_cross_products_are_of_vectors() -> None:
    v, a, u = _STATE.v, _STATE.a, np.array([0.25, -0.5, 1.0])
    np.testing.assert_allclose(_of("cross_matrix") @ u, np.cross(v, u))
    np.testing.assert_allclose(_of("cross_matrices") @ u, np.cross(v, np.cross(a, u)))
    np.testing.assert_allclose(_of("turned_vector"), _R @ v)
    np.testing.assert_allclose(_of("rotation_inverse"), _R.T.ravel())


def test_wrenches_do_the_work_of_twists() -> None:
    np.testing.assert_allclose(_of("power"), [_TWIST @ _WRENCH])
    np.testing.assert_allclose(_of("wrench_cross"), -_of("twist_cross").T)
    np.testing.assert_allclose(_of("wrench_transform_back") @ _of("wrench_transform"), np.eye(6), atol=1e-14)


def _second_moments() -> Array:
    """int r r^T dm of the body, from its moments about the mass centre."""
    S = np.array(MOMENTS)
    return np.asarray(np.trace(S) / 2 * np.eye(3) - S + MASS * np.outer(CENTRE, CENTRE))


def test_parameters_are_moments_of_mass() -> None:
    Sigma, h = _second_moments(), MASS * np.array(CENTRE)
    about = np.trace(Sigma) * np.eye(3) - Sigma
    P = np.block([[Sigma, h[:, None]], [h[None], np.array([[MASS]])]])
    np.testing.assert_allclose(_of("pseudo_inertia"), P, atol=1e-15)
    order = [about[place] for place in ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))]
    np.testing.assert_allclose(_of("inertia_parameters"), [MASS, *h, *order], atol=1e-15)
    matrix = _of("spatial_inertia")
    np.testing.assert_allclose(_of("spatial_inertia_inverse") @ matrix, np.eye(6), atol=1e-13)
    np.testing.assert_allclose(_of("body_energy"), [_TWIST @ matrix @ _TWIST / 2])
    np.testing.assert_allclose(_of("momentum_regressor") @ _of("inertia_parameters"), matrix @ _TWIST)
    rate = matrix @ _WRENCH + _of("wrench_cross") @ matrix @ _TWIST
    np.testing.assert_allclose(_of("momentum_rate_regressor") @ _of("inertia_parameters"), rate)


def _parameters(x: Array) -> Array:
    U = np.array(
        [[np.exp(x[1]), x[4], x[6], x[7]], [0, np.exp(x[2]), x[5], x[8]], [0, 0, np.exp(x[3]), x[9]], [0, 0, 0, 1]]
    )
    P = np.exp(2 * x[0]) * U @ U.T
    about = np.trace(P[:3, :3]) * np.eye(3) - P[:3, :3]
    order = [about[place] for place in ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))]
    return np.array([P[3, 3], *P[:3, 3], *order])


def test_logarithmic_parameters_are_of_a_triangular_root() -> None:
    x = np.r_[_STATE.v, _STATE.a, _STATE.tau, _STATE.v2[:1]]
    x = x / (1 + x * x)
    np.testing.assert_allclose(_of("logarithmic_parameters"), _parameters(x))
    np.testing.assert_allclose(_of("logarithmic_derivatives"), _derivative(_parameters, x), atol=1e-7)
    m, *h = _parameters(x)[:4]
    np.testing.assert_allclose(_of("logarithmic_inertia")[:3], np.c_[m * np.eye(3), -_cross(np.array(h))], atol=1e-15)


def test_moments_are_a_quadratic_form() -> None:
    S, v = np.array(MOMENTS), _STATE.v
    np.testing.assert_allclose(_of("moments_product"), S @ v)
    np.testing.assert_allclose(_of("moments_along"), [v @ S @ v])
    np.testing.assert_allclose(_of("moments_rotated"), _R @ S @ _R.T)


def _log(R: Array) -> Array:
    return np.asarray(Rotation.from_matrix(R).as_rotvec())


def _exp(r: Array) -> Array:
    return np.asarray(Rotation.from_rotvec(r).as_matrix())


def test_differences_of_rotations_by_differences_in_doubles() -> None:
    apart, nothing = _log(_R.T @ _Q), np.zeros(3)
    np.testing.assert_allclose(_of("rotation_difference"), apart)
    np.testing.assert_allclose(_of("rotation_squared_distance"), [apart @ apart])
    by_first = _derivative(lambda x: _log((_R @ _exp(x)).T @ _Q), nothing)
    np.testing.assert_allclose(_of("rotation_difference_dq"), by_first, atol=1e-8)
    by_second = _derivative(lambda x: _log(_R.T @ _Q @ _exp(x)), nothing)
    np.testing.assert_allclose(_of("rotation_difference_dq2"), by_second, atol=1e-8)
    np.testing.assert_allclose(_of("rotation_integrated"), (_R @ _exp(_STATE.v)).ravel())
    np.testing.assert_allclose(_of("rotation_integrated_dq"), _exp(_STATE.v).T, atol=1e-15)

    def rates(x: Array) -> Array:
        return _derivative(lambda y: _log(_R @ _exp(x) @ _exp(y)), nothing)

    turning = (rates(1e-4 * _STATE.v) - rates(-1e-4 * _STATE.v)) / 2e-4
    np.testing.assert_allclose(_of("rotation_vector_rates_along"), turning, atol=1e-5)


def test_differences_of_placements_by_differences_in_doubles() -> None:
    def apart(X: Array, Y: Array) -> Array:
        return _vee(np.real(logm(np.linalg.inv(X) @ Y)))

    def led(x: Array) -> Array:
        return np.asarray(expm(_hat(x)))

    nothing = np.zeros(6)
    np.testing.assert_allclose(_of("pose_squared_distance"), [apart(_X, _Y) @ apart(_X, _Y)])
    by_first = _derivative(lambda x: apart(_X @ led(x), _Y), nothing)
    np.testing.assert_allclose(_of("pose_difference_dq"), by_first, atol=1e-6)
    by_second = _derivative(lambda x: apart(_X, _Y @ led(x)), nothing)
    np.testing.assert_allclose(_of("pose_difference_dq2"), by_second, atol=1e-6)
    end = _X @ led(_TWIST)
    np.testing.assert_allclose(_of("pose_integrated"), [*end[:3, 3], *end[:3, :3].flat])
    moved = _derivative(lambda x: _vee(np.linalg.inv(end) @ _X @ led(x) @ led(_TWIST) - np.eye(4)), nothing)
    np.testing.assert_allclose(_of("pose_integrated_dq"), moved, atol=1e-7)
    moments = _derivative(lambda x: _crossed_momentum(x), _TWIST)
    np.testing.assert_allclose(_of("spatial_momentum_cross_dv"), moments, atol=1e-7)


def _crossed_momentum(x: Array) -> Array:
    force, moment = np.split(_of("spatial_inertia") @ x, 2)
    return np.r_[np.cross(x[3:], force), np.cross(x[3:], moment) + np.cross(x[:3], force)]


def test_angles_and_their_rates_along_the_turned_axes() -> None:
    def matrix(angles: Array) -> Array:
        return np.asarray(Rotation.from_euler("ZYX", angles[::-1]).as_matrix())

    def speeds(angles: Array) -> Array:
        turning = _derivative(matrix, angles)
        return np.stack([_vee_of(matrix(angles).T @ turning[..., k]) for k in range(3)], axis=1)

    np.testing.assert_allclose(_of("rpy_rates_turned"), np.linalg.inv(speeds(_STATE.v)), atol=1e-7)
    rate = (
        np.linalg.inv(speeds(_STATE.v + 1e-4 * _STATE.a)) - np.linalg.inv(speeds(_STATE.v - 1e-4 * _STATE.a))
    ) / 2e-4
    np.testing.assert_allclose(_of("rpy_rates_turned_rate"), rate, atol=1e-4)


def _vee_of(S: Array) -> Array:
    return np.array([S[2, 1] - S[1, 2], S[0, 2] - S[2, 0], S[1, 0] - S[0, 1]]) / 2


def _step(axis: int, angle: float, length: float) -> Array:
    return _pose(_exp(angle * np.eye(3)[axis]), length * np.eye(3)[axis])


@pytest.mark.parametrize("name", ["pose_by_denavit", "pose_by_modified_denavit"])
def test_parameters_place_along_two_axes(name: str) -> None:
    length, alpha, d = _STATE.v
    x, z = _step(0, alpha, length), _step(2, _STATE.a[0], d)
    T = x @ z if "modified" in name else z @ x
    np.testing.assert_allclose(_of(name), [*T[:3, 3], *T[:3, :3].flat], atol=1e-15)


def test_a_line_stays_when_its_body_turns_about_it() -> None:
    u = (_STATE.v + AWAY) / np.linalg.norm(_STATE.v + AWAY)
    made, twist = _of("turn_about_line"), _of("twist_about_line")
    p, R = made[:3], made[3:].reshape(3, 3)
    np.testing.assert_allclose(R @ (_STATE.a + 2 * u) + p, _STATE.a + 2 * u)
    np.testing.assert_allclose(R, _exp(_STATE.tau[0] * u), atol=1e-14)
    np.testing.assert_allclose(twist[3:], u)
    np.testing.assert_allclose(twist[:3] + np.cross(u, _STATE.a), np.zeros(3), atol=1e-14)
