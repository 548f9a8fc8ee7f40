"""Limits of joints as stops, by one rule for all formats.

A file states where a joint ends, and not how hard. With M the mass matrix of the open tree at zero coordinates, and
I = 1/(M^-1)_kk the inertia that a push on the joint alone meets, a stop has the stiffness I w^2 and, for motion further
into the limit, the damping 2 I w: the joint is critically damped at the frequency w, which a step of 1 ms resolves.
MuJoCo scales its limits by the same inertia (dof_invweight0).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symofros.base.arrays import Array
from symofros.base.rotations import skew
from symofros.description.forces import Stop
from symofros.description.frames import IDENTITY_POSE, Pose
from symofros.description.imported.geometry import matrix_of
from symofros.description.joints.joint import Joint
from symofros.description.remarks import Remarks
from symofros.description.system import Inertia, RigidBody
from symofros.description.values import Value

PERIOD = 0.02  # [s]
_OMEGA = 2.0 * math.pi / PERIOD
_MADE = f"limits are stops that yield: critically damped, with the joint's own inertia at a period of {PERIOD:g} s"
_SINGULAR = "limits kept as data, as no stiffness of a stop follows from a singular mass matrix"


def with_stops(bodies: Sequence[RigidBody], remarks: Remarks) -> tuple[RigidBody, ...]:
    """The bodies of an open tree of numbers, with a stop on each coordinate that has limits.

    Args:
        bodies: Bodies, parents first.
        remarks: Takes the stiffness chosen, joint by joint.
    """
    limited = {b.name: b.joint.name for b in bodies if b.joint is not None and _is_limited(b.joint)}
    inertias = apparent_inertias(bodies) if limited else {}
    if inertias is None:
        for name in limited.values():
            remarks.add(_SINGULAR, "joint", name)
        return tuple(bodies)
    return tuple(_stopped(b, inertias[b.name], remarks) if b.name in limited else b for b in bodies)


def _is_limited(joint: Joint) -> bool:
    return joint.limits is not None and (joint.limits.lower, joint.limits.upper) != (None, None)


def _stopped(body: RigidBody, inertia: float, remarks: Remarks) -> RigidBody:
    joint = body.joint
    assert joint is not None and joint.limits is not None
    stiffness, unit = inertia * _OMEGA**2, {"angle": "N m/rad", "length": "N/m"}[joint.traits.coordinates[0].measure]
    remarks.add(_MADE, "joint", f"{joint.name} {stiffness:.3g} {unit}")
    stop = Stop(stiffness, 2.0 * inertia * _OMEGA, joint.limits.lower, joint.limits.upper)
    return replace(body, joint=replace(joint, elements=(*joint.elements, stop)))


def apparent_inertias(bodies: Sequence[RigidBody]) -> dict[str, float] | None:
    """1/(M^-1)_kk of the first speed of each body's joint, by body; None where M is singular.

    Args:
        bodies: Bodies of an open tree of numbers, parents first; all coordinates are zero.
    """
    twists, inertias = _in_world(bodies)
    parents = {body.name: body.joint.parent if body.joint is not None else "" for body in bodies}
    for body in reversed(bodies):
        if parents[body.name] in inertias:
            inertias[parents[body.name]] = inertias[parents[body.name]] + inertias[body.name]
    first, count = dict[str, int](), 0
    for name, own in twists.items():
        first[name], count = count, count + own.shape[1]
    M = np.zeros((count, count))
    for body in bodies:
        columns = slice(first[body.name], first[body.name] + twists[body.name].shape[1])
        momentum, name = inertias[body.name] @ twists[body.name], body.name
        while name in twists:
            rows = slice(first[name], first[name] + twists[name].shape[1])
            M[rows, columns] = twists[name].T @ momentum
            M[columns, rows] = M[rows, columns].T
            name = parents[name]
        if body.joint is not None:
            M[columns, columns] += _number(body.joint.armature) * np.eye(twists[body.name].shape[1])
    try:
        inverse = np.linalg.inv(np.linalg.cholesky(M))
    except np.linalg.LinAlgError:
        return None
    apparent = 1.0 / (inverse * inverse).sum(axis=0)
    return {name: float(apparent[k]) for name, k in first.items() if twists[name].shape[1]}


def _number(value: Value) -> float:
    """A number of a file, in which there are no formulas."""
    assert isinstance(value, float)
    return value


def _in_world(bodies: Sequence[RigidBody]) -> tuple[dict[str, Array], dict[str, Array]]:
    """Twists of each body's own speeds (6, nv), and spatial inertias (6, 6), at the origin of the world."""
    poses, twists, inertias = dict[str, Pose](), dict[str, Array](), dict[str, Array]()
    for body in bodies:
        joint = body.joint or Joint("", "fixed")
        placed = Pose(np.array(joint.position, dtype=float), matrix_of(joint.rotation))
        poses[body.name] = pose = poses.get(joint.parent, IDENTITY_POSE) @ placed
        twists[body.name], inertias[body.name] = _twists(joint, pose), _inertia(body.inertia, pose)
    return twists, inertias


def _twists(joint: Joint, pose: Pose) -> Array:
    """Twists (linear; angular) (6, nv) of unit speeds at zero coordinates, along the world's axes at its origin."""
    along = [np.array(list(map(_number, axis))) for axis in (joint.axis, joint.axis2)]
    axes = dict(zip(("axis", "axis2"), (e / (np.linalg.norm(e) or 1.0) for e in along), strict=True))
    axes |= dict(zip("xyz", np.eye(3), strict=True))
    turns, slides = list[Array](), list[Array]()
    if joint.traits.quasi_velocities:
        free = [np.zeros(3)] * 3 if joint.kind == "free" else []
        turns, slides = [*free, *np.eye(3)], [*np.eye(3)[: len(free)], *[np.zeros(3)] * 3]
    for coordinate in joint.traits.coordinates if not turns else ():
        e, slope = axes[coordinate.axis or "axis"], float(coordinate.measure == "length")
        pitch = _number(joint.pitch) if "pitch" in joint.traits.entries else 0.0
        turns.append((1.0 - slope) * e)
        slides.append((slope + pitch) * e)
    w, v = (pose.R @ np.array(columns).reshape(-1, 3).T for columns in (turns, slides))
    return np.vstack([v + skew(pose.p) @ w, w])


def _inertia(stated: Inertia | None, pose: Pose) -> Array:
    """Spatial inertia (6, 6) of a body about the world's origin, by twists (linear; angular)."""
    if stated is None:
        return np.zeros((6, 6))
    m, p = _number(stated.mass), np.array(list(map(_number, stated.center_of_mass)))
    xx, yy, zz, xy, xz, yz = map(_number, stated.moments)
    R = pose.R @ matrix_of(stated.rotation)
    K = skew(pose.p + pose.R @ p)
    J = R @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ R.T
    return np.block([[m * np.eye(3), -m * K], [m * K, J - m * K @ K]])
