"""PyTorch's own checkers on the dynamics, and the model's numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.late import late

torch = late("torch", extra="torch")


@pytest.fixture(scope="module")
def model() -> sf.Model:
    return sf.compile(MODELS["cart_pole"])


@pytest.fixture(scope="module")
def dynamics(model: sf.Model) -> Any:
    return sf.interop.torch.Dynamics(model)


def tensors(model: sf.Model, n: int, third: int) -> list[Any]:
    rng = np.random.default_rng(3)
    q, v = (torch.tensor(rng.standard_normal((n, model.nv)), requires_grad=True) for _ in range(2))
    w = torch.tensor(rng.standard_normal((n, third)), requires_grad=True)
    par = torch.tensor(model.parameter_values, requires_grad=True)
    return [q, v, w, par]


@pytest.mark.parametrize("name", ["forward_dynamics", "inverse_dynamics"])
def test_gradients_pass_torchs_checker_in_both_modes(dynamics: Any, model: sf.Model, name: str) -> None:
    given = tensors(model, 3, model.nu if name == "forward_dynamics" else model.nv)
    assert torch.autograd.gradcheck(getattr(dynamics, name), given, check_forward_ad=True, check_batched_grad=True)


def test_values_are_the_models(dynamics: Any, model: sf.Model) -> None:
    q, v, u, _ = (x.detach() for x in tensors(model, 5, model.nu))
    right = model.forward_dynamics(q.numpy(), v.numpy(), u.numpy())
    np.testing.assert_array_equal(dynamics.forward_dynamics(q, v, u).numpy(), right)


def test_functional_transforms_give_the_models_derivatives(dynamics: Any, model: sf.Model) -> None:
    q, v, u, _ = (x.detach() for x in tensors(model, 4, model.nu))
    by_q, by_v, by_u = model.forward_dynamics_derivatives(q.numpy(), v.numpy(), u.numpy())
    for transform in (torch.func.jacrev, torch.func.jacfwd):
        slopes = torch.func.vmap(transform(dynamics.forward_dynamics, argnums=(0, 1, 2)))(q, v, u)
        for slope, right in zip(slopes, (by_q, by_v, by_u), strict=True):
            np.testing.assert_allclose(slope.numpy(), right, rtol=1e-12, atol=1e-12)


def test_second_derivatives_are_refused_in_words(dynamics: Any, model: sf.Model) -> None:
    q, v, u, _ = tensors(model, 1, model.nu)
    (slope,) = torch.autograd.grad(dynamics.forward_dynamics(q, v, u).sum(), q, create_graph=True)
    with pytest.raises(sf.SymofrosError, match="second derivatives"):
        slope.sum().backward()


def test_single_precision_is_refused_in_words(dynamics: Any, model: sf.Model) -> None:
    q = torch.zeros(model.nv)
    with pytest.raises(sf.SymofrosError, match="float64 on the CPU"):
        dynamics.forward_dynamics(q, q, q)


def test_loops_keep_their_constraints_in_the_derivatives() -> None:
    four_bar = sf.compile(MODELS["four_bar"])
    closed = sf.assemble(four_bar, [1.2, -1.2, 1.2])
    wrapped = sf.interop.torch.Dynamics(four_bar)
    q, v = torch.tensor(closed.q), torch.tensor(closed.v)
    u = torch.zeros(four_bar.nu, dtype=torch.float64)
    slope = torch.func.jacrev(wrapped.forward_dynamics)(q, v, u)
    np.testing.assert_allclose(
        slope.numpy(), four_bar.forward_dynamics_derivatives(closed.q, closed.v, u.numpy())[0], rtol=1e-12, atol=1e-12
    )
