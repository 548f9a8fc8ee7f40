"""Stability of rods: flutter under a follower force, lateral buckling of a strip that bends on edge before it tips."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eigvals
from scipy.optimize import brentq

import symofros as sf
from tests.mechanics.beams.rods import rod


def under(load: sf.BeamLoad, counts: tuple[int, int, int], **section: float) -> sf.Model:
    """A cantilever of unit length and mass under a load "P"."""
    given = {"rhoA": 1.0, "EI_z": 1.0, "EI_y": 1.0, "GJ": 1.0, "rhoJ": 1.0 if counts[2] else 0.0} | section
    system = sf.System(
        "s",
        (rod(counts, length=1.0, loads=(load,), **given),),
        gravity=(0, 0, 0),
        parameters=(sf.Parameter("P", 0.0, constant=False),),
    )
    return sf.compile(system, sf.Options(("mass_matrix", "generalized_force"), (), backend="interpreter"))


def stiffness(m: sf.Model, q: np.ndarray, P: float, width: float = 1e-4) -> np.ndarray:
    """d(-Q)/dq by differences, whose error is that of the fourth order."""
    n = len(q)
    steps = width * np.concatenate([np.eye(n), -np.eye(n), 2 * np.eye(n), -2 * np.eye(n)])
    forces = m.with_parameters(P=P).generalized_force(q + steps, 0 * steps, ()).reshape(4, n, n)
    return -(8 * (forces[0] - forces[1]) - (forces[2] - forces[3])).T / (12 * width)


def test_becks_rod_flutters_at_its_load() -> None:
    """A compressive force along the tip's tangent (Beck 1952): two frequencies meet at P L^2/EI = 20.0509."""
    force = sf.BeamLoad((sf.formula("-P", "load"), 0.0, 0.0), at=1.0, axes="section")
    m, straight = under(force, (7, 0, 0)), np.zeros(7)
    M = m.mass_matrix(straight)

    def flutters(P: float) -> bool:
        return bool(np.abs(eigvals(stiffness(m, straight, P), M).imag).max() > 1e-4)

    low, high = 15.0, 25.0
    assert flutters(high) and not flutters(low)
    while high - low > 1e-5:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if flutters(middle) else (middle, high)
    assert low == pytest.approx(20.05095, abs=1e-4)


def test_a_dead_load_buckles_at_eulers() -> None:
    force = sf.BeamLoad((sf.formula("-P", "load"), 0.0, 0.0), at=1.0, axes="world")
    m, straight = under(force, (5, 0, 0)), np.zeros(5)
    critical = brentq(lambda P: np.linalg.det(stiffness(m, straight, P)), 2.0, 3.0, xtol=1e-12)
    assert critical == pytest.approx(np.pi**2 / 4, rel=1e-8)


STIFFNESS = np.array([0.7, 1.0, 4.0])  # GJ, EI_y, EI_z


def tipping(P: float) -> float:
    """One less the motion of the tip out of the plane by that of the point where the force acts: zero at the limit.

    The moment in a section is (tip - p) x F; the tip's place is found in the plane, then moved out of it.
    """

    def ends(tip: np.ndarray) -> np.ndarray:
        def slope(_: float, state: np.ndarray) -> np.ndarray:
            R = state[3:].reshape(3, 3)
            x, y, z = R.T @ np.cross(tip - state[:3], (0.0, P, 0.0)) / STIFFNESS
            return np.concatenate([R[:, 0], (R @ np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])).ravel()])

        start = np.concatenate([np.zeros(3), np.eye(3).ravel()])
        return solve_ivp(slope, (0, 1), start, "DOP853", rtol=1e-10, atol=1e-12).y[:3, -1]

    # In the plane the moment depends on how far out along x the tip is, alone.
    x = brentq(lambda x: ends(np.array([x, 0.0, 0.0]))[0] - x, 0.3, 1.0, xtol=1e-12)
    return 1.0 - float(ends(np.array([x, ends(np.array([x, 0.0, 0.0]))[1], 1e-4]))[2]) / 1e-4


@pytest.mark.slow
@pytest.mark.parametrize(("functions", "error"), [(5, 5e-4), pytest.param(7, 1e-4, marks=pytest.mark.slow)])
def test_a_strip_tips_over_where_shooting_says_at_a_finite_ratio_of_its_stiffnesses(
    functions: int, error: float
) -> None:
    """The strip bends by 0.6 rad on edge before it tips, which raises its load by half of that of a stiff one."""
    force = sf.BeamLoad((0.0, sf.formula("P", "load"), 0.0), at=1.0, axes="world")
    m = under(force, (4, functions, functions), GJ=STIFFNESS[0], EI_y=STIFFNESS[1], EI_z=STIFFNESS[2])
    q = np.zeros(4 + 2 * functions)
    known = brentq(tipping, 4.0, 6.0, xtol=1e-6)
    assert known > 1.4 * 4.0126 * np.sqrt(STIFFNESS[0] * STIFFNESS[1])  # Of a strip that stays straight on edge.
    least = []
    for P in ((1 - error) * known, (1 + error) * known):
        for _ in range(4):
            K = stiffness(m, q, P)[:4, :4]
            q[:4] += np.linalg.solve(K, m.with_parameters(P=P).generalized_force(q, 0 * q, ())[:4])
        K = stiffness(m, q, P)[4:, 4:]
        least.append(np.linalg.eigvalsh(0.5 * (K + K.T))[0])
    assert least[0] > 0.0 > least[1]
