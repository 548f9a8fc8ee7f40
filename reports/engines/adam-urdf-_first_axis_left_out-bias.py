# adam 0.5.0, urdf: first axis left out: bias_force raises (h: Coriolis, centrifugal and gravity forces).
import casadi as ca
import numpy as np
from adam.casadi import KinDynComputations
robot = KinDynComputations('<robot name="r"><link name="world" /><link name="a"><inertial><origin xyz="0.1 -0.2 0.3" /><mass value="2" /><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4" /></inertial></link><link name="b"><inertial><origin xyz="0 0.1 0.2" /><mass value="1" /><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4" /></inertial></link><joint name="joint_a" type="revolute"><parent link="world" /><child link="a" /><origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5" /><limit lower="-9" upper="9" effort="9" velocity="9" /></joint><joint name="joint_b" type="revolute"><parent link="a" /><child link="b" /><origin xyz="0 0 0.5" /><axis xyz="0 1 0" /><limit lower="-9" upper="9" effort="9" velocity="9" /></joint></robot>', ['joint_a', 'joint_b'], gravity=np.array([0.0, 0.0, -9.81, 0.0, 0.0, 0.0]))
links = ['a', 'b']
def place(q):
    x, y, z, w = q[3:7]
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    H = np.eye(4)
    H[:3, 3], H[:3, :3] = q[:3], np.eye(3) + 2 * w * K + 2 * K @ K
    return H, q[7:]
