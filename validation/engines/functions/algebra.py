"""Spatial algebra beside trees: twists with wrenches, parameters of inertias, derivatives on groups of placements."""

from __future__ import annotations

from ..truth.geometry import algebra, poses
from .function import functions_of

_BODY = "of the body of 2 kg"
_LOG = "by the logarithmic Cholesky parameters x / (1 + x^2), x = (v, a, tau, v2[0])"
ALGEBRA = functions_of(
    {
        "wrench_cross": ("(6, 6): product of the twist (v; v2) with wrenches", algebra.wrench_cross),
        "wrench_transform_back": (
            "(6, 6): wrenches of the frame that X is in, in X",
            algebra.wrench_transform_back,
        ),
        "power": ("of the wrench (a; tau) at the twist (v; v2) (1)", algebra.power),
        "body_energy": (f"kinetic energy {_BODY} at the twist (v; v2) (1)", algebra.body_energy),
        "inertia_parameters": (
            f"m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the origin {_BODY} (10)",
            algebra.inertia_parameters,
        ),
        "pseudo_inertia": (f"[[tr(I) / 2 - I, m c], [m c^T, m]] {_BODY} (4, 4)", algebra.pseudo_inertia),
        "spatial_inertia_inverse": (f"inverse of the matrix of the momentum {_BODY} (6, 6)", algebra.inertia_inverse),
        "logarithmic_inertia": (f"matrix of the momentum {_LOG} (6, 6)", algebra.logarithmic_matrix),
        "logarithmic_parameters": (f"the ten parameters {_LOG} (10)", algebra.logarithmic_parameters),
        "logarithmic_derivatives": (f"derivatives of these {_LOG} (10, 10)", algebra.logarithmic_derivatives),
        "moments_product": (f"S v of the moments S about the mass centre {_BODY} (3)", algebra.moments_product),
        "moments_along": ("v^T S v (1)", algebra.moments_along),
        "moments_rotated": ("R S R^T (3, 3)", algebra.moments_turned),
        "cross_matrix": ("[v x] (3, 3)", algebra.cross_matrix),
        "cross_matrices": ("[v x] [a x] (3, 3)", algebra.cross_matrices),
        "turned_vector": ("R v (3)", algebra.turned_vector),
        "rotation_inverse": ("rows of R^T (9)", algebra.turned_back),
        "rotation_vector_rates_along": (
            "rate of A^-1 at the rotation vector of R, as R turns with v along the turned axes (3, 3)",
            algebra.vector_rates_along,
        ),
        "rpy_rates_turned": (
            "roll, pitch, yaw rates = B w, w along the turned axes, at angles v (3, 3)",
            algebra.rpy_rates_turned,
        ),
        "rpy_rates_turned_rate": (
            "time derivative of this B at angles v and rates a (3, 3)",
            algebra.rpy_rates_turned_rate,
        ),
        "spatial_momentum_cross_dv": (
            f"derivative of the twist's product with the momentum {_BODY} by the twist (v; v2) (6, 6)",
            algebra.momentum_cross_dv,
        ),
        "momentum_regressor": (
            "Y (6, 10): the momentum at the twist (v; v2) is Y times the ten parameters",
            algebra.momentum_regressor,
        ),
        "momentum_rate_regressor": (
            "Y (6, 10): its rate at the twist (v; v2), as that changes by (a; tau), is Y times them",
            algebra.momentum_rate_regressor,
        ),
        "pose_by_denavit": (
            "Rz(theta) Tz(d) Tx(l) Rx(alpha) of (l, alpha, d) = v, theta = a[0] (12)",
            algebra.by_denavit,
        ),
        "pose_by_modified_denavit": ("Rx(alpha) Tx(l) Rz(theta) Tz(d) of these (12)", algebra.by_modified_denavit),
        "turn_about_line": (
            "turn by tau[0] about the line through a along v + (4, -8, 8) (12)",
            algebra.turn_about_line,
        ),
        "twist_about_line": ("twist of unit angular part about it (6)", algebra.twist_about_line),
        "rotation_difference": ("rotation vector of R^T Q (3)", algebra.turn_difference),
        "rotation_squared_distance": ("square of its length (1)", algebra.squared(algebra.turn_difference)),
        "rotation_difference_dq": ("its derivative by turns of R (3, 3)", algebra.turn_difference_dq(0)),
        "rotation_difference_dq2": ("its derivative by turns of Q (3, 3)", algebra.turn_difference_dq(1)),
        "rotation_integrated": ("rows of R exp v (9)", algebra.turn_integrated),
        "rotation_integrated_dq": ("its turn for one of R, each along its own axes (3, 3)", algebra.turn_integrated_dq),
        "pose_squared_distance": (
            "square of the length of the twist from X to Y (1)",
            algebra.squared(poses.difference),
        ),
        "pose_difference_dq": ("derivative of the twist from X to Y by twists of X (6, 6)", algebra.difference_dq(0)),
        "pose_difference_dq2": ("derivative of the same by twists of Y (6, 6)", algebra.difference_dq(1)),
        "pose_integrated": ("X exp (v; v2) (12)", algebra.integrated),
        "pose_integrated_dq": ("its twist for one of X, each in its own frame (6, 6)", algebra.integrated_dq),
    },
    "turns",
)
