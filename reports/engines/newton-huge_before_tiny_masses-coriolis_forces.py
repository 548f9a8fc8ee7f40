"""newton 1.8.0: eval_inverse_dynamics_passive, huge before tiny masses.

Result: C v = h - g (nv), C the Coriolis matrix.
Known: none found.
"""

import numpy as np
import warp as wp
wp.config.quiet = True
import newton
b = newton.ModelBuilder(gravity=[0.0, 0.0, 0.0])
def X(p, x, y, z, w): return wp.transform(p, wp.quat(x, y, z, w))
b0 = b.add_link(mass=149152914.0, com=[0.0, 1.0, 0.0], inertia=wp.mat33([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), lock_inertia=True)
joints = []
joints.append(b.add_joint_revolute(-1, b0, parent_xform=X([1.0, 0.0, 0.0], 0.0, 0.0, 0.0, 1.0), child_xform=X([0.0, 0.0, 0.0], 0.0, 0.0, 0.0, 1.0), axis=[0.6666666666666666, -0.3333333333333333, 0.6666666666666666], armature=0.0))
b.add_articulation(joints)
m = b.finalize(device="cpu")
def state(q, v=None):
    s = m.state()
    s.joint_q.assign(np.array(q, dtype=np.float32))
    s.joint_qd.assign(np.zeros(m.joint_dof_count, np.float32) if v is None else np.array(v, dtype=np.float32))
    newton.eval_fk(m, s.joint_q, s.joint_qd, s)
    return s
def passive(name, q, v=None):
    out = wp.zeros(m.joint_dof_count, dtype=float, device="cpu")
    newton.eval_inverse_dynamics_passive(m, state(q, v), **{name: out})
    return out
q = np.array([0.0])
v = np.array([1.0])
value = passive('coriolis_force', q, v).numpy()
value = np.array(value, dtype=float)
expected = np.array([0.0])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 3.8e-05
