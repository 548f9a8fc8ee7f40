# newton 1.8.0, millimetres: eval_inverse_dynamics_passive is wrong (C v = h - g, C the Coriolis matrix).
import numpy as np, warp as wp
wp.config.quiet = True
import newton
b = newton.ModelBuilder(gravity=np.zeros(3))
b0 = b.add_link(mass=1.0, com=np.zeros(3), inertia=wp.mat33(np.eye(3)), lock_inertia=True)
b1 = b.add_link(mass=1.0, com=np.zeros(3), inertia=wp.mat33([[1.4176586036222517e-16, -9.179437276663084e-18,
    -2.1797232902586208e-17], [-9.179437276663084e-18, 1.3614809591212705e-16, -8.263564708340657e-18],
    [-2.1797232902586208e-17, -8.263564708340657e-18, 1.4611189783779985e-16]]), lock_inertia=True)
j0 = b.add_joint_revolute(-1, b0, axis=np.eye(3)[2], armature=0.0)
j1 = b.add_joint_revolute(b0, b1, parent_xform=wp.transform(np.zeros(3), wp.quat(0.5, 0.5, 0.5, 0.5)),
    axis=np.eye(3)[2], armature=0.0)
b.add_articulation([j0, j1])
m = b.finalize(device='cpu')
s = m.state()
s.joint_q.assign(np.array([0.0, -2.0]).astype(np.float32))
s.joint_qd.assign(np.eye(2)[1].astype(np.float32))
newton.eval_fk(m, s.joint_q, s.joint_qd, s)
coriolis = wp.zeros(m.joint_dof_count, device='cpu')
newton.eval_inverse_dynamics_passive(m, s, coriolis_force=coriolis)
value, expected = coriolis.numpy()[0], 1.5568113921908623e-18
assert abs(value - expected) <= 3.1e-23, f'value = {value!r}, expected = {expected!r}'
