"""Bricard's mechanism: postures along its motion, and five conditions of rank four.

Source: IFToMM benchmark library A04. Figures: a chain by Pinocchio with multipliers of least norm, integrated with a
tolerance of 1e-12; each row is q, and the corner that the middle bars meet in.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.models import compiled

# Time, corner, q1 = q3 = q5, q2 = q4.
MOTION = np.loadtxt(Path(__file__).with_name("bricard.txt"))
# At rest in the shape of a cube.
ACCELERATION = 1.9580838323353325
SINGULAR_VALUES = (1.902113032590307, 1.9021130325903064, 1.1755705045849463, 1.1755705045849463)
SMALLEST = 1.1755705045849463


@cache
def model() -> sf.Model:
    return compiled("bricard")


def posture(odd: float, even: float) -> np.ndarray:
    return np.array([odd, even, odd, even, odd])


@pytest.mark.parametrize("row", MOTION, ids=lambda row: f"t={row[0]}")
def test_postures_match_the_reference(row: np.ndarray) -> None:
    corner, (odd, even) = row[1:4], row[4:]
    m, q = model(), posture(odd, even)
    # The integration of the figures kept the conditions to some 1e-12.
    assert np.abs(m.constraint(q)).max() < 1e-11
    assert m.frame_pose("bar3.end", q)[0] == pytest.approx(corner, abs=1e-11)
    sizes = np.linalg.svd(m.constraint_jacobian(q), compute_uv=False)
    assert sizes[4] < 1e-11 and sizes[3] > SMALLEST - 1e-9


def test_accelerations_from_rest_in_the_cube_shape_match_the_reference() -> None:
    m, rest = model(), np.zeros(5)
    assert np.linalg.svd(m.constraint_jacobian(rest), compute_uv=False)[:4] == pytest.approx(SINGULAR_VALUES, rel=1e-12)
    a, lam, rank = m.constrained_dynamics(rest, rest, [])
    assert rank == 4
    assert a == pytest.approx(ACCELERATION * np.array([1, -1, 1, -1, 1]), rel=1e-12)
    # The whole system of equations has rank 9 of 10: a solver that needs an inverse has none.
    M, G = m.mass_matrix(rest), m.constraint_jacobian(rest)
    whole = np.block([[M, G.T], [G, np.zeros((5, 5))]])
    assert np.linalg.matrix_rank(whole, tol=1e-12) == 9 and np.linalg.cond(whole) > 1e15
    # Of all multipliers that do, ours are the shortest.
    free = np.linalg.svd(G.T)[2][4]
    assert abs(free @ lam) < 1e-10 and np.abs(G.T @ free).max() < 1e-12
    least = np.linalg.lstsq(whole, np.concatenate([-m.bias(rest, rest), np.zeros(5)]), rcond=1e-10)[0]
    assert -lam == pytest.approx(least[5:], abs=1e-10)
