"""MuJoCo's stages one by one, its integrators, states that are copied, and keyframes."""

from __future__ import annotations

from ...interface import STEP
from ..writing.source import Way
from .forces import COPY, EXPLICIT, FULL, SQUARE, Q

_PLACED = "d.qpos[:] = q\nmj.mj_kinematics(m, d)\nmj.mj_comPos(m, d)\nmj.mj_tendon(m, d)\n"
_WHOLE = f"{_PLACED}mj.mj_makeM(m, d)\n"
_SET = "d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau\n"
_POSITIONS = (
    *("fwdKinematics", "makeM", "factorM", "collision", "makeConstraint", "island", "projectConstraint"),
    *("transmission", "sensorPos", "fwdVelocity", "sensorVel", "fwdActuation", "fwdAcceleration", "fwdConstraint"),
)
_STAGES = f"for stage in {_POSITIONS}: getattr(mj, 'mj_' + stage)({{m}}, d)\n"
_NATIVE = ", ".join(f"mj_{name}" for name in _POSITIONS)
_AS_BEFORE = "\nif m.na: d.act[:] = states"
_LOCAL = "R, p = np.zeros(9), np.zeros(3)\n    mj.mj_local2Global(d, p, R, {given})\n    value.append([*p, *R])"
_COPIED = "mj.mj_forward(m, e)\nvalue = e.qacc"
_SIGNATURE = "FULL, PART = mj.mjtState.mjSTATE_INTEGRATION, mj.mjtState.mjSTATE_FULLPHYSICS\n"
_KEY = (("</mujoco>", "<keyframe><key/></keyframe></mujoco>"),)


def _step(integrator: str, call: str, settings: str = "") -> Way:
    """Forward dynamics, then one integrator by its name."""
    stated = f"{COPY}n.opt.timestep, n.opt.integrator = {STEP}, mj.mjtIntegrator.{integrator}\n{settings}{_SET}"
    return Way(
        f"mj_forward, {call.partition('(')[0]}",
        f"{stated}mj.mj_forward(n, d)\nmj.{call}\nvalue = np.r_[d.qpos, d.qvel]{_AS_BEFORE}",
    )


WAYS = {
    "mass_matrix:mj_makeM": Way("mj_kinematics, mj_comPos, mj_makeM", f"{_WHOLE}{SQUARE}{FULL}"),
    "mass_matrix:mj_crb": Way("mj_kinematics, mj_comPos, mj_crb", f"{_PLACED}mj.mj_crb(m, d)\n{SQUARE}{FULL}"),
    "mass_matrix:mj_addM": Way(
        "mj_addM",
        f"{Q}rows = np.array(m.M_rownnz), np.array(m.M_rowadr), np.zeros(m.nM, np.int32)\n"
        "rows[2][:m.nC], kept = m.M_colind, np.zeros(m.nM)\n"
        f"mj.mj_addM(m, d, kept, *rows)\n{SQUARE}mj.mju_sym2dense(value, kept, *rows)",
    ),
    "mass_matrix_inverse:mj_factorM": Way(
        "mj_makeM, mj_factorM, mj_solveM",
        f"{_WHOLE}mj.mj_factorM(m, d)\n{SQUARE}mj.mj_solveM(m, d, value, np.eye(m.nv))",
    ),
    "bias:mj_comVel": Way(
        "mj_comPos, mj_comVel, mj_rne",
        f"{_PLACED}d.qvel[:] = v\nmj.mj_comVel(m, d)\nvalue = np.zeros(m.nv)\nmj.mj_rne(m, d, 0, value)",
    ),
    # Of all masses twice as large.
    "gravity:mj_setTotalmass": Way(
        "mj_getTotalmass, mj_setTotalmass",
        f"{COPY}mj.mj_setTotalmass(n, 2 * mj.mj_getTotalmass(n))\nd.qpos[:], d.qvel[:] = q, 0.0\n"
        "mj.mj_forward(n, d)\nvalue = d.qfrc_bias / 2",
    ),
    "link_poses:mj_fwdKinematics": Way(
        "mj_fwdKinematics", "d.qpos[:] = q\nmj.mj_fwdKinematics(m, d)\nvalue = np.hstack([d.xpos[bs], d.xmat[bs]])"
    ),
    "link_poses:mj_local2Global": Way(
        "mj_local2Global",
        f"{Q}value = []\nfor b in bs:\n    " + _LOCAL.format(given="np.zeros(3), np.array([1.0, 0, 0, 0]), b, 0"),
    ),
    "link_poses:mj_normalizeQuat": Way(
        "mj_normalizeQuat",
        "x = q.copy()\nfor kind, at in zip(m.jnt_type, m.jnt_qposadr):\n"
        "    if kind < 2: x[at + 3 - 3 * kind:at + 7 - 3 * kind] *= 2\n"
        "mj.mj_normalizeQuat(m, x)\nd.qpos[:] = x\nmj.mj_kinematics(m, d)\n"
        "value = np.hstack([d.xpos[bs], d.xmat[bs]]) + (np.abs(x - q).max() > 1e-9)",
    ),
    "frame_poses:mj_local2Global": Way(
        "mj_local2Global",
        f"{Q}value = []\nfor k in sensed:\n    one = m.site(f'o{{k}}')\n    "
        + _LOCAL.format(given="one.pos, one.quat, one.bodyid[0], 0"),
    ),
    "tendon_lengths:mj_tendon": Way("mj_tendon", f"{_PLACED}value = d.ten_length"),
    "actuator_lengths:mj_transmission": Way(
        "mj_transmission", f"{_PLACED}mj.mj_transmission(m, d)\nvalue = d.actuator_length"
    ),
    "passive_forces:mj_invVelocity": Way(
        "mj_invPosition, mj_invVelocity",
        "d.qpos[:], d.qvel[:] = q, v\nmj.mj_invPosition(m, d)\nmj.mj_invVelocity(m, d)\nvalue = d.qfrc_passive",
    ),
    "forward_dynamics:stages": Way(_NATIVE, f"{_SET}{_STAGES.format(m='m')}value = d.qacc"),
    "limited_acceleration:stages": Way(
        _NATIVE,
        f"{COPY}n.opt.solver, n.opt.tolerance, n.opt.iterations = mj.mjtSolver.mjSOL_NEWTON, 0.0, 500\n{_SET}"
        f"d.qacc_warmstart[:] = 0\n{_STAGES.format(m='n')}value = d.qacc",
    ),
    "limiting_forces:mj_invConstraint": Way(
        "mj_invPosition, mj_invVelocity, mj_invConstraint",
        f"{COPY}n.opt.solver, n.opt.tolerance, n.opt.iterations = mj.mjtSolver.mjSOL_NEWTON, 0.0, 500\n{_SET}"
        "d.qacc_warmstart[:] = 0\nmj.mj_forward(n, d)\nd.qfrc_constraint[:] = 0\nmj.mj_invPosition(n, d)\n"
        "mj.mj_invVelocity(n, d)\nmj.mj_invConstraint(n, d)\nvalue = d.qfrc_constraint",
        1e-9,
    ),
    "step_dampers_implicit:mj_Euler": _step("mjINT_EULER", "mj_Euler(n, d)"),
    "step_semi_implicit:mj_Euler": _step("mjINT_EULER", "mj_Euler(n, d)", EXPLICIT),
    "step_velocities_implicit:mj_implicit": _step("mjINT_IMPLICIT", "mj_implicit(n, d)"),
    "step_forces_implicit:mj_implicit": _step("mjINT_IMPLICITFAST", "mj_implicit(n, d)"),
    "step_rk4_manifold:mj_RungeKutta": _step("mjINT_RK4", "mj_RungeKutta(n, d, 4)"),
    "forward_dynamics:mj_copyState": Way(
        "mj_copyState", f"{_SET}{_SIGNATURE}e = mj.MjData(m)\nmj.mj_copyState(m, d, e, FULL)\n{_COPIED}"
    ),
    "forward_dynamics:mj_copyData": Way("mj_copyData", f"{_SET}e = mj.MjData(m)\nmj.mj_copyData(e, m, d)\n{_COPIED}"),
    "forward_dynamics:mj_extractState": Way(
        "mj_extractState",
        f"{_SET}{_SIGNATURE}whole, part = (np.zeros(mj.mj_stateSize(m, one)) for one in (FULL, PART))\n"
        "mj.mj_getState(m, d, whole, FULL)\nmj.mj_extractState(m, whole, FULL, part, PART)\ne = mj.MjData(m)\n"
        f"e.ctrl[:], e.qfrc_applied[:] = d.ctrl, tau\nmj.mj_setState(m, e, part, PART)\n{_COPIED}",
    ),
    "forward_dynamics:mj_resetDataKeyframe": Way(
        "mj_setKeyframe, mj_resetDataKeyframe",
        f"{_SET}mj.mj_setKeyframe(m, d, 0)\ne = mj.MjData(m)\nmj.mj_resetDataKeyframe(m, e, 0)\n"
        f"e.qfrc_applied[:] = tau\n{_COPIED}",
        built=_KEY,
    ),
}
