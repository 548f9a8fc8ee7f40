"""adam 0.5.0: gravity_term, urdf: axis of length 2.

Result: g (nv): gravity forces.
Known: none found.
"""

import numpy as np
from adam.casadi import KinDynComputations
URDF = """<robot name="r"><link name="w"/><link name="a"><inertial><origin xyz="0.1 -0.2 0.3"/><mass value="2"/><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/></inertial></link><link name="b"><inertial><origin xyz="0 0.1 0.2"/><mass value="1"/><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/></inertial></link><joint name="joint_a" type="revolute"><parent link="w"/><child link="a"/><origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5"/><axis xyz="1.2 0 1.6"/><limit lower="-9" upper="9" effort="9" velocity="9"/></joint><joint name="joint_b" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0 0.5"/><axis xyz="0 1 0"/><limit lower="-9" upper="9" effort="9" velocity="9"/></joint></robot>"""
robot = KinDynComputations(URDF, ['joint_a', 'joint_b'], gravity=np.array([0.0, 0.0, -9.81] + [0, 0, 0]))
cut = 6
def place(q):
    H = np.eye(4)
    if cut == 0:
        x, y, z, w = q[3:7]
        K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        H[:3, 3], H[:3, :3] = q[:3], np.eye(3) + 2 * w * K + 2 * K @ K
    return H, q[7 - 7 * (cut > 0):]

q = np.array([-1.0996201868492035, -1.8914015371177906])
value = np.array(robot.gravity_term_fun()(*place(q))).squeeze(-1)[cut:]
value = np.array(value, dtype=float)
expected = np.array([-0.5855789379766183, 1.5981007262313927])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 2.3e-12
