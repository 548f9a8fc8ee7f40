"""Wrenches of joints and efforts of drives against Newton and Euler's equations, power balances and closed forms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from validation.mechanics.assembly import Mover, assemble

G = 9.81
INTERPRETED = sf.Options(backend="interpreter")
# A sum over bodies of some hundred products, relative to the largest entry.
ROUNDING = 1e-12
FUNCTIONS = ("joint_wrenches", "prescribed_efforts", "closure_wrenches")


@cache
def model(name: str) -> sf.Model:
    return sf.compile(MODELS[name], INTERPRETED)


def weight_and_inertia(
    m: sf.Model, mover: Mover, gravity: np.ndarray, q: np.ndarray, v: np.ndarray, a: np.ndarray
) -> np.ndarray:
    """Rate of a body's momentum less its weight, about the world's origin: Newton and Euler in world axes (6)."""
    mass = mover.merged()
    p, R = m.frame_pose(mover.body, q)
    alpha, w = m.frame_acceleration(mover.body, q, v, a)[3:], m.frame_velocity(mover.body, q, v)[3:]
    r, J = R @ mass.p_BC, R @ mass.J_BC @ R.T
    a_cm = m.frame_acceleration(mover.body, q, v, a)[:3] + np.cross(alpha, r) + np.cross(w, np.cross(w, r))
    force = mass.mass * (a_cm - gravity)
    return np.concatenate([force, np.cross(p + r, force) + J @ alpha + np.cross(w, J @ w)])


def in_world(m: sf.Model, frame: str, q: np.ndarray, wrench: np.ndarray, *, turned: bool) -> np.ndarray:
    """A wrench at a frame about the world's origin, in world axes; `turned`: it is along the frame's axes."""
    p, R = m.frame_pose(frame, q)
    force, moment = (R @ wrench[:3], R @ wrench[3:]) if turned else (wrench[:3], wrench[3:])
    return np.concatenate([force, moment + np.cross(p, force)])


@pytest.mark.parametrize("name", ["joint_zoo", "random_tree1", "four_bar", "slider_crank", "bricard", "delta"])
def test_wrenches_on_each_body_balance_its_momentum(name: str) -> None:
    """For any accelerations and multipliers: those of its joint, of the joints it carries, and of constraints."""
    m, system, assembly = model(name), MODELS[name], assemble(MODELS[name])
    rng = np.random.default_rng(0)
    q, v = m.random_state(rng)
    a, lam = rng.normal(size=m.nv), rng.normal(size=m.nc)
    total: dict[int, np.ndarray] = {i: np.zeros(6) for i in range(-1, len(assembly.movers))}
    wrenches = dict(zip(m.names.joints, m.joint_wrenches(q, v, a, np.zeros(m.nu), lam), strict=True))
    scale = max(1.0, max(np.abs(wrench).max() for wrench in wrenches.values()))
    last = [
        i for i in range(len(assembly.movers)) if i + 1 == len(assembly.movers) or not assembly.movers[i + 1].continues
    ]
    carrier = {}
    for i in last:
        mover, first = assembly.movers[i], i
        while assembly.movers[first].continues:
            first -= 1
        carrier[i] = assembly.movers[first].parent
        wrench = in_world(m, mover.body, q, wrenches[mover.joint.name], turned=True)
        total[i] += wrench - weight_and_inertia(m, mover, assembly.gravity, q, v, a)
        total[carrier[i]] -= wrench
    for constraint in system.constraints:
        assert isinstance(constraint, sf.Closure | sf.Rod)
        for side, (body, frame) in (("first", constraint.first), ("second", constraint.second)):
            at = body if frame is None else f"{body}.{frame}"
            site = assembly.frames.get(at) or assembly.frames[str(frame)]
            wrench = m.closure_wrench(constraint.name, q, lam, on=side)  # type: ignore[arg-type]
            total[site.mover] += in_world(m, at, q, wrench, turned=False)
    for i in last:
        assert np.abs(total[i]).max() < ROUNDING * scale, assembly.movers[i].body


def slope(f: Callable[[float], float], h: float) -> float:
    """Derivative at 0, to the fourth order in h."""
    return (8 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12 * h)


EVERYTHING = sf.load(Path(__file__).with_name("everything.yaml"))


def test_power_of_the_drives_and_actuators_is_the_rate_of_energy() -> None:
    """d(T + V)/dt = drives, actuator and damper: through rotors, beams, springs, potentials and connections."""
    m = sf.compile(EVERYTHING, INTERPRETED)
    assert m.names.prescribed == ("q1", "q3") and m.names.joints == ("q1", "q2", "q3", "clamp", "boom.tip")
    rng = np.random.default_rng(1)
    y, dy, ddy = 0.3 * rng.normal(size=(3, m.nv))
    motion, tau = rng.normal(size=(2, 3)), 1.3

    def energy(s: float) -> float:
        q, v = y + s * dy + 0.5 * s * s * ddy, dy + s * ddy
        u = np.concatenate([[tau], *([x + s * d + 0.5 * s * s * a, d + s * a, a] for x, d, a in motion)])
        return float(m.kinetic_energy(q, v, u=u) + m.potential_energy(q, u=u))

    u = np.concatenate([[tau], *motion])
    ddy = m.forward_dynamics(y, dy, u)
    drives = m.prescribed_efforts(y, dy, ddy, u)
    powers = [*(drives * motion[:, 1]), tau * dy[0], -0.7 * dy[0] ** 2]
    assert slope(energy, 1e-4) == pytest.approx(sum(powers), abs=1e-9 * np.abs(powers).sum())


def test_drive_power_balances_in_a_loop_with_a_beam() -> None:
    """Wrenches through the loop are those of its multipliers: without them the drive of the crank would be wrong."""
    system = MODELS["flexible_slider_crank"]
    bodies = [replace(body, retain="all", damping=0.0) if isinstance(body, sf.Beam) else body for body in system.bodies]
    m = sf.compile(replace(system, bodies=tuple(bodies)), INTERPRETED)
    motion = np.array([0.7, 3.0, 2.0])
    guess = 1e-4 * np.ones(m.nq)
    state = sf.assemble(m, guess, 0.1 * np.ones(m.nv), u=motion)
    a, lam = m.forward_dynamics(state.q, state.v, motion, multipliers=True)

    def energy(s: float) -> float:
        q, v = state.q + s * state.v + 0.5 * s * s * a, state.v + s * a
        u = np.array([motion[0] + s * motion[1] + 0.5 * s * s * motion[2], motion[1] + s * motion[2], motion[2]])
        return float(m.kinetic_energy(q, v, u=u) + m.potential_energy(q, u=u))

    (drive,) = m.prescribed_efforts(state.q, state.v, a, motion, lam)
    assert drive * motion[1] == pytest.approx(slope(energy, 1e-7), rel=1e-7)
    with pytest.raises(sf.ShapeError, match="constraints, whose forces joints carry too"):
        m.prescribed_efforts(state.q, state.v, a, motion)


class TestClosedForms:
    def test_the_pendulum_drive_supplies_the_required_torque(self) -> None:
        """tau = (J + m l^2 + armature) theta'' + m g l sin(theta); the pin carries the weight and the inertia."""
        mass, length, J, armature = 2.0, 0.5, 0.1, 0.03
        joint = sf.Joint("pin", "revolute", axis=(0, -1, 0), prescribed=True, armature=armature)
        body = sf.RigidBody("b", joint, sf.Inertia(mass, (0, 0, -length), (J, J, 0.1 * J)))
        m = sf.compile(sf.System("p", [body]), INTERPRETED)
        theta, rate, acceleration = 0.4, 3.0, 5.0
        u = np.array([theta, rate, acceleration])
        wanted = (J + mass * length**2 + armature) * acceleration + mass * G * length * np.sin(theta)
        assert m.prescribed_efforts([], [], [], u) == pytest.approx([wanted], rel=1e-14)
        wrench = m.joint_wrenches([], [], [], u)[0]
        along, across = (
            mass * (G * np.cos(theta) + length * rate**2),
            mass * (G * np.sin(theta) + length * acceleration),
        )
        assert wrench[[2, 0]] == pytest.approx([along, across], rel=1e-13)
        assert wrench[4] == pytest.approx(-(wanted - armature * acceleration), rel=1e-14)


def test_a_rotor_turned_about_another_axis_loads_the_joint_of_its_carrier() -> None:
    """Its momentum n J dq along x: the joint supplies n J (ddq along x + W dq along y), the moment of a gyroscope."""
    ratio, J, W = 5.0, 0.02, 3.0

    def carried(*rotors: sf.Rotor) -> sf.Model:
        solid = sf.Inertia(1.0, (0.1, 0.2, 0.3), (0.3, 0.4, 0.5))
        bodies = [
            sf.RigidBody("base", sf.Joint("turn", "revolute", axis=(0, 0, 1), prescribed=True), solid),
            sf.RigidBody("arm", sf.Joint("q", "revolute", "base", axis=(1, 0, 0), rotors=rotors), solid),
        ]
        return sf.compile(sf.System("carried", bodies), INTERPRETED)

    q, v, a, u = [0.3], [2.0], [1.7], [0.4, W, 0.0]
    with_rotor, without = (m.joint_wrenches(q, v, a, u) for m in (carried(sf.Rotor(J, ratio)), carried()))
    added = np.array([0, 0, 0, ratio * J * a[0], ratio * J * W * v[0], 0])
    np.testing.assert_allclose(with_rotor[0] - without[0], added, rtol=0, atol=1e-12)
    np.testing.assert_allclose(with_rotor[1], without[1], rtol=0, atol=1e-12)


@pytest.mark.parametrize("coordinate", [0, 1])
def test_a_rotor_loads_the_drive_of_its_own_speed_alone(coordinate: int) -> None:
    """Of a joint with two speeds, on a carrier at rest: ratio^2 J ddq."""
    solid = sf.Inertia(1.0, (0.1, 0.2, 0.3), (0.3, 0.4, 0.5))

    def driven(*rotors: sf.Rotor) -> sf.Model:
        bodies = [
            sf.RigidBody("base", sf.Joint("x", "prismatic", axis=(1, 0, 0)), solid),
            sf.RigidBody("arm", sf.Joint("hook", "universal", "base", prescribed=True, rotors=rotors), solid),
        ]
        return sf.compile(sf.System("hook", bodies), INTERPRETED)

    u = np.array([0.3, 2.0, 1.7, -0.4, 0.6, -0.9])
    rotor = sf.Rotor(0.02, 5.0, (0, 1, 0), coordinate=coordinate)
    with_rotor, without = (m.prescribed_efforts([0.1], [0.2], [0.3], u) for m in (driven(rotor), driven()))
    added = np.zeros(2)
    added[coordinate] = 25.0 * 0.02 * u[4 + coordinate]
    np.testing.assert_allclose(with_rotor - without, added, rtol=0, atol=1e-12)
