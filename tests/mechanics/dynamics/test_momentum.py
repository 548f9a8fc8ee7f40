"""The Coriolis matrix: C v is the bias without weight, M' = C + C^T, Christoffel's symmetry."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from tests.models import MOTORS, SAMPLE, interpreted, model, system
from tests.validation.subjects import assert_agrees
from validation.procedures.equations import identities


@pytest.mark.parametrize("name", [*SAMPLE, *MOTORS])
def test_the_coriolis_matrix_gives_the_bias_without_gravity(name: str) -> None:
    """And its symmetric part the rate of M; motors on turning axes keep both identities."""
    assert_agrees(identities.velocity_terms, MOTORS.get(name) or system(name))


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
