"""Steps of implicit methods are the same in all units: their rank decisions know no scale."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import symofros as sf
from tests.simulation.mechanisms import loop
from tests.simulation.oscillator import oscillator

_PARAMETERS = (sf.Parameter("L", 1.0), sf.Parameter("m", 1.0))


def _thin(length: str) -> sf.Inertia:
    j = sf.formula(f"m*({length})^2/12")
    return sf.Inertia(sf.formula("m"), (sf.formula(f"{length}/2"), 0, 0), (sf.formula(f"m*({length})^2/1200"), j, j))


@cache
def rolling_disc() -> sf.Model:
    moments = tuple(map(sf.formula, ("m*L^2/4", "m*L^2/4", "m*L^2/2")))
    disc = sf.RigidBody("disc", sf.Joint("pose", "free"), sf.Inertia(sf.formula("m"), (0, 0, 0), moments))
    contact = sf.Rolling("contact", ("disc", None), sf.formula("L"))
    return sf.compile(sf.System("disc", (disc,), _PARAMETERS, constraints=(contact,)))


@cache
def loop_in_space() -> sf.Model:
    """A planar four-bar, closed by a point in space: one of its three conditions says nothing but rounding."""
    rows = (("x", "y", "z"), ())
    return sf.compile(loop(("L/2", "L", "L"), "L", inertia=_thin, rows=rows, parameters=_PARAMETERS))


def end_of_disc(L: float, m: float, method: str) -> np.ndarray:
    """Speeds at the end of a short roll, in units of sqrt(g L) and sqrt(g/L)."""
    unit, tilt = np.sqrt(L / 9.81), 0.7
    q = np.array([0, 0, L * np.sin(tilt), np.sin(tilt / 2), 0, 0, np.cos(tilt / 2)])
    wish = np.array([0, 0, 0, 0, 5.0 * np.sin(tilt), 5.0 * np.cos(tilt) + 5.0]) / unit
    model = rolling_disc()
    at = sf.assemble(model, q, wish, held=model.names.v[3:], par=[L, m])
    run = sf.simulate(
        model, at.q, at.v, 0.5 * unit, par=[L, m], method=method, dt=0.01 * unit, adaptive=False, output=0.5 * unit
    )
    assert run.outcome.ok, run.outcome
    return run.v[-1] * unit / np.repeat([L, 1.0], 3)


def end_of_loop(L: float, m: float, method: str) -> np.ndarray:
    """Speeds at the end of a short swing, in units of sqrt(g/L)."""
    unit = np.sqrt(L / 9.81)
    at = sf.assemble(loop_in_space(), [1.2, -0.9, 1.4], [-1.0 / unit, 0, 0], held=("q1",), par=[L, m])
    run = sf.simulate(
        loop_in_space(), at.q, at.v, 0.5 * unit, par=[L, m], method=method, dt=0.01 * unit, adaptive=False
    )
    assert run.outcome.ok, run.outcome
    return run.v[-1] * unit


@pytest.mark.parametrize("method", ["rodas4", "implicit_euler", "generalized_alpha"])
@pytest.mark.parametrize("end", [end_of_disc, end_of_loop])
def test_constrained_motion_is_the_same_at_all_scales(end, method: str) -> None:
    """A disc of 0.1 mm and 10 mg stepped by rodas4 lost its inertia against conditions of order one."""
    reference = end(1.0, 1.0, method)
    for L, m in [(1e-4, 1e-5), (1e-6, 1e-9), (1e3, 1e-6), (1e4, 1e9)]:
        np.testing.assert_allclose(end(L, m, method), reference, rtol=0, atol=1e-5, err_msg=f"{L=} {m=}")


@pytest.mark.parametrize("method", ["dopri5", "dop853", "rodas4"])
@pytest.mark.parametrize("speed", [1e150, 1e300])
def test_adaptive_steps_do_not_begin_at_speeds_too_large_for_their_squares(method: str, speed: float) -> None:
    """The first step is no number then, and would never be made."""
    run = sf.simulate(oscillator(), v0=[speed], t_end=1.0, method=method)
    assert run.outcome.kind == "diverged" and run.outcome.t == 0.0
