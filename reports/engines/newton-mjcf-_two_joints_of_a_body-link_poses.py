# newton 1.8.0, mjcf: two joints of a body: eval_fk is wrong (positions and rows of R).
# Known: https://github.com/newton-physics/newton/issues/1103 (that they are made one; not its order).
import numpy as np, warp as wp
wp.config.quiet = True
import newton
TEXT = '<mujoco model="m"><compiler angle="radian"/><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint axis="0 0 1"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" ><joint axis="0 1 0"/><joint type="slide" axis="1 0 0"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></body></worldbody></mujoco>'
b = newton.ModelBuilder()
b.add_mjcf(TEXT)
m = b.finalize(device="cpu")
def rotation(x, y, z, w):
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * K + 2 * K @ K
bodies = [[x.split('/')[-1] for x in m.body_label].index(name) for name in ['a', 'b']]
q = np.array([0.0, 0.0, 1.0])
s = m.state()
s.joint_q.assign(q.astype(np.float32))
s.joint_qd.zero_()
newton.eval_fk(m, s.joint_q, s.joint_qd, s)
value = [[*x[:3], *rotation(*x[3:]).flat] for x in s.body_q.numpy()[bodies]]
import numpy as np
value, expected = np.reshape(value, (2, 12))[(1, 0)], 1.1
assert abs(value - expected) <= 8.3e-04, f"{value = }, {expected = }"
