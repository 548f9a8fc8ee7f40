"""CasADi's external functions: the model's numbers, exact sparse Jacobians, an optimisation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.late import late

casadi = late("casadi", extra="casadi")


@pytest.fixture(scope="module")
def model() -> sf.Model:
    return sf.compile(MODELS["cart_pole"])


@pytest.fixture(scope="module")
def dynamics() -> Any:
    return sf.interop.casadi.Dynamics(MODELS["cart_pole"])


def state(model: sf.Model, third: int) -> list[np.ndarray]:
    rng = np.random.default_rng(3)
    return [*(rng.standard_normal(size) for size in (model.nq, model.nv, third)), model.parameter_values]


@pytest.mark.parametrize("name", ["forward_dynamics", "inverse_dynamics"])
def test_values_and_jacobians_are_the_models(dynamics: Any, model: sf.Model, name: str) -> None:
    given = state(model, model.nu if name == "forward_dynamics" else model.nv)
    right = getattr(model, name)(*given[:3])
    np.testing.assert_allclose(np.array(dynamics.functions[name](*given)).ravel(), right, rtol=1e-12)
    slopes = dynamics.functions[name].jacobian()(*given, right)
    derivatives = [*getattr(model, f"{name}_derivatives")(*given[:3])]
    if name == "inverse_dynamics":
        derivatives.append(model.mass_matrix(given[0]))
    derivatives.append(getattr(model, f"{name}_by_par")(*given[:3]))
    for slope, wanted in zip(slopes, derivatives, strict=True):
        np.testing.assert_allclose(np.array(slope), wanted, rtol=1e-12, atol=1e-12)


def test_jacobians_agree_with_casadis_finite_differences(dynamics: Any, model: sf.Model) -> None:
    off = {"enable_fd": True, "enable_jacobian": False, "enable_forward": False, "enable_reverse": False}
    rough = casadi.external(dynamics.names["forward_dynamics"], str(dynamics.library), off)
    given = state(model, model.nu)
    x = [casadi.MX.sym(f"x{i}", len(each)) for i, each in enumerate(given)]
    exact, differenced = (
        casadi.Function("J", x, [casadi.jacobian(f(*x), casadi.vertcat(*x[:3]))])
        for f in (dynamics.functions["forward_dynamics"], rough)
    )
    np.testing.assert_allclose(np.array(exact(*given)), np.array(differenced(*given)), rtol=1e-5, atol=1e-6)


def test_structural_zeros_are_left_out(dynamics: Any) -> None:
    """Nothing of a cart and pole depends on where the cart is, nor on how fast it is."""
    jacobian = dynamics.functions["inverse_dynamics"].jacobian()
    assert jacobian.sparsity_out(0).nnz() < 4 and jacobian.sparsity_out(1).nnz() < 4
    assert jacobian.sparsity_out(2).nnz() == 4


def test_ipopt_swings_the_pole_by_the_external_function(dynamics: Any, model: sf.Model) -> None:
    steps, h = 20, 0.05
    opti = casadi.Opti()
    q, v, u = opti.variable(2, steps + 1), opti.variable(2, steps + 1), opti.variable(1, steps)
    opti.minimize(casadi.sumsqr(u) * h)
    for k in range(steps):
        a = dynamics.forward_dynamics(q[:, k], v[:, k], u[:, k])
        opti.subject_to(v[:, k + 1] == v[:, k] + h * a)
        opti.subject_to(q[:, k + 1] == q[:, k] + h * v[:, k + 1])
    opti.subject_to(q[:, 0] == [0.0, 0.2])
    opti.subject_to(v[:, 0] == [0.0, 0.0])
    opti.subject_to(q[:, steps] == [0.0, 0.0])
    opti.subject_to(v[:, steps] == [0.0, 0.0])
    quiet = {"print_level": 0, "hessian_approximation": "limited-memory", "max_iter": 300, "tol": 1e-7}
    opti.solver("ipopt", {"print_time": False}, quiet)
    solution = opti.solve()
    at, speed = np.array([0.0, 0.2]), np.zeros(2)
    for force in np.atleast_1d(solution.value(u)):
        speed = speed + h * model.forward_dynamics(at, speed, np.array([force]))
        at = at + h * speed
    np.testing.assert_allclose([*at, *speed], 0.0, atol=1e-4)
