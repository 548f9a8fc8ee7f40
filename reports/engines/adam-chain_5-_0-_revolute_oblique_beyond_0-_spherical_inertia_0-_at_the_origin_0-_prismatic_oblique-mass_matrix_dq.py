# adam 0.5.0, chain 5: 0: revolute oblique beyond, 0: spherical inertia, 0: at the origin, 0: prismatic oblique: jacobian of mass_matrix raises (derivative of M by q, the last index that of the derivative).
import casadi as ca
import numpy as np
from adam.casadi import KinDynComputations
robot = KinDynComputations('<robot name="tree">\n<link name="world"/>\n<link name="a"><inertial><origin xyz="0.1867721934471957 0.0907901016730902 0.1293771052901697"/><mass value="1.0300170150345114"/>\n<inertia ixx="0.12670585815021812" ixy="0.002195718949208153" ixz="-0.007189489506791988" iyy="0.1174507426373282" iyz="0.0060223348725906446" izz="0.1073817099986604"/></inertial></link>\n<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>\n<origin xyz="0.09420110290152894 0.43597770070201014 -0.12596899311551946" rpy="-1.5953519774466927 1.323690570388257 1.9411947759857897"/>\n<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>\n</joint>\n<link name="b0"><inertial><origin xyz="0.06910347981430254 -0.04747986181475747 -0.1316570271442712"/><mass value="1.9173922404577186"/>\n<inertia ixx="0.125" ixy="0.0" ixz="0.0" iyy="0.125" iyz="0.0" izz="0.125"/></inertial></link>\n<joint name="joint_b0" type="prismatic"><parent link="a"/><child link="b0"/>\n<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>\n<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>\n<limit lower="-100" upper="100" effort="1e9" velocity="1e9"/>\n</joint>\n<link name="c0"><inertial><origin xyz="-0.12345242306345364 0.16272349348523885 0.051156129337902534"/><mass value="1.763426393517729"/>\n<inertia ixx="0.125" ixy="0.0" ixz="0.0" iyy="0.125" iyz="0.0" izz="0.125"/></inertial></link>\n<joint name="joint_c0" type="continuous"><parent link="b0"/><child link="c0"/>\n<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>\n<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>\n</joint>\n</robot>', ['joint_a', 'joint_b0', 'joint_c0'], gravity=np.array([0.0, 0.0, -9.81, 0.0, 0.0, 0.0]))
links = ['a', 'b0', 'c0']
def place(q):
    x, y, z, w = q[3:7]
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    H = np.eye(4)
    H[:3, 3], H[:3, :3] = q[:3], np.eye(3) + 2 * w * K + 2 * K @ K
    return H, q[7:]
q = np.array([-1.0996201868492035, -0.7565606148471162, -0.45415795612897547])
s = ca.SX.sym("s", len(q))
M = ca.SX(robot.mass_matrix(np.eye(4), s))[6:, 6:]
value = np.array(ca.Function("e", [s], [ca.densify(ca.jacobian(ca.vec(M.T), s))])(q)).reshape(*[len(q)] * 3)
