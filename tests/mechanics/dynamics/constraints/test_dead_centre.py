"""A rod beside its dead centre, between a wheel and a slider of any masses: closed form with fifty digits."""

from __future__ import annotations

from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest

import symofros as sf

DIGITS = mpmath.MPContext()
DIGITS.dps = 50
FORMS = ("multipliers", "null_space")


@cache
def model(form: Any, backend: Any) -> sf.Model:
    """A wheel of inertia J and radius 1 m whose rim a rod of 2 m ties to a slider of mass m."""
    rim = (sf.Frame("rim", (1.0, 0, 0)),)
    spin = sf.Joint("q", "revolute", axis=(0, -1, 0))
    wheel = sf.RigidBody("wheel", spin, sf.Inertia(1.0, (0, 0, 0), ("J",) * 3), rim)
    slider = sf.RigidBody("slider", sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Inertia("m"))
    rod = sf.Rod("rod", ("wheel", "rim"), ("slider", None), 2.0)
    parameters = (sf.Parameter("J", 1.0), sf.Parameter("m", 1.0))
    system = sf.System("dead_centre", (wheel, slider), parameters, constraints=(rod,))
    return sf.compile(system, sf.Options(("forward_dynamics",), constraints=form, backend=backend))


def exact(q: float, x: float, w: float, v: float, J: float, m: float) -> tuple[float, float, float]:
    """Accelerations of wheel and slider, and the multiplier, of the posture as it is."""
    q, x, w, v, J, m = map(DIGITS.mpf, (q, x, w, v, J, m))
    cos, sin = DIGITS.cos(q), DIGITS.sin(q)
    d, u = (x - cos, -sin), (v + w * sin, -w * cos)  # From rim to slider, and its rate.
    on_wheel, on_slider = (d[0] * sin - d[1] * cos) / 2, d[0] / 2
    gamma = -(d[0] * w * w * cos + d[1] * w * w * sin + u[0] ** 2 + u[1] ** 2) / 2
    lam = gamma / (on_wheel**2 / J + on_slider**2 / m)
    return float(on_wheel * lam / J), float(on_slider * lam / m), float(lam)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("backend", ["c", "interpreter"])
def test_forces_near_a_dead_centre_match_theory(form: str, backend: str) -> None:
    """Entries of G are 1e-16 off, of what the distance leaves of them; no ratio of masses costs a digit more."""
    one = model(form, backend)
    for distance in 10.0 ** -np.arange(2.0, 13.0):
        for ratio in 10.0 ** np.arange(-12.0, 13.0, 3.0):
            J, m = max(1.0, 1.0 / ratio), max(1.0, ratio)
            q, v = np.array([np.pi / 2, distance]), np.array([1.0, -0.7])
            a, lam, rank = one.constrained_dynamics(q, v, np.zeros(0), par=np.array([J, m]))
            wanted = exact(*q, *v, J, m)
            assert int(rank) == 1
            errors = np.abs(np.array([*a, *lam]) / wanted - 1.0)
            assert errors.max() < 1e-13 + 3e-15 / distance, (distance, ratio, errors)
