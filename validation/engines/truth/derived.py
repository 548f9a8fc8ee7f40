"""Truth of what follows from the dynamics: motions in three frames, centroidal quantities, derivatives, regressors.

Names of frames as Pinocchio uses them: "local" is along the link's axes at its origin, "aligned" along the world's axes
at the link's origin, "world" along the world's axes at the world's origin. Spatial vectors stack linear and angular
parts.
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from typing import Literal

import numpy as np

from .arithmetic import Exact, cross, exact, eye, skew, stack, zeros
from .dynamics import Point, Truth
from .kinematics import Inertia

Frame = Literal["local", "aligned", "world"]
FRAMES: tuple[Frame, ...] = ("local", "aligned", "world")
TruthOf = Callable[[Truth, Point], Exact]


def jacobians(truth: Truth, q: Exact, frame: Frame) -> Exact:
    """Jacobians of the links (L, 6, nv) in a frame."""
    J = truth.kinematics.jacobians(q)
    if frame == "aligned":
        return J
    result = []
    for (R, p), own in zip(truth.kinematics.poses(q), J, strict=True):
        if frame == "local":
            result.append(np.concatenate([R.T @ own[:3], R.T @ own[3:]]))
        else:
            result.append(np.concatenate([own[:3] + skew(p) @ own[3:], own[3:]]))
    return np.array(result, dtype=object)


def jacobian_rates(truth: Truth, q: Exact, v: Exact, frame: Frame) -> Exact:
    """Time derivatives of the Jacobians (L, 6, nv)."""
    return truth.kinematics.along(lambda point: jacobians(truth, point, frame), q, v)


def velocities(truth: Truth, q: Exact, v: Exact, frame: Frame) -> Exact:
    """Spatial velocities (L, 6)."""
    return jacobians(truth, q, frame) @ v


def accelerations(truth: Truth, q: Exact, v: Exact, a: Exact, frame: Frame) -> Exact:
    """Spatial accelerations (L, 6): the rate of the components of the velocity in "local" and "world".

    In "aligned" it is the local one turned into the world's axes.
    """
    if frame != "aligned":
        return jacobians(truth, q, frame) @ a + jacobian_rates(truth, q, v, frame) @ v
    return turned(truth, q, accelerations(truth, q, v, a, "local"))


def classical(truth: Truth, q: Exact, v: Exact, a: Exact) -> Exact:
    """Accelerations of the links' origins and angular accelerations, along world axes (L, 6)."""
    return truth.motions(q, v, a)[2]


def joint_wrenches(truth: Truth, s: Point) -> Exact:
    """Wrench (force; moment) of each joint on its link's subtree, about the link's origin, in link axes (L, 6).

    What straight tendons do to links is no part of it: what holds a link makes up for it.
    """
    poses = truth.kinematics.poses(s.q)
    held = truth.wrenches(truth.motions(s.q, s.v, s.a), poses, list(truth.inertias))
    places = [link.name for link in truth.tree.links]
    for name, point, force in truth.own.pulls(s.q, s.v, s.a):
        if name:
            k = places.index(name)
            held[k] = held[k] - np.concatenate([force, cross(point - poses[k][1], force)])
    for k, link in reversed(list(enumerate(truth.kinematics.tree.links))):
        if link.parent >= 0:
            force, moment = held[k][:3], held[k][3:]
            about = moment + skew(poses[k][1] - poses[link.parent][1]) @ force
            held[link.parent] = held[link.parent] + np.concatenate([force, about])
    return np.array([np.concatenate([R.T @ held[k][:3], R.T @ held[k][3:]]) for k, (R, _) in enumerate(poses)])


def driven(reading: TruthOf) -> TruthOf:
    """A reading of sensors at the accelerations that the forces make."""
    return lambda truth, s: reading(truth, s._replace(a=truth.FD(s.q, s.v, s.tau)))


def from_rest(truth: Truth, s: Point) -> Exact:
    """`joint_wrenches` (L, 6) at rest, at the accelerations that the forces make."""
    return driven(joint_wrenches)(truth, s._replace(v=0 * s.v))


def solid_inertia(truth: Truth, s: Point) -> Exact:
    """Mass, mass centre, moments about it (10) of the only link, along the world's axes."""
    (link,), ((R, p),) = truth.tree.links, truth.kinematics.poses(s.q)
    stated = R @ exact(link.inertia) @ R.T
    moments = [stated[place] for place in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    return np.array([exact(link.mass)[()], *(p + R @ exact(link.com)), *moments])


def held_at_rest(truth: Truth, s: Point) -> Exact:
    """Wrench (force; moment) of the only link's joint on it at rest under tau, at its mass centre, along world axes."""
    still = 0 * s.v
    a = truth.FD(s.q, still, s.tau)
    return truth.wrenches(truth.motions(s.q, still, a), truth.kinematics.poses(s.q), list(truth.inertias))[0]


def held_distance(truth: Truth, s: Point) -> Exact:
    """The distance |q| + 1/2, brought within the limits of the only joint."""
    ((least, greatest),) = truth.own.ranges
    return np.array([min(max(abs(s.q[0]) + Decimal("0.5"), least), greatest)])


def subtree_momenta(truth: Truth, s: Point) -> Exact:
    """Momentum (linear; angular, about its mass centre) of each link with all it carries, along world axes (L, 6)."""
    poses, velocity = truth.kinematics.poses(s.q), truth.kinematics.jacobians(s.q) @ s.v
    # Of each subtree: mass, first moment about the world's origin, momentum about it.
    sums = []
    for inertia, (R, p), twist in zip(truth.inertias, poses, velocity, strict=True):
        momentum = inertia.turned(R).matrix() @ twist
        about = np.concatenate([momentum[:3], momentum[3:] + skew(p) @ momentum[:3]])
        sums.append(np.concatenate([[inertia.mass], inertia.mass * p + R @ inertia.first, about]))
    for k, link in reversed(list(enumerate(truth.tree.links))):
        if link.parent >= 0:
            sums[link.parent] = sums[link.parent] + sums[k]
    return np.array([np.concatenate([x[4:7], x[7:] - skew(x[1:4]) @ x[4:7] / (x[0] or 1)]) for x in sums])


def turned(truth: Truth, q: Exact, local: Exact) -> Exact:
    """Spatial vectors (L, 6, ...) along the links' axes, turned into the world's."""
    return np.array(
        [
            np.concatenate([R @ own[:3], R @ own[3:]])
            for (R, _), own in zip(truth.kinematics.poses(q), local, strict=True)
        ],
        dtype=object,
    )


def at_origins(truth: Truth, q: Exact, world: Exact) -> Exact:
    """Spatial vectors (L, 6, ...) at the world's origin, taken at the links' origins."""
    return np.array(
        [
            np.concatenate([own[:3] - skew(p) @ own[3:], own[3:]])
            for (_, p), own in zip(truth.kinematics.poses(q), world, strict=True)
        ],
        dtype=object,
    )


def velocity_dq(frame: Frame) -> TruthOf:
    """Derivatives of the links' velocities by the configuration (L, 6, nv); "aligned" is "world" at the links' origins.

    That is Pinocchio's convention: it says in which frame derivatives are expressed, not of what components.
    """

    def function(truth: Truth, s: Point) -> Exact:
        own: Frame = "world" if frame == "aligned" else frame
        result = truth.kinematics.tangent(lambda q: velocities(truth, q, s.v, own), s.q)
        return at_origins(truth, s.q, result) if frame == "aligned" else result

    return function


def acceleration_dq(frame: Frame) -> TruthOf:
    """Derivatives of the links' spatial accelerations by the configuration (L, 6, nv)."""

    def function(truth: Truth, s: Point) -> Exact:
        own: Frame = "world" if frame == "aligned" else frame
        result = truth.kinematics.tangent(lambda q: accelerations(truth, q, s.v, s.a, own), s.q)
        return at_origins(truth, s.q, result) if frame == "aligned" else result

    return function


def acceleration_dv(frame: Frame) -> TruthOf:
    """Derivatives of the links' spatial accelerations by the speeds (L, 6, nv)."""

    def function(truth: Truth, s: Point) -> Exact:
        own: Frame = "world" if frame == "aligned" else frame
        result = truth.along_speeds(lambda v: accelerations(truth, s.q, v, s.a, own), s.v)
        return at_origins(truth, s.q, result) if frame == "aligned" else result

    return function


def jacobian_dq(frame: Frame) -> TruthOf:
    """Derivatives of the Jacobians by the configuration (L, 6, nv, nv), the last index that of the derivative."""
    return lambda truth, s: truth.kinematics.tangent(lambda q: jacobians(truth, q, frame), s.q)


def com(truth: Truth, q: Exact) -> Exact:
    """Mass centre of the tree (3)."""
    poses = truth.kinematics.poses(q)
    moment = sum(i.mass * p + R @ i.first for i, (R, p) in zip(truth.inertias, poses, strict=True))
    return moment / sum(i.mass for i in truth.inertias)


def com_jacobian(truth: Truth, q: Exact) -> Exact:
    """Jacobian of the mass centre (3, nv): the momentum's, for a unit of mass."""
    poses, jacobians_ = truth.kinematics.poses(q), truth.kinematics.jacobians(q)
    momentum = sum(i.turned(R).matrix()[:3] @ J for i, (R, _), J in zip(truth.inertias, poses, jacobians_, strict=True))
    return momentum / sum(i.mass for i in truth.inertias)


def centroidal_matrix(truth: Truth, q: Exact) -> Exact:
    """A (6, nv): momentum of the tree about its mass centre, along world axes, linear and angular, is A v."""
    centre = com(truth, q)
    total = zeros(6, truth.nv)
    for inertia, (R, p), J in zip(
        truth.inertias, truth.kinematics.poses(q), truth.kinematics.jacobians(q), strict=True
    ):
        momentum = inertia.turned(R).matrix() @ J
        total = total + np.concatenate([momentum[:3], momentum[3:] + skew(p - centre) @ momentum[:3]])
    return total


def centroidal_rate(truth: Truth, q: Exact, v: Exact) -> Exact:
    """dA/dt (6, nv)."""
    return truth.kinematics.along(lambda point: centroidal_matrix(truth, point), q, v)


def momentum_rate(truth: Truth, q: Exact, v: Exact, a: Exact) -> Exact:
    """Rate of the momentum about the mass centre (6)."""
    return centroidal_matrix(truth, q) @ a + centroidal_rate(truth, q, v) @ v


def unit_inertias() -> list[Inertia]:
    """Inertias whose multiples make any: mass, first moments, and Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the origin."""
    zero, one = Decimal(0), Decimal(1)
    result = [Inertia(one, zeros(3), zeros(3, 3))]
    result += [Inertia(zero, axis, zeros(3, 3)) for axis in eye(3)]
    for i, j in ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)):
        second = zeros(3, 3)
        second[i, j] = second[j, i] = one
        result.append(Inertia(zero, zeros(3), second))
    return result


def each_parameter(truth: Truth, function: Callable[[list[Inertia | None]], Exact]) -> Exact:
    """Values of a function that is linear in inertias, for each parameter of each link, along a new last axis."""
    count = len(truth.inertias)
    columns = []
    for k in range(count):
        for inertia in unit_inertias():
            chosen: list[Inertia | None] = [None] * count
            chosen[k] = inertia
            columns.append(function(chosen))
    return stack(columns)


def torque_regressor(truth: Truth, s: Point) -> Exact:
    """Y (nv, 10 L): M a + h = Y parameters."""
    motions, poses = truth.motions(s.q, s.v, s.a), truth.kinematics.poses(s.q)
    return each_parameter(truth, lambda inertias: truth.forces(motions, poses, inertias))


def kinetic_regressor(truth: Truth, s: Point) -> Exact:
    """Y (10 L): the kinetic energy is Y parameters."""
    velocity = truth.kinematics.jacobians(s.q) @ s.v
    poses = truth.kinematics.poses(s.q)

    def energy(inertias: list[Inertia | None]) -> Exact:
        return sum(
            u @ inertia.turned(R).matrix() @ u / 2
            for u, inertia, (R, _) in zip(velocity, inertias, poses, strict=True)
            if inertia is not None
        )

    return each_parameter(truth, energy)


def potential_regressor(truth: Truth, s: Point) -> Exact:
    """Y (10 L): the potential energy is Y parameters."""
    poses = truth.kinematics.poses(s.q)

    def energy(inertias: list[Inertia | None]) -> Exact:
        return -sum(
            truth.gravity_vector @ (inertia.mass * p + R @ inertia.first)
            for inertia, (R, p) in zip(inertias, poses, strict=True)
            if inertia is not None
        )

    return each_parameter(truth, energy)


def mass_matrix_rate(truth: Truth, s: Point) -> Exact:
    """dM/dt (nv, nv)."""
    return truth.kinematics.along(truth.M, s.q, s.v)
