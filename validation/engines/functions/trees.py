"""Functions of trees: dynamics, energies, mass centre, links in three frames, steps on configurations."""

from __future__ import annotations

from decimal import Decimal

import numpy as np

from ..truth import derived, displacements, sensed
from ..truth.arithmetic import Exact
from ..truth.derived import FRAMES, Frame
from ..truth.dynamics import Point, Truth
from .function import Function


def _momentum(t: Truth, s: Point) -> Exact:
    return derived.centroidal_matrix(t, s.q) @ s.v


TREES: dict[str, Function] = {
    "sizes": Function("lengths of q and v (2)", lambda t, s: np.array([Decimal(len(s.q)), Decimal(len(s.v))])),
    "coordinates": Function("q, v (nq + nv)", lambda t, s: np.concatenate([s.q, s.v])),
    "mass_matrix": Function("M (nv, nv)", lambda t, s: t.M(s.q)),
    "mass_matrix_inverse": Function("M^-1 (nv, nv)", lambda t, s: t.inverse(s.q)),
    "bias": Function("h (nv): Coriolis, centrifugal and gravity forces", lambda t, s: t.h(s.q, s.v)),
    "gravity": Function("g (nv): gravity forces", lambda t, s: t.g(s.q)),
    "coriolis_forces": Function("C v = h - g (nv), C the Coriolis matrix", lambda t, s: t.h(s.q, s.v) - t.g(s.q)),
    "coriolis_symmetry": Function("C + C^T = dM/dt (nv, nv)", derived.mass_matrix_rate),
    "inverse_dynamics": Function("M a + h (nv)", lambda t, s: t.ID(s.q, s.v, s.a)),
    "joint_wrenches": Function(
        "wrench that the joint exerts on each link, at its origin along its axes (L, 6)", derived.joint_wrenches
    ),
    "joint_wrenches_driven": Function(
        "joint_wrenches at the accelerations that tau makes (L, 6)", derived.driven(derived.joint_wrenches)
    ),
    "joint_wrenches_from_rest": Function(
        "joint_wrenches at rest, at the accelerations that tau makes (L, 6)", derived.from_rest
    ),
    "subtree_momenta": Function(
        "momentum of each link's subtree, about its mass centre (L, 6)", derived.subtree_momenta
    ),
    "forward_dynamics": Function("M^-1 (tau - h) (nv)", lambda t, s: t.FD(s.q, s.v, s.tau)),
    "kinetic_energy": Function("T = v^T M v / 2", lambda t, s: t.T(s.q, s.v)),
    "potential_energy": Function("V = -sum m g^T p, and what springs store", lambda t, s: t.V(s.q)),
    "link_poses": Function("positions and rows of R (L, 12)", lambda t, s: t.kinematics.flat_poses(s.q)),
    "link_poses_seen": Function("link_poses in the first link's frame (L, 12)", sensed.poses_seen),
    "link_velocities_seen": Function(
        "rates of positions in the first link's frame, angular velocities against it, along it (L, 6)",
        sensed.velocities_seen,
    ),
    "mass_centre": Function("mass centre (3)", lambda t, s: derived.com(t, s.q)),
    "mass_centre_jacobian": Function("its Jacobian (3, nv)", lambda t, s: derived.com_jacobian(t, s.q)),
    "mass_centre_velocity_dq": Function(
        "derivative of its velocity by q (3, nv)",
        lambda t, s: t.kinematics.tangent(lambda q: derived.com_jacobian(t, q) @ s.v, s.q),
    ),
    "link_accelerations": Function(
        "acceleration of the links' origins and angular accelerations, along world axes (L, 6)",
        lambda t, s: derived.classical(t, s.q, s.v, s.a),
    ),
    "link_velocity_products": Function(
        "link_accelerations at a = 0 (L, 6)", lambda t, s: derived.classical(t, s.q, s.v, 0 * s.a)
    ),
    "mass_centre_velocity_products": Function(
        "acceleration of the mass centre at a = 0 (3)",
        lambda t, s: t.kinematics.along(lambda q: derived.com_jacobian(t, q), s.q, s.v) @ s.v,
    ),
    "centroidal_matrix": Function(
        "A (6, nv): momentum about the mass centre is A v", lambda t, s: derived.centroidal_matrix(t, s.q)
    ),
    "centroidal_matrix_rate": Function("dA/dt (6, nv)", lambda t, s: derived.centroidal_rate(t, s.q, s.v)),
    "centroidal_momentum": Function("A v (6)", _momentum),
    "centroidal_momentum_rate": Function("d(A v)/dt (6)", lambda t, s: derived.momentum_rate(t, s.q, s.v, s.a)),
    "centroidal_momentum_dq": Function(
        "derivative of A v by q (6, nv)",
        lambda t, s: t.kinematics.tangent(lambda q: derived.centroidal_matrix(t, q) @ s.v, s.q),
    ),
    "centroidal_momentum_rate_dq": Function(
        "derivative of d(A v)/dt by q (6, nv)",
        lambda t, s: t.kinematics.tangent(lambda q: derived.momentum_rate(t, q, s.v, s.a), s.q),
    ),
    "centroidal_momentum_rate_dv": Function(
        "derivative of d(A v)/dt by v (6, nv)",
        lambda t, s: t.along_speeds(lambda v: derived.momentum_rate(t, s.q, v, s.a), s.v),
    ),
    "inverse_dynamics_dq": Function(
        "derivative of M a + h by q (nv, nv)", lambda t, s: t.kinematics.tangent(lambda q: t.ID(q, s.v, s.a), s.q)
    ),
    "inverse_dynamics_dv": Function(
        "derivative of M a + h by v (nv, nv)", lambda t, s: t.along_speeds(lambda v: t.h(s.q, v), s.v)
    ),
    "mass_matrix_dq": Function(
        "derivative of M by q (nv, nv, nv), the last index that of the derivative",
        lambda t, s: t.kinematics.tangent(t.M, s.q),
    ),
    "link_poses_dq": Function(
        "derivative of link_poses by q (L, 12, nv)", lambda t, s: t.kinematics.tangent(t.kinematics.flat_poses, s.q)
    ),
    "gravity_dq": Function("derivative of g by q (nv, nv)", lambda t, s: t.kinematics.tangent(t.g, s.q)),
    "forward_dynamics_dq": Function(
        "derivative of forward dynamics by q (nv, nv)",
        lambda t, s: t.kinematics.tangent(lambda q: t.FD(q, s.v, s.tau), s.q),
    ),
    "forward_dynamics_dv": Function(
        "derivative of forward dynamics by v (nv, nv)",
        lambda t, s: t.along_speeds(lambda v: t.FD(s.q, v, s.tau), s.v),
    ),
    "torque_regressor": Function(
        "Y (nv, 10 L): M a + h = Y (m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the origin)", derived.torque_regressor
    ),
    "kinetic_energy_regressor": Function("Y (10 L): T = Y parameters", derived.kinetic_regressor),
    "potential_energy_regressor": Function("Y (10 L): V = Y parameters", derived.potential_regressor),
    "integrate": Function(
        "where q' = N(q) v2 leads in unit time (nq)", lambda t, s: displacements.integrated(t, s.q, s.v2)
    ),
    "difference": Function("v2, of q and where v2 leads from it (nv)", lambda t, s: np.array(s.v2)),
    "interpolate": Function(
        "a quarter of the way from q to where v2 leads (nq)", lambda t, s: displacements.integrated(t, s.q, s.v2 / 4)
    ),
    "difference_dq": Function(
        "derivative of difference by its first configuration (nv, nv)", displacements.difference_dq
    ),
    "difference_dq2": Function("derivative of difference by its second (nv, nv)", displacements.difference_dq2),
    "integrate_dq": Function("derivative of integrate by q (nv, nv)", displacements.integrated_dq),
    "integrate_dv": Function("derivative of integrate by v2 (nv, nv)", displacements.integrated_dv),
}


ALIGNED = ("link_jacobians", "link_jacobian_rates", "link_velocities")


def _in_frame(frame: Frame) -> dict[str, Function]:
    """Functions of links in one of three frames."""
    names = ALIGNED if frame == "aligned" else (f"jacobian_{frame}", f"jacobian_rate_{frame}", f"velocity_{frame}")
    return {
        names[0]: Function("Jacobians of the links (L, 6, nv)", lambda t, s: derived.jacobians(t, s.q, frame)),
        names[1]: Function(
            "their time derivatives (L, 6, nv)", lambda t, s: derived.jacobian_rates(t, s.q, s.v, frame)
        ),
        names[2]: Function(
            "spatial velocities of the links (L, 6)", lambda t, s: derived.velocities(t, s.q, s.v, frame)
        ),
        f"jacobian_dq_{frame}": Function("their derivatives by q (L, 6, nv, nv)", derived.jacobian_dq(frame)),
        f"acceleration_{frame}": Function(
            "spatial accelerations (L, 6)", lambda t, s: derived.accelerations(t, s.q, s.v, s.a, frame)
        ),
        f"velocity_dq_{frame}": Function("derivative of the velocities by q (L, 6, nv)", derived.velocity_dq(frame)),
        f"acceleration_dq_{frame}": Function(
            "derivative of the accelerations by q (L, 6, nv)", derived.acceleration_dq(frame)
        ),
        f"acceleration_dv_{frame}": Function(
            "derivative of the accelerations by v (L, 6, nv)", derived.acceleration_dv(frame)
        ),
    }


for _frame in FRAMES:
    TREES |= _in_frame(_frame)
