# newton 1.8.0, mjcf: main class before childclass: joint_damping, mujoco.dof_passive_damping is wrong (force of dampers for a unit of speed).
# Known: https://github.com/newton-physics/newton/pull/3687.
import numpy as np, warp as wp
wp.config.quiet, wp.config.log_level = True, 30
wp.config.enable_backward, wp.config.optimization_level = False, 0
import newton
TEXT = '<mujoco model="m"><compiler angle="radian" /><option /><default><joint damping="0.5" /><default class="k"><joint damping="3" frictionloss="0.25" armature="0.5" /></default></default><worldbody><body name="a" pos="0.1 0.2 0.3"><joint name="a" axis="0 0 1" /><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4" /><body name="b" pos="0 0 0.5" childclass="k"><joint name="b" axis="0 1 0" class="main" /><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4" /></body></body></worldbody></mujoco>'
b = newton.ModelBuilder()
newton.solvers.SolverMuJoCo.register_custom_attributes(b)
b.add_mjcf(TEXT)
m = b.finalize(device="cpu")
def rotation(x, y, z, w):
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * K + 2 * K @ K
bodies = [[x.split('/')[-1] for x in m.body_label].index(name) for name in ['a', 'b']]
value = m.joint_damping.numpy() if hasattr(m, 'joint_damping') else m.mujoco.dof_passive_damping.numpy()
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], 0.5
assert abs(value - expected) <= 4.8e-04, f"{value = }, {expected = }"
