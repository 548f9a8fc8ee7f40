"""N four-bars in a row: one pendulum by exact reduction, and the rank that all loops lose when the cranks lie flat.

J theta'' + V cos(theta) = 0 with J = (N + 1)/3 + N and V = ((N + 1)/2 + N) g for rods of 1 kg and 1 m (IFToMM A02; Bayo
and Avello 1994). Figures: this equation in 30 digits.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models.closed.four_bars import n_four_bar, n_four_bar_absolute
from tests.models import sampled

Array = np.ndarray
G0 = 9.81
FUNCTIONS = (
    "forward_dynamics",
    "constraint",
    "constraint_rate",
    "constraint_jacobian",
    "constraint_bias",
    "kinetic_energy",
    "potential_energy",
    "mass_matrix",
    "bias",
    "frame_pose",
)
# Energy, then angle and rate of the cranks every second: cranks upright, their tips at 1 m/s.
_ONE, _TWO = np.hsplit(np.loadtxt(Path(__file__).with_name("n_four_bar.txt")), 2)
MOTION = {1: (20.453333333333333, _ONE), 2: (35.835, _TWO)}
# First time with flat cranks, and their rate then.
FLAT = {1: (0.7084500088357472, -4.954190145725105), 2: (0.7143555292929465, -4.887739763939927)}


@cache
def model(n: int) -> sf.Model:
    return sf.compile(n_four_bar(n), sf.Options(functions=FUNCTIONS))


@cache
def absolute(n: int) -> sf.Model:
    functions = ("constraint", "constraint_jacobian") if n > 2 else FUNCTIONS
    return sf.compile(n_four_bar_absolute(n), sf.Options(functions=functions, backend="interpreter"))


def parallel(n: int, crank: float) -> Array:
    """Coordinates (or speeds) of cranks that turn together while couplers stay level."""
    return np.array([(-crank if i % 2 else crank) for i in range(2 * n)] + [crank])


def places(n: int, angle: float) -> Array:
    """The same posture in absolute coordinates."""
    c, s = np.cos(angle), np.sin(angle)
    rows = [row for i in range(n + 1) for row in ((i + c / 2, s / 2, angle), (i + c + 0.5, s, 0.0))]
    return np.array(rows[:-1]).reshape(-1)


def order(n: int) -> Array:
    """Where each coordinate of a chain crank0, coupler0, crank1, ... stands in the model."""
    names = [name for i in range(n + 1) for name in (f"crank{i}", f"coupler{i}")][:-1]
    return np.array([model(n).names.q.index(name) for name in names])


def pendulum(n: int) -> tuple[float, float]:
    return (n + 1) / 3 + n, ((n + 1) / 2 + n) * G0


@pytest.mark.parametrize("n", sampled((1, 2, 5), (1, 2)))
def test_accelerations_are_the_pendulums(n: int, rng: np.random.Generator) -> None:
    m, (J, V) = model(n), pendulum(n)
    for angle, rate in rng.uniform(0.2, 2.9, (20, 2)):
        a = m.forward_dynamics(parallel(n, angle)[order(n)], parallel(n, rate)[order(n)], [])
        wanted = -V / J * np.cos(angle)
        assert a == pytest.approx(parallel(n, wanted)[order(n)], abs=1e-11 * (1 + abs(wanted) + rate**2))


@pytest.mark.parametrize("n", [1, 2])
def test_two_sets_of_coordinates_give_the_same_accelerations(n: int, rng: np.random.Generator) -> None:
    """The accelerations of every mass centre, by closures at each pin."""
    m, (J, V) = absolute(n), pendulum(n)
    for angle, w in rng.uniform(0.2, 2.9, (5, 2)):
        c, s = np.cos(angle), np.sin(angle)
        crank, coupler = (-w * s / 2, w * c / 2, w), (-w * s, w * c, 0.0)
        v = np.array([part for i in range(n + 1) for part in (crank, coupler)][:-1]).reshape(-1)
        q = places(n, angle)
        assert np.abs(m.constraint(q)).max() < 1e-15 and np.abs(m.constraint_rate(q, v)).max() < 1e-14
        turn = -V / J * c
        push = (-turn * s - w**2 * c, turn * c - w**2 * s)
        wanted = [part for i in range(n + 1) for part in ((push[0] / 2, push[1] / 2, turn), (*push, 0.0))][:-1]
        assert m.forward_dynamics(q, v, []) == pytest.approx(np.array(wanted).reshape(-1), abs=1e-10)


@pytest.mark.parametrize("n", [1, 2, 40])
def test_every_loop_loses_a_condition_when_flat(n: int) -> None:
    """N + 1 ways to move where there was one, in both sets of coordinates."""
    m = model(n) if n < 40 else sf.compile(n_four_bar(n), sf.Options(("constraint_jacobian",), backend="interpreter"))
    for matrix, full in (
        (m.constraint_jacobian(m.neutral()), 2 * n),
        (absolute(n).constraint_jacobian(places(n, 0.0)), 6 * n + 2),
    ):
        assert np.linalg.matrix_rank(matrix, tol=1e-10) == full - n
        assert matrix.shape[1] - (full - n) == n + 1


@pytest.mark.parametrize("n", [1, 2])
def test_accelerations_exist_at_the_flat_posture(n: int) -> None:
    """N conditions are left; accelerations keep them, and what is not inertia and weight is a force of theirs."""
    m, w = model(n), FLAT[n][1]
    q, v = np.zeros(m.nv), parallel(n, w)[order(n)]
    a, _, rank = m.constrained_dynamics(q, v, [])
    assert rank == n
    assert np.abs(m.constraint_jacobian(q) @ a - m.constraint_bias(q, v)).max() < 1e-10
    M, h = m.mass_matrix(q), m.bias(q, v)
    # What is left of M a + h lies in the rows that the constraints still have.
    rows = m.constraint_jacobian(q)
    left = M @ a + h
    assert np.abs(left - np.linalg.pinv(rows, rcond=1e-9) @ rows @ left).max() < 1e-10
