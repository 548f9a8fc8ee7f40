"""Stability of rods: flutter under a follower force, lateral buckling of a strip that bends on edge before it tips."""

from __future__ import annotations

import numpy as np
import pytest
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
