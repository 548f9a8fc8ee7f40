"""Each convention against a finite difference or an identity; what engines answer in it, the matrix holds to truth."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from tests.validation.subjects import every_kind, moved, states_of
from validation.adapters.charted import ChartedEngine
from validation.adapters.mujoco import tree as mujoco_adapter
from validation.adapters.pinocchio import tree as pinocchio_adapter
from validation.contract.conventions import times, xyzw_to_wxyz
from validation.contract.interface import States
from validation.mechanics.assembly import assemble

SUBJECT = every_kind()
ASSEMBLY = assemble(SUBJECT.system)
STATES = states_of(SUBJECT, 20)
STEP = 1e-6
# Central differences of step 1e-6 leave 1e-10 of rounding, times what is differentiated.
CLOSE = 1e-6


def engine(name: str) -> ChartedEngine:
    built = {"mujoco": mujoco_adapter, "pinocchio": pinocchio_adapter}[name].build(SUBJECT)
    assert hasattr(built, "chart"), built
    return built


def at(time: float) -> States:
    """The states a moment later or earlier, on a path with velocity v and acceleration a."""
    dq = STATES.v * time + STATES.a * time**2 / 2
    return States(moved(ASSEMBLY, STATES.q, dq), STATES.v + STATES.a * time, *[STATES.a] * 2, *[STATES.applied] * 2)


def rate(of: object) -> np.ndarray:
    return (of(at(STEP)) - of(at(-STEP))) / (2 * STEP)  # type: ignore[operator]


def test_quaternions_are_reordered_from_xyzw_to_wxyz() -> None:
    assert xyzw_to_wxyz(np.array([1.0, 2.0, 3.0, 4.0])).tolist() == [4.0, 1.0, 2.0, 3.0]


@pytest.mark.parametrize("name", ["mujoco", "pinocchio"])
def test_speeds_are_the_rates_of_coordinates(name: str) -> None:
    """Moving the engine's q by its own integrator along T v is moving ours along v."""
    built = engine(name)
    chart = built.chart
    speeds = chart.speeds(STATES.q, STATES.v)
    ahead = chart.coordinates(moved(ASSEMBLY, STATES.q, STEP * STATES.v))
    for q, v, expected in zip(chart.coordinates(STATES.q), speeds, ahead, strict=True):
        if name == "mujoco":
            mujoco.mj_integratePos(built.model, q, v, STEP)
        else:
            q = pin.integrate(built.model, q, STEP * v)
        assert np.abs(q - expected).max() < 1e-9  # What is left is of second order in STEP.


def test_accelerations_are_the_rates_of_speeds() -> None:
    chart = engine("mujoco").chart
    expected = rate(lambda s: chart.speeds(s.q, s.v))
    assert np.abs(chart.accelerations(STATES.q, STATES.v, STATES.a) - expected).max() < CLOSE
    back = chart.our_accelerations(STATES.q, STATES.v, chart.accelerations(STATES.q, STATES.v, STATES.a))
    assert np.abs(back - STATES.a).max() < 1e-12


def test_transform_is_orthogonal_and_its_rate_is_its_rate() -> None:
    chart = engine("mujoco").chart
    T = chart.transform(STATES.q)
    assert np.allclose(T @ T.swapaxes(1, 2), np.eye(ASSEMBLY.nv), atol=1e-14)
    assert np.abs(chart.transform_rate(STATES.q, STATES.v) - rate(lambda s: chart.transform(s.q))).max() < CLOSE


def test_power_and_energy_do_not_depend_on_the_chart() -> None:
    built = engine("mujoco")
    v_e = built.chart.speeds(STATES.q, STATES.v)
    Q_e = built.chart.forces(STATES.q, STATES.applied)
    assert np.allclose(np.sum(Q_e * v_e, axis=1), np.sum(STATES.applied * STATES.v, axis=1))
    assert np.allclose(built.chart.our_forces(STATES.q, Q_e), STATES.applied)
    M = built.mass_matrix(STATES)
    twice = np.sum(STATES.v * times(M, STATES.v), axis=1)
    assert np.allclose(twice / 2, built.kinetic_energy(STATES), rtol=1e-13)
