"""A geared rotor in gimbals: gyroscopic moments, and precession under a weight."""

from __future__ import annotations

import numpy as np
import pytest

from tests.reference.motion import move, reference

ROUNDING = 1e-12
# The integrator's 1e-12 a step, over some hundred steps.
MOTION = 1e-9


def test_rotor_moments_equal_momentum_rates(rng: np.random.Generator) -> None:
    """Momentum H e_y turning with the inner gimbal, H = I n s; e_y . z = sin(pitch).

    On the yaw d(H sin(pitch))/dt, on the pitch -H cos(pitch) yaw', on the shaft I n d(yaw' sin(pitch))/dt.
    """
    driven = reference("gyroscope")
    plain = driven.with_parameters(n=0.0)
    axial, n = driven.parameters["I"], driven.parameters["n"]
    for _ in range(10):
        q, v = rng.uniform(-3, 3, 3), rng.uniform(-20, 20, 3)
        c, s, H = np.cos(q[1]), np.sin(q[1]), axial * n * v[2]
        expected = np.array([H * c * v[1], -H * c * v[0], axial * n * c * v[0] * v[1]])
        found = driven.bias(q, v) - plain.bias(q, v)
        np.testing.assert_allclose(found, expected, atol=ROUNDING * np.abs(driven.bias(q, v)).max())
        extra = np.array([[0.0, 0.0, axial * n * s], [0.0, 0.0, 0.0], [axial * n * s, 0.0, axial * n**2]])
        M = driven.mass_matrix(q)
        np.testing.assert_allclose(M - plain.mass_matrix(q), extra, atol=ROUNDING * np.abs(M).max())


@pytest.mark.parametrize("speed", [20.0, -35.0])
def test_precession_under_a_weight_matches_theory(speed: float) -> None:
    """With the axis level, yaw' = W l / H keeps it level: m g l = H yaw' (H the whole momentum along the axis)."""
    model = reference("gyroscope")
    p = model.parameters
    # The shaft turns too: its own axial inertia, 1e-5, adds to the rotor's.
    H = (p["I"] * p["n"] + 1.0e-5) * speed
    v = np.array([p["m"] * p["g"] * p["l"] / H, 0.0, speed])
    y = move(model, np.zeros(3), v, np.linspace(0.0, 1.0, 21)).y
    np.testing.assert_allclose(y[1], 0.0, atol=MOTION)
    np.testing.assert_allclose(y[3:].T, np.tile(v, (21, 1)), atol=MOTION * abs(speed))
