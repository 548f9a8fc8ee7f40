"""Physics that every mechanism obeys, whatever its joints."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from tests.models import CASES, model, sampled, system
from tests.validation.subjects import assert_agrees
from validation.procedures.equations import identities

STATES = 20
# Sums of some hundred terms of size one: their rounding.
ROUNDING = 1e-12


def states(case: str, rng: np.random.Generator) -> tuple[sf.Model, np.ndarray, np.ndarray]:
    m = model(case)
    pairs = [m.random_state(rng) for _ in range(STATES)]
    return m, np.array([q for q, _ in pairs]), np.array([v for _, v in pairs])


@pytest.mark.parametrize("case", sampled(CASES))
def test_mass_matrix_is_symmetric_and_positive(case: str, rng: np.random.Generator) -> None:
    m, q, _ = states(case, rng)
    M = m.mass_matrix(q)
    assert np.array_equal(M, np.swapaxes(M, -1, -2))
    assert np.linalg.eigvalsh(M).min() > 0.0


@pytest.mark.parametrize("case", sampled(CASES))
def test_energy_changes_by_the_power_of_the_inputs(case: str) -> None:
    """And forward dynamics inverts inverse dynamics: ties M, h, Q, T, V and the manifold together."""
    assert_agrees(identities.balanced, system(case))


@pytest.mark.parametrize("case", sampled(CASES))
def test_fused_functions_equal_single_ones(case: str, rng: np.random.Generator) -> None:
    m, q, v = states(case, rng)
    u = rng.standard_normal((STATES, m.nu))
    alone = m.mass_matrix(q), m.bias(q, v), m.generalized_force(q, v, u)
    for fused, single in zip(m.dynamics(q, v, u), alone, strict=True):
        # Sums are added up in an order that depends on who else reads their parts: the last bits may differ.
        np.testing.assert_allclose(fused, single, rtol=0, atol=ROUNDING * np.abs(single).max(initial=1.0))


@pytest.mark.parametrize("case", [case for case in CASES if case.startswith("parametrised")])
def test_parameters_and_constants_give_the_same_numbers(case: str, rng: np.random.Generator) -> None:
    m, q, v = states(case, rng)
    constant = model(case.replace("parametrised", "tree"))
    scale = np.abs(constant.bias(q, v)).max()
    np.testing.assert_allclose(m.mass_matrix(q), constant.mass_matrix(q), atol=ROUNDING * scale)
    np.testing.assert_allclose(m.bias(q, v), constant.bias(q, v), atol=ROUNDING * scale)
    np.testing.assert_allclose(m.potential_energy(q), constant.potential_energy(q), atol=ROUNDING * scale)
