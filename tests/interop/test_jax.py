"""JAX's own checkers on the dynamics, and the model's numbers through jit and vmap."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.late import late

jax = late("jax", extra="jax")


@pytest.fixture(autouse=True, scope="module")
def double_precision() -> Iterator[None]:
    earlier = jax.config.jax_enable_x64
    jax.config.update("jax_enable_x64", True)
    yield
    jax.config.update("jax_enable_x64", earlier)


@pytest.fixture(scope="module")
def model() -> sf.Model:
    return sf.compile(MODELS["cart_pole"])


@pytest.fixture(scope="module")
def dynamics(model: sf.Model, double_precision: None) -> Any:
    return sf.interop.jax.Dynamics(model)


def arrays(model: sf.Model, n: int, third: int) -> list[np.ndarray]:
    rng = np.random.default_rng(3)
    return [*(rng.standard_normal((n, size)) for size in (model.nq, model.nv, third)), model.parameter_values]


@pytest.mark.parametrize("name", ["forward_dynamics", "inverse_dynamics"])
def test_gradients_pass_jaxs_checker_in_both_modes(dynamics: Any, model: sf.Model, name: str) -> None:
    from jax.test_util import check_grads

    given = arrays(model, 3, model.nu if name == "forward_dynamics" else model.nv)
    check_grads(getattr(dynamics, name), given, order=1, modes=["fwd", "rev"])


@pytest.mark.parametrize("n", [1, 5, 600])
def test_jit_and_vmap_give_the_models_numbers(dynamics: Any, model: sf.Model, n: int) -> None:
    """Large batches by vectors, whose bits are those of the model's own."""
    q, v, u, _ = arrays(model, n, model.nu)
    right = model.forward_dynamics(q, v, u)
    np.testing.assert_array_equal(jax.jit(dynamics.forward_dynamics)(q, v, u), right)
    np.testing.assert_array_equal(jax.jit(jax.vmap(dynamics.forward_dynamics))(q, v, u), right)
    np.testing.assert_array_equal(jax.vmap(dynamics.forward_dynamics, (0, None, None))(q, v[0], u[0])[0], right[0])


def test_jacobians_are_the_models(dynamics: Any, model: sf.Model) -> None:
    q, v, u, _ = arrays(model, 4, model.nu)
    right = model.forward_dynamics_derivatives(q, v, u)
    for transform in (jax.jacfwd, jax.jacrev):
        slopes = jax.jit(jax.vmap(transform(dynamics.forward_dynamics, argnums=(0, 1, 2))))(q, v, u)
        for slope, wanted in zip(slopes, right, strict=True):
            np.testing.assert_allclose(slope, wanted, rtol=1e-12, atol=1e-12)


def test_each_state_may_have_its_own_parameters(dynamics: Any, model: sf.Model) -> None:
    q, v, u, par = arrays(model, 4, model.nu)
    many = np.stack([par, par, 1.1 * par, 1.2 * par])
    right = model.forward_dynamics(q, v, u, par=many)
    np.testing.assert_array_equal(jax.vmap(dynamics.forward_dynamics)(q, v, u, many), right)


def test_loops_are_differentiated_with_their_constraints(double_precision: None) -> None:
    four_bar = sf.compile(MODELS["four_bar"])
    closed = sf.assemble(four_bar, [1.2, -1.2, 1.2])
    wrapped = sf.interop.jax.Dynamics(four_bar)
    slope = jax.jacrev(wrapped.forward_dynamics)(closed.q, closed.v, np.zeros(four_bar.nu))
    right = four_bar.forward_dynamics_derivatives(closed.q, closed.v, np.zeros(four_bar.nu))[0]
    np.testing.assert_allclose(slope, right, rtol=1e-12, atol=1e-12)


def test_single_precision_and_wrong_shapes_are_refused_in_words(dynamics: Any, model: sf.Model) -> None:
    with pytest.raises(sf.SymofrosError, match=r"\(\.\.\., 2\)"):
        dynamics.forward_dynamics(np.zeros(3), np.zeros(2), np.zeros(1))
    jax.config.update("jax_enable_x64", False)
    try:
        with pytest.raises(sf.SymofrosError, match="jax_enable_x64"):
            dynamics.forward_dynamics(np.zeros(2), np.zeros(2), np.zeros(1))
    finally:
        jax.config.update("jax_enable_x64", True)
