# adam 0.5.0, joints against x, y and z: jacobian of mass_matrix raises (derivative of M by q, the last index that of the derivative).
import casadi as ca
import numpy as np
from adam.casadi import KinDynComputations
robot = KinDynComputations('<robot name="tree">\n<link name="world"/>\n<link name="a"><inertial><origin xyz="0.18511263396686511 -0.14689018510822782 -0.10956066905473145"/><mass value="0.6897776108598774"/>\n<inertia ixx="0.13146142344632425" ixy="0.002626907947230278" ixz="0.012960667883250763" iyy="0.13671435245940772" iyz="0.00905083004304389" izz="0.13703608696887884"/></inertial></link>\n<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>\n<origin xyz="-0.06275199987049129 -0.015055673022711935 -0.4348458026298925" rpy="-0.025400454402088248 -0.39353506175099107 2.456431728759886"/>\n<axis xyz="0.0 0.0 -1.0"/>\n</joint>\n<link name="b"><inertial><origin xyz="0.06907010103228828 0.12009974029303244 -0.11216932342009463"/><mass value="1.649700886220237"/>\n<inertia ixx="0.09579983689418664" ixy="-0.0179860186670436" ixz="-0.007530552024438762" iyy="0.05875128903701363" iyz="-0.013436316150795286" izz="0.09427307197477025"/></inertial></link>\n<joint name="joint_b" type="prismatic"><parent link="a"/><child link="b"/>\n<origin xyz="0.2825909153281315 0.4877407468945767 0.48623854928023846" rpy="0.07356765918999668 1.0628483815877965 1.740619078671256"/>\n<axis xyz="-1.0 0.0 0.0"/>\n<limit lower="-100" upper="100" effort="1e9" velocity="1e9"/>\n</joint>\n<link name="c"><inertial><origin xyz="-0.17813443970937196 -0.1496709701499259 0.16183510788361322"/><mass value="1.0658297054799024"/>\n<inertia ixx="0.14525944185935963" ixy="-0.0073162722990339595" ixz="0.0001464110783800823" iyy="0.14289595971997757" iyz="0.00025073824140078686" izz="0.15171590610242566"/></inertial></link>\n<joint name="joint_c" type="continuous"><parent link="b"/><child link="c"/>\n<origin xyz="0.2928578804972283 -0.30491360652095345 -0.4377465025833366" rpy="0.8392282802127735 -0.546509864670304 -1.675892084694669"/>\n<axis xyz="0.0 -1.0 0.0"/>\n</joint>\n</robot>', ['joint_a', 'joint_b', 'joint_c'], gravity=np.array([0.0, 0.0, -9.81, 0.0, 0.0, 0.0]))
links = ['a', 'b', 'c']
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
