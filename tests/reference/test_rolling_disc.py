"""The rolling disc: what it conserves, steady motion on a circle, and a motion by two other formulations.

e2 is the axle, at the lean l from the horizontal; e3 leads from the contact to the centre, e1 = e2 x e3 is level; w1,
w2, w3 are the angular velocity's components. A is the inertia about the axle, D across it. Newton's and Euler's
equations about the centre, with v = r (w2 e1 - w1 e2), give along e2 and e3

    (A + m r^2) w2' = -m r^2 w1 w3,      D w3' = w1 (D w3 tan l - A w2),      l' = w1                    (1)

so (w2, w3) = Phi(l) (k2, k3): two first integrals, linear in the speeds (Appell; Korteweg 1899). The third is energy.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import symofros as sf
from tests.models import compiled
from tests.reference.motion import free, move

Array = np.ndarray
m, r, g = 1.0, 1.0, 9.81
A, D = m * r**2 / 2, m * r**2 / 4
UP = np.array([0.0, 0.0, 1.0])


@cache
def model() -> sf.Model:
    return compiled("rolling_disc")


def axes(R: Array) -> Array:
    """Rows e1, e2, e3, of a disc with R."""
    e2 = R[:, 2]
    e3 = UP - e2[2] * e2
    e3 /= np.linalg.norm(e3)
    return np.array([np.cross(e2, e3), e2, e3])


def quaternion(R: Array) -> Array:
    """x, y, z, w of a rotation by less than half a turn."""
    w = np.sqrt(1 + np.trace(R)) / 2
    return np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], 4 * w**2]) / (4 * w)


def rolling(lean: float, w: Array) -> tuple[Array, Array]:
    """q and v of a disc with its contact at the origin, heading along x, that rolls with w = (w1, w2, w3)."""
    c, s = np.cos(lean), np.sin(lean)
    e = np.array([[1, 0, 0], [0, c, s], [0, -s, c]])
    # The body's axes x, y, z are e3, e1, e2.
    R = e[[2, 0, 1]].T
    velocity = r * (w[1] * e[0] - w[0] * e[1])
    return np.concatenate([r * e[2], quaternion(R)]), np.concatenate([R.T @ velocity, R.T @ (e.T @ w)])


def states(rng: np.random.Generator, count: int = 20) -> list[tuple[Array, Array]]:
    """Random ones, turned about the vertical and moved along the plane by assembly from random guesses."""
    found = []
    for _ in range(count):
        q, v = rolling(rng.uniform(-1.2, 1.2), rng.uniform(-4, 4, 3))
        turned = model().integrate(q, np.concatenate([[0, 0, 0], 0.3 * rng.normal(size=3)]))
        at = sf.assemble(model(), turned, v)
        found.append((at.q, at.v))
    return found


def rates(q: Array, v: Array) -> tuple[Array, Array, Array, float]:
    """w and w' along e1, e2, e3, v' and the lean."""
    a = model().forward_dynamics(q, v, [])
    e = axes(model().frame_pose("disc", q)[1])
    w = e @ model().frame_velocity("disc", q, v)[3:]
    alpha = e @ model().frame_acceleration("disc", q, v, a)[3:]
    lean = np.arcsin(e[1, 2])
    # The axes turn with (w1, w3 tan l, w3): e1 stays level.
    turning = np.array([w[0], w[2] * np.tan(lean), w[2]])
    return w, alpha - np.cross(turning, w), a, float(lean)


def test_first_integrals_linear_in_the_speeds_are_constant(rng: np.random.Generator) -> None:
    """d/dt Phi(l)^-1 (w2, w3) = 0, which is (1)."""
    for q, v in states(rng):
        w, rate, _, lean = rates(q, v)
        scale = 1 + np.abs(rate).max()
        assert abs((A + m * r**2) * rate[1] + m * r**2 * w[0] * w[2]) < 1e-11 * scale
        assert abs(D * rate[2] - w[0] * (D * w[2] * np.tan(lean) - A * w[1])) < 1e-11 * scale


@pytest.mark.parametrize(("lean", "turn"), [(0.3, -2.0), (0.8, 1.5), (-0.5, 3.0)])
def test_steady_circular_motion_is_kept(lean: float, turn: float) -> None:
    """The lean stays if w2 W (A + m r^2) cos l = D W^2 sin l cos l - m g r sin l, with W = w3/cos l about the vertical.

    Euler's equation along e1, w1 = 0.
    """
    c, s = np.cos(lean), np.sin(lean)
    spin = (D * turn**2 * s * c - m * g * r * s) / (turn * c * (A + m * r**2))
    q, v = rolling(lean, np.array([0.0, spin, turn * c]))
    _, rate, a, _ = rates(q, v)
    assert np.abs(rate).max() < 1e-11 * (1 + np.abs(a).max())
    # The centre goes around at the speed r w2, turning with W.
    push = model().frame_acceleration("disc", q, v, a)[:3]
    assert push == pytest.approx([0.0, turn * r * spin, 0.0], abs=1e-10)
    faster = rolling(lean, np.array([0.0, 1.01 * spin, turn * c]))
    assert abs(rates(*faster)[1][0]) > 1e-3


# Lean, heading and place of the contact by reduced Euler equations, and by multipliers in absolute coordinates, which
# agree to 7e-12.
MOTION = {
    0.5: (0.7238036324059317, -0.4295016974706219, 2.2850737177115295, -0.04920563733995847),
    1.0: (0.30230356681197135, -0.9763937787415263, 3.7498772810698497, -1.8781540969722743),
}
ENERGY = 21.496850958322195


def test_the_disc_rolls_as_published() -> None:
    q, v = rolling(0.3, np.array([0.0, 4.0, 1.0]))
    assert model().kinetic_energy(q, v) + model().potential_energy(q) == pytest.approx(ENERGY, rel=1e-14)
    motion = move(model(), q, v, np.array(list(MOTION)), rate=free)
    for wanted, y in zip(MOTION.values(), motion.y.T, strict=True):
        p, R = model().frame_pose("disc", y[:7])
        e = axes(R)
        contact = p - r * e[2]
        found = [np.arcsin(e[1, 2]), np.arctan2(e[0, 1], e[0, 0]), contact[0], contact[1]]
        assert found == pytest.approx(wanted, abs=1e-8)
        assert abs(contact[2]) < 1e-9
        energy = model().kinetic_energy(y[:7], y[7:]) + model().potential_energy(y[:7])
        assert energy == pytest.approx(ENERGY, rel=1e-10)
