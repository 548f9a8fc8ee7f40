"""What is asked of arms: their end, which carries a tool, and what is seen from there."""

from __future__ import annotations

from ..truth import arms
from ..truth.points import POINT
from .function import Function, functions_of


def _arms() -> dict[str, Function]:
    """J is the end's Jacobian along the world's axes (6, nv), R_WE its rotation."""
    rows = {
        "end_pose": ("position and rows of R_WE (12)", arms.pose),
        "end_jacobian": ("J (6, nv)", arms.jacobian),
        "end_jacobian_local": ("along the axes of the end (6, nv)", arms.jacobian_local),
        "end_jacobian_rate": ("dJ/dt (6, nv)", arms.jacobian_rate),
        "end_jacobian_dq": ("derivatives of J by q (6, nv, nv)", arms.jacobian_dq),
        "end_jacobian_of_rpy": (
            "J with rates of roll, pitch, yaw in place of the angular velocity (6, nv)",
            arms.of_rpy,
        ),
        "manipulability": ("root of det(J J^T) (1)", arms.manipulability),
        "manipulability_dq": ("its derivatives (nv)", arms.manipulability_dq),
        "end_mass_matrix": ("K^-T M K^-1 (6, 6), K of end_jacobian_of_rpy", arms.mass_matrix),
        "end_gravity": ("K^-T g (6)", arms.gravity),
        "end_loads_local": (
            "what makes the wrench (force tau[:3], moment tau[3:]) that the last link before the tool exerts, at its"
            " origin, along its axes (nv)",
            arms.loads_local,
        ),
        "inertia_forces": ("M a (nv)", lambda t, s: t.M(s.q) @ s.a),
        "end_point_mass": (
            "gravity forces with a point of 2 kg at (0.25, -0.5, 0.125) of the last link (nv)",
            arms.burdened,
        ),
    }
    return functions_of(rows, "arms")


def _goals() -> dict[str, Function]:
    """What a solver of inverse kinematics reaches where it says that it has; it begins at q2 + tanh(v) / 4."""
    of = "of the last link at the solution, of the goal that it has"
    rows = {
        "goal_pose": (f"position and rows of the rotation {of} the pose at q2 (12)", arms.goal_pose),
        "goal_pose_far": (f"the same {of} the pose at 8 q2, begun as far (12)", arms.goal_pose_far),
        "goal_place": (f"position {of} the position at q2, turned any way (3)", arms.goal_place),
        "goal_turn": (f"rows of the rotation {of} the rotation at q2, anywhere (9)", arms.goal_turn),
        "goal_point": (f"place of the point {POINT} {of} its place at q2, turned any way (3)", arms.goal_point),
    }
    return functions_of(rows, "goals")


ARMS = _arms() | _goals()
