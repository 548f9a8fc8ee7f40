from __future__ import annotations

import inspect

import numpy as np
import pytest

import symofros as sf
from tests.models import model, system

BACKENDS = ["c", "interpreter"]


@pytest.fixture(params=BACKENDS)
def m(request: pytest.FixtureRequest) -> sf.Model:
    return model("parametrised0", request.param)


def test_leading_dimensions_broadcast(m: sf.Model, rng: np.random.Generator) -> None:
    q = np.array([m.random_state(rng)[0] for _ in range(6)]).reshape(2, 3, m.nq)
    v = rng.standard_normal((3, m.nv))
    h = m.bias(q, v)
    assert h.shape == (2, 3, m.nv)
    assert m.mass_matrix(q[0, 0]).shape == (m.nv, m.nv)
    assert m.kinetic_energy(q, v).shape == (2, 3)
    assert m.kinetic_energy(q[0, 0], v[0]).shape == ()
    assert m.mass_matrix(np.empty((0, m.nq))).shape == (0, m.nv, m.nv)
    for i in range(2):
        for j in range(3):
            assert np.array_equal(h[i, j], m.bias(q[i, j], v[j]))


def test_parameters_override_and_batch(m: sf.Model, rng: np.random.Generator) -> None:
    q = m.random_state(rng)[0]
    name = m.names.par[0]
    heavier = m.with_parameters(**{name: 9.0})
    assert heavier.parameters[name] == 9.0 and m.parameters[name] != 9.0
    par = np.array([list(m.parameters.values()), list(heavier.parameters.values())])
    both = m.mass_matrix(q, par=par)
    assert np.array_equal(both[0], m.mass_matrix(q))
    assert np.array_equal(both[1], heavier.mass_matrix(q))
    assert np.abs(both[1] - both[0]).max() > 1e-3
    grid = m.mass_matrix(np.array([q, q, q])[:, None], par=par)
    assert grid.shape == (3, 2, m.nv, m.nv) and np.array_equal(grid[2], both)


def test_wrong_shapes_report_the_expected_shape(m: sf.Model) -> None:
    with pytest.raises(sf.ShapeError, match=rf"q has the wrong shape\n  found:  \(2,\)\n  rule:   .*\.\.\., {m.nq}\)"):
        m.mass_matrix([0.0, 1.0])
    with pytest.raises(sf.ShapeError, match="wrong shape"):
        m.mass_matrix(np.full(m.nq + 1, np.nan))
    with pytest.raises(sf.ShapeError, match="not an array of numbers"):
        m.mass_matrix("abc")
    with pytest.raises(sf.ShapeError, match="do not broadcast"):
        m.bias(np.zeros((2, m.nq)), np.zeros((3, m.nv)))
    with pytest.raises(sf.ShapeError, match="par has the wrong shape"):
        m.mass_matrix(m.neutral(), par=[1.0])
    with pytest.raises(sf.ShapeError):
        m.integrate(m.neutral(), np.zeros(m.nv + 1))


def test_nan_stays_in_its_own_state(m: sf.Model, rng: np.random.Generator) -> None:
    q = np.array([m.random_state(rng)[0] for _ in range(3)])
    clean = m.mass_matrix(q)
    q[1] = np.nan
    M = m.mass_matrix(q)
    assert np.array_equal(M[[0, 2]], clean[[0, 2]])
    assert np.isnan(M[1]).any()


def test_unknown_frame_is_refused_with_a_suggestion(m: sf.Model) -> None:
    with pytest.raises(sf.UnknownNameError, match=r"no frame 'moun'\n[\s\S]*found:[\s\S]*did you mean 'mount'"):
        m.frame_pose("moun", m.neutral())


def test_only_requested_functions_exist() -> None:
    m = sf.compile(system("tree0"), sf.Options(functions=("mass_matrix", "frame_pose"), frames=("mount",)))
    assert m.mass_matrix(m.neutral()).shape == (m.nv, m.nv)
    m.frame_pose("mount", m.neutral())
    with pytest.raises(sf.SymofrosError, match="bias was not generated.*add it to the options"):
        try:
            m.bias(m.neutral(), np.zeros(m.nv))
        except sf.SymofrosError as error:
            raise type(error)(str(error).replace("\n", " ")) from None
    with pytest.raises(sf.UnknownNameError, match="did you mean 'mass_matrix'"):
        sf.compile(system("tree0"), sf.Options(functions=("mass_matrx",)))
    with pytest.raises(sf.UnknownNameError, match="no frame 'mont'"):
        sf.compile(system("tree0"), sf.Options(functions=("frame_pose",), frames=("mont",)))


def test_inverse_dynamics_leaves_out_the_inputs() -> None:
    body = sf.RigidBody(
        "b", sf.Joint("q1", "prismatic", axis=(1, 0, 0), actuated=True, effort=("k*u1 - 3*dq1",)), sf.Inertia(2.0)
    )
    m = sf.compile(sf.System("s", [body], [sf.Parameter("k", 5.0)], [sf.Input("u1")]))
    assert m.names.u == ("u1", "q1")
    assert m.inverse_dynamics([0.0], [1.0], [4.0]) == pytest.approx([2.0 * 4.0 + 3.0])
    assert m.forward_dynamics([0.0], [1.0], [1.0, 0.5]) == pytest.approx([(5.0 - 3.0 + 0.5) / 2.0])


def test_calls_that_state_no_time_are_at_time_zero() -> None:
    methods = {name: inspect.signature(method) for name, method in inspect.getmembers(sf.Model, inspect.isfunction)}
    defaults = {
        name: method.parameters["t"].default
        for name, method in methods.items()
        if "t" in method.parameters and not name.startswith("_")
    }
    assert len(defaults) > 20 and set(defaults.values()) == {0.0}, defaults


def test_a_model_without_states_has_none_among_its_speeds() -> None:
    m = model("double_pendulum")
    for shape in ((m.nv,), (3, m.nv), (2, 3, m.nv)):
        assert m.states_of(np.ones(shape)).shape == (*shape[:-1], 0)
