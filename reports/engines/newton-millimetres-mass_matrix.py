# newton 1.8.0, millimetres: eval_mass_matrix is wrong (M).
import numpy as np, warp as wp
wp.config.quiet = True
import newton
b = newton.ModelBuilder(gravity=np.zeros(3))
b0 = b.add_link(mass=1.0, com=np.zeros(3), inertia=wp.mat33([[1.5387418968542935e-16, -1.040257262437649e-18,
    -7.580033460432243e-18], [-1.040257262437649e-18, 1.570376058065325e-16, 7.857115752477788e-18],
    [-7.580033460432243e-18, 7.857115752477788e-18, 1.848297784889552e-16]]), lock_inertia=True)
j0 = b.add_joint_revolute(-1, b0, axis=np.eye(3)[2], armature=0.0)
b.add_articulation([j0])
m = b.finalize(device='cpu')
s = m.state()
s.joint_q.assign(np.zeros(1).astype(np.float32))
s.joint_qd.zero_()
newton.eval_fk(m, s.joint_q, s.joint_qd, s)
value, expected = newton.eval_mass_matrix(m, s).numpy()[0][0, 0], 1.848297784889552e-16
assert abs(value - expected) <= 3.7e-21, f'value = {value!r}, expected = {expected!r}'
