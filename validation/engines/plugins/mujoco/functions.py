"""What MuJoCo offers of trees: its functions, those of constraints and of forces apart."""

from __future__ import annotations

from ...interface import Steps
from ..writing.source import Way
from .forces import COPY, EXPLICIT, FULL, QV, QVA, SQUARE, Q, transition

_TWISTS = "value = np.zeros((len(bs), 6))\nfor k, b in enumerate(bs):\n    "
_JACOBIANS = "value = np.zeros((len(bs), 6, m.nv))\nfor k, b in enumerate(bs):\n    "
_INVERSE_FD = f"{QVA}{SQUARE}mj.mjd_inverseFD(m, d, 1e-6, False, "
_TRANSITION = transition(1.0, EXPLICIT)
# One-sided differences are off by the step times the second derivative, centred ones by its square times the third.
_INVERSE_STEPS = Steps("inverse_dynamics", 1e-6, 1e-4)
_FORWARD_STEPS = Steps("forward_dynamics", 1e-6, 1e-9)


WAYS = {
    "sizes": Way("nq, nv", "value = [m.nq, m.nv]"),
    "mass_matrix": Way("mj_fullM", f"{Q}{SQUARE}{FULL}"),
    "mass_matrix:mj_mulM": Way(
        "mj_mulM", f"{Q}{SQUARE}for row, unit in zip(value, np.eye(m.nv)):\n    mj.mj_mulM(m, d, row, unit)"
    ),
    "mass_matrix:mjd_inverseFD": Way(
        "mjd_inverseFD", f"{_INVERSE_FD}None, None, value, None, None, None, None)", _INVERSE_STEPS
    ),
    # Of a square root X of M, by rows: X X^T is M. Scaled rows are roots of the inverse.
    "mass_matrix:mj_mulM2": Way(
        "mj_mulM2",
        f"{Q}root = np.zeros((m.nv, m.nv))\nfor row, unit in zip(root, np.eye(m.nv)):\n"
        "    mj.mj_mulM2(m, d, row, unit)\nvalue = root @ root.T",
    ),
    "mass_matrix_inverse:mj_solveM2": Way(
        "mj_solveM2",
        f"{Q}root = np.zeros((m.nv, m.nv))\n"
        "mj.mj_solveM2(m, d, root, np.eye(m.nv), np.sqrt(d.qLDiagInv))\nvalue = root @ root.T",
    ),
    "mass_matrix_inverse": Way("mj_solveM", f"{Q}{SQUARE}mj.mj_solveM(m, d, value, np.eye(m.nv))"),
    "bias": Way("qfrc_bias", f"{QV}value = d.qfrc_bias"),
    "inverse_dynamics": Way("mj_inverse", f"{QVA}mj.mj_inverse(m, d)\nvalue = d.qfrc_inverse"),
    "inverse_dynamics:mj_rne": Way("mj_rne", f"{QVA}value = np.zeros(m.nv)\nmj.mj_rne(m, d, 1, value)"),
    "forward_dynamics": Way("mj_forward", f"d.qfrc_applied[:] = tau\n{QV}value = d.qacc"),
    "kinetic_energy": Way("mj_energyVel", f"{QV}mj.mj_energyVel(m, d)\nvalue = d.energy[1]"),
    "potential_energy": Way("mj_energyPos", f"{Q}mj.mj_energyPos(m, d)\nvalue = d.energy[0]"),
    "link_poses": Way("xpos, xmat", f"{Q}value = np.hstack([d.xpos[bs], d.xmat[bs]])"),
    "mass_centre": Way("subtree_com", f"{Q}value = d.subtree_com[0]"),
    "mass_centre_jacobian": Way(
        "mj_jacSubtreeCom", f"{Q}value = np.zeros((3, m.nv))\nmj.mj_jacSubtreeCom(m, d, value, 0)"
    ),
    "link_jacobians": Way("mj_jacBody", f"{Q}{_JACOBIANS}mj.mj_jacBody(m, d, value[k, :3], value[k, 3:], b)"),
    "link_jacobian_rates": Way(
        "mj_jacDot", f"{QV}{_JACOBIANS}mj.mj_jacDot(m, d, value[k, :3], value[k, 3:], d.xpos[b], b)"
    ),
    "link_velocities": Way(
        "mj_objectVelocity",
        f"{QV}{_TWISTS}mj.mj_objectVelocity(m, d, mj.mjtObj.mjOBJ_XBODY, b, value[k], 0)\n"
        "value = np.roll(value, 3, axis=1)",
    ),
    "velocity_local": Way(
        "mj_objectVelocity",
        f"{QV}{_TWISTS}mj.mj_objectVelocity(m, d, mj.mjtObj.mjOBJ_XBODY, b, value[k], 1)\n"
        "value = np.roll(value, 3, axis=1)",
    ),
    "link_accelerations": Way(
        "mj_objectAcceleration",
        f"{QVA}mj.mj_rnePostConstraint(m, d)\n"
        f"{_TWISTS}mj.mj_objectAcceleration(m, d, mj.mjtObj.mjOBJ_XBODY, b, value[k], 0)\n"
        "value = np.roll(value, 3, axis=1) + np.r_[m.opt.gravity, np.zeros(3)]",
    ),
    "centroidal_matrix": Way(
        "mj_jacSubtreeCom, mj_angmomMat",
        f"{Q}J = np.zeros((3, m.nv))\nmj.mj_jacSubtreeCom(m, d, J, 0)\n"
        "A = np.zeros((3, m.nv))\nmj.mj_angmomMat(m, d, A, 0)\nvalue = np.vstack([m.body_subtreemass[0] * J, A])",
    ),
    "centroidal_momentum": Way(
        "mj_subtreeVel",
        f"{QV}mj.mj_subtreeVel(m, d)\nvalue = np.r_[m.body_subtreemass[0] * d.subtree_linvel[0], d.subtree_angmom[0]]",
    ),
    "inverse_dynamics_dq": Way(
        "mjd_inverseFD", f"{_INVERSE_FD}value, None, None, None, None, None, None)\nvalue = value.T", _INVERSE_STEPS
    ),
    "inverse_dynamics_dv": Way(
        "mjd_inverseFD", f"{_INVERSE_FD}None, value, None, None, None, None, None)\nvalue = value.T", _INVERSE_STEPS
    ),
    "inverse_dynamics_dv:qDeriv": Way(
        "mj_implicit",
        f"{COPY}n.opt.integrator = mj.mjtIntegrator.mjINT_IMPLICIT\n"
        f"{QV}mj.mj_implicit(n, d)\n{SQUARE}for i in range(m.nv):\n"
        "    row = slice(m.D_rowadr[i], m.D_rowadr[i] + m.D_rownnz[i])\n    value[i, m.D_colind[row]] = -d.qDeriv[row]",
    ),
    "forward_dynamics_dq": Way("mjd_transitionFD", f"{_TRANSITION}value = A[m.nv:, :m.nv]", _FORWARD_STEPS),
    "forward_dynamics_dv": Way(
        "mjd_transitionFD", f"{_TRANSITION}value = A[m.nv:, m.nv:] - np.eye(m.nv)", _FORWARD_STEPS
    ),
    "integrate": Way("mj_integratePos", "value = q\nmj.mj_integratePos(m, value, v2, 1.0)"),
    "difference": Way(
        "mj_differentiatePos",
        "q1, value = q.copy(), np.zeros(m.nv)\nmj.mj_integratePos(m, q1, v2, 1.0)\n"
        "mj.mj_differentiatePos(m, value, 1.0, q, q1)",
    ),
}
