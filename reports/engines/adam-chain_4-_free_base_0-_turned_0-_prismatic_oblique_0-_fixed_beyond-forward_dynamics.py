# adam 0.5.0, chain 4: free base, 0: turned, 0: prismatic oblique, 0: fixed beyond: aba raises (M^-1 (tau - h)).
import casadi as ca
import numpy as np
from adam.casadi import KinDynComputations
robot = KinDynComputations('<robot name="tree">\n<link name="a"><inertial><origin xyz="-0.11316279137896057 0.1670422795864347 -0.1443513855964166"/><mass value="1.9857909388046384"/>\n<inertia ixx="0.1344463412077271" ixy="0.007199729735247461" ixz="-0.011706131232554283" iyy="0.13266375631184033" iyz="0.011204964779399156" izz="0.09553475255897532"/></inertial></link>\n<link name="b0"><inertial><origin xyz="-0.1848596517105967 -0.016833646427195065 0.12122954278643722"/><mass value="1.8662441394838676"/>\n<inertia ixx="0.1280018292939448" ixy="-0.006096328129756258" ixz="0.005696759708423076" iyy="0.14037661960466366" iyz="0.014596157468502395" izz="0.10267436264175726"/></inertial></link>\n<joint name="joint_b0" type="prismatic"><parent link="a"/><child link="b0"/>\n<origin xyz="0.0 0.0 0.0" rpy="-1.6345106730282974 -0.1321994681133433 -1.7152333963763822"/>\n<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>\n<limit lower="-100" upper="100" effort="1e9" velocity="1e9"/>\n</joint>\n<link name="c0"><inertial><origin xyz="0.03484549304555595 0.0835216204865839 -0.02556236411238144"/><mass value="1.7886296792306497"/>\n<inertia ixx="0.09812414707628125" ixy="0.005074672356185505" ixz="-0.0005044661666692065" iyy="0.12718585349000758" iyz="-0.008098089354440787" izz="0.1064178080947721"/></inertial></link>\n<joint name="joint_c0" type="fixed"><parent link="b0"/><child link="c0"/>\n<origin xyz="0.0 0.0 0.0" rpy="-0.522675001005824 -1.1971750329119761 -1.8980551590524462"/>\n</joint>\n</robot>', ['joint_b0'], gravity=np.array([0.0, 0.0, -9.81, 0.0, 0.0, 0.0]))
links = ['a', 'b0', 'c0']
def place(q):
    x, y, z, w = q[3:7]
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    H = np.eye(4)
    H[:3, 3], H[:3, :3] = q[:3], np.eye(3) + 2 * w * K + 2 * K @ K
    return H, q[7:]
q = np.array([-0.43984807473968135, -0.07770658039411571, -0.7565606148471162, 0.273294341638708, 0.3567708494566067, -0.42174035036639745, -0.7875022797929568, -0.8948288577550136])
v = np.array([0.6266106715793658, -0.9900567750811642, -0.33988931180500503, -0.821826286778075, -0.0641061844211126, 0.23537891976009928, 0.10209612590551109])
tau = np.array([-0.710473452573168, -0.2428584944462442, -0.48155231111019514, 0.2324192618491383, 0.3891087769682364, 0.4077886105995967, 0.547772126580389])
value = np.array(ca.evalf(robot.aba(*place(q), v[:6], v[6:], tau[6:], {links[0]: tau[:6]}))).squeeze(-1)
