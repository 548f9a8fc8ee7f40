# newton 1.8.0, mjcf: ranges of three joints of a body: joint_limit_lower, joint_limit_upper is wrong (least and greatest coordinates).
# Known: https://github.com/newton-physics/newton/issues/1103 (that they are made one; not its order).
import numpy as np, warp as wp
wp.config.quiet, wp.config.log_level = True, 30
wp.config.enable_backward, wp.config.optimization_level = False, 0
import newton
TEXT = '<mujoco model="m"><compiler angle="radian"/><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint axis="0 0 1" range="-1.0 0.75"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" ><joint axis="0 1 0" range="-0.5 1.25"/><joint type="slide" axis="1 0 0" range="-0.25 2"/><joint axis="1 0 0" range="-2 0.125"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></body></worldbody></mujoco>'
b = newton.ModelBuilder()
newton.solvers.SolverMuJoCo.register_custom_attributes(b)
b.add_mjcf(TEXT)
m = b.finalize(device="cpu")
def rotation(x, y, z, w):
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * K + 2 * K @ K
bodies = [[x.split('/')[-1] for x in m.body_label].index(name) for name in ['a', 'b']]
value = np.c_[m.joint_limit_lower.numpy(), m.joint_limit_upper.numpy()]
import numpy as np
value, expected = np.reshape(value, (4, 2))[(1, 1)], 1.25
assert abs(value - expected) <= 1.1e-03, f"{value = }, {expected = }"
