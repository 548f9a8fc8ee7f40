# newton 1.8.0, base 10 km away: SolverFeatherstone is wrong (q+, v+ (nq + nv) after a step: v+ = v + h M^-1 f, q+ = q + h N(q) v+ with quaternions brought to unit length).
# not finite.
import numpy as np, warp as wp
wp.config.quiet = True
import newton
b = newton.ModelBuilder(gravity=[0.0, 0.0, 0.0])
b0 = b.add_link(mass=1.0, com=[0.0, 0.0, 0.0], inertia=wp.mat33([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), lock_inertia=True)
j0 = b.add_joint_revolute(-1, b0, parent_xform=wp.transform([6400.0, -4800.0, 6000.0], wp.quat(0.5, 0.5, 0.5, 0.5)), axis=[0.0, 0.0, 1.0], armature=0.0)
b.add_articulation([j0])
m = b.finalize(device="cpu")
def rotation(x, y, z, w):
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * K + 2 * K @ K
def centres(s): return [rotation(*x[3:]) @ c for x, c in zip(s.body_q.numpy(), m.body_com.numpy())]
q = np.array([0.0])
v = np.array([0.0])
tau = np.array([0.0])
solver, after, control = newton.solvers.SolverFeatherstone(m, angular_damping=0.0), m.state(), m.control()
s = m.state()
s.joint_q.assign(q.astype(np.float32))
s.joint_qd.assign(v.astype(np.float32))
newton.eval_fk(m, s.joint_q, s.joint_qd, s)
control.joint_f.assign(tau.astype(np.float32))
solver.step(s, after, control, None, 0.015625)
value = np.r_[after.joint_q.numpy(), after.joint_qd.numpy()]
import numpy as np
value, expected = np.reshape(value, (2,))[(0,)], 0.0
assert abs(value - expected) <= 5.4e-04, f"{value = }, {expected = }"
