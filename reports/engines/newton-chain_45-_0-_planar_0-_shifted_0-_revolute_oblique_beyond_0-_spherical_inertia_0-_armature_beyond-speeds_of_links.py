# newton 1.8.0, chain 45: 0: planar, 0: shifted, 0: revolute oblique beyond, 0: spherical inertia, 0: armature beyond: eval_fk, eval_ik is wrong (v, of the velocities that the links have there).
import numpy as np, warp as wp
wp.config.quiet, wp.config.log_level = True, 30
wp.config.enable_backward, wp.config.optimization_level = False, 0
import newton
b = newton.ModelBuilder(gravity=[0.0, 0.0, 0.0])
b0 = b.add_link(mass=1.0, com=[0.0, 0.0, 0.0], inertia=wp.mat33([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), lock_inertia=True)
b1 = b.add_link(mass=1.0, com=[0.0, 0.0, 0.0], inertia=wp.mat33([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), lock_inertia=True)
j0 = b.add_joint_revolute(-1, b0, axis=[0.0, 0.0, 1.0], armature=0.0)
axis = newton.ModelBuilder.JointDofConfig
j1 = b.add_joint_d6(b0, b1, linear_axes=[axis(axis=[1.0, 0.0, 0.0], armature=0.0, target_ke=0, target_kd=0), axis(axis=[0.0, 1.0, 0.0], armature=0.0, target_ke=0, target_kd=0)], angular_axes=[axis(axis=[0.0, 0.0, 1.0], armature=0.0, target_ke=0, target_kd=0)])
b.add_articulation([j0, j1])
m = b.finalize(device="cpu")
def rotation(x, y, z, w):
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * K + 2 * K @ K
def centres(s): return [rotation(*x[3:]) @ c for x, c in zip(s.body_q.numpy(), m.body_com.numpy())]
q = np.array([0.0, 0.0, 1.0, 0.0])
v = np.array([1.0, 0.0, 0.0, 0.0])
s = m.state()
s.joint_q.assign(q.astype(np.float32))
s.joint_qd.assign(v.astype(np.float32))
newton.eval_fk(m, s.joint_q, s.joint_qd, s)
q1, v1 = wp.zeros(m.joint_coord_count, device='cpu'), wp.zeros(m.joint_dof_count, device='cpu')
newton.eval_ik(m, s, q1, v1)
value = v1.numpy()
import numpy as np
value, expected = np.reshape(value, (4,))[(1,)], 0.0
assert abs(value - expected) <= 7.8e-04, f"{value = }, {expected = }"
