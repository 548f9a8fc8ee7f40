"""Truth of what sensors read at their frames, of forces that act there, and of links as the first of them sees them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .arithmetic import Exact, cross, exact, orthonormal, skew
from .derived import joint_wrenches
from .dynamics import Point, Truth


def _poses_seen(poses: Sequence[tuple[Exact, ...]]) -> Exact:
    """Positions and rows of R of frames (n, 12), in the first of them."""
    R_first, p_first, *_ = poses[0]
    return np.array([[*(R_first.T @ (p - p_first)), *(R_first.T @ R).reshape(9)] for R, p, *_ in poses], dtype=object)


def _velocities_seen(frames: Sequence[tuple[Exact, ...]]) -> Exact:
    """Rates of positions in the first of frames (R, p, twist), and angular velocities against it, along it (n, 6)."""
    (R_first, p_first, first), *_ = frames
    rows = []
    for _, p, own in frames:
        linear = own[:3] - first[:3] - cross(first[3:], p - p_first)
        rows.append(np.concatenate([R_first.T @ linear, R_first.T @ (own[3:] - first[3:])]))
    return np.array(rows, dtype=object)


def poses_seen(truth: Truth, s: Point) -> Exact:
    """Positions and rows of R of the links, in the first link's frame (L, 12)."""
    return _poses_seen(truth.kinematics.poses(s.q))


def velocities_seen(truth: Truth, s: Point) -> Exact:
    """Rates of the links' positions in the first link's frame, and angular velocities against it, along it (L, 6)."""
    twists_ = truth.kinematics.jacobians(s.q) @ s.v
    return _velocities_seen([(*pose, own) for pose, own in zip(truth.kinematics.poses(s.q), twists_, strict=True)])


def twists(truth: Truth, s: Point) -> Exact:
    """Velocities of the sensors' frames, along their axes (n, 6)."""
    frames = [truth.kinematics.held(s.q, end) for end in truth.tree.sensors]
    return np.array([np.concatenate([R.T @ (J @ s.v)[:3], R.T @ (J @ s.v)[3:]]) for R, _, J in frames])


def frame_accelerations(truth: Truth, s: Point) -> Exact:
    """Accelerations of the sensors' points and angular accelerations, along world axes (n, 6)."""

    def jacobians_there(q: Exact) -> Exact:
        return np.array([J for _, _, J in _frames(truth, q)])

    return jacobians_there(s.q) @ s.a + truth.kinematics.along(jacobians_there, s.q, s.v) @ s.v


def accelerometers(truth: Truth, s: Point) -> Exact:
    """Accelerations of the sensors' points less gravity's, along the sensors' axes (n, 3)."""
    frames = [truth.kinematics.held(s.q, end) for end in truth.tree.sensors]
    accelerations = frame_accelerations(truth, s)
    return np.array([R.T @ (a[:3] - truth.gravity_vector) for (R, _, _), a in zip(frames, accelerations, strict=True)])


def angular_accelerations(truth: Truth, s: Point) -> Exact:
    """Angular accelerations of the sensors, along world axes (n, 3)."""
    return frame_accelerations(truth, s)[:, 3:]


def _frames(truth: Truth, q: Exact) -> list[tuple[Exact, Exact, Exact]]:
    """Rotation, position and Jacobian along the world's axes of each sensor's frame."""
    return [truth.kinematics.held(q, end) for end in truth.tree.sensors]


def frame_poses(truth: Truth, s: Point) -> Exact:
    """Positions and rows of R of the sensors' frames (n, 12)."""
    return np.array([np.concatenate([p, R.reshape(9)]) for R, p, _ in _frames(truth, s.q)])


def frame_poses_seen(truth: Truth, s: Point) -> Exact:
    """The same in the first of these frames (n, 12)."""
    return _poses_seen(_frames(truth, s.q))


def frame_jacobians(truth: Truth, s: Point) -> Exact:
    """Jacobians of the sensors' frames, along the world's axes (n, 6, nv)."""
    return np.array([J for _, _, J in _frames(truth, s.q)])


def frame_velocities(truth: Truth, s: Point) -> Exact:
    """Velocities of the sensors' frames, along the world's axes (n, 6)."""
    return frame_jacobians(truth, s) @ s.v


def frame_velocities_seen(truth: Truth, s: Point) -> Exact:
    """Rates of the frames' positions in the first of them, and angular velocities against it, along it (n, 6)."""
    return _velocities_seen([(R, p, J @ s.v) for R, p, J in _frames(truth, s.q)])


def frame_velocity_products(truth: Truth, s: Point) -> Exact:
    """Accelerations of the sensors' frames at a = 0, along the world's axes (n, 6)."""
    return frame_accelerations(truth, s._replace(a=0 * s.a))


# Of the world.
MAGNETIC = (0.25, -0.5, 1.0)


def magnetic_fields(truth: Truth, s: Point) -> Exact:
    """The world's field along the axes of the sensors (n, 3)."""
    return np.array([R.T @ exact(MAGNETIC) for R, _, _ in _frames(truth, s.q)])


# Force, then moment about the frame's origin, along its axes.
WRENCH = (1.0, -2.0, 3.0, 0.5, -0.25, 0.75)


def applied_wrenches(truth: Truth, s: Point) -> Exact:
    """Forces along the speeds (nv) of `WRENCH` at each sensor's frame."""
    total, wrench = 0 * s.v, exact(WRENCH)
    for end in truth.tree.sensors:
        R, _, J = truth.kinematics.held(s.q, end)
        total = total + np.concatenate([R @ wrench[:3], R @ wrench[3:]]) @ J
    return total


def applied_wrenches_dq(truth: Truth, s: Point) -> Exact:
    """Derivative of `applied_wrenches` by q (nv, nv)."""
    return truth.kinematics.tangent(lambda q: applied_wrenches(truth, s._replace(q=q)), s.q)


def pushed_forces(truth: Truth, s: Point) -> Exact:
    """Forces (nv) that inverse dynamics find beside these wrenches."""
    return truth.ID(s.q, s.v, s.a) - applied_wrenches(truth, s)


def pushed(truth: Truth, s: Point) -> Exact:
    """Accelerations (nv) that the forces and these wrenches make."""
    return truth.FD(s.q, s.v, s.tau + applied_wrenches(truth, s))


def pushed_dq(truth: Truth, s: Point) -> Exact:
    """Derivative of these accelerations by q (nv, nv), the wrenches constant along the links' axes."""
    return truth.kinematics.tangent(lambda q: pushed(truth, s._replace(q=q)), s.q)


def pushed_dv(truth: Truth, s: Point) -> Exact:
    """Derivative of these accelerations by v (nv, nv)."""
    return truth.along_speeds(lambda v: pushed(truth, s._replace(v=v)), s.v)


def wrench_sensors(truth: Truth, s: Point) -> Exact:
    """Wrench (force; moment) of each sensor's link's joint on its subtree, at the sensor, along its axes (n, 6)."""
    held, places = joint_wrenches(truth, s), [link.name for link in truth.tree.links]
    rows = []
    for end in truth.tree.sensors:
        wrench, R = held[places.index(end.link)], orthonormal(end.R)
        moment = wrench[3:] - skew(exact(end.p)) @ wrench[:3]
        rows.append(np.concatenate([R.T @ wrench[:3], R.T @ moment]))
    return np.array(rows)
