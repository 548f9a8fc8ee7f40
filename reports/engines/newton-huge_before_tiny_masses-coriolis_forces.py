# newton 1.8.0, huge before tiny masses: eval_inverse_dynamics_passive is wrong (C v = h - g, C the Coriolis matrix).
import numpy as np, warp as wp
wp.config.quiet = True
import newton
b = newton.ModelBuilder(gravity=np.zeros(3))
b0 = b.add_link(mass=149152914.0, com=np.eye(3)[0], inertia=wp.mat33([[9765779.85204871, 303033.19644972985,
    392273.05491541605], [303033.19644972985, 13379296.165810723, 997742.3511289492], [392273.05491541605,
    997742.3511289492, 10444614.484902825]]), lock_inertia=True)
j0 = b.add_joint_revolute(-1, b0, parent_xform=wp.transform(np.eye(3)[0], wp.quat(0.7071067811865475, 0.0, 0.0,
    0.7071067811865476)), axis=np.eye(3)[2], armature=0.0)
b.add_articulation([j0])
m = b.finalize(device='cpu')
s = m.state()
s.joint_q.assign(np.array([-1.0]).astype(np.float32))
s.joint_qd.assign(np.array([1.0]).astype(np.float32))
newton.eval_fk(m, s.joint_q, s.joint_qd, s)
coriolis = wp.zeros(m.joint_dof_count, device='cpu')
newton.eval_inverse_dynamics_passive(m, s, coriolis_force=coriolis)
value, expected = coriolis.numpy()[0], 0.0
assert abs(value - expected) <= 2e-05, f'value = {value!r}, expected = {expected!r}'
