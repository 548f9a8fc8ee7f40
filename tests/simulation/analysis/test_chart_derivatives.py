"""Slopes of the rates of rotation vectors, by the series near zero and in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from symofros.simulation.analysis.chart_derivatives import _SERIES, _rate_slopes


def rate(theta: np.ndarray, w: np.ndarray) -> np.ndarray:
    """theta' of a rotation vector, (2) of simulation.md in its closed form."""
    a = float(np.linalg.norm(theta))
    c = (1.0 - 0.5 * a / np.tan(0.5 * a)) / a**2
    tw = np.cross(theta, w)
    return np.asarray(w + 0.5 * tw + c * np.cross(theta, tw))


@pytest.mark.parametrize("angle", [0.05, 0.3 * _SERIES, 0.999 * _SERIES, 1.001 * _SERIES, 0.5, 2.0, 3.0])
def test_slopes_of_rates_are_central_differences(angle: float, rng: np.random.Generator) -> None:
    theta, w, h = rng.standard_normal(3), rng.standard_normal(3), 1e-4
    theta *= angle / np.linalg.norm(theta)
    differences = [(rate(theta + h * e, w) - rate(theta - h * e, w)) / (2.0 * h) for e in np.eye(3)]
    np.testing.assert_allclose(_rate_slopes(theta, w), np.transpose(differences), atol=2e-8)


def test_the_series_meets_the_closed_form(rng: np.random.Generator) -> None:
    """To rounding: the slope of c counts there by theta^2 alone."""
    theta, w = rng.standard_normal(3), rng.standard_normal(3)
    theta /= np.linalg.norm(theta)
    below, above = (_rate_slopes(theta * _SERIES * (1.0 + side), w) for side in (-1e-13, 1e-13))
    np.testing.assert_allclose(below, above, rtol=0.0, atol=2e-13)
