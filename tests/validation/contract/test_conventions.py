"""Each convention against a finite difference or an identity."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from tests.validation.subjects import every_kind, moved, states_of
from validation.adapters.mujoco import tree as mujoco_adapter
from validation.adapters.pinocchio import tree as pinocchio_adapter
from validation.contract.conventions import angular_first_to_linear_first, times, xyzw_to_wxyz
from validation.contract.interface import States
from validation.mechanics.assembly import assemble

SUBJECT = every_kind()
ASSEMBLY = assemble(SUBJECT.system)
STATES = states_of(SUBJECT, 20)
STEP = 1e-6
# Central differences of step 1e-6 leave 1e-10 of rounding, times what is differentiated.
CLOSE = 1e-6


def engine(name: str) -> mujoco_adapter.MujocoEngine | pinocchio_adapter.PinocchioEngine:
    built = {"mujoco": mujoco_adapter, "pinocchio": pinocchio_adapter}[name].build(SUBJECT)
    assert hasattr(built, "chart"), built
    return built


def at(time: float) -> States:
    """The states a moment later or earlier, on a path with velocity v and acceleration a."""
    dq = STATES.v * time + STATES.a * time**2 / 2
    return States(moved(ASSEMBLY, STATES.q, dq), STATES.v + STATES.a * time, *[STATES.a] * 2, *[STATES.applied] * 2)


def rate(of: object) -> np.ndarray:
    return (of(at(STEP)) - of(at(-STEP))) / (2 * STEP)  # type: ignore[operator]


def test_quaternion_orders() -> None:
    assert xyzw_to_wxyz(np.array([1.0, 2.0, 3.0, 4.0])).tolist() == [4.0, 1.0, 2.0, 3.0]
    assert angular_first_to_linear_first(np.arange(6.0)).tolist() == [3, 4, 5, 0, 1, 2]


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


@pytest.mark.parametrize("name", ["mujoco", "pinocchio"])
class TestFrames:
    """Each engine's frame quantities are the derivatives of one another, in world axes."""

    def test_linear_velocity_is_the_rate_of_position(self, name: str) -> None:
        built = engine(name)
        expected = rate(built.frame_pose)[..., :3]
        assert np.abs(built.frame_velocity(STATES)[..., :3] - expected).max() < CLOSE * 100

    def test_angular_velocity_turns_the_axes(self, name: str) -> None:
        built = engine(name)
        R = built.frame_pose(STATES)[..., 3:].reshape(-1, len(SUBJECT.frames), 3, 3)
        R_rate = rate(built.frame_pose)[..., 3:].reshape(R.shape)
        spin = R_rate @ R.swapaxes(-1, -2)  # [w]x
        w = np.stack([spin[..., 2, 1], spin[..., 0, 2], spin[..., 1, 0]], axis=-1)
        assert np.abs(built.frame_velocity(STATES)[..., 3:] - w).max() < CLOSE * 100

    def test_acceleration_is_the_rate_of_velocity(self, name: str) -> None:
        built = engine(name)
        value = built.frame_acceleration(STATES)
        assert np.abs(value - rate(built.frame_velocity)).max() < CLOSE * np.abs(value).max()

    def test_jacobian_rate_is_the_rate_of_the_jacobian(self, name: str) -> None:
        built = engine(name)
        value = built.frame_jacobian_rate(STATES)
        assert np.abs(value - rate(built.frame_jacobian)).max() < CLOSE * np.abs(value).max()

    def test_jacobians_give_velocity_and_acceleration(self, name: str) -> None:
        built = engine(name)
        J, J_rate = built.frame_jacobian(STATES), built.frame_jacobian_rate(STATES)
        velocity = times(J, STATES.v[:, None])
        assert np.allclose(velocity, built.frame_velocity(STATES), atol=1e-11)
        acceleration = times(J, STATES.a[:, None]) + times(J_rate, STATES.v[:, None])
        assert np.abs(acceleration - built.frame_acceleration(STATES)).max() < 1e-12 * np.abs(acceleration).max() * 10


@pytest.mark.parametrize("name", ["mujoco", "pinocchio"])
def test_inverse_and_forward_dynamics_are_one_equation(name: str) -> None:
    built = engine(name)
    M, h = built.mass_matrix(STATES), built.bias(STATES)
    inverse = times(M, STATES.a) + h - STATES.passive
    assert np.allclose(built.inverse_dynamics(STATES), inverse, rtol=1e-10, atol=1e-10)
    forward = times(np.linalg.inv(M), STATES.applied - h)
    assert np.allclose(built.forward_dynamics(STATES), forward, rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("name", ["mujoco", "pinocchio"])
def test_power_balance(name: str) -> None:
    """d(T + V)/dt is the power of the applied forces, when v' is what they produce."""
    built = engine(name)
    a = built.forward_dynamics(STATES)

    def energy(time: float) -> np.ndarray:
        q = moved(ASSEMBLY, STATES.q, STATES.v * time + a * time**2 / 2)
        later = States(q, STATES.v + a * time, *[STATES.a] * 2, *[STATES.applied] * 2)
        return built.kinetic_energy(later) + built.potential_energy(later)

    power = np.sum(STATES.applied * STATES.v, axis=1)
    scale = np.abs(energy(0.0)).max()
    assert np.abs((energy(STEP) - energy(-STEP)) / (2 * STEP) - power).max() < 1e-5 * scale
