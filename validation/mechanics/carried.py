"""What a tree carries, as functions of its state: places and rotations, their Jacobians and accelerations, for batches.

Every body, and every section of a beam, is followed from the world outwards. With v all speeds, those of prescribed
joints after the others, the velocity of a point is J v and its acceleration J v' + J' v; J and J' v are stated in
closed form (docs/theory/elements.md, section 2), apart from the generator's recursion. World axes throughout.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .assembly import BASE, Assembly, Mover
from .elastic import Curve, ElasticBeam, Turn
from .geometry import Array, Placement, quaternion_matrix, skew
from .joint_kinds import PartKind
from .parts import coordinate_symbols, speed_symbols
from .rod import StrainRod

# Kinds of simple joints whose motion is stated here.
KINDS: frozenset[PartKind] = frozenset({"revolute", "prismatic", "screw", "ball", "free", "elastic"})


@dataclass(frozen=True)
class AllSpeeds:
    """N states of a tree with its prescribed joints' motion appended.

    Attributes:
        q: Coordinates (N, nq + prescribed).
        v: Speeds (N, n).
        a: Rates of the speeds (N, n).
    """

    q: Array
    v: Array
    a: Array


@dataclass(frozen=True)
class Carried:
    """K points with a triad each, on one body, for N states.

    Attributes:
        p: Places (N, K, 3).
        R: Rotations (N, K, 3, 3).
        J: Velocities of unit speeds (N, K, 3, n).
        J_w: Angular velocities of unit speeds (N, K, 3, n).
        a: Accelerations at the given rates of the speeds (N, K, 3).
        alpha: Angular accelerations (N, K, 3), in the same axes.
    """

    p: Array
    R: Array
    J: Array
    J_w: Array
    a: Array
    alpha: Array


def all_speeds(assembly: Assembly, q: Array, v: Array, a: Array, motions: Array) -> AllSpeeds:
    """States with prescribed motions.

    Args:
        assembly: The tree.
        q: Coordinates (N, nq).
        v: Speeds (N, nv).
        a: Rates of the speeds (N, nv).
        motions: Inputs of the prescribed joints (N, m): coordinates, speeds and rates, joint by joint.
    """
    parts: tuple[list[Array], list[Array], list[Array]] = ([q], [v], [a])
    at = 0
    for joint in assembly.driven_joints:
        sizes = len(coordinate_symbols(joint)), len(speed_symbols(joint)), len(speed_symbols(joint))
        for part, size in zip(parts, sizes, strict=True):
            part.append(motions[:, at : at + size])
            at += size
    return AllSpeeds(*(np.concatenate(part, axis=1) for part in parts))


def slots(assembly: Assembly) -> list[tuple[slice, slice]]:
    """Slices of each mover's coordinates and speeds; those of prescribed motions come after all others."""
    ends = {}
    q, v = assembly.nq, assembly.nv
    for joint in assembly.driven_joints:
        ends[joint.name] = q, v
        q, v = q + len(coordinate_symbols(joint)), v + len(speed_symbols(joint))
    places = []
    for mover in assembly.movers:
        if not mover.joint.prescribed:
            places.append((mover.q, mover.v))
            continue
        q, v = (end + mover.part.first for end in ends[mover.joint.name])
        places.append((slice(q, q + mover.part.coordinates), slice(v, v + mover.part.speeds)))
    return places


def bodies(assembly: Assembly, beams: Mapping[str, ElasticBeam | StrainRod], states: AllSpeeds) -> list[Carried]:
    """The frame of every mover (K = 1); that of elastic coordinates is the beam's tip."""
    frames: list[Carried] = []
    for mover, (own_q, own_v) in zip(assembly.movers, slots(assembly), strict=True):
        q, v = states.q[:, own_q], states.v[:, own_v]
        if mover.kind == "elastic":
            beam = beams[mover.body]
            tip = np.array([beam.length])
            step, turn = beam.axis(tip, q, v), beam.rotation(tip, q, v)
        else:
            step, turn = _across(mover, q, v)
        frames.append(led(proximal(frames, mover, states), states, own_v, step, turn))
    return frames


def proximal(frames: list[Carried], mover: Mover, states: AllSpeeds) -> Carried:
    """The frame that a mover moves in (K = 1): its joint's, or the root of its beam."""
    parent = ground(states) if mover.parent == BASE else frames[mover.parent]
    return fixed(parent, states, mover.X_AP)


def fixed(frame: Carried, states: AllSpeeds, X: Placement) -> Carried:
    """A frame placed on a body (K = 1)."""
    shape = (len(states.v), 1, 3)
    none, still = np.zeros((*shape, 0)), np.zeros(shape)
    curve = Curve(np.broadcast_to(X.p, shape), none, still)
    return led(frame, states, slice(0, 0), curve, Turn(np.broadcast_to(X.R, (*shape, 3)), none, still))


def led(root: Carried, states: AllSpeeds, own: slice, place: Curve, turn: Turn) -> Carried:
    """Triads that move in a frame by speeds of their own.

    Args:
        root: The frame (K = 1).
        states: The states.
        own: Those speeds among all.
        place: Places in the frame.
        turn: Rotations in the frame.
    """
    R, w = root.R[:, 0], _times(root.J_w, states.v)
    r, J, a = arrow(root, states, own, place)
    spin = np.einsum("nab,nkbi->nkai", R, turn.partial)
    J_w = np.repeat(root.J_w, r.shape[1], axis=1)
    J_w[..., own] += spin
    turning = _times(spin, states.a[:, own]) + np.einsum("nab,nkb->nka", R, turn.bend)
    alpha = root.alpha + np.cross(w, _times(spin, states.v[:, own])) + turning
    return Carried(root.p + r, root.R @ turn.R, root.J + J, J_w, root.a + a, alpha)


def arrow(root: Carried, states: AllSpeeds, own: slice, curve: Curve) -> tuple[Array, Array, Array]:
    """Vectors of a beam along world axes: value (N, K, 3), rates of unit speeds (N, K, 3, n), second rate (N, K, 3)."""
    R, w, alpha = root.R[:, 0], _times(root.J_w, states.v), root.alpha
    value = np.einsum("nab,nkb->nka", R, curve.value)
    partial = np.einsum("nab,nkbi->nkai", R, curve.partial)
    J = -skew(value) @ root.J_w
    J[..., own] += partial
    rate = _times(partial, states.v[:, own])
    bend = np.einsum("nab,nkb->nka", R, curve.bend) + _times(partial, states.a[:, own])
    turned = np.cross(alpha, value) + np.cross(w, np.cross(w, value)) + 2.0 * np.cross(w, rate) + bend
    return value, J, turned


def ground(states: AllSpeeds) -> Carried:
    """The world's frame (K = 1)."""
    count, n = states.v.shape
    still, none = np.zeros((count, 1, 3)), np.zeros((count, 1, 3, n))
    return Carried(still, np.broadcast_to(np.eye(3), (count, 1, 3, 3)), none, none, still, still)


def _across(mover: Mover, q: Array, v: Array) -> tuple[Curve, Turn]:
    """Place and rotation of a joint's moving frame in its proximal one."""
    count, speeds = v.shape
    value, still = np.zeros((count, 1, 3)), np.zeros((count, 1, 3))
    R = np.broadcast_to(np.eye(3), (count, 1, 3, 3))
    partial, spin = np.zeros((count, 1, 3, speeds)), np.zeros((count, 1, 3, speeds))
    if mover.kind in ("prismatic", "screw"):
        along = mover.axis * (mover.pitch if mover.kind == "screw" else 1.0)
        value, partial[:, 0, :, 0] = q[:, None] * along, along
    if mover.kind in ("revolute", "screw"):
        R, spin[:, 0, :, 0] = about_axes(mover.axis, q), mover.axis
    if mover.kind in ("ball", "free"):
        R = quaternion_matrix(q[:, None, -4:])
        spin[..., -3:] = R
    if mover.kind == "free":
        value, partial[..., :3] = q[:, None, :3], R
        # Linear speeds are along the moving axes.
        still = (R @ np.cross(v[:, None, 3:], v[:, None, :3])[..., None])[..., 0]
    return Curve(value, partial, still), Turn(R, spin, np.zeros((count, 1, 3)))


def about_axes(axis: Array, angles: Array) -> Array:
    """Rotations about a unit axis, by Rodrigues' formula (..., 3, 3)."""
    K = skew(axis)
    s, c = np.sin(angles)[..., None, None], np.cos(angles)[..., None, None]
    return np.asarray(np.eye(3) + s * K + (1.0 - c) * (K @ K))


def _times(J: Array, v: Array) -> Array:
    """Jacobians (N, K, 3, n) times speeds (N, n); of no speeds, zeros, which NumPy's einsum leaves unset at times."""
    return np.asarray((J @ v[:, None, :, None])[..., 0])


def joined(frames: list[Carried]) -> Carried:
    """Triads of several bodies as one batch."""
    names = ("p", "R", "J", "J_w", "a", "alpha")
    return Carried(*(np.concatenate([getattr(frame, name) for frame in frames], axis=1) for name in names))
