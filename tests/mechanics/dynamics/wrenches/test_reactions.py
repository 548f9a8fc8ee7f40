"""Wrenches of joints and efforts of drives against Newton and Euler's equations, power balances and closed forms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.mechanics.beams.rods import BODY, HUB, OFF_AXIS, SECTION, integrated
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


L = 1.3
STATIONS = (0.0, 0.2, 0.55, 0.9, 1.0)
THEORIES: dict[str, dict[str, Any]] = {
    "zeroth order": {"retain": "zeroth_order"},
    "first order": {"retain": "first_order"},
    "all": {"retain": "all"},
    "strain": {"theory": "strain"},
    "stretch and shear": {"theory": "strain", "stretch": 1, "shear_y": 1, "EA": 900.0, "GA_y": 400.0},
}
OFF_THE_CENTRES: dict[str, Any] = {"theory": "strain"} | OFF_AXIS


def beam(joint: sf.Joint, **more: Any) -> sf.Beam:
    given: dict[str, Any] = SECTION | {"bend_y": 2, "bend_z": 1, "twist": 1, "family": "legendre"} | more
    return sf.Beam("b", joint, L, stations=STATIONS, **given)


def compiled(bodies: list[sf.Beam | sf.RigidBody], gravity: tuple[float, float, float] = (0, 0, -G)) -> sf.Model:
    return sf.compile(sf.System("s", bodies, gravity=gravity), INTERPRETED)


@pytest.mark.parametrize("entries", [*THEORIES.values(), OFF_THE_CENTRES], ids=[*THEORIES, "off the centres"])
@pytest.mark.parametrize("tapered", [False, True])
def test_section_forces_at_the_ends_match_joint_and_tip_wrenches(entries: dict[str, Any], tapered: bool) -> None:
    """In any motion, whatever the theory leaves out, with loads, rotary inertia and a body on the tip."""
    loads = (
        sf.BeamLoad(force=(0.3, "0.2*x", -3.0), torque=(0.1, 0, 0.2), axes="world"),
        sf.BeamLoad(force=(0, 1.0, -2.0), torque=(0.3, 0.1, 0.2), at=0.6),
    )
    more: dict[str, Any] = {"rhoA": "2 + x", "EI_z": "3 - x"} if tapered else {}
    one = beam(HUB, rotary_inertia=True, loads=loads, **entries, **more)
    m = compiled([one, sf.RigidBody("body", sf.Joint("wrist", "revolute", "b", "tip", axis=(0, 1, 0)), BODY)])
    rng = np.random.default_rng(2)
    q, v, a = (rng.normal(size=(3, m.nq)) * scale for scale in (0.3, 1.0, 1.0))
    wrenches, forces = (call(q, v, a, np.zeros(m.nu)) for call in (m.joint_wrenches, m.section_forces))
    scale = np.abs(wrenches[:, 0]).max()
    np.testing.assert_allclose(forces[:, 0], -wrenches[:, 0], atol=1e-14 * scale)
    np.testing.assert_allclose(forces[:, -1], -wrenches[:, 1], atol=1e-14 * scale)


@pytest.mark.parametrize("theory", THEORIES)
def test_section_forces_jump_at_loaded_stations(theory: str) -> None:
    """A weight of 0.7 kg at 0.4 of the length: it counts up to its station, that included."""
    frames = (sf.Frame("middle", at=0.4), sf.Frame("tip"))
    one = replace(beam(sf.Joint("clamp", "fixed"), frames=frames, **THEORIES[theory]), stations=(0.0, 0.4, 0.41))
    weld = sf.Joint("weld", "fixed", "b", "middle", position=(0.05, 0, 0))
    m = compiled([one, sf.RigidBody("weight", weld, sf.Inertia(0.7))])
    none = np.zeros(m.nv)
    shear = SECTION["rhoA"] * G * L * (1 - np.array([0.0, 0.4, 0.41])) + 0.7 * G * np.array([1, 1, 0])
    forces = m.section_forces(none, none, none, [])
    np.testing.assert_allclose(forces[:, 2], -shear, rtol=1e-12)
    bending = SECTION["rhoA"] * G * (L * 0.6) ** 2 / 2 + 0.7 * G * 0.05
    assert forces[1, 4] == pytest.approx(bending, rel=1e-12)


@pytest.mark.parametrize("theory", ["first order", "strain"])
@pytest.mark.parametrize("n", [2, 3])
def test_segments_carry_the_same_section_forces(theory: str, n: int) -> None:
    """Undeformed in any rigid motion; at the joints between segments it is what these transmit."""
    hub = sf.Joint("ball", "ball")
    stations = tuple(k / 6 for k in range(7))
    whole, parts = (
        compiled([replace(beam(hub, twist=0, **THEORIES[theory]), stations=stations, segments=count)])
        for count in (1, n)
    )
    rng = np.random.default_rng(4)
    q, v, a = np.array([0.1, -0.3, 0.2, 0.9]), rng.normal(size=3), rng.normal(size=3)
    q[:4] /= np.linalg.norm(q[:4])

    def forces(m: sf.Model, call: Callable[..., np.ndarray]) -> np.ndarray:
        rates = (np.pad(x, (0, m.nv - 3)) for x in (v, a))
        return call(np.pad(q, (0, m.nq - 4)), *rates, np.zeros(m.nu))

    wanted = forces(whole, whole.section_forces)
    got = forces(parts, parts.section_forces)
    np.testing.assert_allclose(got, wanted, atol=1e-12 * np.abs(wanted).max())
    ends = [k for k, (_, xi) in enumerate(parts.names.sections) if xi == 1.0]
    joints = [k for k, name in enumerate(parts.names.joints) if name.endswith(".tip")]
    transmitted = forces(parts, parts.joint_wrenches)[joints]
    np.testing.assert_allclose(got[ends], -transmitted, atol=1e-13 * np.abs(wanted).max())


def second_order_shape(q: np.ndarray, xi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions and rotations of sections with v = q0 xi^2 + q1 xi^3, w = q2 xi^2, roll = q3 xi, after (1)-(3)."""
    v, w, roll = q[0] * xi**2 + q[1] * xi**3, q[2] * xi**2, q[3] * xi
    slope = np.polynomial.Polynomial([0, 2 * q[0] / L, 3 * q[1] / L])
    pitch = np.polynomial.Polynomial([0, -2 * q[2] / L])
    shortened = -0.5 * L * ((slope**2 + pitch**2).integ())(xi)
    R = np.array([_turn(2, P) @ _turn(1, T) @ _turn(0, F) for P, T, F in zip(slope(xi), pitch(xi), roll, strict=True)])
    return np.stack([L * xi + shortened, v, w], axis=-1), R


def _turn(axis: int, angle: float) -> np.ndarray:
    R, (i, j) = np.eye(3), ((axis + 1) % 3, (axis + 2) % 3)
    R[i, i] = R[j, j] = np.cos(angle)
    R[j, i], R[i, j] = np.sin(angle), -np.sin(angle)
    return R


def rod_shape(q: np.ndarray, xi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    p, R = integrated((2, 1, 1), q, np.concatenate([xi, [1.0]]))
    return L * p[:-1], R[:-1]


@pytest.mark.parametrize(("theory", "center"), [("all", (0.0, 0.0)), ("strain", (0.0, 0.0)), ("strain", (0.05, -0.08))])
def test_section_forces_equal_the_momentum_rate_beyond(theory: str, center: tuple[float, float]) -> None:
    """Newton and Euler for the part beyond a station: its momentum by differences of positions that share nothing."""
    shape = {"all": second_order_shape, "strain": rod_shape}[theory]
    hub = sf.Joint("hub", "revolute", axis=(0, 0, 1))
    plain: dict[str, Any] = {"rhoJ": 1e-12}
    plain |= {"family": "polynomial"} if theory == "all" else {"sections": 12}  # To the digits of the differences.
    m = compiled([beam(hub, mass_center=center, **THEORIES[theory], **plain)])
    rng = np.random.default_rng(5)
    q, v, a = rng.normal(size=(3, m.nv)) * [[0.2], [0.5], [0.5]]
    station = 2
    nodes, weights = np.polynomial.legendre.leggauss(12)
    xi0 = STATIONS[station]
    xi, mass = xi0 + (1 - xi0) * (1 + nodes) / 2, SECTION["rhoA"] * L * (1 - xi0) * weights / 2

    def positions(t: float) -> np.ndarray:
        at = q + v * t + a * t**2 / 2
        places, turns = shape(at[1:], xi)
        return (places + turns @ (0.0, *center)) @ _turn(2, at[0]).T

    h = 2e-3
    there = [positions(k * h) for k in (-2, -1, 0, 1, 2)]
    acceleration = sum(c * p for c, p in zip((-1, 16, -30, 16, -1), there, strict=True)) / (12 * h * h)
    forces = mass[:, None] * (acceleration - [0, 0, -G])
    p, R = shape(q[1:], np.array([xi0]))
    R_WS = _turn(2, q[0]) @ R[0]
    arms = there[2] - _turn(2, q[0]) @ p[0]
    wanted = -np.concatenate([R_WS.T @ forces.sum(axis=0), R_WS.T @ np.cross(arms, forces).sum(axis=0)])
    got = m.section_forces(q, v, a, np.zeros(m.nu))[station]
    np.testing.assert_allclose(got, wanted, atol=3e-7 * np.abs(wanted).max())
