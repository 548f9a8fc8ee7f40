"""Forces inside beams against closed forms, joints' wrenches and the momentum of the part beyond a station."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.mechanics.beams.rods import BODY, HUB, OFF_AXIS, SECTION, integrated

G = 9.81
L = 1.3
INTERPRETED = sf.Options(backend="interpreter")
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
