"""JAX's own checkers on the dynamics, and the model's numbers through jit and vmap."""

from __future__ import annotations

import pickle
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.interop.turning import SYSTEMS, states, unit
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


@pytest.mark.parametrize("n", [5, 600])
def test_jit_and_vmap_give_the_models_numbers(dynamics: Any, model: sf.Model, n: int) -> None:
    """Large batches by vectors, whose bits are those of the model's own."""
    q, v, u, _ = arrays(model, n, model.nu)
    right = model.forward_dynamics(q, v, u)
    np.testing.assert_array_equal(jax.jit(dynamics.forward_dynamics)(q, v, u), right)
    np.testing.assert_array_equal(jax.jit(jax.vmap(dynamics.forward_dynamics))(q, v, u), right)
    np.testing.assert_array_equal(jax.vmap(dynamics.forward_dynamics, (0, None, None))(q, v[0], u[0])[0], right[0])


def test_jax_jacobians_match_the_model(dynamics: Any, model: sf.Model) -> None:
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


@pytest.fixture(scope="module", params=SYSTEMS)
def turning(request: pytest.FixtureRequest, double_precision: None) -> tuple[sf.Model, Any]:
    m = sf.compile(SYSTEMS[request.param]())
    return m, sf.interop.jax.Dynamics(m)


def test_quaternions_of_any_length_pass_jaxs_checker(turning: tuple[sf.Model, Any]) -> None:
    from jax.test_util import check_grads

    m, wrapped = turning
    rng = np.random.default_rng(5)
    q, v = states(m, 2, rng)
    u, a, par = rng.standard_normal((2, m.nu)), rng.standard_normal((2, m.nv)), m.parameter_values

    @jax.jit
    def both(q: Any, v: Any, u: Any, a: Any, par: Any) -> Any:
        return wrapped.forward_dynamics(q, v, u, par), wrapped.inverse_dynamics(q, v, a, par)

    right = m.forward_dynamics(unit(m, q), v, u), m.inverse_dynamics(unit(m, q), v, a)
    np.testing.assert_allclose(both(q, v, u, a, par), right, rtol=1e-12, atol=1e-12)
    check_grads(both, (q, v, u, a, par), order=1, modes=["fwd", "rev"])


@pytest.mark.parametrize("scale", [0.0, 2.5])
def test_motions_along_the_manifold_are_the_models(turning: tuple[sf.Model, Any], scale: float) -> None:
    """Differentiable by JAX, at no turn as well, and on both sides of where a series ends."""
    from jax.test_util import check_grads

    m, wrapped = turning
    rng = np.random.default_rng(7)
    q, dq = states(m, 2, rng)
    dq *= scale / max(1.0, float(np.abs(dq).max()))
    ends = m.integrate(unit(m, q), dq)
    np.testing.assert_allclose(wrapped.integrate(q, dq), ends, rtol=1e-13, atol=1e-14)
    np.testing.assert_allclose(wrapped.difference(q, ends), dq, rtol=1e-9, atol=1e-14)
    h = 1e-6
    rates = (m.integrate(unit(m, q), h * dq) - m.integrate(unit(m, q), -h * dq)) / (2 * h)
    np.testing.assert_allclose(wrapped.coordinate_rates(unit(m, q), dq), rates, atol=1e-8)

    @jax.jit
    def every(q: Any, dq: Any, ends: Any) -> Any:
        return wrapped.integrate(q, dq), wrapped.coordinate_rates(q, dq), wrapped.difference(q, ends)

    check_grads(every, (q[0], dq[0], ends[0]), order=1, modes=["fwd", "rev"])


def test_dynamics_can_be_sent_to_other_processes(dynamics: Any, model: sf.Model) -> None:
    q, v, u, _ = arrays(model, 2, model.nu)
    again = pickle.loads(pickle.dumps(dynamics))
    np.testing.assert_array_equal(again.forward_dynamics(q, v, u), dynamics.forward_dynamics(q, v, u))


def test_second_derivatives_are_refused(dynamics: Any, model: sf.Model) -> None:
    """When they are traced, not by XLA."""
    q, v, u, _ = (x[0] for x in arrays(model, 1, model.nu))
    for transform in (jax.hessian, lambda f: jax.jit(jax.hessian(f)), lambda f: jax.jacrev(jax.jacrev(f))):
        with pytest.raises(sf.SymofrosError, match=r"forward_dynamics_hessian"):
            transform(lambda q: dynamics.forward_dynamics(q, v, u)[1])(q)


def test_untraced_parameters_are_checked(dynamics: Any, model: sf.Model) -> None:
    q, v, u, par = arrays(model, 1, model.nu)
    with pytest.raises(sf.ParameterError, match="run-time parameters"):
        dynamics.forward_dynamics(q, v, u, jax.numpy.asarray(-par))


@pytest.mark.parametrize("label", ["q", "par"])
def test_arrays_of_single_precision_are_refused(dynamics: Any, model: sf.Model, label: str) -> None:
    q, v, u, par = arrays(model, 1, model.nu)
    given = {"q": q, "v": v, "u": u, "par": par}
    given[label] = jax.numpy.asarray(given[label], dtype="float32")
    with pytest.raises(sf.SymofrosError, match=f"'{label}' can't be taken"):
        dynamics.forward_dynamics(**given)


def test_single_precision_and_wrong_shapes_are_refused(dynamics: Any, model: sf.Model) -> None:
    with pytest.raises(sf.SymofrosError, match=r"\(\.\.\., 2\)"):
        dynamics.forward_dynamics(np.zeros(3), np.zeros(2), np.zeros(1))
    jax.config.update("jax_enable_x64", False)
    try:
        with pytest.raises(sf.SymofrosError, match="jax_enable_x64"):
            dynamics.forward_dynamics(np.zeros(2), np.zeros(2), np.zeros(1))
    finally:
        jax.config.update("jax_enable_x64", True)
