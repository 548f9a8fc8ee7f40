"""What Newton offers of articulations: dynamics, kinematics, a step, what its importers keep of joints and sites."""

from __future__ import annotations

from ...interface import STEP
from ..writing import copies
from ..writing.source import Way

# Warp prints what it compiles unless this is set before it starts: `quiet` of older releases, the level of newer ones.
QUIET = "wp.config.quiet, wp.config.log_level = True, 30"
# Warp compiles Newton's kernels on their first use: without their derivatives, and as they stand, it takes seconds.
PLAIN = "wp.config.enable_backward, wp.config.optimization_level = False, 0"
# Newton's import starts Warp. `b` is the builder, `m` the model.
IMPORTS = ("import numpy as np, warp as wp", QUIET, PLAIN, "import newton")
AXIS = "axis = newton.ModelBuilder.JointDofConfig"
ROTATION = (
    "def rotation(x, y, z, w):",
    "    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])",
    "    return np.eye(3) + 2 * w * K + 2 * K @ K",
)
CENTRES = ("def centres(s): return [rotation(*x[3:]) @ c for x, c in zip(s.body_q.numpy(), m.body_com.numpy())]",)
_Q = (
    "s = m.state()\ns.joint_q.assign(q.astype(np.float32))\ns.joint_qd.zero_()\n"
    "newton.eval_fk(m, s.joint_q, s.joint_qd, s)\n"
)
QV = _Q.replace("s.joint_qd.zero_()", "s.joint_qd.assign(v.astype(np.float32))")


def _passive(name: str) -> str:
    out = f"{name} = wp.zeros(m.joint_dof_count, device='cpu')"
    return f"{out}\nnewton.eval_inverse_dynamics_passive(m, s, {name}_force={name})\n"


WAYS = {
    "mass_matrix": Way("eval_mass_matrix", f"{_Q}value = newton.eval_mass_matrix(m, s).numpy()[0]"),
    "gravity": Way("eval_inverse_dynamics_passive", f"{_Q}{_passive('gravity')}value = gravity.numpy()"),
    "coriolis_forces": Way("eval_inverse_dynamics_passive", f"{QV}{_passive('coriolis')}value = coriolis.numpy()"),
    "inverse_dynamics": Way(
        "eval_inverse_dynamics_force",
        f"{QV}{_passive('gravity')}{_passive('coriolis')}out = wp.zeros(m.joint_dof_count, device='cpu')\n"
        "M = newton.eval_mass_matrix(m, s)\n"
        "newton.eval_inverse_dynamics_force(m, s, mass_matrix=M, joint_qdd=wp.array(a, dtype=float, device='cpu'),"
        " coriolis_force=coriolis, gravity_force=gravity, joint_f=out)\nvalue = out.numpy()",
    ),
    "link_poses": Way("eval_fk", f"{_Q}value = [[*x[:3], *rotation(*x[3:]).flat] for x in s.body_q.numpy()]"),
    "link_velocities": Way(
        "eval_fk",
        f"{QV}rotation\n"
        "value = [[*(x[:3] - np.cross(x[3:], r)), *x[3:]] for x, r in zip(s.body_qd.numpy(), centres(s))]",
    ),
    # Of the mass centres.
    "link_jacobians": Way(
        "eval_jacobian",
        f"""rotation
{_Q}J = newton.eval_jacobian(m, s).numpy()[0].reshape(-1, 6, len(v))
value = [np.concatenate([j[:3] - np.cross(j[3:].T, r).T, j[3:]]) for j, r in zip(J, centres(s))]""",
    ),
}
# A builder's bodies, as they stand and move, are added turned and shifted to another: seen from there nothing changes.
_ADDED = f"""{QV}rotation
b.body_q[:] = [wp.transform(wp.vec3(*x[:3]), wp.quat(*x[3:])) for x in s.body_q.numpy().tolist()]
b.body_qd[:] = [wp.spatial_vector(*x) for x in s.body_qd.numpy().tolist()]
to = newton.ModelBuilder()
to.add_builder(b, wp.transform(wp.vec3(1.0, -2.0, 0.5), wp.quat(0.0, 0.6, 0.0, 0.8)))
R, p = rotation(0.0, 0.6, 0.0, 0.8), np.array([1.0, -2.0, 0.5])
"""
_JOINED = """to = newton.ModelBuilder()
to.add_builder(b)
m = to.finalize(device="cpu")"""
WAYS |= copies.of_model(WAYS, {"add_builder": _JOINED}, ("mass_matrix", "link_poses")) | {
    "link_poses:add_builder, turned": Way(
        "add_builder, body_q",
        f"{_ADDED}value = []\nfor x in np.array(to.body_q):\n"
        "    value.append([*(R.T @ (x[:3] - p)), *(R.T @ rotation(*x[3:])).flat])",
    ),
    "link_velocities:add_builder, turned": Way(
        "add_builder, body_qd",
        f"{_ADDED}value = []\nfor x, r in zip(np.array(to.body_qd), centres(s)):\n"
        "    u, w = R.T @ x[:3], R.T @ x[3:]\n    value.append([*(u - np.cross(w, r)), *w])",
    ),
}
_FORCES = "control.joint_f.assign(tau.astype(np.float32))\n"
# Where there are actuators; targets had another name before.
DRIVEN = {
    _FORCES: """control.joint_f.assign((tau + fed).astype(np.float32))
newer = hasattr(control, 'joint_target_q')
(control.joint_target_q if newer else control.joint_target_pos).assign(places.astype(np.float32))
(control.joint_target_qd if newer else control.joint_target_vel).assign(speeds.astype(np.float32))
"""
}
WAYS["step_semi_implicit_normalized"] = Way(
    "SolverFeatherstone",
    f"""solver, after, control = newton.solvers.SolverFeatherstone(m, angular_damping=0.0), m.state(), m.control()
{QV}{_FORCES}solver.step(s, after, control, None, {STEP})
value = np.r_[after.joint_q.numpy(), after.joint_qd.numpy()]""",
)


_BACK = (
    f"{QV}q1, v1 = wp.zeros(m.joint_coord_count, device='cpu'), wp.zeros(m.joint_dof_count, device='cpu')\n"
    "newton.eval_ik(m, s, q1, v1)\n"
)
WAYS |= {
    "coordinates_of_links": Way("eval_fk, eval_ik", f"{_BACK}value = q1.numpy()"),
    "speeds_of_links": Way("eval_fk, eval_ik", f"{_BACK}value = v1.numpy()"),
    "frame_poses": Way(
        "add_site",
        f"""{_Q}rotation, sensed
value = []
for k in sensed:
    at = [x.split('/')[-1] for x in m.shape_label].index(f'o{{k}}')
    body, own = m.shape_body.numpy()[at], m.shape_transform.numpy()[at]
    x = s.body_q.numpy()[body] if body >= 0 else np.array([0.0, 0, 0, 0, 0, 0, 1])
    R = rotation(*x[3:])
    value.append([*(x[:3] + R @ own[:3]), *(R @ rotation(*own[3:])).flat])""",
    ),
    "joint_dampings": Way(
        "joint_damping, mujoco.dof_passive_damping",
        "value = m.joint_damping.numpy() if hasattr(m, 'joint_damping') else m.mujoco.dof_passive_damping.numpy()",
    ),
    "joint_speed_limits": Way("joint_velocity_limit", "value = m.joint_velocity_limit.numpy()"),
    "joint_force_limits": Way("joint_effort_limit", "value = m.joint_effort_limit.numpy()"),
    "joint_limits": Way(
        "joint_limit_lower, joint_limit_upper",
        "value = np.c_[m.joint_limit_lower.numpy(), m.joint_limit_upper.numpy()]",
    ),
    # Newton states no limit as 1e10.
    "joint_limits_of_some": Way(
        "joint_limit_lower, joint_limit_upper",
        "x = np.c_[m.joint_limit_lower.numpy(), m.joint_limit_upper.numpy()]\n"
        "value = np.where(np.abs(x) < 1e9, x, 0.0)",
    ),
    "joint_frictions": Way("joint_friction", "value = m.joint_friction.numpy()"),
    "joint_stiffnesses": Way("mujoco.dof_passive_stiffness", "value = m.mujoco.dof_passive_stiffness.numpy()"),
}
