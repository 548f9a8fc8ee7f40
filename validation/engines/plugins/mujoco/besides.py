"""What MuJoCo says a second time of what is asked: other fields, functions and drivers of the same."""

from __future__ import annotations

from ...interface import STEP
from ...truth.points import POINT
from ..writing.source import ways_of
from .forces import COPY, QV, QVA, Q

_JACOBIANS = "value = np.zeros((len(bs), 6, m.nv))\nfor J, b in zip(value, bs):\n    "
_AT_POINT = f"def at(b): return d.xpos[b] + d.xmat[b].reshape(3, 3) @ {list(POINT)}\n"
_SET = "d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau\n"
_STEPPED = f"{COPY}n.opt.timestep = {STEP}\n"
_FULL = "mj.mjtState.mjSTATE_INTEGRATION"
_COPIED = (
    f"d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau\nstate = np.zeros(mj.mj_stateSize(m, {_FULL}))\n"
    f"mj.mj_getState(m, d, state, {_FULL})\ne = mj.MjData(m)\nmj.mj_setState(m, e, state, {_FULL})\n"
)
# What is left of the solver's residual, beside forces that speeds make large.
_CONVERGED = 1e-5

WAYS = ways_of(f"""
== link_velocities:cvel | cvel
{QV}value = []
for b in bs:
    w, u = d.cvel[b].reshape(2, 3)
    value.append([*(u + np.cross(w, d.xpos[b] - d.subtree_com[m.body_rootid[b]])), *w])
== mass_centre:xipos | xipos | {Q}value = m.body_mass @ d.xipos / sum(m.body_mass)
== link_jacobians:mj_jac | mj_jac | {Q}{_JACOBIANS}mj.mj_jac(m, d, J[:3], J[3:], d.xpos[b], b)
== link_jacobians:mj_jacBodyCom | mj_jacBodyCom
{Q}{_JACOBIANS}mj.mj_jacBodyCom(m, d, J[:3], J[3:], b)
    J[:3] += np.cross(d.xipos[b] - d.xpos[b], J[3:].T).T
== link_jacobians:mj_jacPointAxis | mj_jacPointAxis
{Q}value = np.zeros((len(bs), 6, m.nv))
for J, b in zip(value, bs):
    turned = np.zeros((3, 3, m.nv))
    for x, unit in zip(turned, np.eye(3)): mj.mj_jacPointAxis(m, d, J[:3], x, d.xpos[b], unit, b)
    J[3:] = [turned[1][2], turned[2][0], turned[0][1]]
== link_velocities:cdof | cdof
{QV}value = np.zeros((len(bs), 6))
for row, b in zip(value, bs):
    place = b
    while place:
        for k in range(m.body_dofadr[place], m.body_dofadr[place] + m.body_dofnum[place]):
            w, u = d.cdof[k].reshape(2, 3) * v[k]
            row += [*(u + np.cross(w, d.xpos[b] - d.subtree_com[m.body_rootid[b]])), *w]
        place = m.body_parentid[place]
== point_jacobians | mj_jac, of a point
{Q}{_AT_POINT}value = np.zeros((len(bs), 3, m.nv))
for J, b in zip(value, bs): mj.mj_jac(m, d, J, None, at(b), b)
== point_velocity_products | mj_jacDot, of a point
{QV}{_AT_POINT}value = np.zeros((len(bs), 3, m.nv))
for J, b in zip(value, bs): mj.mj_jacDot(m, d, J, None, at(b), b)
value = value @ v
== forward_dynamics:mj_fwdAcceleration | mj_fwdPosition, mj_fwdVelocity, mj_fwdActuation, mj_fwdAcceleration
{_SET}for stage in (mj.mj_fwdPosition, mj.mj_fwdVelocity, mj.mj_fwdActuation, mj.mj_fwdAcceleration):
    stage(m, d)
value = d.qacc_smooth
== forward_dynamics:mj_forwardSkip | mj_forwardSkip
{_SET}d.qfrc_applied[:], d.qvel[:] = 0 * tau, 0 * v
mj.mj_forward(m, d)
d.qfrc_applied[:], d.qvel[:] = tau, v
mj.mj_forwardSkip(m, d, mj.mjtStage.mjSTAGE_POS, 1)
value = d.qacc
== inverse_dynamics:mj_inverseSkip | mj_inverseSkip
{_SET}d.qvel[:] = 0 * v
mj.mj_inverse(m, d)
d.qvel[:], d.qacc[:] = v, a
mj.mj_inverseSkip(m, d, mj.mjtStage.mjSTAGE_POS, 1)
value = d.qfrc_inverse
== bias:mj_rne | mj_rne without accelerations | {QVA}value = np.zeros(m.nv)\nmj.mj_rne(m, d, 0, value)
== inverse_dynamics_acted | mj_inverse | {QVA}mj.mj_inverse(m, d)\nvalue = d.qfrc_inverse
== forward_dynamics:mj_setState | mj_getState, mj_setState | {_COPIED}mj.mj_forward(m, e)\nvalue = e.qacc
== step_dampers_implicit:mj_setState | mj_getState, mj_setState, mj_step
{_COPIED}{_STEPPED}mj.mj_step(n, e)
value = np.r_[e.qpos, e.qvel]
== step_dampers_implicit:rollout | rollout
from mujoco import rollout
{_STEPPED}d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau
FULL, APPLIED = mj.mjtState.mjSTATE_FULLPHYSICS, mj.mjtState.mjSTATE_CTRL | mj.mjtState.mjSTATE_QFRC_APPLIED
state, given = np.zeros(mj.mj_stateSize(n, FULL)), np.zeros(mj.mj_stateSize(n, APPLIED))
mj.mj_getState(n, d, state, FULL)
mj.mj_getState(n, d, given, APPLIED)
reached, _ = rollout.rollout(n, mj.MjData(n), state[None], given[None, None], control_spec=APPLIED)
e = mj.MjData(n)
mj.mj_setState(n, e, reached[0, -1], FULL)
value = np.r_[e.qpos, e.qvel]
== passive_forces:parts | qfrc_spring, qfrc_damper, qfrc_gravcomp, qfrc_fluid
{QV}value = d.qfrc_spring + d.qfrc_damper + d.qfrc_gravcomp + d.qfrc_fluid
== tendon_stiffnesses | tendon_stiffness | value = m.tendon_stiffness
== tendon_dampings | tendon_damping | value = m.tendon_damping
== tendon_rests | tendon_lengthspring | value = m.tendon_lengthspring[:, 0]
== tendon_armatures | tendon_armature | value = m.tendon_armature
== actuator_gears | actuator_gear | value = m.actuator_gear[:, 0]
== actuator_gains | actuator_gainprm | value = m.actuator_gainprm[:, 0]
== actuator_biases | actuator_biasprm | value = m.actuator_biasprm[:, :3]
== actuator_control_limits | actuator_ctrlrange | value = m.actuator_ctrlrange
== actuator_force_limits | actuator_forcerange | value = m.actuator_forcerange
== actuator_sites | actuator_trnid
value = [np.ravel([m.site_pos[k] for k in pair if k >= 0]) for pair in m.actuator_trnid]
== coupled_coefficients | eq_data | value = m.eq_data[:, :2]
== weight_shares | body_gravcomp | value = m.body_gravcomp[bs]
== tendon_speeds | ten_velocity | {QV}value = d.ten_velocity
== actuator_speeds | actuator_velocity | {QV}value = d.actuator_velocity
== constraint_jacobian:mj_mulJacVec | mj_mulJacVec
m.eq_solref[:] = 0.0
m.opt.jacobian, m.opt.tolerance = mj.mjtJacobian.mjJAC_SPARSE, 0.0
d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau
mj.mj_forward(m, d)
J = np.zeros((m.nv, d.nefc))
for column, unit in zip(J, np.eye(m.nv)): mj.mj_mulJacVec(m, d, column, unit)
value = axes() @ J.T
== constrained_inverse ~ {_CONVERGED} | mj_forward, mj_inverse
m.opt.tolerance = 0.0
d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau
mj.mj_forward(m, d)
mj.mj_inverse(m, d)
value = d.qfrc_inverse
""")
