"""The generator against Lagrange's equations by quadrature and automatic differentiation, for everything kept."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from tests.mechanics.beams.cases import CASES, GRAVITY
from validation.adapters.lagrangian.tree import Lagrangian

# Both sides are sums of some thousand terms of size one, to rounding; the weight's energy may cancel to a hundredth.
TOLERANCE = 1e-12
# A formula's second derivative is that of its interpolant.
INEXACT = {"planar formulas": 1e-10, "user's own": 1e-10}
FUNCTIONS = ("mass_matrix", "bias", "generalized_force", "kinetic_energy", "potential_energy")


@pytest.mark.parametrize("name", CASES)
def test_everything_kept_equals_the_lagrangian(name: str, rng: np.random.Generator) -> None:
    case = CASES[name]
    model = sf.compile(case.system, sf.Options(FUNCTIONS, backend="interpreter"))
    oracle = Lagrangian(case.nodes, GRAVITY)
    driven = np.concatenate([np.array(x) for x in case.driven])
    for _ in range(2):
        q, v = 0.3 * rng.standard_normal(model.nq), rng.standard_normal(model.nv)
        expected = oracle(q, v, case.driven)
        u = driven if len(driven) else None
        found = {
            "M": model.mass_matrix(q, u=u),
            "h": model.bias(q, v, u=u),
            "Q": model.generalized_force(q, v, u),
            "T": model.kinetic_energy(q, v, u=u),
            "V": model.potential_energy(q, u=u),
        }
        for term, value in found.items():
            right = getattr(expected, term)
            error = np.linalg.norm(value - right) / np.linalg.norm(right)
            assert error < INEXACT.get(name, TOLERANCE), (term, error)
