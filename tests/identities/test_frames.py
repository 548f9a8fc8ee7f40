"""Frames: Jacobians and accelerations are the derivatives they claim to be."""

from __future__ import annotations

import numpy as np
import pytest

from tests.identities.test_dynamics import DIFFERENCE, ROUNDING, STATES, STEP, states
from tests.models import CASES, sampled


@pytest.mark.parametrize("case", sampled(CASES))
def test_velocity_is_jacobian_times_speed(case: str, rng: np.random.Generator) -> None:
    m, q, v = states(case, rng)
    for frame in m.names.frames:
        expected = np.einsum("nij,nj->ni", m.frame_jacobian(frame, q), v)
        np.testing.assert_allclose(m.frame_velocity(frame, q, v), expected, atol=ROUNDING * 100)


@pytest.mark.parametrize("case", sampled(CASES))
def test_acceleration_and_jacobian_rate_are_derivatives(case: str, rng: np.random.Generator) -> None:
    m, q, v = states(case, rng)
    a = rng.standard_normal((STATES, m.nv))
    ahead, behind = m.integrate(q, STEP * v), m.integrate(q, -STEP * v)
    for frame in m.names.frames[-3:]:
        J, dJ = m.frame_jacobian(frame, q), m.frame_jacobian_rate(frame, q, v)
        measured = (m.frame_jacobian(frame, ahead) - m.frame_jacobian(frame, behind)) / (2 * STEP)
        np.testing.assert_allclose(dJ, measured, atol=DIFFERENCE * 10)
        expected = np.einsum("nij,nj->ni", J, a) + np.einsum("nij,nj->ni", dJ, v)
        np.testing.assert_allclose(m.frame_acceleration(frame, q, v, a), expected, atol=ROUNDING * 1000)
