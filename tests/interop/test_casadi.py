"""CasADi's external functions: the model's numbers, exact sparse Jacobians, an optimisation."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.interop.turning import SYSTEMS, rate_matrix, states, turns, unit
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


def lagrangian_hessians(f: Any, options: dict[str, Any], given: list[np.ndarray], weights: np.ndarray) -> np.ndarray:
    """Second derivatives of weights . f by all inputs, by CasADi from what the function offers."""
    f = casadi.external(f[0], f[1], options)
    x = casadi.MX.sym("x", sum(map(len, given)))
    parts = casadi.vertsplit(x, [0, *np.cumsum([len(each) for each in given]).tolist()])
    H, _ = casadi.hessian(casadi.dot(casadi.DM(weights), f(*parts)), x)
    return np.array(casadi.Function("H", [x], [H])(np.concatenate(given)))


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


def test_casadi_hessians_of_loops_match_the_model() -> None:
    system = MODELS["four_bar"]
    model, dynamics = sf.compile(system), sf.interop.casadi.Dynamics(system)
    given = state(model, model.nu)
    weights = np.ones(model.nv)
    exact = lagrangian_hessians((dynamics.names["forward_dynamics"], str(dynamics.library)), {}, given, weights)
    at = dict(zip(("q", "v", "u", "par"), given, strict=True))
    (right,) = model.evaluate("forward_dynamics_hessian", **at, a_bar=weights, lam_bar=np.zeros(model.nc))
    np.testing.assert_allclose(exact, right, rtol=1e-9, atol=1e-11 * np.abs(right).max())


def test_dynamics_can_be_sent_to_other_processes(dynamics: Any, model: sf.Model) -> None:
    again = pickle.loads(pickle.dumps(dynamics))
    assert again.library == dynamics.library and again.names == dynamics.names
    q, v, u = np.full(model.nq, 0.1), np.full(model.nv, 0.2), np.full(model.nu, 0.3)
    np.testing.assert_array_equal(again.forward_dynamics(q, v, u), dynamics.forward_dynamics(q, v, u))


def test_frames_that_were_not_asked_for_are_refused(dynamics: Any) -> None:
    with pytest.raises(sf.UnknownNameError, match="frames are those that"):
        dynamics.frame_position("tip", [0.0, 0.0])


@pytest.fixture(scope="module", params=SYSTEMS)
def turning(request: pytest.FixtureRequest) -> tuple[sf.Model, Any]:
    system = SYSTEMS[request.param]()
    return sf.compile(system), sf.interop.casadi.Dynamics(system, frames=["toe"])


def with_arguments(m: sf.Model, name: str) -> tuple[list[np.ndarray], np.ndarray]:
    """Arguments of a function, quaternions of any length, and the model's value there."""
    rng = np.random.default_rng(11)
    q, v = (x[0] for x in states(m, 1, rng))
    if name.startswith("frame"):
        return [q, m.parameter_values], m.frame_pose("toe", unit(m, q))[0]
    third = rng.standard_normal(m.nu if name == "forward_dynamics" else m.nv)
    return [q, v, third, m.parameter_values], getattr(m, name)(unit(m, q), v, third)


def differences(f: Any, x: np.ndarray) -> np.ndarray:
    """Derivatives of a function of CasADi by differences whose errors of second order cancel."""

    def central(h: float) -> np.ndarray:
        return np.column_stack([np.array(f(x + e) - f(x - e)).ravel(order="F") / (2 * h) for e in h * np.eye(len(x))])

    return (4 * central(2e-4) - central(4e-4)) / 3


@pytest.mark.parametrize("name", ["forward_dynamics", "inverse_dynamics", "frame_position toe"])
def test_derivatives_of_quaternions_of_any_length_up_to_the_second(turning: tuple[sf.Model, Any], name: str) -> None:
    """Values, Jacobians, gradients, their Hessians, and derivatives of the Jacobian itself."""
    m, dynamics = turning
    given, right = with_arguments(m, name)
    x, at = casadi.MX.sym("x", sum(map(len, given))), np.concatenate(given)
    parts = casadi.vertsplit(x, [0, *np.cumsum([len(each) for each in given]).tolist()])
    value = dynamics.functions[name](*parts)
    rng = np.random.default_rng(12)
    weights, direction = casadi.DM(rng.standard_normal(len(right))), casadi.DM(rng.standard_normal(len(at)))
    H, gradient = casadi.hessian(casadi.dot(weights, value), x)
    J = casadi.jacobian(value, x)
    made = {"value": value, "J": J, "g": gradient, "H": H, "Jd": J @ direction}
    made["JJd"] = casadi.jacobian(made["Jd"], x)
    f = {key: casadi.Function(key, [x], [each]) for key, each in made.items()}
    np.testing.assert_allclose(np.array(f["value"](at)).ravel(), right, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(np.array(weights.T @ f["J"](at)), np.array(f["g"](at)).T, rtol=1e-10, atol=1e-12)
    for slope, of in (("J", "value"), ("H", "g"), ("JJd", "Jd")):
        exact = np.array(f[slope](at))
        np.testing.assert_allclose(exact, differences(f[of], at), rtol=0, atol=1e-8 * np.abs(exact).max())
    H = np.array(f["H"](at))
    np.testing.assert_allclose(H, H.T, rtol=0, atol=1e-12 * np.abs(H).max())
    for turn in turns(m):  # Nothing depends on the length of a quaternion: by Euler's theorem H q = -g.
        np.testing.assert_allclose(H[turn, turn] @ at[turn], -np.array(f["g"](at)).ravel()[turn], rtol=1e-9, atol=1e-11)


def test_motions_along_the_manifold_are_the_models(turning: tuple[sf.Model, Any]) -> None:
    m, dynamics = turning
    rng = np.random.default_rng(13)
    q, dq = (x[0] for x in states(m, 1, rng))
    for scale in (0.0, 1e-9, 0.01, 1.0):
        end = m.integrate(unit(m, q), scale * dq)
        np.testing.assert_allclose(np.array(dynamics.integrate(q, scale * dq)).ravel(), end, rtol=1e-13, atol=1e-14)
        back = np.array(dynamics.difference(q, end)).ravel()
        np.testing.assert_allclose(back, scale * dq, rtol=1e-9, atol=1e-14)
    at = unit(m, q)
    np.testing.assert_allclose(np.array(dynamics.coordinate_rates(at, dq)).ravel(), rate_matrix(m, at) @ dq, atol=1e-8)


@pytest.mark.parametrize("method", ["cvodes", "idas"])
@pytest.mark.parametrize("name", ["cart_pole", "hopper"])
def test_casadi_integrators_give_correct_sensitivities(method: str, name: str) -> None:
    """The Jacobian of the end by start and inputs, that of `rk` on many elements; quaternions keep their length."""
    system = MODELS[name] if name in MODELS else SYSTEMS[name]()
    m, dynamics = sf.compile(system), sf.interop.casadi.Dynamics(system)
    x, u = casadi.MX.sym("x", m.nq + m.nv), casadi.MX.sym("u", m.nu)
    ode = {"x": x, "p": u, "ode": dynamics.state_derivative(x, u)}
    rng = np.random.default_rng(14)
    start = np.concatenate([m.integrate(m.neutral(), rng.standard_normal(m.nv)), rng.standard_normal(m.nv)])
    ends = []
    for each, options in (("rk", {"number_of_finite_elements": 100}), (method, {"abstol": 1e-10, "reltol": 1e-10})):
        step = casadi.integrator("step", each, ode, 0, 0.3, options)(x0=x, p=u)["xf"]
        f = casadi.Function("f", [x, u], [step, casadi.jacobian(step, casadi.vertcat(x, u))])
        ends.append([np.array(part) for part in f(start, np.ones(m.nu))])
    # Errors of the integrators, of tolerance 1e-10 a step.
    for found, right in zip(*ends, strict=True):
        np.testing.assert_allclose(found, right, rtol=0, atol=1e-6 * np.abs(right).max())
    for turn in turns(m):
        assert np.linalg.norm(ends[0][0][turn]) == pytest.approx(1.0, abs=1e-9)


def test_methods_are_the_functions_by_name(dynamics: Any, model: sf.Model) -> None:
    """With the model's parameters where none are stated, and with others."""
    for par in (None, 1.5 * np.asarray(model.parameter_values)):
        for name in ("forward_dynamics", "inverse_dynamics"):
            given = state(model, model.nu if name == "forward_dynamics" else model.nv)[:3]
            found = getattr(dynamics, name)(*given, par)
            np.testing.assert_allclose(np.array(found).ravel(), getattr(model, name)(*given, par=par), rtol=1e-12)


@pytest.mark.parametrize("given", [(0.1, [0, 0], [0]), ([0, 0], [0, 0], []), ([0, 0, 0], [0, 0], 0), ([0], [0, 0], 0)])
def test_arrays_that_casadi_would_fill_up_are_refused(dynamics: Any, given: Any) -> None:
    """A single entry is repeated, an empty array is zeros to it."""
    with pytest.raises(sf.SymofrosError, match="does not fit"):
        dynamics.forward_dynamics(*given)


def test_states_of_forces_have_their_entries() -> None:
    """An accelerated mass: 2000 N came of a speed that CasADi repeated for the bristle."""
    bristle = sf.LuGre(1.0, stiffness=1e4, damping=10.0)
    cart = sf.RigidBody("cart", sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=[bristle]), sf.Inertia(1.0))
    dynamics = sf.interop.casadi.Dynamics(sf.System("sliding", [cart]), second_order=False)
    with pytest.raises(sf.SymofrosError, match="q does not fit(.|\n)*bristle"):
        dynamics.forward_dynamics([0.0], [0.2], [])
