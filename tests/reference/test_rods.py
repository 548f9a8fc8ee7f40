"""Geometrically exact rods at rest against exact solutions that the report on accuracy has not, and its bounds."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import symofros as sf
from validation.accuracy.statics import princeton, rods
from validation.accuracy.statics.elastica import exact
from validation.adapters.exudyn.ancf import Strip
from validation.adapters.exudyn.ancf import princeton as exact_elements


def ritz(functions: int) -> float:
    """The error that the report's bounds are of: least energy over Legendre curvatures, integrals by 60 Gauss nodes."""
    s, w = (np.polynomial.legendre.leggauss(60)[0] + 1) / 2, np.polynomial.legendre.leggauss(60)[1] / 2
    P = np.array([np.polynomial.Legendre.basis(k, domain=[0, 1]) for k in range(functions)])
    turn = np.array([p.integ(lbnd=0)(s) for p in P])
    K = np.array([np.sum(w * p(s) ** 2) for p in P])
    q = np.zeros(functions)
    for load in (5.0, 10.0, *[rods.LOAD] * 6):
        theta = q @ turn
        gradient = K * q - load * turn @ (w * np.cos(theta))
        q = q - np.linalg.solve(np.diag(K) + load * (turn * (w * np.sin(theta))) @ turn.T, gradient)
    deflection, shortening = exact(rods.LOAD)
    return max(abs(w @ np.cos(q @ turn) - 1 + shortening), abs(w @ np.sin(q @ turn) - deflection))


@pytest.mark.parametrize(
    ("functions", "error"), [(3, "2.3e-03"), (4, "3.5e-05"), (5, "1.8e-05"), (6, "3.6e-06"), (7, "5.7e-07")]
)
def test_error_bounds_of_the_elastica_match_a_ritz_solution(functions: int, error: str) -> None:
    assert f"{ritz(functions):.1e}" == error


@pytest.mark.slow
@pytest.mark.parametrize("load", princeton.LOADS)
def test_a_strip_under_each_load_of_the_experiment_bends_as_the_exact_rod_at_all_angles(load: float) -> None:
    """In place of measured points, which stand in the paper's figures alone."""
    errors = [rods.strip(3, degrees, load) for degrees in np.linspace(0.0, 90.0, 7)]
    assert max(errors) < rods.PRINCETON[3]


@pytest.mark.slow
@pytest.mark.parametrize("load", princeton.LOADS)
def test_a_strip_under_each_load_of_the_experiment_bends_as_elements_of_exudyn(load: float) -> None:
    """Elements without their error of second order; they stretch and shear, which moves the tip by 1.5e-5 L."""
    strip = Strip()
    stiffness = np.array([strip.GJ, strip.EI_y, strip.EI_z])
    for angle in np.radians([0.0, 30.0, 60.0, 90.0]):
        coarse, fine = (exact_elements(load, angle, elements)[0] for elements in (32, 64))
        known = (4.0 * fine - coarse) / 3.0 + (strip.length, 0.0, 0.0)
        loads = {"Fy": load * float(np.cos(angle)), "Fz": load * float(np.sin(angle))}
        tip = rods.spatial(strip.length, 3, stiffness, loads)
        assert np.abs(tip - known).max() < (2e-5 + rods.PRINCETON[3]) * strip.length


@pytest.mark.parametrize(("functions", "error"), [(3, 4e-3), (5, 2e-5), (7, 1.2e-6)])
def test_a_cantilever_hangs_from_its_root_as_the_heavy_elastica(functions: int, error: float) -> None:
    """Under a weight of rhoA g L^3/EI = 20, against the equation theta'' = 20 (1 - s) cos(theta) by shooting."""
    weight = 20.0

    def slope(s: float, y: np.ndarray) -> list[float]:
        theta, bend = y[:2]
        return [bend, weight * (1.0 - s) * np.cos(theta), np.cos(theta), np.sin(theta)]

    def ends(bend: float) -> np.ndarray:
        run = solve_ivp(slope, (0.0, 1.0), [0.0, bend, 0.0, 0.0], "DOP853", rtol=1e-12, atol=1e-13)
        return np.asarray(run.y[:, -1])

    at_root = brentq(lambda bend: float(ends(bend)[1]), -8.0, -2.0, xtol=1e-13)
    beam = sf.Beam(
        "rod", sf.Joint("root", "fixed"), 1.0, 1.0, EI_z=1.0, bend_y=functions, family="legendre", theory="strain"
    )
    m = sf.compile(sf.System("heavy", (beam,), gravity=(0.0, -weight, 0.0)))
    tip = m.frame_pose("tip", sf.equilibrium(m).q)[0]
    assert np.abs(tip[:2] - ends(at_root)[2:]).max() < error
