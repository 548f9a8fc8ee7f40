"""Values by name are the vectors that they name, wherever vectors are taken."""

import numpy as np
import pytest

import symofros as sf
from symofros.errors import ShapeError, UnknownNameError
from tests.models import model as compiled


@pytest.fixture(scope="module")
def arm() -> sf.Model:
    return compiled("cart_pole", "c")


@pytest.fixture(scope="module")
def loop() -> sf.Model:
    return compiled("four_bar")


def named(names: tuple[str, ...], values: np.ndarray) -> dict[str, float]:
    return dict(zip(names, values.tolist(), strict=True))


def test_functions_take_names(arm: sf.Model) -> None:
    q, v = arm.random_state(np.random.default_rng(0))
    u, par = np.array([0.5]), np.array(arm.parameter_values) * 1.5
    by_name = named(arm.names.q, q), named(arm.names.v, v), named(arm.names.u, u)
    for ours, expected in zip(
        arm.dynamics(*by_name, par=named(arm.names.par, par)), arm.dynamics(q, v, u, par=par), strict=True
    ):
        assert np.array_equal(ours, expected)
    a = arm.forward_dynamics(q, v, u)
    assert np.array_equal(
        arm.inverse_dynamics(by_name[0], by_name[1], named(arm.names.v, a)), arm.inverse_dynamics(q, v, a)
    )


def test_simulations_take_names(arm: sf.Model) -> None:
    first, last = arm.names.q
    ours = sf.simulate(arm, {last: 0.2}, {f"d{last}": 1.0}, t_end=0.05, dt=1e-2, par={"m_cart": 3.0})
    par = np.array(arm.with_parameters(m_cart=3.0).parameter_values)
    expected = sf.simulate(arm, [0.0, 0.2], [0.0, 1.0], t_end=0.05, dt=1e-2, par=par)
    assert np.array_equal(ours.q, expected.q) and ours.par[0] == par[0]
    several = {last: [0.2, 0.3]}, {}, 0.05
    batch = sf.simulate_batch(arm, *several, dt=1e-2, par={"m_cart": 3.0})
    assert np.array_equal(
        batch.q, sf.simulate_batch(arm, [[0.0, 0.2], [0.0, 0.3]], [0.0, 0.0], 0.05, dt=1e-2, par=par).q
    )


def test_analyses_take_names(arm: sf.Model, loop: sf.Model) -> None:
    guess = {"q1": 1.2, "q2": -1.0, "q3": 1.3}
    ours, expected = (sf.assemble(loop, q, held=["q1"]) for q in (guess, [1.2, -1.0, 1.3]))
    assert np.array_equal(ours.q, expected.q)
    hanging = sf.equilibrium(arm, {arm.names.q[1]: 3.0})
    assert np.array_equal(hanging.q, sf.equilibrium(arm, [0.0, 3.0]).q)
    q = named(arm.names.q, hanging.q)
    assert np.array_equal(sf.modes(arm, q).frequencies, sf.modes(arm, hanging.q).frequencies)
    rest = named(arm.names.v, np.zeros(2))
    assert np.array_equal(sf.state_space(arm, q, rest, {}).A, sf.state_space(arm, hanging.q, [0.0, 0.0], [0.0]).A)
    assert np.array_equal(arm.linearize(q, rest, {})[0], arm.linearize(hanging.q, [0.0, 0.0], [0.0])[0])


def test_an_unknown_parameter_is_refused_with_the_nearest_name(arm: sf.Model) -> None:
    with pytest.raises(UnknownNameError, match="did you mean 'm_cart'"):
        arm.mass_matrix([0.0, 0.0], par={"m_cat": 1.0})
    with pytest.raises(UnknownNameError, match="q0: no 'nothing'"):
        sf.simulate(arm, {"nothing": 1.0})
    with pytest.raises(ShapeError, match="is not a number"):
        arm.mass_matrix({arm.names.q[0]: "1.0"})
    with pytest.raises(ShapeError, match="named twice"):
        arm.bias([0.0, 0.0], {arm.names.v[0]: 1.0, f"d{arm.names.v[0]}": 2.0})
    with pytest.raises(ShapeError, match="do not broadcast"):
        arm.mass_matrix({arm.names.q[0]: [1.0, 2.0], arm.names.q[1]: [1.0, 2.0, 3.0]})
