"""Run-time parameters are judged by the conditions of the description, wherever they enter."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

import symofros as sf
from symofros.runtime.calls.kernel import Array

FUNCTIONS = sf.Options(functions=("mass_matrix",), backend="interpreter")
NAMES = ("m", "c", "Jx", "Jy", "Jz", "Jxy", "L", "EI", "GJ", "rho", "damping", "rod", "slope")
DEFAULTS = (1.0, 0.4, 1.0, 1.2, 1.5, 0.1, 2.0, 3.0, 1.0, 0.5, 0.01, 0.7, 0.2)


def scene(values: tuple[float, ...]) -> sf.System:
    """A body with all its inertia by parameters, a tapered beam, a rod between two of the bodies."""
    arm = sf.RigidBody(
        "arm",
        sf.Joint("q", "revolute"),
        sf.Inertia("m", ("c", 0, 0), ("Jx", "Jy", "Jz", "Jxy", 0, 0)),
        (sf.Frame("end", (1.0, 0, 0)),),
    )
    beam = sf.Beam(
        "beam",
        sf.Joint("b", "revolute"),
        "L",
        rhoA="rho*(1 - slope*x)",
        EI_z="EI",
        GJ="GJ",
        rhoJ=0.1,
        bend_y=1,
        twist=1,
        damping="damping",
        frames=(sf.Frame("tip"),),
    )
    rod = sf.Rod("rod", ("arm", "end"), ("beam", None), "rod")
    parameters = tuple(sf.Parameter(name, value) for name, value in zip(NAMES, values, strict=True))
    return sf.System("scene", (arm, beam), parameters=parameters, constraints=(rod,))


@cache
def model() -> sf.Model:
    return sf.compile(scene(DEFAULTS), FUNCTIONS)


def as_described(values: tuple[float, ...]) -> list[str]:
    """What is wrong with a description that has the values as its defaults."""
    try:
        sf.compile(scene(values), FUNCTIONS)
    except sf.DescriptionError as error:
        return [problem.what for problem in error.problems]
    return []


VALUES = st.one_of(
    st.floats(-3.0, 3.0), st.sampled_from([0.0, -0.0, 1e-12, -1e-12, 1e-300, -1e-300, 1e9, 1e200, -1e200])
)


@settings(max_examples=120)
@given(st.sampled_from(NAMES), VALUES, st.sampled_from(NAMES), VALUES)
@example("m", 1e200, "c", 1e200)
def test_run_time_parameters_are_refused_exactly_where_a_description_is(one: str, x: float, two: str, y: float) -> None:
    """Any two parameters of a scene, at any values: the same verdict, about the same objects."""
    values = dict(zip(NAMES, DEFAULTS, strict=True)) | {one: x} | {two: y}
    described = as_described(tuple(values.values()))
    try:
        model().with_parameters(**values)
    except sf.ParameterError as error:
        assert described
        assert all(p.found and p.rule and p.remedy for p in error.problems)
        for what in described[:1]:
            assert any(p.what.endswith(what) for p in error.problems)
    else:
        assert not described


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_parameters_are_finite(name: str, value: float) -> None:
    with pytest.raises(sf.ParameterError, match=name):
        model().with_parameters(**{name: value})
    par = np.array(DEFAULTS)
    par[NAMES.index(name)] = value
    with pytest.raises(sf.ParameterError, match=f"{name} = (nan|inf|-inf)"):
        model().mass_matrix(model().neutral(), par=par)


def pendulum(backend: Any = "interpreter") -> sf.Model:
    bob = sf.RigidBody("bob", sf.Joint("q", "revolute"), sf.Inertia("m", ("L", 0, 0)))
    system = sf.System("pendulum", (bob,), parameters=(sf.Parameter("m", 1.0), sf.Parameter("L", 1.0)))
    return sf.compile(system, sf.Options(backend=backend))


ENTRIES = {
    "with_parameters": lambda m, par: m.with_parameters(m=par[0], L=par[1]),
    "a function": lambda m, par: m.mass_matrix([0.0], par=par),
    "evaluate": lambda m, par: m.evaluate("mass_matrix", q=[0.0], par=par),
    "bind": lambda m, par: m.bind("mass_matrix", par=par),
    "simulate": lambda m, par: sf.simulate(m, [0.1], [0.0], 0.01, par=par),
    "simulate_batch": lambda m, par: sf.simulate_batch(m, [0.1], [0.0], 0.01, par=np.tile(par, (3, 1))),
    "equilibrium": lambda m, par: sf.equilibrium(m, [-1.0], par=par),
}


@pytest.mark.parametrize("entry", ENTRIES)
@pytest.mark.parametrize("par", [(-1.0, 1.0), (1.0, 0.0), (math.nan, 1.0)])
def test_parameters_are_judged_wherever_they_enter(entry: str, par: tuple[float, float]) -> None:
    with pytest.raises(sf.ParameterError):
        ENTRIES[entry](compiled(), par)


@cache
def compiled() -> sf.Model:
    return pendulum("c")


def test_an_invalid_parameter_set_of_a_batch_is_named() -> None:
    par = np.ones((100, 2))
    par[37, 0] = -2.0
    with pytest.raises(sf.ParameterError, match=r"of set 37 \(m = -2\)"):
        compiled().mass_matrix(np.zeros((100, 1)), par=par)
    with pytest.raises(sf.ParameterError, match="of set 37"):
        sf.simulate_batch(compiled(), np.zeros((100, 1)), np.zeros((100, 1)), 0.01, par=par)


def test_the_checks_can_be_left_out() -> None:
    """For loops that know what they pass; with NaN there, one bad set does not spoil its batch."""
    free = compiled().with_parameter_checks(False)
    assert free.with_parameters(m=-1.0).mass_matrix([0.0]) == pytest.approx(-1.0)
    M = free.mass_matrix(np.zeros((2, 1)), par=[[1.0, 2.0], [math.nan, 1.0]])
    assert M[0, 0, 0] == 4.0 and np.isnan(M[1, 0, 0])
    assert sf.simulate_batch(free, [0.0], [0.0], 0.01, par=[-1.0, 1.0]).q.shape[-1] == 1
    with pytest.raises(sf.ParameterError):
        compiled().with_parameters(m=-1.0)


def test_a_description_that_waives_a_check_waives_it_at_run_time() -> None:
    body = sf.RigidBody("b", sf.Joint("q", "revolute"), sf.Inertia("m", (1, 0, 0)), waive=("nonphysical_inertia",))
    m = sf.compile(sf.System("waived", (body,), parameters=(sf.Parameter("m", -1.0),)), FUNCTIONS)
    assert m.with_parameters(m=-2.0).parameters["m"] == -2.0


@settings(max_examples=100)
@given(st.lists(st.floats(-1.0, 1.0), min_size=9, max_size=9), st.floats(-1.5, 1.5), st.floats(-9, 9))
def test_inertias_of_any_size_are_judged_by_their_principal_moments(
    entries: list[float], excess: float, decade: float
) -> None:
    """Moments (1, x, 1 + x + excess), turned at will: physical as long as the excess is not positive."""
    R = np.linalg.qr(np.array(entries).reshape(3, 3) + 2.0 * np.eye(3))[0]
    assume(abs(excess) > 1e-4)
    moments = 10.0**decade * np.array([1.0, 0.6, 1.6 + excess])
    J = R @ np.diag(moments) @ R.T
    physical = excess < 0.0 and moments[2] >= 0.0 and 1.0 <= 0.6 + 1.6 + excess and 0.6 <= 1.0 + 1.6 + excess
    assert inertia_is_accepted(J) is bool(physical)


@cache
def any_inertia() -> sf.Model:
    names = ("xx", "yy", "zz", "xy", "xz", "yz")
    body = sf.RigidBody("b", sf.Joint("q", "revolute"), sf.Inertia(1.0, (1, 0, 0), names))
    parameters = tuple(sf.Parameter(name, float(name[0] == name[1])) for name in names)
    return sf.compile(sf.System("any", (body,), parameters=parameters), FUNCTIONS)


def inertia_is_accepted(J: Array) -> bool:
    try:
        any_inertia().checked_parameters([J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]])
    except sf.ParameterError:
        return False
    return True


def test_rotations_and_axes_of_parameters_are_judged_in_each_set() -> None:
    """The set in which a matrix is no rotation is named by its number."""
    matrix = ((1.0, 0, 0), (0, "c", "-s"), (0, "s", "c"))
    joint = sf.Joint("q", "revolute", axis=("x", 0, 1), rotation=sf.Rotation.matrix(matrix))
    names = {"x": 0.3, "c": 0.6, "s": 0.8}
    parameters = tuple(sf.Parameter(name, value) for name, value in names.items())
    model = sf.compile(sf.System("s", (sf.RigidBody("b", joint, sf.Inertia(1.0)),), parameters=parameters), FUNCTIONS)
    good = np.array([[0.3, 0.6, 0.8], [-2.0, 1.0, 0.0], [0.3, 0.8, -0.6]])
    assert model.mass_matrix(np.zeros((3, 1)), par=good).shape == (3, 1, 1)
    for k in range(3):
        bad = good.copy()
        bad[k, 1] += 0.01
        with pytest.raises(sf.ParameterError) as caught:
            model.mass_matrix(np.zeros((3, 1)), par=bad)
        stated = f"run-time parameters of set {k} (c = {bad[k, 1]:g}, s = {bad[k, 2]:g}): joint 'q': rotation"
        assert stated in caught.value.problem.what
