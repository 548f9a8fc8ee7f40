"""What MuJoCo offers of trees: its functions, those of constraints and of forces apart."""

from __future__ import annotations

from ..writing.source import ways_of
from .forces import COPY, EXPLICIT, FULL, QV, QVA, SQUARE, Q, transition

_TWISTS = "value = np.zeros((len(bs), 6))\nfor k, b in enumerate(bs):\n    "
_JACOBIANS = "value = np.zeros((len(bs), 6, m.nv))\nfor k, b in enumerate(bs):\n    "
_INVERSE_FD = f"{QVA}{SQUARE}mj.mjd_inverseFD(m, d, 1e-6, False, "
_TRANSITION = transition(1.0, EXPLICIT)
# One-sided differences are off by the step times the second derivative, centred ones by its square times the third.


WAYS = ways_of(f"""
== sizes | nq, nv | value = [m.nq, m.nv]
== mass_matrix | mj_fullM | {Q}{SQUARE}{FULL}
== mass_matrix:mj_mulM | mj_mulM
{Q}{SQUARE}for row, unit in zip(value, np.eye(m.nv)):
    mj.mj_mulM(m, d, row, unit)
== mass_matrix:mjd_inverseFD ~ inverse_dynamics 1e-06 0.0001 | mjd_inverseFD
{_INVERSE_FD}None, None, value, None, None, None, None)
== # Of a square root X of M, by rows: X X^T is M. Scaled rows are roots of the inverse.
== mass_matrix:mj_mulM2 | mj_mulM2
{Q}root = np.zeros((m.nv, m.nv))
for row, unit in zip(root, np.eye(m.nv)):
    mj.mj_mulM2(m, d, row, unit)
value = root @ root.T
== mass_matrix_inverse:mj_solveM2 | mj_solveM2
{Q}root = np.zeros((m.nv, m.nv))
mj.mj_solveM2(m, d, root, np.eye(m.nv), np.sqrt(d.qLDiagInv))
value = root @ root.T
== mass_matrix_inverse | mj_solveM | {Q}{SQUARE}mj.mj_solveM(m, d, value, np.eye(m.nv))
== bias | qfrc_bias | {QV}value = d.qfrc_bias
== inverse_dynamics | mj_inverse | {QVA}mj.mj_inverse(m, d)\nvalue = d.qfrc_inverse
== inverse_dynamics:mj_rne | mj_rne | {QVA}value = np.zeros(m.nv)\nmj.mj_rne(m, d, 1, value)
== forward_dynamics | mj_forward | d.qfrc_applied[:] = tau\n{QV}value = d.qacc
== kinetic_energy | mj_energyVel | {QV}mj.mj_energyVel(m, d)\nvalue = d.energy[1]
== potential_energy | mj_energyPos | {Q}mj.mj_energyPos(m, d)\nvalue = d.energy[0]
== link_poses | xpos, xmat | {Q}value = np.hstack([d.xpos[bs], d.xmat[bs]])
== mass_centre | subtree_com | {Q}value = d.subtree_com[0]
== mass_centre_jacobian | mj_jacSubtreeCom | {Q}value = np.zeros((3, m.nv))\nmj.mj_jacSubtreeCom(m, d, value, 0)
== link_jacobians | mj_jacBody | {Q}{_JACOBIANS}mj.mj_jacBody(m, d, value[k, :3], value[k, 3:], b)
== link_jacobian_rates | mj_jacDot | {QV}{_JACOBIANS}mj.mj_jacDot(m, d, value[k, :3], value[k, 3:], d.xpos[b], b)
== link_velocities | mj_objectVelocity
{QV}{_TWISTS}mj.mj_objectVelocity(m, d, mj.mjtObj.mjOBJ_XBODY, b, value[k], 0)
value = np.roll(value, 3, axis=1)
== velocity_local | mj_objectVelocity
{QV}{_TWISTS}mj.mj_objectVelocity(m, d, mj.mjtObj.mjOBJ_XBODY, b, value[k], 1)
value = np.roll(value, 3, axis=1)
== link_accelerations | mj_objectAcceleration
{QVA}mj.mj_rnePostConstraint(m, d)
{_TWISTS}mj.mj_objectAcceleration(m, d, mj.mjtObj.mjOBJ_XBODY, b, value[k], 0)
value = np.roll(value, 3, axis=1) + np.r_[m.opt.gravity, np.zeros(3)]
== centroidal_matrix | mj_jacSubtreeCom, mj_angmomMat
{Q}J = np.zeros((3, m.nv))
mj.mj_jacSubtreeCom(m, d, J, 0)
A = np.zeros((3, m.nv))
mj.mj_angmomMat(m, d, A, 0)
value = np.vstack([m.body_subtreemass[0] * J, A])
== centroidal_momentum | mj_subtreeVel
{QV}mj.mj_subtreeVel(m, d)
value = np.r_[m.body_subtreemass[0] * d.subtree_linvel[0], d.subtree_angmom[0]]
== inverse_dynamics_dq ~ inverse_dynamics 1e-06 0.0001 | mjd_inverseFD
{_INVERSE_FD}value, None, None, None, None, None, None)
value = value.T
== inverse_dynamics_dv ~ inverse_dynamics 1e-06 0.0001 | mjd_inverseFD
{_INVERSE_FD}None, value, None, None, None, None, None)
value = value.T
== inverse_dynamics_dv:qDeriv | mj_implicit
{COPY}n.opt.integrator = mj.mjtIntegrator.mjINT_IMPLICIT
{QV}mj.mj_implicit(n, d)
{SQUARE}for i in range(m.nv):
    row = slice(m.D_rowadr[i], m.D_rowadr[i] + m.D_rownnz[i])
    value[i, m.D_colind[row]] = -d.qDeriv[row]
== forward_dynamics_dq ~ forward_dynamics 1e-06 1e-09 | mjd_transitionFD | {_TRANSITION}value = A[m.nv:, :m.nv]
== forward_dynamics_dv ~ forward_dynamics 1e-06 1e-09 | mjd_transitionFD
{_TRANSITION}value = A[m.nv:, m.nv:] - np.eye(m.nv)
== integrate | mj_integratePos | value = q\nmj.mj_integratePos(m, value, v2, 1.0)
== difference | mj_differentiatePos
q1, value = q.copy(), np.zeros(m.nv)
mj.mj_integratePos(m, q1, v2, 1.0)
mj.mj_differentiatePos(m, value, 1.0, q, q1)
""")
