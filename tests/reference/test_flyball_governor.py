"""The stiff flyball governor: its fastest mode; its motion is in test_iftomm.py.

Figures: reduced equations (angle of the shaft, angle of both rods, place of the slider); two initial speeds, because
public sources differ (IFToMM A05: one turn a second; Exudyn's example 0.16).
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.models import compiled

# Speed of the shaft -> fastest eigenvalue.
FASTEST = {6.283185307179586: -8117.203311123155, 1.0053096491487339: -8117.204635964803}


@pytest.mark.parametrize(("speed", "fastest"), FASTEST.items())
def test_the_fastest_mode_matches_reduced_equations(speed: float, fastest: float) -> None:
    m = compiled("flyball_governor")
    assert m.names.q == ("phi", "beta_right", "beta_left", "s")
    q, v = np.array([0.0, np.pi / 6, np.pi / 6, 0.5]), np.array([speed, 0.0, 0.0, 0.0])
    A, _ = m.linearize(q, v, [])
    assert np.linalg.eigvals(A).real.min() == pytest.approx(fastest, rel=1e-11)
