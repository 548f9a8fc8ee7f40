"""Andrews' squeezing mechanism: closed postures, accelerations and loop forces.

Figures: the IVP test set (Mazzia and Magherini) for t = 0 and t = 0.03; a solution in absolute coordinates that agrees
with it for the other times. Accelerations are also found from positions of the mass centres as the IVP test set states
them, without joints and loops of ours.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.models import compiled

Array = np.ndarray
# The coordinates in the order of the literature.
ORDER = ("beta", "Theta", "gamma", "Phi", "delta", "Omega", "epsilon")
START = (
    -0.06171389001427645,
    0.0,
    0.45527981916307037,
    0.22266839016588588,
    0.48736497954384256,
    -0.22266839016588588,
    1.2305474445498212,
)
# Angles, rates, and the point F at the end of K1, by time.
MOTION = {
    float(head[0]): (angles, rates, head[1:3])
    for head, angles, rates in np.loadtxt(Path(__file__).with_name("andrews_squeezer.txt")).reshape(-1, 3, 7)
}
TORQUE = 0.033  # On K1 [N m].


@cache
def model() -> sf.Model:
    return compiled("andrews_squeezer")


def ours(values: Sequence[float] | Array) -> Array:
    """Numbers in the order of the literature, in that of the model."""
    return np.array([values[ORDER.index(name)] for name in model().names.q])


def test_accelerations_and_forces_at_the_start() -> None:
    """y'' and lambda of the IVP test set: only the crank and K2 accelerate, only the loop through K3 is loaded."""
    m, q = model(), ours(START)
    assert np.abs(m.constraint(q)).max() < 1e-16
    a, lam = m.forward_dynamics(q, np.zeros(7), [], multipliers=True)
    wanted = ours((14222.4439199541138, -10666.8329399655854, 0, 0, 0, 0, 0))
    assert np.abs(a - wanted).max() < 1e-12 * 14222.0
    # Its lambda acts against ours, along the axes of the world; ours along those of K3.
    _, R = m.frame_pose("K3.end", q)
    assert -(R[:2, :2] @ lam[:2]) == pytest.approx([98.56687039624109, -6.122688344255662], rel=1e-12)
    assert np.abs(lam[2:]).max() < 1e-11


@pytest.mark.parametrize("t", MOTION)
def test_postures_are_closed(t: float) -> None:
    """At 0.03 s the solution of the test set was found with a tolerance of 1e-14 on an equation of index 3."""
    angles, rates, F = MOTION[t]
    m, q, v = model(), ours(angles), ours(rates)
    # Links of centimetres, rates of a thousand rad/s; the digits of the test set's rates are good for 2e-7 rad/s.
    assert np.abs(m.constraint(q)).max() < 1e-12
    assert np.abs(m.constraint_rate(q, v)).max() < 1e-8
    assert m.frame_pose("F", q)[0][:2] == pytest.approx(F, abs=1e-10)


@pytest.mark.parametrize("t", MOTION)
def test_energy_is_what_the_torque_put_in(t: float) -> None:
    angles, rates, _ = MOTION[t]
    m, q, v, q0 = model(), ours(angles), ours(rates), ours(START)
    energy = m.kinetic_energy(q, v) + m.potential_energy(q)
    assert energy - m.potential_energy(q0) == pytest.approx(TORQUE * (angles[0] - START[0]), rel=1e-8)


@pytest.mark.parametrize("t", MOTION)
def test_accelerations_on_the_way(t: float) -> None:
    angles, rates, _ = MOTION[t]
    m = model()
    a = m.forward_dynamics(ours(angles), ours(rates), [])
    wanted = literature(angles, rates)
    # Accelerations of 1e6 rad/s^2 in loops of centimetres: the condition of the equations is 1e5.
    assert np.abs(a - ours(wanted)).max() < 1e-9 * np.abs(wanted).max()


# The mechanism as the literature has it, in plain trigonometry.

MASSES = (0.04325, 0.00365, 0.02373, 0.00706, 0.0705, 0.00706, 0.05498)
INERTIAS = (2.194e-6, 4.41e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5)
# The angle of each link as a sum of coordinates.
TURNS = np.array(
    [
        [1, 0, 0, 0, 0, 0, 0],
        [1, 1, 0, 0, 0, 0, 0],
        [0, 0, 1, 0, 0, 0, 0],
        [0, 0, 0, 1, 1, 0, 0],
        [0, 0, 0, 0, 1, 0, 0],
        [0, 0, 0, 0, 0, 1, 1],
        [0, 0, 0, 0, 0, 0, 1],
    ]
)
XA, YA, XB, YB, XC, YC = -0.06934, -0.00227, -0.03635, 0.03273, 0.014, 0.072


def places(q: Array) -> tuple[Array, Array, Array]:
    """Mass centres (14,), the six conditions (6,) and the spring's end D (2,); q may be complex."""
    beta, theta, gamma, phi, delta, omega, epsilon = q
    c, s = np.cos, np.sin
    centres = [
        0.00092 * c(beta),
        0.00092 * s(beta),
        0.007 * c(beta) - 0.0115 * c(beta + theta),
        0.007 * s(beta) - 0.0115 * s(beta + theta),
        XB + 0.01874 * s(gamma) + 0.01043 * c(gamma),
        YB - 0.01874 * c(gamma) + 0.01043 * s(gamma),
        XA + 0.04 * c(delta) + 0.00579 * s(phi + delta),
        YA + 0.04 * s(delta) - 0.00579 * c(phi + delta),
        XA + 0.02308 * c(delta) - 0.00916 * s(delta),
        YA + 0.02308 * s(delta) + 0.00916 * c(delta),
        XA + 0.04 * s(epsilon) + 0.00579 * c(omega + epsilon),
        YA - 0.04 * c(epsilon) + 0.00579 * s(omega + epsilon),
        XA + 0.01228 * s(epsilon) - 0.00449 * c(epsilon),
        YA - 0.01228 * c(epsilon) - 0.00449 * s(epsilon),
    ]
    x, y = 0.007 * c(beta) - 0.028 * c(beta + theta), 0.007 * s(beta) - 0.028 * s(beta + theta)
    conditions = [
        x - 0.035 * s(gamma) - XB,
        y + 0.035 * c(gamma) - YB,
        x - 0.02 * s(phi + delta) - 0.04 * c(delta) - XA,
        y + 0.02 * c(phi + delta) - 0.04 * s(delta) - YA,
        x - 0.02 * c(omega + epsilon) - 0.04 * s(epsilon) - XA,
        y - 0.02 * s(omega + epsilon) + 0.04 * c(epsilon) - YA,
    ]
    spring = [XB + 0.02 * c(gamma) + 0.018 * s(gamma), YB + 0.02 * s(gamma) - 0.018 * c(gamma)]
    return np.array(centres), np.array(conditions), np.array(spring)


def jacobians(q: Array) -> list[Array]:
    """Of the places, by steps into the complex plane: exact to rounding."""
    columns = [places(q + 1e-30j * e) for e in np.eye(7)]
    return [np.array([column[k].imag / 1e-30 for column in columns]).T for k in range(3)]


def literature(q: Array, v: Array) -> Array:
    """Accelerations from Newton's and Euler's equations of the links, projected; loops by Lagrange's multipliers."""
    J, G, D = jacobians(q)
    # J' v and G' v by a difference of sixth order of exact Jacobians along the motion; a turn takes 5 ms.
    h = 1e-6
    weights = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))
    ahead = [(w, jacobians(q + k * h * v), jacobians(q - k * h * v)) for k, w in weights]
    drift, gamma = (sum(w * (a[i] - b[i]) @ v for w, a, b in ahead) / h for i in (0, 1))
    m = np.diag(np.repeat(MASSES, 2))
    M = J.T @ m @ J + TURNS.T @ np.diag(INERTIAS) @ TURNS
    stretch = places(q)[2] - (XC, YC)
    length = np.linalg.norm(stretch)
    force = -J.T @ m @ drift - D.T @ (4530.0 * (1 - 0.07785 / length) * stretch)
    force[0] += TORQUE
    whole = np.block([[M, -G.T], [G, np.zeros((6, 6))]])
    return np.asarray(np.linalg.solve(whole, np.concatenate([force, -gamma]))[:7])
