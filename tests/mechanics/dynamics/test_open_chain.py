"""Mass matrix, bias and free acceleration of open_chain_5r at three states, against published engines' numbers.

Source: computed with Pinocchio 4.1.0 and MuJoCo 4.0.0, which agree on them to 8e-15, from a description of their own.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS

# Two recursions of five joints differ by their rounding, some 1e-14; the acceleration also by the condition of M, which
# is some hundred here.
ROUNDING = 1e-13
CONDITIONED = 1e-12

STATES = np.loadtxt(Path(__file__).with_name("open_chain_5r.txt")).reshape(3, 9, 5)


@pytest.mark.parametrize("state", STATES, ids=["first", "second", "third"])
def test_an_open_chain_matches_stored_results_of_other_engines(state: np.ndarray) -> None:
    model = sf.compile(MODELS["open_chain_5r"], sf.Options(backend="interpreter"))
    (q, v, bias, free), M = state[:4], state[4:]
    np.testing.assert_allclose(model.mass_matrix(q), M, rtol=0, atol=ROUNDING * np.abs(M).max())
    np.testing.assert_allclose(model.bias(q, v), bias, rtol=0, atol=ROUNDING * np.abs(bias).max())
    a = model.forward_dynamics(q, v, np.zeros(5))
    np.testing.assert_allclose(a, free, rtol=0, atol=CONDITIONED * np.abs(free).max())
