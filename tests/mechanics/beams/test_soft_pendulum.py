"""A soft rod that swings through large angles: energy, and an exact rod by links and springs, which shares nothing."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import symofros as sf

GRAVITY, END, OUTPUT = 9.81, 2.0, 0.02
TIMES = np.linspace(0.0, END, round(END / OUTPUT) + 1)


def pendulum(functions: int, damping: float) -> sf.Model:
    """A rod of unit length, stiffness and mass a length on a hinge, along x."""
    rod = sf.Beam(
        "rod",
        sf.Joint("pin", "revolute"),
        1.0,
        1.0,
        EI_z=1.0,
        bend_y=functions,
        family="legendre",
        theory="strain",
        damping=damping,
    )
    return sf.compile(sf.System("soft pendulum", (rod,), gravity=(0, -GRAVITY, 0)))


def linked(links: int, damping: float) -> np.ndarray:
    """Tip (n, 2) of a chain of uniform bars in absolute angles a, with springs of EI/h at its joints.

    sum_j h^3 c_ij (cos(a_i - a_j) a_j'' + sin(a_i - a_j) a_j'^2) = -h^2 g (n - i - 1/2) cos(a_i) - (K (a + tau a'))_i
    with c_ij = n - max(i, j) - 1/2, and n - i - 2/3 where i = j.
    """
    n, h, i = links, 1.0 / links, np.arange(links)
    mass = h**3 * (n - 0.5 - np.maximum.outer(i, i)) - h**3 / 6.0 * np.eye(n)
    weight = h**2 * GRAVITY * (n - i - 0.5)
    apart = np.diff(np.eye(n), axis=0)
    K = apart.T @ apart / h

    def slope(_: float, y: np.ndarray) -> np.ndarray:
        a, w = y[:n], y[n:]
        between = a[:, None] - a
        force = -(mass * np.sin(between)) @ (w * w) - weight * np.cos(a) - K @ (a + damping * w)
        return np.concatenate([w, np.linalg.solve(mass * np.cos(between), force)])

    # Damped, the highest vibrations are too stiff for an explicit method.
    a = solve_ivp(slope, (0.0, END), np.zeros(2 * n), "Radau", t_eval=TIMES, rtol=1e-7, atol=1e-9).y[:n].T
    return h * np.stack([np.cos(a).sum(axis=1), np.sin(a).sum(axis=1)], axis=-1)


def exact(links: int, damping: float) -> np.ndarray:
    """Tip (n, 2) of the exact rod: what links err falls with the square of their length, which two counts remove."""
    coarse, fine = linked(links, damping), linked(2 * links, damping)
    return (4.0 * fine - coarse) / 3.0


def test_a_soft_pendulum_swings_as_the_exact_rod() -> None:
    """Without damping, waves that the release starts have fronts, which take more functions."""
    functions, damping, links, error = 5, 0.01, 8, 3e-5
    m = pendulum(functions, damping)
    run = sf.simulate(m, t_end=END, method="dopri5", rtol=1e-9, atol=1e-10, output=OUTPUT)
    tip = m.frame_pose("tip", run.q)[0][:, :2]
    assert np.ptp(np.arctan2(tip[:, 1], tip[:, 0])) > 2.5
    assert tip == pytest.approx(exact(links, damping), abs=error)


def test_a_soft_pendulum_without_damping_keeps_its_energy_by_a_rosenbrock_method() -> None:
    """Tolerances below which a Rosenbrock method's speeds once rounded; its steps follow the highest vibration."""
    m = pendulum(5, 0.0)
    run = sf.simulate(m, t_end=1.0, method="rodas4", rtol=1e-9, atol=1e-11, output=OUTPUT)
    assert run.t[-1] == 1.0
    stored = m.potential_energy(run.q)
    assert np.ptp(m.kinetic_energy(run.q, run.v) + stored) < 1e-9 * np.ptp(stored)
