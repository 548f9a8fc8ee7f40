# newton 1.8.0, wheel on a hinge: SolverXPBD, body_parent_f is wrong (force and moment on the body of what holds it, along the world's axes, at rest under tau).
import numpy as np, warp as wp
wp.config.quiet, wp.config.log_level = True, 30
import newton
b = newton.ModelBuilder()
hasattr(b, "request_state_attributes") and b.request_state_attributes("body_parent_f")
b0 = b.add_link(mass=1.0, com=[0.0, 0.0, 0.0], inertia=wp.mat33([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), lock_inertia=True)
j0 = b.add_joint_revolute(-1, b0, axis=[0.6, 0.0, 0.8], armature=0.0)
b.add_articulation([j0])
m = b.finalize(device="cpu")
m.gravity.zero_()
def rotation(x, y, z, w):
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * K + 2 * K @ K
def centres(s): return [rotation(*x[3:]) @ c for x, c in zip(s.body_q.numpy(), m.body_com.numpy())]
q = np.array([1.0])
v = np.array([0.0])
tau = np.array([0.0])
s = m.state()
s.joint_q.assign(q.astype(np.float32))
s.joint_qd.assign((0 * v).astype(np.float32))
newton.eval_fk(m, s.joint_q, s.joint_qd, s)
after, control = m.state(), m.control()
control.joint_f.assign(tau.astype(np.float32))
newton.solvers.SolverXPBD(m, angular_damping=0.0).step(s, after, control, None, 0.015625)
value = after.body_parent_f.numpy()[0]
import numpy as np
value, expected = np.reshape(value, (6,))[(4,)], 0.0
assert abs(value - expected) <= 1.0e-03, f"{value = }, {expected = }"
