# adam 0.5.0, chain 1: 0: revolute oblique, 0: revolute oblique beyond: jacobian_dot is wrong (their time derivatives).
import casadi as ca
import numpy as np
from adam.casadi import KinDynComputations
robot = KinDynComputations('<robot name="tree">\n<link name="world"/>\n<link name="a"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>\n<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>\n<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>\n<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>\n<axis xyz="0.0 0.0 1.0"/>\n</joint>\n<link name="b0"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>\n<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>\n<joint name="joint_b0" type="continuous"><parent link="a"/><child link="b0"/>\n<origin xyz="1.0 0.0 0.0" rpy="0.0 0.0 0.0"/>\n<axis xyz="0.0 0.0 1.0"/>\n</joint>\n</robot>', ['joint_a', 'joint_b0'], gravity=np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
links = ['a', 'b0']
def place(q):
    x, y, z, w = q[3:7]
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    H = np.eye(4)
    H[:3, 3], H[:3, :3] = q[:3], np.eye(3) + 2 * w * K + 2 * K @ K
    return H, q[7:]
q = np.array([0.0, 0.0])
v = np.array([0.0, 1.0])
value = np.array([robot.jacobian_dot_fun(name)(np.eye(4), q, np.zeros(6), v) for name in links])[:, :, 6:]
import numpy as np
value, expected = np.reshape(value, (2, 6, 2))[(1, 0, 0)], 0.0
assert abs(value - expected) <= 1.4e-12, f"{value = }, {expected = }"
