# adam 0.5.0, chain 4: free base, 0: turned, 0: prismatic oblique, 0: fixed beyond: forward_kinematics is wrong (positions and rows of R).
import casadi as ca
import numpy as np
from adam.casadi import KinDynComputations
robot = KinDynComputations('<robot name="tree">\n<link name="world"/>\n<link name="b0"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>\n<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>\n<joint name="joint_b0" type="prismatic"><parent link="world"/><child link="b0"/>\n<origin xyz="0.0 0.0 0.0" rpy="1.5707963267948966 0.0 1.5707963267948966"/>\n<axis xyz="0.0 0.0 1.0"/>\n<limit lower="-100" upper="100" effort="1e9" velocity="1e9"/>\n</joint>\n</robot>', ['joint_b0'], gravity=np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
links = ['b0']
def place(q):
    x, y, z, w = q[3:7]
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    H = np.eye(4)
    H[:3, 3], H[:3, :3] = q[:3], np.eye(3) + 2 * w * K + 2 * K @ K
    return H, q[7:]
q = np.array([1.0])
value = []
for name in links:
    H = np.array(robot.forward_kinematics_fun(name)(np.eye(4), q))
    value.append([*H[:3, 3], *H[:3, :3].flat])
import numpy as np
value, expected = np.reshape(value, (1, 12))[(0, 0)], 1.0
assert abs(value - expected) <= 1.5e-12, f"{value = }, {expected = }"
