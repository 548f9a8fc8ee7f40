"""What engines are asked for: one row a function, with its truth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from validation.engines.arithmetic import Exact
from validation.engines.truth import Point, Truth


@dataclass(frozen=True)
class Function:
    """One function of a tree and a state.

    Attributes:
        text: What it is, with shape and conventions.
        truth: Its value in many digits.
    """

    text: str
    truth: Callable[[Truth, Point], Exact]


FUNCTIONS: dict[str, Function] = {
    "mass_matrix": Function("M (nv, nv)", lambda t, s: t.M(s.q)),
    "bias": Function("h (nv): Coriolis, centrifugal and gravity forces", lambda t, s: t.h(s.q, s.v)),
    "gravity": Function("g (nv): gravity forces", lambda t, s: t.g(s.q)),
    "inverse_dynamics": Function("M a + h (nv)", lambda t, s: t.ID(s.q, s.v, s.a)),
    "forward_dynamics": Function("M^-1 (tau - h) (nv)", lambda t, s: t.FD(s.q, s.v, s.tau)),
    "kinetic_energy": Function("v^T M v / 2", lambda t, s: t.T(s.q, s.v)),
    "potential_energy": Function("-sum m g^T p", lambda t, s: t.V(s.q)),
    "mass_matrix_inverse": Function("M^-1 (nv, nv)", lambda t, s: t.inverse(s.q)),
    "coriolis_forces": Function("h - g (nv): Coriolis and centrifugal forces", lambda t, s: t.h(s.q, s.v) - t.g(s.q)),
    "link_poses": Function(
        "position of each link's origin and rows of its rotation (L, 12)", lambda t, s: t.kinematics.flat_poses(s.q)
    ),
    "link_jacobians": Function(
        "Jacobians of the links' origins, linear, then angular, along world axes (L, 6, nv)",
        lambda t, s: t.kinematics.jacobians(s.q),
    ),
    "link_jacobian_rates": Function(
        "time derivatives of link_jacobians (L, 6, nv)",
        lambda t, s: t.kinematics.along(t.kinematics.jacobians, s.q, s.v),
    ),
    "link_velocities": Function("link_jacobians v (L, 6)", lambda t, s: t.motions(s.q, s.v, s.a)[1]),
    "link_accelerations": Function(
        "time derivatives of link_velocities (L, 6)", lambda t, s: t.motions(s.q, s.v, s.a)[2]
    ),
    "link_velocity_products": Function(
        "link_accelerations at a = 0 (L, 6)", lambda t, s: t.motions(s.q, s.v, 0 * s.a)[2]
    ),
    "mass_centre": Function("mass centre of the tree, in the world (3)", lambda t, s: t.centre(s.q)),
    "mass_centre_jacobian": Function("Jacobian of mass_centre (3, nv)", lambda t, s: t.centre_jacobian(s.q)),
    "mass_centre_velocity_products": Function(
        "acceleration of mass_centre at a = 0 (3)", lambda t, s: t.kinematics.along(t.centre_jacobian, s.q, s.v) @ s.v
    ),
    "centroidal_matrix": Function(
        "map from v to the momentum about mass_centre along world axes, linear, then angular (6, nv)",
        lambda t, s: t.centroidal(s.q),
    ),
    "centroidal_momentum": Function("centroidal_matrix v (6)", lambda t, s: t.centroidal(s.q) @ s.v),
}
