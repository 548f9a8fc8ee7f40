"""Singular postures on the way are found between the states that are looked at, however many loops there are."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from reference_models.closed.four_bars import n_four_bar
from symofros.simulation.analysis.postures import nearest_to_singular


@pytest.fixture(scope="module")
def row() -> sf.Model:
    return sf.compile(n_four_bar(24), sf.Options(functions=("constraint_jacobian",)))


def swept(m: sf.Model, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    signs = np.array([1.0 if name.startswith("crank") else -1.0 for name in m.names.q])
    return np.linspace(0.0, 1.0, len(angles)), angles[:, None] * signs


@pytest.mark.parametrize("lowest", [0.004, 0.02])
def test_the_weakest_of_many_states_is_found(row: sf.Model, lowest: float) -> None:
    """A dip of a hundredth of the run, that lies between any ninety states spread over it."""
    t = np.linspace(0.0, 1.0, 4001)
    angles = 1.0 - (1.0 - lowest) * np.exp(-(((t - 0.4567) / 0.02) ** 2))
    times, q = swept(row, angles)
    close = nearest_to_singular(row, times, q, np.zeros((len(t), row.nu)), row.parameter_values, row.nc)
    assert close is not None
    when, share = close
    assert when == pytest.approx(0.4567, abs=1e-3)
    assert share == pytest.approx(np.sin(lowest), rel=0.5)


def test_a_row_that_stays_upright_is_not_near(row: sf.Model) -> None:
    times, q = swept(row, np.linspace(1.2, 0.7, 500))
    assert nearest_to_singular(row, times, q, np.zeros((500, row.nu)), row.parameter_values, row.nc) is None
