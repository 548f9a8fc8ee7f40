"""Friction of the paper's table 3: its law, and that it only dissipates."""

from __future__ import annotations

import numpy as np

from tests.reference.motion import reference

# Motor by motor, from table 3 of the SYMOFROS paper.
STATIC, DYNAMIC = np.array([0.49, 0.20, 0.10]), np.array([0.42, 0.17, 0.08])
VISCOUS = np.array([0.05, 0.03, 0.01])
SLOW, STRIBECK = 0.001, 0.02
PEAK = 15.0 / 8.0 * SLOW
ROUNDING = 1e-14


def test_the_friction_law_follows_stribeck(rng: np.random.Generator) -> None:
    """Up to the peak a polynomial with the value, slope and curvature of Stribeck's curve, which goes on from there."""
    arm = reference("friction_arm")
    v = rng.choice([-1, 1], (200, 3)) * 10.0 ** rng.uniform(-5, 1, (200, 3))
    x, drop = np.abs(v) / PEAK, STATIC - DYNAMIC
    rising = STATIC * (15 * x - 10 * x**3 + 3 * x**5) / 8 - drop * (PEAK / STRIBECK) ** 2 * x * (1 - x**2) ** 2 / 4
    falling = DYNAMIC + drop * np.exp(-(((np.abs(v) - PEAK) / STRIBECK) ** 2))
    expected = -np.sign(v) * np.where(x < 1.0, rising, falling) - VISCOUS * v
    Q = arm.generalized_force(rng.uniform(-3, 3, (200, 3)), v, np.zeros(3))
    np.testing.assert_allclose(Q, expected, rtol=ROUNDING, atol=ROUNDING)
    assert np.all(Q * v < 0.0)
