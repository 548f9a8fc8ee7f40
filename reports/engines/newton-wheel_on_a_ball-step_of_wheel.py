# newton 1.8.0, wheel on a ball: SolverXPBD is imprecise (q+, v+ (nq + nv): v+ = v + h M^-1 (tau - D v); q+ = q + h N(q) v+, of unit length where it is a quaternion).
import numpy as np, warp as wp
wp.config.quiet, wp.config.log_level = True, 30
import newton
b = newton.ModelBuilder()
hasattr(b, "request_state_attributes") and b.request_state_attributes("body_parent_f")
b0 = b.add_link(mass=1.0, com=[0.0, 0.0, 0.0], inertia=wp.mat33([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), lock_inertia=True)
j0 = b.add_joint_ball(-1, b0, parent_xform=wp.transform([0.0, 0.0, 0.0], wp.quat(0.5, 0.5, 0.5, 0.5)), armature=0.0)
b.add_articulation([j0])
m = b.finalize(device="cpu")
m.gravity.zero_()
def rotation(x, y, z, w):
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * K + 2 * K @ K
def centres(s): return [rotation(*x[3:]) @ c for x, c in zip(s.body_q.numpy(), m.body_com.numpy())]
q = np.array([-0.18877504894423414, 0.6317591176355501, 0.7331581168476692, 0.16650397557065305])
v = np.array([0.0, 0.0, 0.0])
tau = np.array([-0.8948288577550136, 0.6149502567089378, 0.6266106715793658])
s = m.state()
s.joint_q.assign(q.astype(np.float32))
s.joint_qd.assign(v.astype(np.float32))
newton.eval_fk(m, s.joint_q, s.joint_qd, s)
after, control = m.state(), m.control()
control.joint_f.assign(tau.astype(np.float32))
newton.solvers.SolverXPBD(m, angular_damping=0.0).step(s, after, control, None, 0.015625)
q1, v1 = wp.zeros(m.joint_coord_count, device='cpu'), wp.zeros(m.joint_dof_count, device='cpu')
newton.eval_ik(m, after, q1, v1)
value = np.r_[q1.numpy(), v1.numpy()]
import numpy as np
value, expected = np.reshape(value, (7,))[(6,)], 0.00979079174342759
assert abs(value - expected) <= 1.0e-02, f"{value = }, {expected = }"
