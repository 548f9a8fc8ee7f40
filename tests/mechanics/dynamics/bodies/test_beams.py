"""Physics that every tree with beams obeys, at every order."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import symofros as sf
from symofros.generator.passes.count import count_program
from tests.mechanics.beams.cases import CASES
from tests.validation.subjects import assert_agrees
from validation.procedures.equations import identities

ORDERS = ("zeroth_order", "first_order", "all")
NAMES = ("hub about another axis", "free base, rotary inertia", "two in series", "body hinged to the tip", "tapered")
# Sums of some hundred terms of size one.
ROUNDING = 1e-12
STATES = 4


@cache
def model(name: str, retain: str) -> sf.Model:
    return sf.compile(CASES[name].retaining(retain), sf.Options(backend="interpreter"))


def states(m: sf.Model, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Deflections of a tenth of the length or so: second-order theory is good there, and M positive."""
    elastic = np.array(["[" in name for name in m.names.q])
    size = np.where(elastic, 0.05, 1.0)
    return size * rng.standard_normal((STATES, m.nq)), rng.standard_normal((STATES, m.nv))


@pytest.mark.parametrize("retain", ORDERS)
@pytest.mark.parametrize("name", NAMES)
def test_equations_of_beams_belong_together(name: str, retain: str) -> None:
    """Energies and forces, both ways of the dynamics; frames move as their poses do, at any order."""
    system = CASES[name].retaining(retain)
    assert_agrees(identities.balanced, system)
    assert_agrees(identities.moving_frames, system)


@pytest.mark.parametrize("retain", ORDERS)
def test_a_quaternion_base_moves_as_one_with_euler_angles(retain: str, rng: np.random.Generator) -> None:
    """The same motion, stated with other coordinates: its forces have the same virtual power."""
    euler = model("free base, rotary inertia", retain)
    body = CASES["free base, rotary inertia"].retaining(retain).bodies[0]
    floating = replace(body, joint=sf.Joint("base", "free"))
    stated = replace(CASES["free base, rotary inertia"].system, bodies=(floating,))
    free = sf.compile(stated, sf.Options(("inverse_dynamics",), backend="interpreter"))
    q, v = (x[0] for x in states(euler, rng))
    a = rng.standard_normal(euler.nv)
    p, R = euler.frame_pose("beam", q)
    velocity, acceleration = euler.frame_velocity("beam", q, v), euler.frame_acceleration("beam", q, v, a)
    # Body velocities and their rates: the linear one is seen to turn.
    turned = acceleration[:3] - np.cross(velocity[3:], velocity[:3])
    v_free = np.concatenate([R.T @ velocity[:3], R.T @ velocity[3:], v[6:]])
    a_free = np.concatenate([R.T @ turned, R.T @ acceleration[3:], a[6:]])
    q_free = np.concatenate([p, Rotation.from_matrix(R).as_quat(), q[6:]])
    partial = np.eye(euler.nv)
    partial[:6] = np.kron(np.eye(2), R.T) @ euler.frame_jacobian("beam", q)
    expected = euler.inverse_dynamics(q, v, a)
    found = partial.T @ free.inverse_dynamics(q_free, v_free, a_free)
    np.testing.assert_allclose(found, expected, atol=ROUNDING * np.abs(expected).max())


@pytest.mark.parametrize("orders", [("zeroth_order", "all"), ("all", "zeroth_order"), ("first_order", "all")])
def test_orders_mix_in_one_tree(orders: tuple[str, str], rng: np.random.Generator) -> None:
    """Each beam has its own order; M, h and the frames still belong together."""
    stated = CASES["two in series"].system
    bodies = [replace(body, retain=retain) for body, retain in zip(stated.bodies, orders, strict=True)]
    mixed = replace(stated, bodies=tuple(bodies))
    assert_agrees(identities.balanced, mixed)
    assert_agrees(identities.moving_frames, mixed)
    m = sf.compile(mixed, sf.Options(backend="interpreter"))
    q, _ = states(m, rng)
    (p, _), (other, _) = m.frame_pose("two.tip", q), model("two in series", "all").frame_pose("two.tip", q)
    np.testing.assert_allclose(p, other, rtol=ROUNDING)


# Rigid limits.

LENGTH, RHO_A, RHO_J, RHO_Y, RHO_Z = 1.3, 2.0, 0.04, 0.03, 0.01


def arm(kind: str, rotary: bool, parametrised: bool = False) -> sf.System:
    """Two links in series and a body on the last: beams without shape functions, or the same written by hand."""
    L, m = ("L", "rho*L") if parametrised else (LENGTH, RHO_A * LENGTH)
    slender = RHO_A * LENGTH**3 / 3
    moments: tuple[Any, ...]
    if parametrised:
        moments = ("J*L", "rho*L^3/3 + Iy*L", "rho*L^3/3 + Iz*L") if rotary else ("J*L", "rho*L^3/3", "rho*L^3/3")
    elif rotary:
        moments = (RHO_J * LENGTH, slender + RHO_Y * LENGTH, slender + RHO_Z * LENGTH)
    else:
        moments = (RHO_J * LENGTH, slender, slender)
    section = (
        {"rhoA": "rho", "rhoJ": "J", "rhoI_y": "Iy", "rhoI_z": "Iz"}
        if parametrised
        else {"rhoA": RHO_A, "rhoJ": RHO_J, "rhoI_y": RHO_Y, "rhoI_z": RHO_Z}
    )
    bodies: list[sf.Beam | sf.RigidBody] = []
    for i, axis in enumerate(((0, 0, 1), (1, 2, 2))):
        joint = sf.Joint(f"q{i}", "revolute", "b0" if i else "world", "tip" if i else None, axis=axis)
        if kind == "beams":
            bodies.append(sf.Beam(f"b{i}", joint, L, rotary_inertia=rotary, **section))  # type: ignore[arg-type]
        else:
            middle = ("L/2", 0, 0) if parametrised else (LENGTH / 2, 0, 0)
            solid = sf.Inertia(m, middle, moments, about="body")
            bodies.append(sf.RigidBody(f"b{i}", joint, solid, (sf.Frame("tip", (L, 0, 0)),)))
    joint = sf.Joint("q2", "revolute", "b1", "tip", axis=(0, 1, 0))
    bodies.append(sf.RigidBody("load", joint, sf.Inertia(0.5, (0.1, 0.2, 0), (0.01, 0.02, 0.025))))
    numbers = {"L": LENGTH, "rho": RHO_A, "J": RHO_J, "Iy": RHO_Y, "Iz": RHO_Z} if parametrised else {}
    return sf.System("arm", bodies, [sf.Parameter(*item) for item in numbers.items()])


FUNCTIONS = ("mass_matrix", "bias", "generalized_force", "kinetic_energy", "potential_energy", "inverse_dynamics")


@pytest.mark.parametrize("rotary", [False, True])
@pytest.mark.parametrize("parametrised", [False, True])
def test_a_beam_without_shape_functions_is_a_rigid_body(
    rotary: bool, parametrised: bool, rng: np.random.Generator
) -> None:
    systems = [arm(kind, rotary, parametrised) for kind in ("beams", "by hand")]
    one, other = (sf.compile(s, sf.Options(FUNCTIONS, backend="interpreter")) for s in systems)
    q, v = rng.standard_normal((2, 10, 3))
    for function in ("mass_matrix", "potential_energy"):
        a, b = (getattr(m, function)(q) for m in (one, other))
        np.testing.assert_allclose(a, b, atol=1e-14 * np.abs(b).max())
    for function in ("bias", "kinetic_energy"):
        a, b = (getattr(m, function)(q, v) for m in (one, other))
        np.testing.assert_allclose(a, b, atol=1e-14 * np.abs(b).max())
    for name in FUNCTIONS:
        counts = [count_program(sf.program_of(s, [name]))[name, ""] for s in systems]
        assert counts[0] == counts[1], name


def test_directions_without_functions_do_not_move(rng: np.random.Generator) -> None:
    """A beam that only bends along y is one that bends in space, its other coordinates held at zero."""
    planar = replace(CASES["free base"].system.bodies[0], bend_z=0, twist=0)
    m = model("free base", "all")
    other = sf.compile(replace(CASES["free base"].system, bodies=(planar,)), sf.Options(backend="interpreter"))
    kept = [m.names.q.index(name) for name in other.names.q]
    q, v = rng.standard_normal((2, other.nq))
    full_q, full_v = np.zeros((2, m.nq))
    full_q[kept], full_v[kept] = q, v
    np.testing.assert_allclose(other.mass_matrix(q), m.mass_matrix(full_q)[np.ix_(kept, kept)], rtol=ROUNDING)
    np.testing.assert_allclose(other.bias(q, v), m.bias(full_q, full_v)[kept], rtol=ROUNDING)


# Generated code.
