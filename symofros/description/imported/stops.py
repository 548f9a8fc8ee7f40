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

from symofros.base.rotations import Array, skew
from symofros.description.forces import Stop
from symofros.description.imported.geometry import matrix_of
from symofros.description.joints.joint import Joint
from symofros.description.pose import IDENTITY_POSE, Pose
from symofros.description.remarks import Remarks
from symofros.description.system import RigidBody

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
    limited = [body.name for body in bodies if body.joint is not None and _is_limited(body.joint)]
    inertias = apparent_inertias(bodies) if limited else None
    for body in (body for body in bodies if inertias is None and body.name in limited and body.joint is not None):
        remarks.add(_SINGULAR, "joint", body.joint.name)
    if inertias is None:
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
    poses: dict[str, Pose] = {}
    twists: dict[str, Array] = {}  # Of each body's own speeds, at the origin of the world (6, nv).
    parents: dict[str, str] = {}
    inertias: dict[str, Array] = {}  # What the body carries, itself too, about the origin of the world (6, 6).
    for body in bodies:
        joint = body.joint or Joint("", "fixed")
        p, R = np.array(joint.position, dtype=float), matrix_of(joint.rotation)
        poses[body.name] = poses.get(joint.parent, IDENTITY_POSE) @ Pose(p, R)
        parents[body.name], twists[body.name] = joint.parent, _twists(joint, poses[body.name])
        inertias[body.name] = _inertia(body, poses[body.name])
    for body in reversed(bodies):
        if parents[body.name] in inertias and parents[body.name] != body.name:
            inertias[parents[body.name]] = inertias[parents[body.name]] + inertias[body.name]
    first, count = dict[str, int](), 0
    for name, own in twists.items():
        first[name], count = count, count + own.shape[1]
    M = np.zeros((count, count))
    for body in bodies:
        own, at = twists[body.name], first[body.name]
        momentum, name = inertias[body.name] @ own, body.name
        while own.shape[1] and name in twists:
            block = twists[name].T @ momentum
            M[first[name] : first[name] + block.shape[0], at : at + own.shape[1]] = block
            M[at : at + own.shape[1], first[name] : first[name] + block.shape[0]] = block.T
            name = parents[name] if parents[name] != name else ""
        if body.joint is not None:
            armature = float(body.joint.armature) if isinstance(body.joint.armature, float) else 0.0
            M[range(at, at + own.shape[1]), range(at, at + own.shape[1])] += armature
    try:
        inverse = np.linalg.inv(np.linalg.cholesky(M))
    except np.linalg.LinAlgError:
        return None
    apparent = 1.0 / (inverse * inverse).sum(axis=0)
    return {name: float(apparent[k]) for name, k in first.items() if twists[name].shape[1]}


def _twists(joint: Joint, pose: Pose) -> Array:
    """Twists (linear; angular) (6, nv) of unit speeds at zero coordinates, along the world's axes at its origin."""
    along = [[float(x) for x in axis] for axis in (joint.axis, joint.axis2)]
    axes = dict(zip(("axis", "axis2"), (np.array(e) / (np.linalg.norm(e) or 1.0) for e in along), strict=True))
    axes |= dict(zip("xyz", np.eye(3), strict=True))
    turns, slides = list[Array](), list[Array]()
    if joint.traits.quasi_velocities:
        free = [np.zeros(3)] * 3 if joint.kind == "free" else []
        turns, slides = [*free, *np.eye(3)], [*np.eye(3)[: len(free)], *[np.zeros(3)] * 3]
    for coordinate in joint.traits.coordinates if not turns else ():
        e, slope = axes[coordinate.axis or "axis"], float(coordinate.measure == "length")
        pitch = float(joint.pitch) if joint.kind == "screw" and isinstance(joint.pitch, float) else 0.0
        turns.append((1.0 - slope) * e)
        slides.append((slope + pitch) * e)
    w, v = (pose.R @ np.array(columns).reshape(-1, 3).T for columns in (turns, slides))
    return np.vstack([v + skew(pose.p) @ w, w])


def _inertia(body: RigidBody, pose: Pose) -> Array:
    """Spatial inertia (6, 6) of a body about the world's origin, by twists (linear; angular)."""
    if body.inertia is None:
        return np.zeros((6, 6))
    numbers = [float(x) for x in (body.inertia.mass, *body.inertia.center_of_mass, *body.inertia.moments)]  # type: ignore[arg-type]
    m, p, (xx, yy, zz, xy, xz, yz) = numbers[0], np.array(numbers[1:4]), numbers[4:]
    R = pose.R @ matrix_of(body.inertia.rotation)
    K = skew(pose.p + pose.R @ p)
    J = R @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ R.T
    return np.block([[m * np.eye(3), -m * K], [m * K, J - m * K @ K]])
