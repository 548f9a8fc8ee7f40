"""States of forces in the equations: derivatives, balances, what does not know them (docs/theory/states.md)."""

from __future__ import annotations

import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.expr.edges import ZERO
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.topology.tree import build_tree


def bristles(coordinate: int = 0) -> sf.LuGre:
    return sf.LuGre(2.0, 300.0, 2.0, static=3.0, stribeck_velocity=0.5, viscous=0.3, coordinate=coordinate)


def arm(closed: bool = False) -> sf.System:
    """A ball joint, a hinge and a slide, with all elements that have states, and states of formulas."""
    ball = sf.Joint("ball", "ball", elements=(bristles(), sf.Hysteresis(20.0, 1.0, coordinate=2)))
    slips = sf.Hysteresis(20.0, 1.0), sf.Hysteresis(30.0, 0.4, sharpness=3.0)
    hinge = sf.Joint(
        "q", "revolute", parent="upper", position=(0.5, 0, 0), axis=(0, 1, 0), elements=(bristles(), *slips)
    )
    slide = sf.Joint("x", "prismatic", parent="fore", position=(0.1, 0, 0), elements=(bristles(),), actuated=True)
    inertia, frames = sf.Inertia(1.0, (0.2, 0, 0.1), (0.1,) * 3), (sf.Frame("tip", (0.6, 0, 0)),)
    return sf.System(
        "arm",
        [
            sf.RigidBody("upper", ball, sf.Inertia(1.5, (0.2, 0.1, 0), (0.1, 0.2, 0.15))),
            sf.RigidBody("fore", hinge, inertia, frames, loads=(sf.Load(("3*y", "0", "2*w")),)),
            sf.RigidBody("hand", slide, sf.Inertia(0.7, (0, 0, 0.1), (0.1,) * 3)),
        ],
        (sf.Parameter("k", 2.0),),
        states=(sf.ForceState("y", "k*dq - y*y + x*sin(q)"), sf.ForceState("w", "x*x - w")),
        potentials=(sf.Potential("stored", "k*y^2 + w*q"),),
        constraints=(sf.Closure("wall", ("fore", "tip"), ("world", None), translations=("x",)),) if closed else (),
    )


def drawn(model: sf.Model, seed: int) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(seed)
    q, v = model.random_state(rng)
    z = np.concatenate([rng.standard_normal(2), 5e-3 * rng.standard_normal(model.nz - 2)])
    return q, v, z, rng.standard_normal(model.nu)


def test_names_and_sizes() -> None:
    """Those that formulas have first; then those of elements, by the speed that they act on."""
    model = sf.compile(arm(), sf.Options(backend="interpreter"))
    assert model.names.z == ("y", "w", "ball.wx.bristle", "ball.wz.slip", "q.bristle", "q.slip", "q.slip2", "x.bristle")
    assert (model.nq, model.nv, model.nz, model.carried.nq, model.carried.nv) == (6, 5, 8, 14, 13)


@pytest.mark.parametrize(
    ("closed", "options"),
    [(False, {"forward_dynamics": "factors"}), (False, {"forward_dynamics": "articulated"}), (True, {})],
)
def test_the_linear_model_has_the_derivatives_by_states_and_of_their_rates(
    closed: bool, options: dict[str, Any]
) -> None:
    """Every column of A and B, by central differences; (3)."""
    model = sf.compile(arm(closed), sf.Options(backend="interpreter", **options))
    q, v, z, u = drawn(model, 1)
    n, step = model.nv, 1e-6

    def rates(q: np.ndarray, v: np.ndarray, z: np.ndarray, u: np.ndarray) -> np.ndarray:
        return np.concatenate([model.forward_dynamics(q, v, u, z=z), model.state_rates(q, v, u, z=z)])

    columns = [
        (rates(model.integrate(q, d), v, z, u), rates(model.integrate(q, -d), v, z, u)) for d in step * np.eye(n)
    ]
    columns += [(rates(q, v + d, z, u), rates(q, v - d, z, u)) for d in step * np.eye(n)]
    columns += [(rates(q, v, z + d, u), rates(q, v, z - d, u)) for d in step * np.eye(model.nz)]
    columns += [(rates(q, v, z, u + d), rates(q, v, z, u - d)) for d in step * np.eye(model.nu)]
    wanted = np.array([(after - before) / (2.0 * step) for after, before in columns]).T
    A, B = model.linearize(q, v, u, z=z)
    assert np.hstack([A[n:], B[n:]]) == pytest.approx(wanted, rel=1e-7, abs=1e-6)
    assert A[:n, : 2 * n] == pytest.approx(np.hstack([A[:n, :n], np.eye(n)])) and not A[:n, 2 * n :].any()


def test_functions_agree_at_given_states() -> None:
    """M a + h = Q, inverse dynamics and their derivatives take z; at none it is the neutral one."""
    model = sf.compile(arm(), sf.Options(backend="interpreter"))
    q, v, z, u = drawn(model, 2)
    a, step = model.forward_dynamics(q, v, u, z=z), 1e-6
    M, h, Q = model.dynamics(q, v, u, z=z)
    assert M.shape == (5, 5) and M @ a + h == pytest.approx(Q, rel=1e-12, abs=1e-12)
    assert model.inverse_dynamics(q, v, a, z=z) == pytest.approx([0, 0, 0, 0, u[0]], abs=1e-12)
    by_v = [
        (model.inverse_dynamics(q, v + d, a, z=z) - model.inverse_dynamics(q, v - d, a, z=z)) / (2.0 * step)
        for d in step * np.eye(5)
    ]
    assert model.inverse_dynamics_derivatives(q, v, a, z=z)[1] == pytest.approx(np.transpose(by_v), rel=1e-7, abs=1e-6)
    neutral = np.zeros(model.nz)
    assert (model.forward_dynamics(q, v, u) == model.forward_dynamics(q, v, u, z=neutral)).all()
    assert model.generalized_force(q, v, u, z=neutral) != pytest.approx(model.generalized_force(q, v, u, z=z))
    named = model.generalized_force(q, v, u, z={"q.slip2": 1e-3})
    assert named[3] - model.generalized_force(q, v, u)[3] == pytest.approx(-30.0 * 1e-3)


def test_products_of_the_carried_model_are_those_of_its_derivatives() -> None:
    """Reverse mode and forward mode know states alike; second derivatives of their rates are those of (10)."""
    carried = sf.compile(arm(), sf.Options(backend="interpreter")).carried
    rng = np.random.default_rng(3)
    q, v = carried.random_state(rng)
    u, w = rng.standard_normal(carried.nu), rng.standard_normal(carried.nv)
    by_q, by_v, by_u = carried.forward_dynamics_derivatives(q, v, u)
    products = carried.vjp("forward_dynamics", q=q, v=v, u=u, a_bar=w)
    for name, slopes in (("q", by_q), ("v", by_v), ("u", by_u)):
        assert products[name] == pytest.approx(w @ slopes, rel=1e-10, abs=1e-9)
    a = rng.standard_normal(carried.nv)
    tensor, step = carried.inverse_dynamics_second_derivatives(q, v, a).d2tau_dv2, 1e-6
    at = carried.names.v.index("y")
    slopes = [carried.inverse_dynamics_derivatives(q, v + s * np.eye(carried.nv)[at], a)[1] for s in (step, -step)]
    assert tensor[:, :, at] == pytest.approx((slopes[0] - slopes[1]) / (2.0 * step), rel=1e-6, abs=1e-5)


def test_energies_and_momenta_do_not_know_states_but_what_they_store() -> None:
    """T is that of the bodies; V has k y^2 + w q, the springs of bristles, and of slips."""
    model = sf.compile(arm(), sf.Options(backend="interpreter"))
    q, v, z, _ = drawn(model, 4)
    stiffness = np.array([0.0, 0.0, 300.0, 20.0, 300.0, 20.0, 30.0, 300.0])
    stored = 2.0 * z[0] ** 2 + z[1] * q[4] + 0.5 * stiffness @ z**2
    assert model.potential_energy(q, z=z) - model.potential_energy(q) == pytest.approx(stored, rel=1e-12)
    assert model.kinetic_energy(q, v) == pytest.approx(0.5 * v @ model.mass_matrix(q) @ v, rel=1e-12)
    p = model.carried.centroidal_momentum(np.append(q, z), np.append(v, z))
    assert (p == model.centroidal_momentum(q, v)).all()


def test_the_gradient_of_the_energy_knows_what_states_store() -> None:
    """By each coordinate beside stated states, by central differences: `vjp` of the carried model."""
    model = sf.compile(arm(), sf.Options(backend="interpreter"))
    q, v, z, _ = drawn(model, 4)
    at = {"q": np.concatenate([q, np.zeros(model.nz)]), "v": np.concatenate([v, z])}
    gradient, h = model.carried.vjp("potential_energy", V_bar=1.0, **at)["q"], 1e-6
    ends = [[model.potential_energy(model.integrate(q, dq), z=z) for dq in h * np.eye(model.nv) * x] for x in (1, -1)]
    assert gradient[: model.nv] == pytest.approx(np.subtract(*ends) / (2 * h), abs=1e-7)


def test_states_have_unit_inertia_and_move_nothing() -> None:
    """M* = diag(M, 1), h* = (h, 0) of (2), formed as numbers."""
    equations = Equations(build_tree(arm()))
    n = len(equations.tree.coordinates.states)
    assert all(equations.M[-k][-k] == 1 and equations.h[-k] == ZERO for k in range(1, n + 1))
    assert all(entry == ZERO for row in equations.M[:-n] for entry in row[-n:])


def test_projection_leaves_states_as_they_are() -> None:
    """Off a constraint, q and v move, z to the last bit not."""
    carried = sf.compile(arm(closed=True), sf.Options(backend="interpreter")).carried
    rng = np.random.default_rng(5)
    q, v = carried.random_state(rng)
    q_on, v_on, _ = carried.project(q, v)
    n = len(carried.record.state_names)
    assert (q_on[-n:] == q[-n:]).all() and (v_on[-n:] == v[-n:]).all() and (v_on[:-n] != v[:-n]).any()


@pytest.mark.parametrize(
    ("element", "message"),
    [
        (sf.LuGre(0.0, 1.0), "lugre dynamic 0"),
        (sf.LuGre(1.0, -1.0), "lugre stiffness -1"),
        (sf.LuGre(1.0, 1.0, -1.0), "lugre damping -1"),
        (sf.LuGre(1.0, 1.0, static=2.0, stribeck_velocity=0.0), "lugre stribeck_velocity 0"),
        (sf.LuGre("k", 1.0), "lugre dynamic -2"),
        (sf.Hysteresis(1.0, 0.0), "hysteresis force 0"),
        (sf.Hysteresis(0.0, 1.0), "hysteresis stiffness 0"),
        (sf.Hysteresis(1.0, 1.0, 0.5), "hysteresis sharpness 0.5"),
        (sf.LuGre(1.0, 1.0, coordinate=1), "lugre on coordinate 1"),
    ],
)
def test_numbers_that_make_no_element_are_refused(element: Any, message: str) -> None:
    body = sf.RigidBody("b", sf.Joint("q", "prismatic", elements=(element,)), sf.Inertia(1.0))
    with pytest.raises(sf.DescriptionError, match=message):
        sf.compile(sf.System("s", (body,), (sf.Parameter("k", -2.0),)), sf.Options(backend="interpreter"))


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"states": (sf.ForceState("q", "1"),)}, "the name of its coordinate is taken"),
        ({"states": (sf.ForceState("y", "1"), sf.ForceState("y", "2"))}, "state 'y'"),
        ({"states": (sf.ForceState("y", "nothing"),)}, "state 'y': rate: unknown symbol 'nothing'"),
        ({"states": (sf.ForceState("", "1"),)}, "state with an unusable name"),
        (
            {"states": (sf.ForceState("y", "1"),), "constraints": (sf.Coupling("c", "q - y"),)},
            "'y' may not be used here",
        ),
    ],
)
def test_states_that_can_not_be_are_refused(fields: dict[str, Any], message: str) -> None:
    body = sf.RigidBody("b", sf.Joint("q", "prismatic"), sf.Inertia(1.0))
    with pytest.raises(sf.SymofrosError, match=message):
        sf.compile(sf.System("s", (body,), **fields), sf.Options(backend="interpreter"))


def test_one_of_two_entries_of_stribeck() -> None:
    with pytest.raises(sf.DescriptionError, match="static alone"):
        sf.LuGre(1.0, 1.0, static=2.0)


def test_copies_have_their_states_and_what_was_changed() -> None:
    """Other parameters, another precision, no checks of parameters: (q, v) and z stay apart."""
    options = sf.Options(("potential_energy", "generalized_force"), (), backend="interpreter")
    model = sf.compile(arm(), options)
    other = sf.compile(replace(arm(), parameters=(sf.Parameter("k", 5.0),)), options)
    q, v, z, u = drawn(model, 2)
    for copy, exact in (
        (model.with_parameters(k=5.0), other),
        (model.with_threads(2), model),
        (model.with_parameter_checks(False).with_parameters(k=5.0), other),
        (pickle.loads(pickle.dumps(model)), model),
    ):
        assert copy.names == exact.names and (copy.nq, copy.nv, copy.nz) == (model.nq, model.nv, model.nz)
        assert copy.potential_energy(q, z=z) == exact.potential_energy(q, z=z)
        found, wanted = (m.generalized_force(q, v, z=z, u=u) for m in (copy, exact))
        np.testing.assert_array_equal(found, wanted)


def test_a_start_takes_speeds_of_any_form() -> None:
    """Rows, names, and speeds that end with the states already; of a ball joint, which has a coordinate more."""
    model = sf.compile(arm(), sf.Options(("mass_matrix",), (), backend="interpreter"))
    q, v, z, _ = drawn(model, 5)
    named = dict(zip(model.names.v, v.tolist(), strict=True))
    for stated, states, wanted in (
        (v, None, np.zeros(model.nz)),
        (named, None, np.zeros(model.nz)),
        (v, z, z),
        (np.concatenate([v, z]), None, z),
    ):
        coordinates, speeds = model.carry(q, stated, states)  # type: ignore[arg-type]
        np.testing.assert_array_equal(coordinates, np.concatenate([q, np.zeros(model.nz)]))
        np.testing.assert_array_equal(speeds, np.concatenate([v, wanted]))
