"""newton 1.8.0: eval_mass_matrix, universal with armature.

Result: M (nv, nv).
Known: none found.
"""

import numpy as np
import warp as wp
wp.config.quiet = True
import newton
b = newton.ModelBuilder(gravity=[0.0, 0.0, 0.0])
def X(p, x, y, z, w): return wp.transform(p, wp.quat(x, y, z, w))
def axis(direction, armature=0.0):
    return newton.ModelBuilder.JointDofConfig(axis=direction, armature=armature, target_ke=0, target_kd=0)
b0 = b.add_link(mass=1.0, com=[0.0, 0.0, 0.0], inertia=wp.mat33([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), lock_inertia=True)
joints = []
joints.append(b.add_joint_d6(-1, b0, parent_xform=X([0.0, 0.0, 0.0], 0.0, 0.0, 0.0, 1.0), child_xform=X([0.0, 0.0, 0.0], 0.0, 0.0, 0.0, 1.0), linear_axes=[], angular_axes=[axis([1.0, 0.0, 0.0]), axis([0.0, 1.0, 0.0])]))
b.add_articulation(joints)
m = b.finalize(device="cpu")
def state(q, v=None):
    s = m.state()
    s.joint_q.assign(np.array(q, dtype=np.float32))
    s.joint_qd.assign(np.zeros(m.joint_dof_count, np.float32) if v is None else np.array(v, dtype=np.float32))
    newton.eval_fk(m, s.joint_q, s.joint_qd, s)
    return s
q = np.array([0.0, 0.0])
value = newton.eval_mass_matrix(m, state(q)).numpy()[0]
value = np.array(value, dtype=float)
expected = np.array([[2.0, 0.0], [0.0, 2.0]])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 4.0e-05
