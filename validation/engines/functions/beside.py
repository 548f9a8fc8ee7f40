"""What is asked beside trees: rotations, solids, flexible bodies, lone bodies, a bound pair."""

from __future__ import annotations

from decimal import Decimal

import numpy as np

from ..truth import constraints, derived, steps
from ..truth.arithmetic import root
from ..truth.geometry import poses, turns
from .function import Function, functions_of


def _of_turns() -> dict[str, Function]:
    """What packages offer of rotations: R of the coordinates q, Q of q2, vectors of rotation (`turns`)."""
    rows = {
        "rotation_matrix": ("rows of R (9)", turns.matrix),
        "rotation_composed": ("rows of R Q (9)", turns.composed),
        "rotation_angle": ("angle of R^T Q (1)", turns.angle),
        "rotation_cost": ("1 + 2 (1 - cos of the angle of R^T Q) (1)", turns.cost),
        "rotation_logarithm": ("rotation vector of R (3)", turns.logarithm),
        "rotation_exponential": ("rows of the rotation by the vector v (9)", turns.exponential),
        "rotation_exponential_of_turns": ("rows of the rotation by the vector 16 v (9)", turns.exponential_of_turns),
        "rotation_half_turn": (
            "rows of the half turn about u = v + (4, -8, 8), once its matrix is a quaternion (9)",
            turns.half_turn,
        ),
        "rotation_half_turns": (
            "rows of the half turns about axes of whole numbers to 2, once their matrices are quaternions (62, 9)",
            turns.half_turns,
        ),
        "rotation_vector_rates": ("A^-1 at r = tau, in the turned axes (3, 3)", turns.vector_rates),
        "rotation_vector_speeds": ("A at r = tau, in the turned axes (3, 3)", turns.vector_speeds),
        "rotation_vector_rates_fixed": ("A^-1 at r = v, along the axes before (3, 3)", turns.vector_rates_fixed),
        "rotation_vector_rates_rate": (
            "time derivative of the latter at r = tau, r' = a (3, 3)",
            turns.vector_rates_rate,
        ),
        "rpy_rates": ("roll, pitch, yaw rates = B w, w along the axes before, at angles v (3, 3)", turns.rpy_rates),
        "rpy_rates_rate": ("time derivative of B at angles v and rates a (3, 3)", turns.rpy_rates_rate),
        "rpy_second_rates": (
            "second rates of roll, pitch, yaw v, of rates a, at angular acceleration tau along the axes before (3)",
            turns.rpy_second_rates,
        ),
        "rotation_matrix_dq": (
            "derivative of the rows of R along the angular velocity in the turned axes (9, 3)",
            turns.along_speeds(lambda R: R.reshape(9)),
        ),
        "rotation_to_rpy_dq": (
            "derivative of roll, pitch, yaw of R along it (3, 3)",
            turns.along_speeds(poses.angles_of),
        ),
        "rotation_of_rpy_du": (
            "derivative of the rows of Rz(u[2]) Ry(u[1]) Rx(u[0]) by u = v + (4, -8, 8) (9, 3)",
            turns.by_vector(lambda u: poses.matrix_of(u).reshape(9)),
        ),
        "rotation_exponential_du": (
            "derivative of the rows of the rotation by u = v + (4, -8, 8) by u (9, 3)",
            turns.by_vector(lambda u: turns.turned_by(u).reshape(9)),
        ),
        "unit_vector_du": (
            "derivative of u / |u| by u = v + (4, -8, 8) (3, 3)",
            turns.by_vector(lambda u: u / root(u @ u)),
        ),
        "rotation_halfway": (
            "rows of the rotation a quarter of the way from R to Q, the shorter way (9)",
            turns.between,
        ),
        "twist_transform": (
            "(6, 6): twists (linear; angular) of a frame at (R, a) in the frame it is in",
            turns.adjoint,
        ),
    }
    return functions_of(rows, "turns")


TURNS = _of_turns()
LONE: dict[str, Function] = {
    "solid_inertia": Function(
        "mass, mass centre, moments about it xx, yy, zz, xy, xz, yz of the only link (10)",
        derived.solid_inertia,
        ("solids",),
    ),
    "solid_mass": Function("mass of the only link (1)", lambda t, s: derived.solid_inertia(t, s)[:1], ("solids",)),
    "flexible_relation": Function(
        "1 + what forces or steps of a flexible body change with the frame it stands in, as part of them (n)",
        lambda t, s: np.array([Decimal(1)]),
        ("flexible bodies",),
    ),
    "constraint_diagonal": Function(
        "diagonal of J M^-1 J^T (m)", lambda t, s: np.diag(constraints.delassus(t, s.q)), ("a lone body",)
    ),
    "step_of_wheel": Function(
        "q+, v+ (nq + nv): v+ = v + h M^-1 (tau - D v); q+ = q + h N(q) v+, of unit length where it is a quaternion",
        steps.single("nothing", steps.normalized),
        ("wheels",),
    ),
    "wheel_wrench": Function(
        "force and moment on the body of what holds it, along the world's axes, at rest under tau (6)",
        derived.held_at_rest,
        ("wheels",),
    ),
    "distance_after_step": Function(
        "distance (1) after a step at rest from |q| + 1/2: the nearest within the bounds",
        derived.held_distance,
        ("held distances",),
    ),
    "step_bound": Function(
        "v+ (nv) after a step from q, v2: M (v+ - v2) = h (tau - (bias)) + J^T impulse, J v+ = 0",
        constraints.after_step,
        ("a bound pair",),
    ),
}
