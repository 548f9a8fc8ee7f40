"""MuJoCo's steps, forces of a model's own, and sensors: what is asked of trees that move by themselves or measure."""

from __future__ import annotations

from ...interface import STEP, Steps
from ...truth.sensed import WRENCH
from ..writing.source import Way, ways_of

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
_INTEGRATOR = "n.opt.integrator = mj.mjtIntegrator.mjINT_{}\n"
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


def _states_after(integrator: str) -> str:
    """Actuators' states after a step, with an integrator of a model of its own."""
    return (
        f"{COPY}n.opt.timestep, n.opt.integrator = {STEP}, mj.mjtIntegrator.{integrator}\n"
        f"d.qpos[:], d.qvel[:] = q, v\nmj.mj_step(n, d)\nvalue = np.array(d.act){_AS_BEFORE}"
    )


def _step(integrator: str, settings: str = "") -> Way:
    """A step of mj_step, with options of a model of its own."""
    code = f"{COPY}n.opt.timestep, n.opt.integrator = {STEP}, mj.mjtIntegrator.{integrator}"
    state = "d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau"
    return Way(
        f"mj_step, {integrator}",
        f"{code}\n{settings}{state}\nmj.mj_step(n, d)\nvalue = np.r_[d.qpos, d.qvel]{_AS_BEFORE}",
    )


_TRANSITIONS = {
    f"step_{step}": Way("mjd_transitionFD", f"{transition(STEP, settings)}value = {rows}", Steps(of, 1e-6, 1e-9))
    for step, of, settings, rows in (
        ("dampers_implicit_derivative", "step_dampers_implicit", "", "A"),
        ("dampers_implicit_control_derivative", "step_dampers_implicit", "", "B[:2 * m.nv]"),
        ("velocities_implicit_derivative", "step_velocities_implicit", _INTEGRATOR.format("IMPLICIT"), "A"),
        ("forces_implicit_derivative", "step_forces_implicit", _INTEGRATOR.format("IMPLICITFAST"), "A"),
    )
}
WAYS = (
    {
        "step_dampers_implicit": _step("mjINT_EULER"),
        "step_semi_implicit": _step("mjINT_EULER", EXPLICIT),
        "step_velocities_implicit": _step("mjINT_IMPLICIT"),
        "step_forces_implicit": _step("mjINT_IMPLICITFAST"),
        "step_velocities_implicit:sparse": _step("mjINT_IMPLICIT", SPARSE),
        "step_forces_implicit:sparse": _step("mjINT_IMPLICITFAST", SPARSE),
    }
    | _TRANSITIONS
    | {
        # Tendons and actuators that couple joints are solved for by iterations.
        "step_stiffness_implicit_lone": _step("mjINT_DISCRETE", "n.opt.tolerance = 0.0\n"),
        "step_rk4_manifold": _step("mjINT_RK4"),
    }
    | ways_of(f"""
== joint_wrenches | mj_rnePostConstraint: cfrc_int | {QVA}mj.mj_rnePostConstraint(m, d)\n{_HELD}
== joint_wrenches_driven | mj_forward, mj_rnePostConstraint: cfrc_int
{_DRIVEN}mj.mj_forward(m, d)
mj.mj_rnePostConstraint(m, d)
{_HELD}
== subtree_momenta | mj_subtreeVel
{QV}mj.mj_subtreeVel(m, d)
value = [[*(m.body_subtreemass[b] * d.subtree_linvel[b]), *d.subtree_angmom[b]] for b in bs]
== accelerometers | accelerometer | {_MEASURED}value = [data('accelerometer', k) for k in sensed]
== gyroscopes | gyro | {_MEASURED}value = [data('gyro', k) for k in sensed]
== velocimeters | velocimeter | {_MEASURED}value = [data('velocimeter', k) for k in sensed]
== wrench_sensors | force, torque | {_MEASURED}{_WRENCHES}
== accelerometers_driven | mj_forward, accelerometer | {_DRIVEN}mj.mj_forward(m, d)\n{_ACCELEROMETERS}
== accelerometers_driven:mj_step2 | mj_step1, mj_step2, accelerometer
{_DRIVEN}mj.mj_step1(m, d); mj.mj_step2(m, d)
{_ACCELEROMETERS}
== # Other forces before, then forces that are known after the first half of a step only.
== accelerometers_driven:mj_step2 again | mj_step1, mj_step2 with other forces, accelerometer
{_DRIVEN_AGAIN}value = [e.sensor(f'accelerometer{{k}}').data for k in sensed]
== angular_accelerations_driven | mj_forward, frameangacc
{_DRIVEN}mj.mj_forward(m, d)
value = [data('frameangacc', k) for k in sensed]
== angular_accelerations_driven:mj_step2 again | mj_step1, mj_step2 with other forces, frameangacc
{_DRIVEN_AGAIN}value = [e.sensor(f'frameangacc{{k}}').data for k in sensed]
== wrench_sensors_driven | mj_forward, force, torque | {_DRIVEN}mj.mj_forward(m, d)\n{_WRENCHES}
== wrench_sensors_driven:mj_step2 again | mj_step1, mj_step2 with other forces, force, torque
{_DRIVEN_AGAIN}value = [[*e.sensor(f'force{{k}}').data, *e.sensor(f'torque{{k}}').data] for k in sensed]
== accelerometers_driven:mj_step | mj_step, accelerometer | {_DRIVEN}mj.mj_step(m, d)\n{_ACCELEROMETERS}
== frame_poses | site_xpos, site_xmat
{Q}own = [m.site(f'o{{k}}').id for k in sensed]
value = np.hstack([d.site_xpos[own], d.site_xmat[own]])
== frame_jacobians | mj_jacSite
{Q}value = np.zeros((len(sensed), 6, m.nv))
for J, k in zip(value, sensed): mj.mj_jacSite(m, d, J[:3], J[3:], m.site(f'o{{k}}').id)
== applied_wrenches | mj_applyFT
{Q}value = np.zeros(m.nv)
for k in sensed:
    site = m.site(f'o{{k}}').id
    R = d.site_xmat[site].reshape(3, 3)
    mj.mj_applyFT(m, d, R @ {FORCE}, R @ {MOMENT}, d.site_xpos[site], m.site_bodyid[site], value)
== flexible_relation ~ 1e-09 | qfrc_passive, mj_step | value = 1.0 + difference()
== joint_dampings | dof_damping | value = m.dof_damping
== joint_limits | jnt_range | value = m.jnt_range
== joint_limits_of_some | jnt_range, jnt_limited | value = (m.jnt_range * m.jnt_limited[:, np.newaxis])[m.dof_jntid]
== joint_frictions | dof_frictionloss | value = m.dof_frictionloss
== joint_stiffnesses | jnt_stiffness | value = m.jnt_stiffness[m.dof_jntid]
== angular_accelerations | frameangacc | {_MEASURED}value = [data('frameangacc', k) for k in sensed]
== passive_forces | qfrc_passive | {QV}value = d.qfrc_passive
== tendon_lengths | ten_length | {QV}value = d.ten_length
== # Entries that are not zero since the model has their places.
== tendon_arms | ten_J
{QV}value = np.array(d.ten_J)
if hasattr(m, 'ten_J_rownnz'):
    value = np.zeros((m.ntendon, m.nv))
    mj.mju_sparse2dense(value, np.ravel(d.ten_J), m.ten_J_rownnz, m.ten_J_rowadr, m.ten_J_colind)
value = value.reshape(-1, m.nv)
== actuator_lengths | actuator_length | {QV}value = d.actuator_length
== # Rows of entries that are not zero since 3.2.5, which hands them out as a rectangle.
== actuator_arms | actuator_moment
{QV}value = np.array(d.actuator_moment)
if hasattr(d, 'moment_rownnz'):
    entries, columns = value.ravel(), np.ravel(d.moment_colind)
    value = np.zeros((m.nu, m.nv))
    mj.mju_sparse2dense(value, entries, d.moment_rownnz, d.moment_rowadr, columns)
== actuator_forces | actuator_force | {QV}value = d.actuator_force
== activation_rates | act_dot | {QV}value = d.act_dot
== activations_after_step | mj_step\n{_states_after("mjINT_EULER")}
== activations_after_step:RK4 | mj_step, mjINT_RK4\n{_states_after("mjINT_RK4")}
== actuated_forces | qfrc_actuator | {QV}value = d.qfrc_actuator
""")
)
