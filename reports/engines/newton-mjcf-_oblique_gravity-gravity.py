# newton 1.8.0, mjcf: oblique gravity: eval_inverse_dynamics_passive is wrong (g: gravity forces).
import numpy as np, warp as wp
wp.config.quiet, wp.config.log_level = True, 30
wp.config.enable_backward, wp.config.optimization_level = False, 0
import newton
TEXT = '<mujoco model="m"><compiler angle="radian" /><option gravity="1 -2 -3" /><default /><worldbody><body name="a" pos="0.1 0.2 0.3"><joint name="a" axis="0 0 1" /><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4" /><body name="b" pos="0 0 0.5"><joint name="b" axis="0 1 0" /><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4" /></body></body></worldbody></mujoco>'
b = newton.ModelBuilder()
newton.solvers.SolverMuJoCo.register_custom_attributes(b)
b.add_mjcf(TEXT)
m = b.finalize(device="cpu")
def rotation(x, y, z, w):
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * K + 2 * K @ K
bodies = [[x.split('/')[-1] for x in m.body_label].index(name) for name in ['a', 'b']]
q = np.array([0.0, 0.0])
s = m.state()
s.joint_q.assign(q.astype(np.float32))
s.joint_qd.zero_()
newton.eval_fk(m, s.joint_q, s.joint_qd, s)
gravity = wp.zeros(m.joint_dof_count, device='cpu')
newton.eval_inverse_dynamics_passive(m, s, gravity_force=gravity)
value = gravity.numpy()
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], -0.2
assert abs(value - expected) <= 2.3e-03, f"{value = }, {expected = }"
