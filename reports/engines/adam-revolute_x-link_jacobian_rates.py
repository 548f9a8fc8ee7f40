"""adam 0.5.0: jacobian_dot, revolute x.

Result: their time derivatives (L, 6, nv).
Known: none found.
"""

import numpy as np
from adam.casadi import KinDynComputations
URDF = """<robot name="tree">
<link name="world"/>
<link name="a"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>
<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>
<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>
<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>
<axis xyz="1.0 0.0 0.0"/>
</joint>
<link name="b"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>
<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>
<joint name="joint_b" type="continuous"><parent link="a"/><child link="b"/>
<origin xyz="0.0 1.0 0.0" rpy="0.0 0.0 0.0"/>
<axis xyz="1.0 0.0 0.0"/>
</joint>
</robot>"""
robot = KinDynComputations(URDF, ['joint_a', 'joint_b'], gravity=np.array([0.0, 0.0, 0.0] + [0, 0, 0]))
links = ['a', 'b']
cut = 6
def place(q):
    H = np.eye(4)
    if cut == 0:
        x, y, z, w = q[3:7]
        K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        H[:3, 3], H[:3, :3] = q[:3], np.eye(3) + 2 * w * K + 2 * K @ K
    return H, q[7 - 7 * (cut > 0):]
def move(v): return (v[:6], v[6:]) if cut == 0 else (np.zeros(6), v)

q = np.array([0.0, 0.0])
v = np.array([0.0, 1.0])
value = np.array([robot.jacobian_dot_fun(name)(*place(q), *move(v)) for name in links])[:, :, cut:]
value = np.array(value, dtype=float)
value = value[1, 1, 0]
expected = 0.0
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 1.4e-12
