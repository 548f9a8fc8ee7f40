"""What MuJoCo says a second time of what is asked: other fields, functions and drivers of the same."""

from __future__ import annotations

from ...interface import STEP
from ...truth.points import POINT
from ..writing.source import Way
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

WAYS = {
    "link_velocities:cvel": Way(
        "cvel",
        f"{QV}value = []\nfor b in bs:\n    w, u = d.cvel[b].reshape(2, 3)\n"
        "    value.append([*(u + np.cross(w, d.xpos[b] - d.subtree_com[m.body_rootid[b]])), *w])",
    ),
    "mass_centre:xipos": Way("xipos", f"{Q}value = m.body_mass @ d.xipos / sum(m.body_mass)"),
    "link_jacobians:mj_jac": Way("mj_jac", f"{Q}{_JACOBIANS}mj.mj_jac(m, d, J[:3], J[3:], d.xpos[b], b)"),
    "link_jacobians:mj_jacBodyCom": Way(
        "mj_jacBodyCom",
        f"{Q}{_JACOBIANS}mj.mj_jacBodyCom(m, d, J[:3], J[3:], b)\n"
        "    J[:3] += np.cross(d.xipos[b] - d.xpos[b], J[3:].T).T",
    ),
    "link_jacobians:mj_jacPointAxis": Way(
        "mj_jacPointAxis",
        f"{Q}value = np.zeros((len(bs), 6, m.nv))\nfor J, b in zip(value, bs):\n    turned = np.zeros((3, 3, m.nv))\n"
        "    for x, unit in zip(turned, np.eye(3)): mj.mj_jacPointAxis(m, d, J[:3], x, d.xpos[b], unit, b)\n"
        "    J[3:] = [turned[1][2], turned[2][0], turned[0][1]]",
    ),
    "link_velocities:cdof": Way(
        "cdof",
        f"{QV}value = np.zeros((len(bs), 6))\nfor row, b in zip(value, bs):\n    place = b\n    while place:\n"
        "        for k in range(m.body_dofadr[place], m.body_dofadr[place] + m.body_dofnum[place]):\n"
        "            w, u = d.cdof[k].reshape(2, 3) * v[k]\n"
        "            row += [*(u + np.cross(w, d.xpos[b] - d.subtree_com[m.body_rootid[b]])), *w]\n"
        "        place = m.body_parentid[place]",
    ),
    "point_jacobians": Way(
        "mj_jac, of a point",
        f"{Q}{_AT_POINT}value = np.zeros((len(bs), 3, m.nv))\n"
        "for J, b in zip(value, bs): mj.mj_jac(m, d, J, None, at(b), b)",
    ),
    "point_velocity_products": Way(
        "mj_jacDot, of a point",
        f"{QV}{_AT_POINT}value = np.zeros((len(bs), 3, m.nv))\n"
        "for J, b in zip(value, bs): mj.mj_jacDot(m, d, J, None, at(b), b)\nvalue = value @ v",
    ),
    "forward_dynamics:mj_fwdAcceleration": Way(
        "mj_fwdPosition, mj_fwdVelocity, mj_fwdActuation, mj_fwdAcceleration",
        f"{_SET}for stage in (mj.mj_fwdPosition, mj.mj_fwdVelocity, mj.mj_fwdActuation, mj.mj_fwdAcceleration):\n"
        "    stage(m, d)\nvalue = d.qacc_smooth",
    ),
    "forward_dynamics:mj_forwardSkip": Way(
        "mj_forwardSkip",
        f"{_SET}d.qfrc_applied[:], d.qvel[:] = 0 * tau, 0 * v\nmj.mj_forward(m, d)\n"
        "d.qfrc_applied[:], d.qvel[:] = tau, v\nmj.mj_forwardSkip(m, d, mj.mjtStage.mjSTAGE_POS, 1)\nvalue = d.qacc",
    ),
    "inverse_dynamics:mj_inverseSkip": Way(
        "mj_inverseSkip",
        f"{_SET}d.qvel[:] = 0 * v\nmj.mj_inverse(m, d)\nd.qvel[:], d.qacc[:] = v, a\n"
        "mj.mj_inverseSkip(m, d, mj.mjtStage.mjSTAGE_POS, 1)\nvalue = d.qfrc_inverse",
    ),
    "bias:mj_rne": Way("mj_rne without accelerations", f"{QVA}value = np.zeros(m.nv)\nmj.mj_rne(m, d, 0, value)"),
    "inverse_dynamics_acted": Way("mj_inverse", f"{QVA}mj.mj_inverse(m, d)\nvalue = d.qfrc_inverse"),
    "forward_dynamics:mj_setState": Way("mj_getState, mj_setState", f"{_COPIED}mj.mj_forward(m, e)\nvalue = e.qacc"),
    "step_dampers_implicit:mj_setState": Way(
        "mj_getState, mj_setState, mj_step",
        f"{_COPIED}{_STEPPED}mj.mj_step(n, e)\nvalue = np.r_[e.qpos, e.qvel]",
    ),
    "step_dampers_implicit:rollout": Way(
        "rollout",
        f"from mujoco import rollout\n{_STEPPED}d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau\n"
        "FULL, APPLIED = mj.mjtState.mjSTATE_FULLPHYSICS, mj.mjtState.mjSTATE_CTRL | mj.mjtState.mjSTATE_QFRC_APPLIED\n"
        "state, given = np.zeros(mj.mj_stateSize(n, FULL)), np.zeros(mj.mj_stateSize(n, APPLIED))\n"
        "mj.mj_getState(n, d, state, FULL)\nmj.mj_getState(n, d, given, APPLIED)\n"
        "reached, _ = rollout.rollout(n, mj.MjData(n), state[None], given[None, None], control_spec=APPLIED)\n"
        "e = mj.MjData(n)\nmj.mj_setState(n, e, reached[0, -1], FULL)\nvalue = np.r_[e.qpos, e.qvel]",
    ),
    "passive_forces:parts": Way(
        "qfrc_spring, qfrc_damper, qfrc_gravcomp, qfrc_fluid",
        f"{QV}value = d.qfrc_spring + d.qfrc_damper + d.qfrc_gravcomp + d.qfrc_fluid",
    ),
    "tendon_stiffnesses": Way("tendon_stiffness", "value = m.tendon_stiffness"),
    "tendon_dampings": Way("tendon_damping", "value = m.tendon_damping"),
    "tendon_rests": Way("tendon_lengthspring", "value = m.tendon_lengthspring[:, 0]"),
    "tendon_armatures": Way("tendon_armature", "value = m.tendon_armature"),
    "actuator_gears": Way("actuator_gear", "value = m.actuator_gear[:, 0]"),
    "actuator_gains": Way("actuator_gainprm", "value = m.actuator_gainprm[:, 0]"),
    "actuator_biases": Way("actuator_biasprm", "value = m.actuator_biasprm[:, :3]"),
    "actuator_control_limits": Way("actuator_ctrlrange", "value = m.actuator_ctrlrange"),
    "actuator_force_limits": Way("actuator_forcerange", "value = m.actuator_forcerange"),
    "actuator_sites": Way(
        "actuator_trnid", "value = [np.ravel([m.site_pos[k] for k in pair if k >= 0]) for pair in m.actuator_trnid]"
    ),
    "coupled_coefficients": Way("eq_data", "value = m.eq_data[:, :2]"),
    "weight_shares": Way("body_gravcomp", "value = m.body_gravcomp[bs]"),
    "tendon_speeds": Way("ten_velocity", f"{QV}value = d.ten_velocity"),
    "actuator_speeds": Way("actuator_velocity", f"{QV}value = d.actuator_velocity"),
    "constraint_jacobian:mj_mulJacVec": Way(
        "mj_mulJacVec",
        "m.eq_solref[:] = 0.0\nm.opt.jacobian, m.opt.tolerance = mj.mjtJacobian.mjJAC_SPARSE, 0.0\n"
        "d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau\nmj.mj_forward(m, d)\nJ = np.zeros((m.nv, d.nefc))\n"
        "for column, unit in zip(J, np.eye(m.nv)): mj.mj_mulJacVec(m, d, column, unit)\nvalue = axes() @ J.T",
    ),
    "constrained_inverse": Way(
        "mj_forward, mj_inverse",
        "m.opt.tolerance = 0.0\nd.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau\nmj.mj_forward(m, d)\n"
        "mj.mj_inverse(m, d)\nvalue = d.qfrc_inverse",
        _CONVERGED,
    ),
}
