"""A cantilever under a dead load at its tip, bent by 86 degrees: geometrically exact rods against the elastica."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import symofros as sf

LOAD = 15.0


def elastica() -> np.ndarray:
    """Tip of the elastica of length and stiffness one, by shooting for the curvature at the clamp."""

    def tip(curvature: float) -> np.ndarray:
        def slope(_: float, y: np.ndarray) -> list[float]:
            return [y[1], -LOAD * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])]

        run = solve_ivp(slope, (0, 1), [0, curvature, 0, 0], method="DOP853", rtol=1e-12, atol=1e-13)
        return np.asarray(run.y[:, -1])

    return tip(brentq(lambda k: tip(k)[1], 3, 8, xtol=1e-14))[2:]


@pytest.mark.parametrize(("functions", "error"), [(3, 2.4e-3), (4, 3.7e-5), (5, 1.9e-5), (6, 5.2e-6), (7, 6.6e-7)])
def test_the_tip_converges_to_that_of_the_elastica(functions: int, error: float) -> None:
    load = sf.BeamLoad((0, LOAD, 0), at=1.0, axes="world")
    rod = sf.Beam(
        "rod",
        sf.Joint("root", "fixed"),
        1.0,
        1.0,
        EI_z=1.0,
        bend_y=functions,
        family="legendre",
        theory="strain",
        loads=(load,),
    )
    system = sf.System("s", (rod,), gravity=(0, 0, 0))
    m = sf.compile(system, sf.Options(("generalized_force", "frame_pose"), backend="interpreter"))
    q, step = np.zeros(functions), 1e-6 * np.eye(functions)
    q[0] = 1.2
    for _ in range(12):
        force = m.generalized_force(q, 0 * q, ())
        rows = [m.generalized_force(q + dq, 0 * q, ()) - m.generalized_force(q - dq, 0 * q, ()) for dq in step]
        q = q - np.linalg.solve(np.array(rows).T / 2e-6, force)
    p, _ = m.frame_pose("tip", q)
    assert np.abs(m.generalized_force(q, 0 * q, ())).max() < 1e-10
    assert 0.5 * error < np.hypot(*(p[:2] - elastica())) < error
