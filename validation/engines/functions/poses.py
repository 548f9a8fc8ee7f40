"""Placements, screws, lines and planes, a body's spatial inertia: what packages offer beside rotations."""

from __future__ import annotations

from ..truth.geometry import lines, poses, solutions
from .function import Function, functions_of


def _placements() -> dict[str, Function]:
    """X = (R, a) of the coordinates q, Y = (Q, tau) of q2; position and rows of the rotation each (12)."""
    rows = {
        "pose_composed": ("X Y (12)", poses.composed),
        "pose_unset": ("a placement as it is before anybody sets it: zeros and rows of 1 (12)", poses.unset),
        "pose_drawn": ("position of a random placement within bounds of no width about v (3)", poses.drawn),
        "pose_aligned": (
            "X of points and their places under it, by least squares, however each counts (12)",
            poses.aligned,
        ),
        "pose_inverse": ("X^-1 (12)", poses.inverse),
        "pose_relative": ("X^-1 Y (12)", poses.relative),
        "pose_of_point": ("the point v of X, in the frame that X is in (3)", poses.placed),
        "pose_logarithm": ("twist (linear; angular) that leads to X in unit time (6)", poses.logarithm),
        "pose_difference": ("twist that leads from X to Y, along the axes of X (6)", poses.difference),
        "pose_exponential": ("where the twist (v; v2) leads in unit time (12)", poses.exponential),
        "pose_halfway": ("a quarter of the way from X to Y, along the screw (12)", poses.between),
        "pose_halfway_apart": (
            "a quarter of the way from X to Y: positions along a line, rotations the shorter way (12)",
            poses.between_apart,
        ),
        "pose_exponential_speeds": (
            "J: the twist of exp x in its own frame is J x', at x = (v; v2) (6, 6)",
            poses.exponential_speeds,
        ),
        "pose_logarithm_rates": (
            "J: the rates of the twist that leads to X are J times the twist of X in its own frame (6, 6)",
            poses.logarithm_rates,
        ),
        "wrench_transform": (
            "(6, 6): wrenches (force; moment) of a frame at X in the frame it is in",
            poses.wrench_transform,
        ),
        "twist_transform_back": ("(6, 6): twists of the frame that X is in, in X", poses.twist_transform_back),
        "twist_cross": ("(6, 6): product of the twist (v; v2) with twists", poses.twist_cross),
    }
    return functions_of(rows, "turns")


def _parameters() -> dict[str, Function]:
    """Parameters of rotations, and matrices that are none."""
    rows = {
        "quaternion_rates": (
            "rates of the quaternion (4) at angular velocity v along the turned axes",
            poses.quaternion_rates,
        ),
        "quaternion_rates_fixed": ("the same with v along the axes before", poses.quaternion_rates_fixed),
        "rotation_of_rpy": ("rows of Rz(v[2]) Ry(v[1]) Rx(v[0]) (9)", poses.of_rpy),
        "rotation_matrix_rate_of_rpy": ("their rates as v changes by a (9)", poses.rate_of_rpy),
        "rotation_to_rpy": ("roll, pitch, yaw of R = Rz Ry Rx, the pitch within a quarter turn (3)", poses.to_rpy),
        "rotation_of_zyz": ("rows of Rz(v[0]) Ry(v[1]) Rz(v[2]) (9)", poses.of_zyz),
        "rotations_of_three_angles": (
            "rows of the turns by v about successive axes, for twelve sequences of these (12, 9)",
            poses.of_three_angles,
        ),
        "rotations_on_end": (
            "rows of Rz(v[2]) Ry(p) Rx(v[0]), p a quarter turn up and down, once they are angles (2, 9)",
            poses.on_end,
        ),
        "rotation_of_z": ("rows of the shortest turn of z along v + (4, -8, 8) (9)", poses.of_z),
        "rotation_of_z_back": (
            f"rows of the shortest turn of z along v / 64 + {poses.BACK} (9)",
            poses.of_z_back,
        ),
        "zyz_speeds": ("B: w = B x' along the axes before, of these angles x = v (3, 3)", poses.zyz_speeds),
        "are_rotations": (
            "1, 0, 0: whether R, R with a column turned round, 1.25 R are rotations",
            poses.are_rotations,
        ),
        "rotation_of_two_axes": (
            "rows of the rotation with its third axis along v + (4, -8, 8), its second in the half plane of that and"
            " v2 + (8, 4, 4) (9)",
            poses.of_two_axes,
        ),
    }
    return functions_of(rows, "turns")


def _lines() -> dict[str, Function]:
    """The line through a along v + (4, -8, 8), the one through tau along v2 + (8, 4, 4); moments are x cross d."""
    rows = {
        "line": ("moment and unit direction of the first line (6)", lines.line),
        "line_placed": ("the same of that line, given in Y, in the frame that Y is in (6)", lines.line_placed),
        "line_nearest": ("its point nearest to tau (3)", lines.line_nearest),
        "line_nearest_to_origin": ("its point nearest to the origin (3)", lines.line_nearest_to_origin),
        "lines_apart": ("distance of the two lines (1)", lines.lines_apart),
        "lines_perpendicular": (
            "moment and unit direction of the line at right angles through both (6)",
            lines.common_perpendicular,
        ),
        "line_of_plane": ("its point in the plane through tau, normal to v2 + (8, -4, 4) (3)", lines.line_of_plane),
        "line_of_planes": (
            "moment, unit direction of the line of the planes through a, tau, normal to (4, -8, 8), (8, 4, 4) (6)",
            lines.line_of_planes,
        ),
        "planes_meet": ("the point of these and the one through v2 normal to (8, -4, 4) (3)", lines.planes_meet),
        "plane_of_points": (
            "distance of the origin from the plane of the first line and tau (1)",
            lines.plane_of_points,
        ),
        "plane_of_lines": (
            "distance of the origin from the plane of the first line that is parallel to the second (1)",
            lines.plane_of_lines,
        ),
        "screw_pitch": ("advance for a radian of the twist (a; v + (4, -8, 8)) (1)", lines.screw_pitch),
        "screw_unit": ("the twist (a; v + (4, -8, 8)) for a radian (6)", lines.screw_unit),
        "screw_unit_sliding": ("the twist (v + (4, -8, 8); 0) for a metre (6)", lines.screw_unit_sliding),
        "screw_line": ("moment and unit direction of the line that it turns about (6)", lines.screw_line),
        "screw_pole": ("the point of that line nearest to the origin (3)", lines.screw_pole),
        "screw_of_line": ("twist of unit angular part about the first line, of pitch 3/8 (6)", lines.screw_of_line),
    }
    return functions_of(rows, "turns")


def _inertias() -> dict[str, Function]:
    """A body of 2 kg, and what its momentum is for twists (linear; angular) at the frame's origin."""
    rows = {
        "spatial_inertia": ("matrix of the momentum (6, 6)", poses.inertia_matrix),
        "spatial_inertia_placed": (
            "the same of the body, given in X, in the frame X is in (6, 6)",
            poses.inertia_placed,
        ),
        "spatial_inertia_sum": ("the same of that body and the one at X (6, 6)", poses.inertia_sum),
        "spatial_momentum": ("its momentum for the twist (v; v2) (6)", poses.momentum),
        "spatial_momentum_cross": ("the twist's product with it (6)", poses.momentum_cross),
        "spatial_inertia_rate": ("rate of its matrix as it moves with the twist (6, 6)", poses.inertia_rate),
    }
    return functions_of(rows, "turns")


def _solutions() -> dict[str, Function]:
    """Functions of A = B B^T + 1, B of the rows v, a, v2, and tau."""
    rows = {
        "solution": ("x of A x = tau (3)", solutions.unbounded),
        "solution_in_a_box": (
            f"the same where x^T A x / 2 - tau^T x is least, |x| <= {solutions.BOX} (3)",
            solutions.bounded,
        ),
    }
    return functions_of(rows, "turns")


POSES = _placements() | _parameters() | _lines() | _inertias() | _solutions()
