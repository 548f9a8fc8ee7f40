"""Physics that every mechanism obeys, whatever its joints."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from tests.models import CASES, model, sampled

STATES = 20
# Sums of some hundred terms of size one: their rounding.
ROUNDING = 1e-12
# Central differences with step 1e-5 of functions of size 1 to 100: error h^2 and eps/h.
DIFFERENCE = 1e-6
STEP = 1e-5


def states(case: str, rng: np.random.Generator) -> tuple[sf.Model, np.ndarray, np.ndarray]:
    m = model(case)
    pairs = [m.random_state(rng) for _ in range(STATES)]
    return m, np.array([q for q, _ in pairs]), np.array([v for _, v in pairs])


def elastic_force(m: sf.Model, q: np.ndarray) -> np.ndarray:
    """Q without speeds and inputs: what springs do."""
    return m.generalized_force(q, np.zeros((len(q), m.nv)), np.zeros((len(q), m.nu)))


@pytest.mark.parametrize("case", sampled(CASES))
def test_mass_matrix_is_symmetric_and_positive(case: str, rng: np.random.Generator) -> None:
    """And that of the kinetic energy."""
    m, q, v = states(case, rng)
    M = m.mass_matrix(q)
    assert np.array_equal(M, np.swapaxes(M, -1, -2))
    assert np.linalg.eigvalsh(M).min() > 0.0
    np.testing.assert_allclose(m.kinetic_energy(q, v), 0.5 * np.einsum("ni,nij,nj->n", v, M, v), rtol=ROUNDING)


@pytest.mark.parametrize("case", sampled(CASES))
def test_energy_changes_by_the_power_of_the_inputs(case: str, rng: np.random.Generator) -> None:
    """d(T + V)/dt = v . (Q less the springs', which V stores): ties M, h, Q, T, V and the manifold together."""
    m, q, v = states(case, rng)
    u = rng.standard_normal((STATES, m.nu))
    a = m.forward_dynamics(q, v, u)

    def energy(h: float) -> np.ndarray:
        # On a free joint the path with constant body velocity is exact to first order, which is all this needs.
        q_h, v_h = m.integrate(q, h * v), v + h * a
        return m.kinetic_energy(q_h, v_h) + m.potential_energy(q_h)

    power = np.sum(v * (m.generalized_force(q, v, u) - elastic_force(m, q)), axis=-1)
    rate = (energy(STEP) - energy(-STEP)) / (2 * STEP)
    np.testing.assert_allclose(rate, power, atol=DIFFERENCE * np.abs(energy(0.0)).max())


@pytest.mark.parametrize("case", sampled(CASES))
def test_forward_dynamics_inverts_inverse_dynamics(case: str, rng: np.random.Generator) -> None:
    m, q, v = states(case, rng)
    u = rng.standard_normal((STATES, m.nu))
    M, h, Q = m.dynamics(q, v, u)
    a = m.forward_dynamics(q, v, u)
    residual = np.einsum("nij,nj->ni", M, a) + h - Q
    scale = np.abs(M).max() * np.abs(a).max()
    np.testing.assert_allclose(residual, 0.0, atol=ROUNDING * scale)
    required = m.inverse_dynamics(q, v, a)
    driven = m.generalized_force(q, v, u) - m.generalized_force(q, v, 0.0 * u)
    np.testing.assert_allclose(required, driven, atol=ROUNDING * scale)


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
