# adam 0.5.0, prismatic: jacobian of mass_matrix raises (derivative of M by q, the last index that of the derivative).
import casadi as ca
import numpy as np
from adam.casadi import KinDynComputations
robot = KinDynComputations('<robot name="tree">\n<link name="world"/>\n<link name="a"><inertial><origin xyz="0.010806543682752745 0.17484419426677955 -0.008603338305321284"/><mass value="1.799117970234311"/>\n<inertia ixx="0.12403625814500127" ixy="-0.0025639609443399505" ixz="-0.00080587103692776" iyy="0.11336050173272094" iyz="-0.003736048684044071" izz="0.12347699983223076"/></inertial></link>\n<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>\n<origin xyz="-0.49613635983294624 -0.14001725618426675 0.4361110898594589" rpy="0.1039359591702811 0.21460053883892918 -1.7339099695229154"/>\n<axis xyz="1.0 0.0 0.0"/>\n</joint>\n<link name="b"><inertial><origin xyz="0.01831025946523046 0.091819374729179 0.0939248830227511"/><mass value="0.9541402434914962"/>\n<inertia ixx="0.1647026974199732" ixy="0.01107870547624153" ixz="-0.007552207606221068" iyy="0.13020968512062234" iyz="0.0019104618855247902" izz="0.1110189992041518"/></inertial></link>\n<joint name="joint_b" type="prismatic"><parent link="a"/><child link="b"/>\n<origin xyz="0.08126313426573739 -0.47750992045335894 -0.24366934823316" rpy="0.27691466681765375 0.7837812268751834 2.8873039704780177"/>\n<axis xyz="1.0 0.0 0.0"/>\n<limit lower="-100" upper="100" effort="1e9" velocity="1e9"/>\n</joint>\n<link name="c"><inertial><origin xyz="0.19372455779802306 -0.13718970171274605 0.048232790329033964"/><mass value="0.7414713846425609"/>\n<inertia ixx="0.16748359549999556" ixy="-0.0007211169855986452" ixz="0.013439485756905727" iyy="0.14178729590988226" iyz="-0.0030432960179629875" izz="0.1374281924426779"/></inertial></link>\n<joint name="joint_c" type="continuous"><parent link="b"/><child link="c"/>\n<origin xyz="-0.29432789881187726 0.07756064595130163 0.4621771052747403" rpy="0.28229005017475073 0.28388112995443027 1.6563725781611458"/>\n<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>\n</joint>\n</robot>', ['joint_a', 'joint_b', 'joint_c'], gravity=np.array([0.0, 0.0, -9.81, 0.0, 0.0, 0.0]))
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
