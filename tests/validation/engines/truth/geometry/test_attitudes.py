"""Truths of attitudes, orbits, guidance and spacecraft, by derivatives in doubles and by what is known of them."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from validation.engines.functions import FUNCTIONS
from validation.engines.interface import Slot, State
from validation.engines.models import spacecraft
from validation.engines.models.single import trees
from validation.engines.plugins.basilisk import PLUGIN
from validation.engines.plugins.writing.source import Source
from validation.engines.proving.pieces import Layout
from validation.engines.truth.dynamics import Point, Truth, digits, random_state
from validation.engines.truth.geometry import attitudes
from validation.engines.truth.spaceflight import guidance, orbits
from validation.engines.verdicts import expected, judge

_TREE = trees()["rotations"]
_LAYOUT = Layout(4, 3, ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),))
_STATES = [random_state(_TREE, _LAYOUT, seed) for seed in range(3)]


def _of(name: str, state: State) -> NDArray[np.float64]:
    return digits(Truth(_TREE, _LAYOUT).value(FUNCTIONS[name].truth, Point.of(state)))


def _rotation(name: str, state: State) -> Rotation:
    match name:
        case "gibbs":
            return Rotation.from_quat([*state.tau, 1.0])
        case "mrp":
            return Rotation.from_mrp(state.tau)
        case "prv":
            return Rotation.from_rotvec(state.tau)
    axes = name.removeprefix("euler").translate(str.maketrans("123", "XYZ"))
    return Rotation.from_euler(axes, state.tau / 4 + attitudes.ANGLES)


def _at(state: State, tau: NDArray[np.float64]) -> State:
    return State(state.q, state.v, state.a, tau, state.v2, state.q2)


@pytest.mark.parametrize("name", attitudes.SETS)
def test_parameters_make_the_rotation_that_scipy_makes_of_them(name: str) -> None:
    state = _STATES[0]
    np.testing.assert_allclose(
        _of(f"attitude_of_{name}", state), _rotation(name, state).as_matrix().ravel(), atol=1e-14
    )
    step, scale = 1e-6, 4 if name.startswith("euler") else 1
    for k, axis in enumerate(np.eye(3)):
        there = _rotation(name, _at(state, state.tau + scale * step * axis))
        back = _rotation(name, _at(state, state.tau - scale * step * axis))
        turning = (back.inv() * there).as_rotvec() / (2 * step)
        np.testing.assert_allclose(_of(f"attitude_speeds_{name}", state)[:, k], turning, atol=1e-8)
    product = _of(f"attitude_speeds_{name}", state) @ _of(f"attitude_rates_{name}", state)
    np.testing.assert_allclose(product, np.eye(3), atol=1e-14)


@pytest.mark.parametrize("state", _STATES)
@pytest.mark.parametrize("end", ["", "_open"])
def test_elements_are_those_of_energy_and_momentum(state: State, end: str) -> None:
    r, v = np.split(_of(f"orbit_state{end}", state), 2)
    axis, eccentricity, inclination = _of(f"orbit_elements{end}", state)[:3]
    momentum = np.cross(r, v)
    np.testing.assert_allclose(v @ v / 2 - orbits.MU / np.linalg.norm(r), -orbits.MU / (2 * axis), rtol=1e-13)
    np.testing.assert_allclose(momentum @ momentum, orbits.MU * axis * (1 - eccentricity**2), rtol=1e-13)
    np.testing.assert_allclose(momentum[2] / np.linalg.norm(momentum), np.cos(inclination), rtol=1e-12)


@pytest.mark.parametrize("state", _STATES)
def test_anomalies_solve_their_equations(state: State) -> None:
    e, x = 0.5 + state.a[1] / (1 + abs(state.a[1])) / 4, state.tau[0]
    true, mean, of_true, of_mean = _of("orbit_anomalies", state)
    np.testing.assert_allclose(np.cos(true), (np.cos(x) - e) / (1 - e * np.cos(x)), atol=1e-14)
    np.testing.assert_allclose([mean, of_mean - e * np.sin(of_mean)], [x - e * np.sin(x), x], atol=1e-14)
    np.testing.assert_allclose(np.cos(x), (np.cos(of_true) - e) / (1 - e * np.cos(of_true)), atol=1e-14)
    true, mean, _, of_mean = _of("orbit_anomalies_open", state)
    cosine = (1 / e - np.cosh(x)) / (np.cosh(x) / e - 1)
    np.testing.assert_allclose(np.cos(true), cosine, atol=1e-13)
    np.testing.assert_allclose([mean, np.sinh(of_mean) / e - of_mean], [np.sinh(x) / e - x, x], atol=1e-13)


@pytest.mark.parametrize("name", [name for name in orbits.ORBITS if name.startswith("gravity")])
def test_gravity_has_no_divergence(name: str) -> None:
    state, step = _STATES[1], 1e-5

    def pull(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return _of(name, State(state.q, state.v, state.a, state.tau, state.v2 + x, state.q2))

    slopes = np.array([(pull(step * axis) - pull(-step * axis)) / (2 * step) for axis in np.eye(3)])
    assert abs(np.trace(slopes)) < 1e-7 * np.max(np.abs(slopes))
    np.testing.assert_allclose(slopes, slopes.T, atol=1e-7 * np.max(np.abs(slopes)))


def test_the_second_harmonic_is_what_textbooks_have() -> None:
    state = _STATES[1]
    r = state.v2 + [1.0, -1.5, 2.0]
    square, height = r @ r, 5 * r[2] ** 2 / (r @ r)
    known = -1.5 / square**2.5 * r * [1 - height, 1 - height, 3 - height]
    np.testing.assert_allclose(_of("gravity_zonal_2", state), known, rtol=1e-13)


@pytest.mark.parametrize("state", _STATES)
def test_errors_and_what_is_asked_for(state: State) -> None:
    sigma = _of("guidance_tracking", state)[:3]
    q, reference = (Rotation.from_quat([*x[1:], x[0]]) for x in (state.q, state.q2))
    np.testing.assert_allclose(sigma, (reference.inv() * q).as_mrp(), atol=1e-14)
    pointed = q * Rotation.from_mrp(_of("guidance_pointing", state)[:3]).inv()
    sight = state.v2 + [4.0, -8.0, 8.0]
    np.testing.assert_allclose(pointed.apply([1.0, 0.0, 0.0]), sight / np.linalg.norm(sight), atol=1e-14)
    x = guidance.K * state.v2 + guidance.CUBIC * state.v2**3
    wanted = -2 / np.pi * guidance.LIMIT * np.arctan(np.pi / 2 * x / guidance.LIMIT)
    np.testing.assert_allclose(_of("control_steering", state)[:3], wanted, atol=1e-14)


def test_a_frame_that_follows_an_orbit_turns_as_its_momentum_says() -> None:
    state = _STATES[0]
    r, v = np.split(_of("orbit_state", state), 2)
    turning, change = np.split(_of("guidance_orbit_frame", state)[9:], 2)
    np.testing.assert_allclose(turning, np.cross(r, v) / (r @ r), atol=1e-13)
    np.testing.assert_allclose(change, -2 * (r @ v) / (r @ r) * turning, atol=1e-13)


def test_a_cosine_for_a_sine_in_a_reference_is_red() -> None:
    state = _STATES[0]
    want = expected("guidance_turning_on", _TREE, _LAYOUT, state)
    wrong = want.value + [*np.zeros(14), 1e-3]
    verdicts = [judge("planted", _TREE, "guidance_turning_on", one, want).verdict for one in (want.value, wrong)]
    assert verdicts == ["right", "wrong"]


def test_every_effector_has_a_spacecraft() -> None:
    offered = set[str]()
    for tree in spacecraft.trees().values():
        source = PLUGIN.write(tree)
        assert isinstance(source, Source)
        offered |= {name for name in PLUGIN.ways if name.startswith("craft") and name not in source.lacks}
    assert offered == {name for name in PLUGIN.ways if name.startswith("craft")}
