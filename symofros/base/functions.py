"""The functions of a model, one row a function: names, inputs, outputs and shapes are stated here and nowhere else.

`Options`, `Model`, the exports, the command line, the editor and the documentation read this table. To add a function:
a row here, and what its outputs name in `symofros/mechanics/dynamics/equations.py` (of frame functions:
`frame_equations.py` beside it).
"""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import get_args

from symofros.base.model_function import Group, cotangent_inputs, row_of, transposed
from symofros.base.model_function import ModelFunction as ModelFunction
from symofros.base.model_function import OutputArray as OutputArray
from symofros.base.model_function import size_of as size_of

# Input groups: their sizes, and what they hold.
INPUTS: dict[str, tuple[str, str]] = {
    "q": ("nq", "coordinates"),
    "v": ("nv", "speeds"),
    "a": ("nv", "rates of the speeds, v'"),
    "u": ("nu", "inputs: efforts, then prescribed motions with their speeds and rates"),
    "lam": ("nc", "constraint multipliers"),
    "gains": ("2 nc", "Baumgarte's alpha of each condition, then beta of each [1/s]"),
    "t": ("1", "time [s]"),
    "par": ("npar", "run-time parameters"),
    "step": ("nv", "step along the configuration manifold"),
    "dq": ("nv", "direction of the coordinates, along their manifold"),
    "dv": ("nv", "direction of the speeds"),
    "da": ("nv", "direction of the accelerations"),
}
_ROWS: tuple[ModelFunction, ...] = (
    row_of("mass_matrix", "q", "M (nv, nv)", "dynamics", "mass matrix M(q)", exported=True),
    row_of("bias", "q v", "h (nv)", "dynamics", "Coriolis, centrifugal and gravity terms h(q, v)", exported=True),
    row_of(
        "gravity_force",
        "q",
        "g (nv) = gravity_force",
        "dynamics",
        "g(q) = h(q, 0), what holds the weight at rest: the efforts of gravity compensation",
        exported=True,
    ),
    row_of("generalized_force", "q v u t", "Q (nv)", "dynamics", "applied and joint forces Q(q, v, u)", exported=True),
    row_of("dynamics", "q v u t", "M (nv, nv); h (nv); Q (nv)", "dynamics", "M, h and Q in one call", exported=True),
    row_of(
        "forward_dynamics",
        "q v u gains t",
        "a (nv); lam (nc); rank ()",
        "dynamics",
        "accelerations v'; under constraints their multipliers and the rank of G as well",
        exported=True,
        by_solver=True,
        unit="step",
    ),
    row_of(
        "inverse_dynamics",
        "q v a t",
        "tau (nv) = inverse_dynamics",
        "dynamics",
        "efforts that an acceleration takes, M a + h - Q(q, v, 0)",
        exported=True,
    ),
    row_of("kinetic_energy", "q v", "T ()", "dynamics", "kinetic energy [J]", exported=True, unit="energy"),
    row_of("potential_energy", "q t", "V ()", "dynamics", "potential energy [J]", exported=True, unit="energy"),
    row_of(
        "forward_dynamics_derivatives",
        "q v u t",
        "by_q (nv + nc, nv) = residual_by_q; by_v (nv + nc, nv) = residual_by_v; by_u (nv + nc, nu) = residual_by_u",
        "derivatives",
        "derivatives of the accelerations (and multipliers) by q, v and u",
        exported=True,
        by_solver=True,
    ),
    row_of(
        "implicit_terms",
        "q v a u lam t",
        "M (nv, nv); G (nc, nv); by_q (nv + nc, nv) = residual_by_q; by_v (nv + nc, nv) = residual_by_v; "
        "by_u (nv + nc, nu) = residual_by_u; rate_by_q (nc, nv) = constraint_rate_by_q",
        "stepping",
        "terms of an implicit step's linear system: docs/theory/simulation.md, section 3",
        exported=True,
    ),
    row_of("constraint", "q t", "phi (nc)", "constraints", "phi(q)", exported=True, unit="closing"),
    row_of(
        "constraint_rate",
        "q v t",
        "phi_rate (nc) = constraint_rate",
        "constraints",
        "G v - b: the rate of phi, and the residual of conditions on speeds",
        exported=True,
        unit="closing",
    ),
    row_of("constraint_jacobian", "q t", "G (nc, nv)", "constraints", "Jacobian G(q)", exported=True, unit="closing"),
    row_of("constraint_bias", "q v t", "gamma (nc)", "constraints", "gamma(q, v), which G v' equals", exported=True),
    row_of(
        "project",
        "q v u t",
        "q_on (nq); v_on (nv); residual (); rank (); energies (2); gap ()",
        "stepping",
        "nearest state on the constraints",
        exported=True,
        by_solver=True,
        unit="step",
    ),
    row_of(
        "closure_wrenches",
        "q lam t",
        "on_second (nw, 6) = wrenches_on_second; on_first (nw, 6) = wrenches_on_first",
        "constraints",
        "force and moment of each constraint on the frames that it joins",
    ),
    row_of(
        "joint_wrenches",
        "q v a u lam t",
        "wrench (nj, 6) = joint_wrenches",
        "dynamics",
        "force and moment that each joint transmits to its body",
    ),
    row_of(
        "section_forces",
        "q v a u lam t",
        "F (nf, 6) = section_forces",
        "dynamics",
        "force and moment inside elastic beams at their stations, N Vy Vz T My Mz in the axes of the section",
    ),
    row_of(
        "prescribed_efforts",
        "q v a u lam t",
        "effort (ns) = prescribed_efforts",
        "dynamics",
        "efforts of the drives of prescribed motions",
    ),
    row_of(
        "contact_forces",
        "q v t",
        "gap (nk) = contact_gaps; push (nk) = contact_pushes; force (nk, 3) = contact_forces; "
        "point (nk, 3) = contact_points; share (nk) = contact_shares",
        "dynamics",
        "distances of balls from the surfaces that they may touch, forces on them and where these act",
    ),
    row_of(
        "constraint_rate_derivative",
        "q v t",
        "by_q (nc, nv) = constraint_rate_by_q",
        "derivatives",
        "derivative of G v - b by q",
    ),
    row_of(
        "inverse_dynamics_derivatives",
        "q v a t",
        "dtau_dq (nv, nv) = inverse_dynamics_by_q; dtau_dv (nv, nv) = inverse_dynamics_by_v",
        "derivatives",
        "derivatives of inverse_dynamics by q and v",
    ),
    row_of(
        "inverse_dynamics_second_derivatives",
        "q v a t",
        "d2tau_dq2 (nv, nv nv); d2tau_dv2 (nv, nv nv); d2tau_dqdv (nv, nv nv); d2tau_dadq (nv, nv nv)",
        "derivatives",
        "second derivatives of inverse_dynamics; entry (i, j nv + k) is that of tau_i by the j-th, then the k-th",
        by_solver=True,
    ),
    row_of(
        "inverse_dynamics_hvp",
        "q v a t tau_bar dq dv da",
        "by_q (nv); by_v (nv); by_a (nv)",
        "derivatives",
        "Hessian-vector product: change of the derivatives of tau_bar . inverse_dynamics along (dq, dv, da)",
        by_solver=True,
    ),
    row_of(
        "inverse_dynamics_hessian",
        "q v a t tau_bar",
        "H (3 nv + npar, 3 nv + npar)",
        "derivatives",
        "second derivatives of tau_bar . inverse_dynamics by (q, v, a, par)",
        by_solver=True,
    ),
    row_of(
        "inverse_dynamics_by_par",
        "q v a t",
        "dtau_dpar (nv, npar) = inverse_dynamics_by_par",
        "derivatives",
        "derivative of inverse_dynamics by the run-time parameters",
    ),
    row_of(
        "forward_dynamics_by_par",
        "q v u t",
        "by_par (nv + nc, npar) = residual_by_par",
        "derivatives",
        "derivative of the accelerations (and multipliers) by the run-time parameters",
        by_solver=True,
    ),
    row_of(
        "forward_dynamics_hessian",
        "q v u t a_bar lam_bar",
        "H (2 nv + nu + npar, 2 nv + nu + npar)",
        "derivatives",
        "second derivatives of a_bar . v' + lam_bar . lam by (q, v, u, par)",
        by_solver=True,
    ),
    row_of(
        "residual_derivatives",
        "q v a u lam t",
        "by_q (nv + nc, nv) = residual_by_q; by_v (nv + nc, nv) = residual_by_v; by_u (nv + nc, nu) = residual_by_u",
        "derivatives",
        "derivatives of (M a + h - Q - G^T lam; G a - gamma) by q, v and u",
    ),
    row_of(
        "rest_stiffness",
        "q u lam t",
        "K (nv, nv)",
        "derivatives",
        "derivative of h - Q - G^T lam by q at rest, v = 0",
        by_solver=True,
        unit="rest",
    ),
    row_of(
        "rest_forces",
        "q u t",
        "h (nv); Q (nv)",
        "dynamics",
        "h and Q at rest, v = 0",
        by_solver=True,
        unit="rest",
    ),
    row_of(
        "rest_damping",
        "q u t",
        "D (nv, nv)",
        "derivatives",
        "derivative of h - Q by v at rest, v = 0",
        by_solver=True,
    ),
    row_of(
        "residual",
        "q v a u lam t",
        "R (nv) = dynamic_residual; phi (nc); phi_rate (nc) = constraint_rate",
        "stepping",
        "M a + h - Q - G^T lam, phi and G v - b",
    ),
    row_of(
        "momentum",
        "q v u t",
        "p (nv) = momentum; F (nv) = momentum_force; M (nv, nv)",
        "stepping",
        "p = M v, and F with p' = F + ad_v^T p",
    ),
    row_of(
        "beam_stiffness",
        "",
        "L (nb) = beam_lengths; EI (nb, 2) = bending_stiffnesses; K (nv, nv) = elastic_stiffness",
        "dynamics",
        "of elastic beams: lengths, EI_z and EI_y at mid-length (rods: 0), and stiffness of the elastic coordinates",
        by_solver=True,
    ),
    row_of(
        "instant_operands",
        "t",
        "operand (ni); kind (ni)",
        "stepping",
        "operands of formulas of time that steps end at zeros or extrema of: docs/theory/simulation.md, (3a)",
        by_solver=True,
    ),
    row_of(
        "mass_matrix_values",
        "q",
        "values (nz)",
        "dynamics",
        "entries of M's lower triangle that may differ from zero",
        by_solver=True,
    ),
    row_of(
        "mass_matrix_pattern",
        "",
        "row (nz); column (nz)",
        "dynamics",
        "rows and columns of mass_matrix_values",
        by_solver=True,
    ),
    row_of("center_of_mass", "q", "p_WScm (3) = center_of_mass", "dynamics", "mass centre of all that joints carry"),
    row_of(
        "centroidal_momentum",
        "q v",
        "h_G (6) = centroidal_momentum",
        "dynamics",
        "momentum about the mass centre, linear then angular",
    ),
    row_of(
        "centroidal_momentum_matrix",
        "q",
        "A_G (6, nv) = centroidal_momentum_matrix",
        "dynamics",
        "A_G with centroidal_momentum = A_G v",
    ),
    row_of(
        "centroidal_momentum_rate",
        "q v a",
        "h_G_rate (6) = centroidal_momentum_rate",
        "dynamics",
        "rate of the momentum about the mass centre",
    ),
    row_of("coriolis_matrix", "q v", "C (nv, nv) = coriolis_matrix", "dynamics", "C with C v = h without weight"),
    row_of(
        "regressor",
        "q v a",
        "Y (nv, npi) = regressor",
        "derivatives",
        "Y with M a + h = Y pi, for the links' inertial parameters pi, ten a link",
    ),
    row_of("frame_pose", "q", "p (3); R (3, 3)", "frames", "p_WF and R_WF of a frame", exported=True),
    row_of("frame_velocity", "q v", "V (6) = velocity", "frames", "velocity and angular velocity", exported=True),
    row_of(
        "frame_acceleration",
        "q v a",
        "A (6) = acceleration",
        "frames",
        "acceleration and angular acceleration",
        exported=True,
    ),
    row_of("frame_jacobian", "q", "J (6, nv) = jacobian", "frames", "J with frame_velocity = J v", exported=True),
    row_of("frame_jacobian_rate", "q v", "dJ (6, nv) = jacobian_rate", "frames", "rate of the Jacobian", exported=True),
    row_of("frame_position_by_par", "q", "by_par (3, npar) = position_by_par", "frames", "derivative of p_WF by par"),
    row_of(
        "frame_position_hessian",
        "q p_WF_bar",
        "H (nv + npar, nv + npar) = position_hessian",
        "frames",
        "second derivatives of p_WF_bar . p_WF by (q, par)",
    ),
    row_of(
        "frame_derivatives",
        "q v a u",
        "pose_by_q (6, nv); pose_by_u (6, nu); velocity_by_q (6, nv); velocity_by_v (6, nv) = jacobian; "
        "velocity_by_u (6, nu); acceleration_by_q (6, nv); acceleration_by_v (6, nv); acceleration_by_u (6, nu)",
        "frames",
        "derivatives of a frame's pose, velocity and acceleration by q, v and u",
    ),
)

# Functions whose vector-Jacobian products are functions, too, named with "_vjp" at the end.
_TRANSPOSED = (
    "mass_matrix",
    "bias",
    "generalized_force",
    "inverse_dynamics",
    "forward_dynamics",
    "residual",
    "kinetic_energy",
    "potential_energy",
    "constraint",
    "constraint_rate",
    "constraint_bias",
    "joint_wrenches",
    "center_of_mass",
    "centroidal_momentum",
    "frame_pose",
    "frame_velocity",
    "frame_acceleration",
    "frame_jacobian",
)

_WITH_VJP = tuple(row for row in _ROWS if row.name in _TRANSPOSED)
for _row_with_vjp in _WITH_VJP:
    INPUTS |= cotangent_inputs(_row_with_vjp)
_ROWS = (*_ROWS, *map(transposed, _WITH_VJP))
FUNCTIONS: dict[str, ModelFunction] = {row.name: row for row in _ROWS}
# Names of the functions of the whole model, and of the functions of one frame.
MODEL_FUNCTIONS = tuple(row.name for row in _ROWS if not row.of_frame)
FRAME_FUNCTIONS = tuple(row.name for row in _ROWS if row.of_frame)
# What commands generate where no functions are named: reverse mode and second order are long, and asked for by name.
_SECOND_ORDER = re.compile(r".*_(second_derivatives|hvp|hessian)")
_DEFAULT = [row.name for row in _ROWS if not (row.transposes or _SECOND_ORDER.fullmatch(row.name))]
DEFAULT_FUNCTIONS = tuple(name for name in _DEFAULT if not FUNCTIONS[name].of_frame)
DEFAULT_FRAME_FUNCTIONS = tuple(name for name in _DEFAULT if FUNCTIONS[name].of_frame)


def generated_with(name: str, constrained: bool) -> tuple[str, ...]:
    """Names of the functions that are generated in one unit with a function, itself among them.

    Args:
        name: A function's name.
        constrained: Whether the model has constraints; of a tree, functions that only constraints need are in a
            unit of their own.
    """
    row = FUNCTIONS[name]
    if row.constrained_only and not constrained:
        empty = tuple(other.name for other in _ROWS if other.constrained_only and not other.by_solver)
        return empty if name in empty else (name,)
    shared = [other for other in _ROWS if row.unit and other.unit == row.unit]
    return tuple(other.name for other in shared if constrained or not other.constrained_only) or (name,)


def exported(constrained: bool, groups: Collection[Group] = get_args(Group)) -> tuple[str, ...]:
    """Names of the exported functions of some groups; of a tree, without those that only constraints need."""
    return tuple(
        row.name for row in _ROWS if row.exported and row.group in groups and (constrained or not row.constrained_only)
    )
