"""Chaplygin's sleigh: a knife edge behind the mass centre.

u is the speed along the edge, w the turning rate: u' = a w^2, (J + m a^2) w' = -m a u w. What is conserved is energy,
m u^2/2 + (J + m a^2) w^2/2, and no momentum; solutions are u = c tanh(k t), w = W / cosh(k t).
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import symofros as sf
from tests.models import compiled
from tests.reference.motion import move

Array = np.ndarray
m, J, a = 2.0, 0.3, 0.25
ROLL = J + m * a**2


@cache
def model() -> sf.Model:
    return compiled("sleigh")


def state(angle: float, u: float, w: float) -> tuple[Array, Array]:
    return np.array([0.4, -0.3, angle]), np.array([u * np.cos(angle), u * np.sin(angle), w])


def test_accelerations_match_the_formula(rng: np.random.Generator) -> None:
    for angle, u, w in rng.uniform(-3, 3, (20, 3)):
        q, v = state(angle, u, w)
        assert np.abs(model().constraint_rate(q, v)).max() < 1e-14
        rate = model().forward_dynamics(q, v, [])
        along = np.array([np.cos(angle), np.sin(angle)])
        assert along @ rate[:2] == pytest.approx(a * w**2, abs=1e-12)
        assert ROLL * rate[2] == pytest.approx(-m * a * u * w, abs=1e-12)
        # d/dt of energy.
        assert abs(m * u * (along @ rate[:2]) + ROLL * w * rate[2]) < 1e-11
        assert abs(v @ (model().mass_matrix(q) @ rate + model().bias(q, v))) < 1e-11


def test_motion_matches_the_closed_form() -> None:
    """From a spin on the spot it ends up gliding straight ahead."""
    W = 2.0
    c = W * np.sqrt(ROLL / m)
    k = m * a * c / ROLL
    times = np.linspace(0.0, 3.0, 7)
    motion = move(model(), *state(0.1, 0.0, W), times)
    angle, speeds = motion.y[2], motion.y[3:]
    assert speeds[2] == pytest.approx(W / np.cosh(k * times), abs=1e-9)
    assert np.cos(angle) * speeds[0] + np.sin(angle) * speeds[1] == pytest.approx(c * np.tanh(k * times), abs=1e-9)
    assert angle == pytest.approx(0.1 + W / k * np.arctan(np.sinh(k * times)), abs=1e-9)
