"""adam 0.5.0: forward_kinematics, prismatic.

Result: positions and rows of R (L, 12).
Known: none found.
"""

import numpy as np
from adam.casadi import KinDynComputations
URDF = """<robot name="tree">
<link name="world"/>
<link name="b"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>
<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>
<joint name="joint_b" type="prismatic"><parent link="world"/><child link="b"/>
<origin xyz="0.0 0.0 0.0" rpy="0.2769146668176534 0.7837812268751835 2.8873039704780177"/>
<axis xyz="1.0 0.0 0.0"/>
<limit lower="-100" upper="100" effort="1e9" velocity="1e9"/>
</joint>
</robot>"""
robot = KinDynComputations(URDF, ['joint_b'], gravity=np.array([0.0, 0.0, 0.0] + [0, 0, 0]))
links = ['b']
cut = 6
def place(q):
    H = np.eye(4)
    if cut == 0:
        x, y, z, w = q[3:7]
        K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        H[:3, 3], H[:3, :3] = q[:3], np.eye(3) + 2 * w * K + 2 * K @ K
    return H, q[7 - 7 * (cut > 0):]

q = np.array([1.0])
value = []
for name in links:
    H = np.array(robot.forward_kinematics_fun(name)(*place(q)))
    value.append([*H[:3, 3], *H[:3, :3].flat])
value = np.array(value, dtype=float)
expected = np.array([[-0.685473663273498, 0.17816506577433916, -0.7059625105457346, -0.685473663273498, -0.42876960695067395, -0.5884577139555361, 0.17816506577433916, -0.8824199425591392, 0.43542192676937014, -0.7059625105457346, 0.1936276558998996, 0.6812673957960073]])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 1.2e-12
