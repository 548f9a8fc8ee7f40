"""What geometrically exact rods are used with: functions of the user, C beside NumPy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import symofros as sf
from symofros.mechanics.beams.strain.theory import StrainShape
from tests.mechanics.beams.rods import HUB, STIFF, rod


def test_strains_of_the_user_that_are_legendres_give_the_same_equations(rng: np.random.Generator) -> None:
    shapes = {"bend_y": ("1", "2*xi - 1"), "bend_z": ("1",), "twist": ("1", "2*xi - 1", "6*xi^2 - 6*xi + 1")}
    theirs, ours = (
        sf.compile(
            sf.System("s", (rod((2, 1, 3), HUB, sections=6, **more),)), sf.Options(("dynamics",), backend="interpreter")
        )
        for more in ({}, {"family": "user", "shapes": shapes})
    )
    q, v = rng.standard_normal((2, theirs.nv))
    for a, b in zip(ours.dynamics(q, v, ()), theirs.dynamics(q, v, ()), strict=True):
        assert a == pytest.approx(b, rel=1e-12, abs=1e-12)


def test_user_strains_that_are_not_polynomials_place_the_tip() -> None:
    """A curvature cos(pi xi) in one plane: its angle is q/pi sin(pi xi)."""
    stated = rod((1, 0, 0), family="user", shapes={"bend_y": ("cos(pi*xi)",)}, sections=14)
    (tip,), _ = StrainShape(stated, {}, [1.0]).sections(np.array([2.5]))

    def slope(xi: float, _: np.ndarray) -> list[float]:
        angle = 2.5 / np.pi * np.sin(np.pi * xi)
        return [np.cos(angle), np.sin(angle)]

    known = solve_ivp(slope, (0.0, 1.0), [0.0, 0.0], "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    assert tip[:2] == pytest.approx(known, abs=1e-9)


@pytest.mark.parametrize("size", [0.0, 1e-300, 1e-9, 0.7])
def test_c_and_numpy_give_the_same_bits_at_small_and_no_curvature(size: float, rng: np.random.Generator) -> None:
    """The exponential has no branch and no quotient that vanishes."""
    system = sf.System("s", (rod((1, 1, 1), HUB, stretch=1, **STIFF),))
    # Without contraction, so that C and NumPy round alike.
    options = sf.Options(("dynamics",), (), flags=("-O2", "-ffp-contract=off"))
    compiled, m = sf.compile(system, options), sf.compile(system, replace(options, backend="interpreter"))
    q, v = np.concatenate([[0.3], size * rng.standard_normal(m.nv - 1)]), rng.standard_normal(m.nv)
    for a, b in zip(compiled.dynamics(q, v, ()), m.dynamics(q, v, ()), strict=True):
        assert np.isfinite(a).all()
        assert np.array_equal(a, b)
