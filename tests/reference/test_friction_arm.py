"""Friction of the paper's table 3: its law, that it only dissipates, and how long a link coasts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.reference.motion import move, reference

# Motor by motor, from table 3 of the SYMOFROS paper.
STATIC, DYNAMIC = np.array([0.49, 0.20, 0.10]), np.array([0.42, 0.17, 0.08])
VISCOUS = np.array([0.05, 0.03, 0.01])
SLOW, STRIBECK = 0.001, 0.02
PEAK = 15.0 / 8.0 * SLOW
ROUNDING = 1e-14
# The integrator's 1e-12 a step.
MOTION = 1e-10


def test_the_law(rng: np.random.Generator) -> None:
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


@pytest.mark.parametrize("motor", range(3))
def test_landmarks_of_the_table(motor: int) -> None:
    """Nothing at rest; static friction at 15/8 minimum velocities, and no more; dynamic and viscous when fast."""
    arm = reference("friction_arm")

    def force(speed: float) -> float:
        v = np.zeros(3)
        v[motor] = speed
        return float(-arm.generalized_force(np.zeros(3), v, np.zeros(3))[motor])

    assert force(0.0) == 0.0
    dry = [force(speed) - VISCOUS[motor] * speed for speed in np.linspace(0.0, 5 * PEAK, 101)]
    assert np.argmax(dry) == 20 and dry[20] == pytest.approx(STATIC[motor], rel=ROUNDING)
    assert force(1.0) == pytest.approx(DYNAMIC[motor] + VISCOUS[motor])


def test_a_single_link_coasts_to_rest_as_it_should() -> None:
    """J v' = -(F + c v) until v is small: v = (v0 + F/c) exp(-c t/J) - F/c, at rest after (J/c) ln(1 + c v0/F)."""
    stated = MODELS["friction_arm"]
    bodies = [stated.body(name) for name in ("fore", "hand")]
    locked = []
    for body in bodies:
        assert isinstance(body, sf.RigidBody) and body.joint is not None
        locked.append(replace(body, joint=replace(body.joint, kind="fixed", actuated=False, elements=())))
    link = sf.compile(stated.with_bodies(*locked), sf.Options(backend="interpreter"))
    L = link.parameters["L"]
    # Stretched out: rods about the first axis, and the hand.
    J = 1.5 * L**2 / 3 + L**2 / 12 + (1.5 * L) ** 2 + 0.002 + 0.3 * (2 * L + 0.1) ** 2
    assert link.mass_matrix([0.0])[0, 0] == pytest.approx(J, rel=ROUNDING * 10)

    F, c, v0 = DYNAMIC[0], VISCOUS[0], 2.0
    rest = J / c * np.log(1 + c * v0 / F)
    # Up to where the sign of v begins to be smoothed, and static friction to return: some Stribeck velocities.
    times = np.linspace(0.0, rest - J * 7 * STRIBECK / F, 20)
    y = move(link, np.zeros(1), np.array([v0]), times).y
    decay = np.exp(-c * times / J)
    np.testing.assert_allclose(y[1], (v0 + F / c) * decay - F / c, atol=MOTION)
    np.testing.assert_allclose(y[0], (v0 + F / c) * J / c * (1 - decay) - F / c * times, atol=MOTION)
