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


def lagrangian_hessians(f: Any, options: dict[str, Any], given: list[np.ndarray], weights: np.ndarray) -> np.ndarray:
    """Second derivatives of weights . f by all inputs, by CasADi from what the function offers."""
    f = casadi.external(f[0], f[1], options)
    x = casadi.MX.sym("x", sum(map(len, given)))
    parts = casadi.vertsplit(x, [0, *np.cumsum([len(each) for each in given]).tolist()])
    H, _ = casadi.hessian(casadi.dot(casadi.DM(weights), f(*parts)), x)
    return np.array(casadi.Function("H", [x], [H])(np.concatenate(given)))


@pytest.mark.parametrize("name", ["forward_dynamics", "inverse_dynamics", "frame_position tip"])
def test_hessians_are_the_models_and_differences_of_casadis_gradients(model: sf.Model, name: str) -> None:
    dynamics = sf.interop.casadi.Dynamics(MODELS["cart_pole"], frames=["tip"])
    given = state(model, model.nv if name == "inverse_dynamics" else model.nu)
    given = [given[0], given[3]] if name.startswith("frame") else given
    rng = np.random.default_rng(4)
    weights = rng.standard_normal(3 if name.startswith("frame") else model.nv)
    where = dynamics.names[name], str(dynamics.library)
    exact = lagrangian_hessians(where, {}, given, weights)
    frame, base = ("tip", "frame_position") if name.startswith("frame") else ("", name)
    cotangent = {"forward_dynamics": "a_bar", "inverse_dynamics": "tau_bar", "frame_position": "p_WF_bar"}[base]
    groups = {"forward_dynamics": "q v u par", "inverse_dynamics": "q v a par", "frame_position": "q par"}[base].split()
    weighed = {cotangent: weights} | ({"lam_bar": np.zeros(0)} if base == "forward_dynamics" else {})
    (right,) = model.evaluate(f"{base}_hessian", frame, **dict(zip(groups, given, strict=True)), **weighed)
    np.testing.assert_allclose(exact, right, rtol=1e-12, atol=1e-12)
    # Central differences at two steps: their errors of second order cancel.
    coarse, fine = (differences_of_gradient(where, given, weights, step) for step in (4e-4, 2e-4))
    np.testing.assert_allclose(exact, (4 * fine - coarse) / 3, rtol=0, atol=1e-9 * np.abs(exact).max())


def differences_of_gradient(where: tuple[str, str], given: list[np.ndarray], weights: np.ndarray, h: float) -> Any:
    """Central differences of the gradient that CasADi gets of a function, by all inputs; its own are good to 1e-7."""
    gradient = casadi.external(f"adj1_{where[0]}", where[1])
    ends = np.cumsum([len(each) for each in given])[:-1]

    def at(x: np.ndarray) -> np.ndarray:
        return np.array(casadi.vertcat(*gradient(*np.split(x, ends), np.zeros(len(weights)), weights))).ravel()

    x = np.concatenate(given)
    return np.column_stack([(at(x + step) - at(x - step)) / (2 * h) for step in h * np.eye(len(x))])


def test_structural_zeros_of_hessians_are_left_out(dynamics: Any) -> None:
    """Efforts enter forward dynamics linearly and with no speed; nothing depends on where the cart is."""
    x = [casadi.MX.sym(name, n) for name, n in (("q", 2), ("v", 2), ("u", 1))]
    weighed = casadi.sum1(dynamics.forward_dynamics(*x))
    H = casadi.hessian(weighed, casadi.vertcat(*x))[0]
    nonzero = np.array(casadi.DM(casadi.Function("H", x, [H]).sparsity_out(0), 1)) != 0
    assert nonzero.astype(int).tolist() == [
        [0, 0, 0, 0, 0],
        [0, 1, 0, 1, 1],
        [0, 0, 0, 0, 0],
        [0, 1, 0, 1, 0],
        [0, 1, 0, 0, 0],
    ]


def test_loops_have_hessians_too() -> None:
    system = MODELS["four_bar"]
    model, dynamics = sf.compile(system), sf.interop.casadi.Dynamics(system)
    given = state(model, model.nu)
    weights = np.ones(model.nv)
    exact = lagrangian_hessians((dynamics.names["forward_dynamics"], str(dynamics.library)), {}, given, weights)
    at = dict(zip(("q", "v", "u", "par"), given, strict=True))
    (right,) = model.evaluate("forward_dynamics_hessian", **at, a_bar=weights, lam_bar=np.zeros(model.nc))
    np.testing.assert_allclose(exact, right, rtol=1e-9, atol=1e-11 * np.abs(right).max())


def test_frames_that_were_not_asked_for_are_refused(dynamics: Any) -> None:
    with pytest.raises(sf.UnknownNameError, match="frames are those that"):
        dynamics.frame_position("tip", [0.0, 0.0])


def test_wrong_frames_are_refused() -> None:
    with pytest.raises(sf.ArgumentError, match="one alone"):
        sf.interop.casadi.Dynamics(MODELS["cart_pole"], frames="tip")
    with pytest.raises(sf.UnknownNameError, match="tipp"):
        sf.interop.casadi.Dynamics(MODELS["cart_pole"], frames=["tipp"])


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
    quiet = {"print_level": 0, "max_iter": 300, "tol": 1e-7}
    opti.solver("ipopt", {"print_time": False}, quiet)
    solution = opti.solve()
    assert solution.stats()["iter_count"] <= 5  # 4 with exact Hessians, 6 with "limited-memory".
    at, speed = np.array([0.0, 0.2]), np.zeros(2)
    for force in np.atleast_1d(solution.value(u)):
        speed = speed + h * model.forward_dynamics(at, speed, np.array([force]))
        at = at + h * speed
    np.testing.assert_allclose([*at, *speed], 0.0, atol=1e-4)
