"""A cantilever under a dead load at its tip: second-order theory against the elastica."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.reference.beams import FUNCTIONS, cantilever, compiled, data, stiffness

TABLE = data("elastica_tip_load")["table"]
THRESHOLDS = data("elastica_tip_load")["thresholds_on_linear_theory"]


@cache
def model() -> sf.Model:
    load = sf.BeamLoad((0, "P", 0), at=1.0, axes="world")
    beam = cantilever(bend_y=2, loads=(load,), retain="all")
    return compiled(beam, functions=(*FUNCTIONS, "frame_pose"), parameters=[sf.Parameter("P", 0.0)])


def tip(alpha: float) -> tuple[np.ndarray, np.ndarray]:
    """Position and axes of the tip at rest under P = alpha EI/L^2; two functions hold the cubic exactly."""
    m = model().with_parameters(P=alpha)
    force = m.generalized_force(np.zeros(2), np.zeros(2), ())
    p, R = m.frame_pose("tip", np.linalg.solve(stiffness(m), force))
    return p, R


@pytest.mark.parametrize("row", TABLE, ids=lambda row: f"alpha {row['alpha']}")
def test_second_order_tip_matches_its_known_distance_from_the_elastica(row: dict[str, Any]) -> None:
    alpha = row["alpha"]
    p, R = tip(alpha)
    assert p[1] == pytest.approx(alpha / 3, rel=1e-12)
    assert 1.0 - p[0] == pytest.approx(alpha**2 / 15, rel=1e-11)
    assert np.arctan2(R[1, 0], R[0, 0]) % (2 * np.pi) == pytest.approx((alpha / 2) % (2 * np.pi), rel=1e-12)
    assert p[1] / row["tip_y"] - 1.0 == pytest.approx(row["linear_y_rel_err"], rel=1e-7)
    assert (1.0 - p[0]) / row["tip_shortening"] - 1.0 == pytest.approx(row["second_order_shortening_rel_err"], rel=1e-7)


@pytest.mark.parametrize("error", ["0.01", "0.05", "0.1"])
def test_theory_errors_grow_with_tip_deflection_as_stated(error: str) -> None:
    """1 % at 0.10 L, 5 % at 0.21 L, 10 % at 0.30 L of tip deflection."""
    limit = THRESHOLDS[error]
    p, _ = tip(limit["alpha_linear_deflection"])
    assert p[1] / limit["tip_y_over_L"] - 1.0 == pytest.approx(float(error), rel=1e-6)
