"""The car in flight: its damped bounce, and the moment of a spinning wheel that is steered."""

from __future__ import annotations

import numpy as np

from tests.reference.motion import Array, free, move, reference

ROUNDING = 1e-12
# The integrator's 1e-12 a step, over some hundred steps.
MOTION = 1e-9
FRONT, REAR = 15.0 + 4.0 + 18.0, 15.0 + 18.0  # What a front and a rear suspension carry [kg].


def rate(q: Array, v: Array) -> Array:
    return np.concatenate([free(q[:7], v[:6]), v[6:]])


def test_damped_bounce_matches_the_formula() -> None:
    """Springs let go together in flight; both sides alike, so that the car heaves and pitches but does not roll.

    A front corner pushes the chassis with f = k s + c s', a rear one with r, and itself the other way:
    s_f'' = -f/m_f - 2 (f + r)/M - 2 a^2 (f - r)/J, and likewise with front and rear exchanged.
    """
    car = reference("car")
    k, c, M, a = (car.parameters[name] for name in ("k", "c", "M", "a"))
    J = M * (a**2 + 0.2) / 3
    travel = [i for i, name in enumerate(car.names.v) if name.endswith("_travel")]
    s0, times = 1e-4, np.linspace(0.0, 0.2, 21)
    q, v = car.neutral(), np.zeros(car.nv)
    q[np.array(travel) + 1] = s0  # After the one coordinate that the free joint has more than speeds.
    y = move(car, q, v, times, rate).y[np.array(travel) + 1]
    np.testing.assert_allclose(y[0], y[1], atol=MOTION)

    same, across = 2 / M + 2 * a**2 / J, 2 / M - 2 * a**2 / J
    B = np.array([[1 / FRONT + same, across], [across, 1 / REAR + same]])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-k * B, -c * B]])
    values, vectors = np.linalg.eig(A)
    start = np.linalg.solve(vectors, np.array([s0, s0, 0.0, 0.0], dtype=complex))
    expected = (vectors @ (start[:, None] * np.exp(np.outer(values, times)))).real
    # Linear in the travel of 1e-4 m up to its square: the chassis pitches by as little.
    np.testing.assert_allclose(y[[0, 2]], expected[:2], atol=s0**2)


def test_a_spinning_wheel_resists_steering() -> None:
    """Steered with rate p about z, a wheel of axial inertia I spinning with s about y exerts -I s p about x."""
    car = reference("car")
    p = car.parameters
    v = np.zeros(car.nv)
    steer, spin = car.names.v.index("front_left_steer"), car.names.v.index("front_left_spin")
    v[steer], v[spin] = 0.5, 80.0
    weightless = car.with_parameters(g=0.0)
    h = weightless.bias(car.neutral(), v)
    expected = np.zeros(car.nv)
    # dH/dt = p z x (I s y) = -I s p x is what the chassis must supply, about its x axis alone.
    expected[3] = -p["m_wheel"] * p["r"] ** 2 / 2 * v[spin] * v[steer]
    np.testing.assert_allclose(h, expected, atol=ROUNDING * abs(expected[3]))
