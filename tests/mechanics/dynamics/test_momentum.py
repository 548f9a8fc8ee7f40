"""The Coriolis matrix: C v is the bias without weight, M' = C + C^T, Christoffel's symmetry."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.models import MOTORS, SAMPLE, interpreted, model


def assert_rate(m: sf.Model, q: np.ndarray, v: np.ndarray) -> None:
    C, step = m.coriolis_matrix(q, v), 1e-5
    rate = (m.mass_matrix(m.integrate(q, step * v)) - m.mass_matrix(m.integrate(q, -step * v))) / (2 * step)
    np.testing.assert_allclose(C + C.T, rate, rtol=0, atol=1e-7 * max(1.0, np.abs(rate).max()))


@pytest.mark.parametrize("name", SAMPLE)
def test_coriolis_matrix_and_transpose_sum_to_the_mass_matrix_rate(name: str, rng: np.random.Generator) -> None:
    m = model(name)
    assert_rate(m, *m.random_state(rng))


@pytest.mark.parametrize("name", ["double_pendulum", "space_arm", "gyroscope", "joint_zoo", "friction_arm", *MOTORS])
def test_the_coriolis_matrix_gives_the_bias_without_gravity(name: str, rng: np.random.Generator) -> None:
    """Motors on turning axes keep both identities."""
    m = interpreted(replace(MOTORS.get(name) or MODELS[name], gravity=(0.0, 0.0, 0.0)))
    q, v = m.random_state(rng)
    h = m.bias(q, v)
    np.testing.assert_allclose(m.coriolis_matrix(q, v) @ v, h, rtol=0, atol=1e-12 * max(1.0, np.abs(h).max()))
    if name in MOTORS:
        assert_rate(m, q, v)


@pytest.mark.parametrize("name", ["double_pendulum", "chain7"])
def test_coriolis_matrix_is_symmetric_in_both_speeds_for_joints_of_one_freedom(
    name: str, rng: np.random.Generator
) -> None:
    """C(v) w = C(w) v for joints of one freedom: no other matrix with C v = h is so and has M' = C + C^T."""
    m = model(name)
    q, v = m.random_state(rng)
    w = rng.normal(size=m.nv)
    one, other = m.coriolis_matrix(q, v) @ w, m.coriolis_matrix(q, w) @ v
    np.testing.assert_allclose(one, other, rtol=0, atol=1e-11 * max(1.0, np.abs(one).max()))


def test_a_free_body_has_the_gyroscopic_matrix() -> None:
    """Of a body that only turns: 2 C = [w] J + J [w] - [J w], by hand from Koszul's formula."""
    J = np.diag([1.0, 2.0, 2.5])
    body = sf.RigidBody("top", sf.Joint("r", "ball"), sf.Inertia(1.0, (0, 0, 0), tuple(np.diag(J))))
    m = interpreted(sf.System("top", [body], gravity=(0, 0, 0)))
    w = np.array([0.3, -0.8, 0.5])

    def skew(x: np.ndarray) -> np.ndarray:
        return np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])

    expected = 0.5 * (skew(w) @ J + J @ skew(w) - skew(J @ w))
    np.testing.assert_allclose(m.coriolis_matrix(m.neutral(), w), expected, rtol=0, atol=1e-14)
