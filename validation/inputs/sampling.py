"""Seeded random states on the manifold of q: the same states for every engine, on every machine."""

from __future__ import annotations

import zlib
from collections.abc import Callable

import numpy as np

from ..contract.interface import States
from ..mechanics.assembly import Assembly, Mover
from ..mechanics.geometry import Array
from ..mechanics.joint_kinds import SIMPLE_JOINTS

# No multiple of 2, 4 or 8: whatever the width of vectors, some states are left behind the last whole one.
DEFAULT_STATES = 1003

# Angles all around, whatever the limits: engines must agree beyond a robot's stops too.
ANGLE = np.pi
SLIDE = 1.0  # [m]
SPEED = 2.0  # [rad/s, m/s]
ACCELERATION = 5.0  # [rad/s^2, m/s^2]
DEFLECTION = 0.1  # [rad, and m per m of length]: what second-order beam theory is good for.
TURN = 0.3  # [rad, and stretch and shear without dimension]: of exact rods, all coordinates together.
INPUT = 10.0  # [N m, N]
MANY_TURNS = 100.0  # [rad]
FAST = 20.0  # [rad/s, m/s]


def sample(assembly: Assembly, nu: int, count: int = DEFAULT_STATES, seed: int = 0, first: int = 0) -> States:
    """Random states, the first few of them special.

    Args:
        assembly: Assembly whose coordinates are drawn; its name is part of the seed, so that models do not share their
            states.
        nu: Number of inputs.
        count: Number of states; the special ones come first and count.
        seed: Seed of the draw.
        first: Number of the first state, where these are a later part of many: drawn apart, none of them special.

    Returns:
        States without forces: `with_forces` adds them.
    """
    part = [first] if first else []
    rng = np.random.default_rng([seed, zlib.crc32(assembly.name.encode()), *part])
    q = np.empty((count, assembly.nq))
    for mover in assembly.movers:
        if not mover.joint.prescribed:
            q[:, mover.q] = _coordinates(mover, rng, count)
    v = rng.uniform(-SPEED, SPEED, (count, assembly.nv))
    a = rng.uniform(-ACCELERATION, ACCELERATION, (count, assembly.nv))
    u = rng.uniform(-INPUT, INPUT, (count, nu))
    for k, make_special in enumerate(_SPECIAL[: special_states(count, first)]):
        make_special(assembly, q[k], v[k])
    none = np.zeros((count, assembly.nv))
    return States(q, v, a, u, none, none)


def special_states(count: int, first: int = 0) -> int:
    """How many of the first states are not random.

    Args:
        count: Number of states.
        first: Number of the first state, where these are a later part of many.
    """
    return 0 if first else min(count, len(_SPECIAL))


def neutral(assembly: Assembly) -> Array:
    """All coordinates zero, all quaternions no rotation (nq,)."""
    q = np.zeros(assembly.nq)
    for mover in assembly.movers:
        if mover.has_quaternion:
            q[mover.q.stop - 1] = 1.0
    return q


def _coordinates(mover: Mover, rng: np.random.Generator, count: int) -> Array:
    sampling = SIMPLE_JOINTS[mover.kind].sampling
    if sampling == "angle":
        return rng.uniform(-ANGLE, ANGLE, (count, 1))
    if sampling == "slide":
        return rng.uniform(-SLIDE, SLIDE, (count, mover.part.coordinates))
    if sampling == "deflection":
        n = mover.part.coordinates
        most = TURN if mover.is_rod else DEFLECTION * min(1.0, mover.length)
        return rng.uniform(-most, most, (count, n)) / max(n, 1)
    quaternion = rng.standard_normal((count, 4))  # Normal in four directions: uniform on the sphere.
    quaternion /= np.linalg.norm(quaternion, axis=1, keepdims=True)
    if sampling == "quaternion":
        return quaternion
    return np.concatenate([rng.uniform(-SLIDE, SLIDE, (count, 3)), quaternion], axis=1)


def _set_neutral_at_rest(assembly: Assembly, q: Array, v: Array) -> None:
    q[:], v[:] = neutral(assembly), 0.0


def _neutral_moving(assembly: Assembly, q: Array, v: Array) -> None:
    q[:] = neutral(assembly)


def _at_rest(assembly: Assembly, q: Array, v: Array) -> None:
    v[:] = 0.0


def _many_turns(assembly: Assembly, q: Array, v: Array) -> None:
    for mover in assembly.movers:
        if mover.kind == "revolute":
            q[mover.q] *= MANY_TURNS / ANGLE


def _half_turns(assembly: Assembly, q: Array, v: Array) -> None:
    """Quaternions with w = 0, where careless conversions from matrices fail."""
    for mover in assembly.movers:
        if mover.has_quaternion:
            q[mover.q.stop - 4 : mover.q.stop] = (0.6, 0.0, 0.8, 0.0)


def _negative_quaternions(assembly: Assembly, q: Array, v: Array) -> None:
    """-q is the same rotation as q."""
    for mover in assembly.movers:
        if mover.has_quaternion:
            q[mover.q.stop - 4 : mover.q.stop] *= -1.0


def _fast(assembly: Assembly, q: Array, v: Array) -> None:
    v *= FAST / SPEED


_SPECIAL: tuple[Callable[[Assembly, Array, Array], None], ...] = (
    _set_neutral_at_rest,
    _neutral_moving,
    _at_rest,
    _many_turns,
    _half_turns,
    _negative_quaternions,
    _fast,
)
