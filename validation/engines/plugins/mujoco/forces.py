"""MuJoCo's steps, forces of a model's own, and sensors: what is asked of trees that move by themselves or measure."""

from __future__ import annotations

from ...interface import STEP, Steps
from ...truth.sensed import WRENCH
from ..writing.source import Way

FORCE, MOMENT = list(WRENCH[:3]), list(WRENCH[3:])
Q = "d.qpos[:] = q\nmj.mj_forward(m, d)\n"
QV = "d.qpos[:], d.qvel[:] = q, v\nmj.mj_forward(m, d)\n"
QVA = f"{QV}d.qacc[:] = a\n"
_MEASURED = f"{QVA}mj.mj_rnePostConstraint(m, d)\nmj.mj_sensorVel(m, d); mj.mj_sensorAcc(m, d)\n"
# What forces make of accelerations, and what accelerometers read then.
_DRIVEN = "d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau\n"
# On data that are new: what was computed before hides what isn't computed again.
_DRIVEN_AGAIN = """e = mj.MjData(m)
e.ctrl[:] = d.ctrl
e.qpos[:], e.qvel[:], e.qfrc_applied[:] = q, v, a
mj.mj_step1(m, e); mj.mj_step2(m, e)
e.qpos[:], e.qvel[:] = q, v
mj.mj_step1(m, e)
e.qfrc_applied[:] = tau
mj.mj_step2(m, e)
"""
_WRENCHES = "value = [[*data('force', k), *data('torque', k)] for k in sensed]"
_ACCELEROMETERS = "value = [data('accelerometer', k) for k in sensed]"
# About the mass centre of the whole mechanism that the body is in.
_HELD = """value = []
for b in bs:
    moment, force = d.cfrc_int[b].reshape(2, 3)
    R, arm = d.xmat[b].reshape(3, 3), d.subtree_com[m.body_rootid[b]] - d.xpos[b]
    value.append([*(R.T @ force), *(R.T @ (moment + np.cross(arm, force)))])"""
# First it took the numbers of M.
FULL = "try: mj.mj_fullM(m, d, value)\nexcept TypeError: mj.mj_fullM(m, value, d.qM if hasattr(d, 'qM') else d.M)"
SQUARE = "value = np.zeros((m.nv, m.nv))\n"
# Options of a model of its own: what others are asked stays as it was.
COPY = "from copy import copy\nn = copy(m)\n"
SPARSE = "n.opt.jacobian = mj.mjtJacobian.mjJAC_SPARSE\n"
EXPLICIT = "n.opt.disableflags = mj.mjtDisableBit.mjDSBL_EULERDAMP\n"


def transition(step: float, settings: str = "") -> str:
    """Derivatives of Euler's step, with options of a model of its own."""
    return (
        f"{COPY}n.opt.timestep = {step}\n{settings}d.qfrc_applied[:] = tau\n{QV}A = np.zeros([2 * m.nv + m.na] * 2)\n"
        "B = np.zeros((2 * m.nv + m.na, m.nu)) if m.nu else None\n"
        "mj.mjd_transitionFD(n, d, 1e-6, True, A, B, None, None)\nA = A[:2 * m.nv, :2 * m.nv]\n"
    )


# A step moves the actuators' states, too, which other calls are to find as they were.
_AS_BEFORE = "\nif m.na: d.act[:] = states"


def _step(integrator: str, settings: str = "") -> Way:
    """A step of mj_step, with options of a model of its own."""
    code = f"{COPY}n.opt.timestep, n.opt.integrator = {STEP}, mj.mjtIntegrator.{integrator}"
    state = "d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau"
    return Way(
        f"mj_step, {integrator}",
        f"{code}\n{settings}{state}\nmj.mj_step(n, d)\nvalue = np.r_[d.qpos, d.qvel]{_AS_BEFORE}",
    )


WAYS = {
    "step_dampers_implicit": _step("mjINT_EULER"),
    "step_semi_implicit": _step("mjINT_EULER", EXPLICIT),
    "step_velocities_implicit": _step("mjINT_IMPLICIT"),
    "step_forces_implicit": _step("mjINT_IMPLICITFAST"),
    "step_velocities_implicit:sparse": _step("mjINT_IMPLICIT", SPARSE),
    "step_forces_implicit:sparse": _step("mjINT_IMPLICITFAST", SPARSE),
    "step_dampers_implicit_derivative": Way(
        "mjd_transitionFD", f"{transition(STEP)}value = A", Steps("step_dampers_implicit", 1e-6, 1e-9)
    ),
    "step_dampers_implicit_control_derivative": Way(
        "mjd_transitionFD", f"{transition(STEP)}value = B[:2 * m.nv]", Steps("step_dampers_implicit", 1e-6, 1e-9)
    ),
    # Tendons and actuators that couple joints are solved for by iterations.
    "step_stiffness_implicit_lone": _step("mjINT_DISCRETE", "n.opt.tolerance = 0.0\n"),
    "step_rk4_manifold": _step("mjINT_RK4"),
    "joint_wrenches": Way("mj_rnePostConstraint: cfrc_int", f"{QVA}mj.mj_rnePostConstraint(m, d)\n{_HELD}"),
    "joint_wrenches_driven": Way(
        "mj_forward, mj_rnePostConstraint: cfrc_int",
        f"{_DRIVEN}mj.mj_forward(m, d)\nmj.mj_rnePostConstraint(m, d)\n{_HELD}",
    ),
    "subtree_momenta": Way(
        "mj_subtreeVel",
        f"{QV}mj.mj_subtreeVel(m, d)\n"
        "value = [[*(m.body_subtreemass[b] * d.subtree_linvel[b]), *d.subtree_angmom[b]] for b in bs]",
    ),
    "accelerometers": Way("accelerometer", f"{_MEASURED}value = [data('accelerometer', k) for k in sensed]"),
    "gyroscopes": Way("gyro", f"{_MEASURED}value = [data('gyro', k) for k in sensed]"),
    "velocimeters": Way("velocimeter", f"{_MEASURED}value = [data('velocimeter', k) for k in sensed]"),
    "wrench_sensors": Way("force, torque", f"{_MEASURED}{_WRENCHES}"),
    "accelerometers_driven": Way("mj_forward, accelerometer", f"{_DRIVEN}mj.mj_forward(m, d)\n{_ACCELEROMETERS}"),
    "accelerometers_driven:mj_step2": Way(
        "mj_step1, mj_step2, accelerometer", f"{_DRIVEN}mj.mj_step1(m, d); mj.mj_step2(m, d)\n{_ACCELEROMETERS}"
    ),
    # Other forces before, then forces that are known after the first half of a step only.
    "accelerometers_driven:mj_step2 again": Way(
        "mj_step1, mj_step2 with other forces, accelerometer",
        _DRIVEN_AGAIN + "value = [e.sensor(f'accelerometer{k}').data for k in sensed]",
    ),
    "angular_accelerations_driven": Way(
        "mj_forward, frameangacc", f"{_DRIVEN}mj.mj_forward(m, d)\nvalue = [data('frameangacc', k) for k in sensed]"
    ),
    "angular_accelerations_driven:mj_step2 again": Way(
        "mj_step1, mj_step2 with other forces, frameangacc",
        _DRIVEN_AGAIN + "value = [e.sensor(f'frameangacc{k}').data for k in sensed]",
    ),
    "wrench_sensors_driven": Way("mj_forward, force, torque", f"{_DRIVEN}mj.mj_forward(m, d)\n{_WRENCHES}"),
    "wrench_sensors_driven:mj_step2 again": Way(
        "mj_step1, mj_step2 with other forces, force, torque",
        _DRIVEN_AGAIN + "value = [[*e.sensor(f'force{k}').data, *e.sensor(f'torque{k}').data] for k in sensed]",
    ),
    "accelerometers_driven:mj_step": Way("mj_step, accelerometer", f"{_DRIVEN}mj.mj_step(m, d)\n{_ACCELEROMETERS}"),
    "frame_poses": Way(
        "site_xpos, site_xmat",
        f"{Q}own = [m.site(f'o{{k}}').id for k in sensed]\nvalue = np.hstack([d.site_xpos[own], d.site_xmat[own]])",
    ),
    "frame_jacobians": Way(
        "mj_jacSite",
        f"{Q}value = np.zeros((len(sensed), 6, m.nv))\n"
        "for J, k in zip(value, sensed): mj.mj_jacSite(m, d, J[:3], J[3:], m.site(f'o{k}').id)",
    ),
    "applied_wrenches": Way(
        "mj_applyFT",
        f"""{Q}value = np.zeros(m.nv)
for k in sensed:
    site = m.site(f'o{{k}}').id
    R = d.site_xmat[site].reshape(3, 3)
    mj.mj_applyFT(m, d, R @ {FORCE}, R @ {MOMENT}, d.site_xpos[site], m.site_bodyid[site], value)""",
    ),
    "flexible_relation": Way("qfrc_passive, mj_step", "value = 1.0 + difference()", 1e-9),
    "joint_dampings": Way("dof_damping", "value = m.dof_damping"),
    "joint_limits": Way("jnt_range", "value = m.jnt_range"),
    "joint_limits_of_some": Way(
        "jnt_range, jnt_limited", "value = (m.jnt_range * m.jnt_limited[:, np.newaxis])[m.dof_jntid]"
    ),
    "joint_frictions": Way("dof_frictionloss", "value = m.dof_frictionloss"),
    "joint_stiffnesses": Way("jnt_stiffness", "value = m.jnt_stiffness[m.dof_jntid]"),
    "angular_accelerations": Way("frameangacc", f"{_MEASURED}value = [data('frameangacc', k) for k in sensed]"),
    "passive_forces": Way("qfrc_passive", f"{QV}value = d.qfrc_passive"),
    "tendon_lengths": Way("ten_length", f"{QV}value = d.ten_length"),
    # Entries that are not zero since the model has their places.
    "tendon_arms": Way(
        "ten_J",
        f"{QV}value = np.array(d.ten_J)\n"
        "if hasattr(m, 'ten_J_rownnz'):\n"
        "    value = np.zeros((m.ntendon, m.nv))\n"
        "    mj.mju_sparse2dense(value, np.ravel(d.ten_J), m.ten_J_rownnz, m.ten_J_rowadr, m.ten_J_colind)\n"
        "value = value.reshape(-1, m.nv)",
    ),
    "actuator_lengths": Way("actuator_length", f"{QV}value = d.actuator_length"),
    "actuator_arms": Way(
        "actuator_moment",
        # Rows of entries that are not zero since 3.2.5, which hands them out as a rectangle.
        f"{QV}value = np.array(d.actuator_moment)\n"
        "if hasattr(d, 'moment_rownnz'):\n"
        "    entries, columns = value.ravel(), np.ravel(d.moment_colind)\n"
        "    value = np.zeros((m.nu, m.nv))\n"
        "    mj.mju_sparse2dense(value, entries, d.moment_rownnz, d.moment_rowadr, columns)",
    ),
    "actuator_forces": Way("actuator_force", f"{QV}value = d.actuator_force"),
    "activation_rates": Way("act_dot", f"{QV}value = d.act_dot"),
    "activations_after_step": Way(
        "mj_step",
        f"{COPY}n.opt.timestep = {STEP}\nd.qpos[:], d.qvel[:] = q, v\nmj.mj_step(n, d)\n"
        "value = np.array(d.act)\nd.act[:] = states",
    ),
    "actuated_forces": Way("qfrc_actuator", f"{QV}value = d.qfrc_actuator"),
}
