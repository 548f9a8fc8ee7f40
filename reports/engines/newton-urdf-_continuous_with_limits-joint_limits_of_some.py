# newton 1.8.0, urdf: continuous with limits: joint_limit_lower, joint_limit_upper is wrong (the same where not all joints have limits: zeros for none).
import numpy as np, warp as wp
wp.config.quiet, wp.config.log_level = True, 30
wp.config.enable_backward, wp.config.optimization_level = False, 0
import newton
TEXT = '<robot name="r"><link name="world" /><link name="a"><inertial><origin xyz="0.1 -0.2 0.3" /><mass value="2" /><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4" /></inertial></link><link name="b"><inertial><origin xyz="0 0.1 0.2" /><mass value="1" /><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4" /></inertial></link><joint name="joint_a" type="revolute"><parent link="world" /><child link="a" /><origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5" /><axis xyz="0 0 1" /><limit lower="-9" upper="9" effort="9" velocity="9" /></joint><joint name="joint_b" type="continuous"><parent link="a" /><child link="b" /><origin xyz="0 0 0.5" /><axis xyz="0 1 0" /><limit lower="-9" upper="9" effort="9" velocity="9" /></joint></robot>'
b = newton.ModelBuilder()
newton.solvers.SolverMuJoCo.register_custom_attributes(b)
b.add_urdf(TEXT)
m = b.finalize(device="cpu")
def rotation(x, y, z, w):
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * K + 2 * K @ K
bodies = [[x.split('/')[-1] for x in m.body_label].index(name) for name in ['a', 'b']]
x = np.c_[m.joint_limit_lower.numpy(), m.joint_limit_upper.numpy()]
value = np.where(np.abs(x) < 1e9, x, 0.0)
import numpy as np
value, expected = np.reshape(value, (2, 2))[(1, 0)], 0.0
assert abs(value - expected) <= 4.8e-03, f"{value = }, {expected = }"
