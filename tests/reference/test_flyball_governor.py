"""The stiff flyball governor: its fastest mode, and half a second of motion.

Figures: reduced equations (angle of the shaft, angle of both rods, place of the slider) solved by an implicit method,
and Pinocchio; two initial speeds, because public sources differ (IFToMM A05: one turn a second; Exudyn's example 0.16).
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.models import compiled

# Speed of the shaft -> fastest eigenvalue, and shaft, rods, slider after 0.5 s.
RUNS = {
    6.283185307179586: (-8117.203311123155, (2.8076794883678655, 0.25949138154265694, 0.7432494247871565)),
    1.0053096491487339: (-8117.204635964803, (1.5356492230532157, 1.384035177278509, 0.01735175107091301)),
}


@pytest.mark.parametrize("speed", RUNS)
def test_against_reduced_equations(speed: float) -> None:
    fastest, (phi, beta, s) = RUNS[speed]
    m = compiled("flyball_governor")
    assert m.names.q == ("phi", "beta_right", "beta_left", "s")
    q, v = np.array([0.0, np.pi / 6, np.pi / 6, 0.5]), np.array([speed, 0.0, 0.0, 0.0])
    A, _ = m.linearize(q, v, [])
    assert np.linalg.eigvals(A).real.min() == pytest.approx(fastest, rel=1e-11)
    # An explicit method takes steps of 3 / 8117 s here, whatever its tolerance.
    motion = solve_ivp(
        lambda t, y: np.concatenate([y[4:], m.forward_dynamics(y[:4], y[4:], [])]),
        (0.0, 0.5),
        np.concatenate([q, v]),
        "DOP853",
        rtol=1e-9,
        atol=1e-11,
    )
    assert motion.y[:4, -1] == pytest.approx([phi, beta, beta, s], abs=1e-8)
