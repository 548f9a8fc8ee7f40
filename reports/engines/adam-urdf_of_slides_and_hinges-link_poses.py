"""adam 0.5.0: forward_kinematics, urdf of slides and hinges.

Result: positions and rows of R (L, 12).
Known: none found.
"""

import numpy as np
from adam.casadi import KinDynComputations
URDF = """<robot name="tree">
<link name="world"/>
<link name="a"><inertial><origin xyz="-0.0968180164956039 -0.033241583746758924 -0.018553551258689405"/><mass value="0.6602769110356099"/>
<inertia ixx="0.11468067143847203" ixy="-0.018610640285244152" ixz="-0.005278304573701506" iyy="0.12878999421776724" iyz="-0.014074970303142838" izz="0.14123883534190113"/></inertial></link>
<joint name="joint_a" type="revolute"><limit lower="-100" upper="100" effort="1e9" velocity="1e9"/><parent link="world"/><child link="a"/>
<origin xyz="0.3581304890839089 -0.49717296781337994 0.04146616171879425" rpy="-0.051627618710464826 0.7136950486716324 1.5802258672913192"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
<link name="b"><inertial><origin xyz="-0.07044197914636957 -0.13190149137455814 0.11215312051724191"/><mass value="1.1285105720172022"/>
<inertia ixx="0.14797401045540023" ixy="-0.003411896662493406" ixz="-0.003439911738982019" iyy="0.16958631822892425" iyz="-0.00414082655877092" izz="0.1614285923850921"/></inertial></link>
<joint name="joint_b" type="prismatic"><parent link="a"/><child link="b"/>
<origin xyz="0.44560068129860597 -0.3649121374907345 0.100110285529601" rpy="-0.2552010118198077 -0.14479097327457754 2.4569811530095484"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
<limit lower="-100" upper="100" effort="1e9" velocity="1e9"/>
</joint>
<link name="c"><inertial><origin xyz="-0.15901456740992842 -0.03821086511841468 0.10536086551208823"/><mass value="1.7282158351024437"/>
<inertia ixx="0.15979498219493055" ixy="-0.011569791617949222" ixz="-0.026229933574684804" iyy="0.13804566170266444" iyz="0.006609509734345607" izz="0.15528090246491197"/></inertial></link>
<joint name="joint_c" type="revolute"><limit lower="-100" upper="100" effort="1e9" velocity="1e9"/><parent link="b"/><child link="c"/>
<origin xyz="-0.06346367804383157 -0.20889285145900183 0.4186639262189912" rpy="-0.8197807354339477 0.23676938160705732 -2.0171863380647927"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
<link name="d"><inertial><origin xyz="0.1555157469114517 -0.01553628531125803 0.11783655564498696"/><mass value="1.5451327931156162"/>
<inertia ixx="0.1460125919233471" ixy="-0.0016978636483513001" ixz="-0.0034210498068833724" iyy="0.1654867789272636" iyz="0.008466924337293721" izz="0.15578061823167666"/></inertial></link>
<joint name="joint_d" type="prismatic"><parent link="c"/><child link="d"/>
<origin xyz="0.021341606641042232 -0.37856688037495745 -0.39160620410857894" rpy="-0.4674143892806835 0.9010002139308898 -2.629548948019568"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
<limit lower="-100" upper="100" effort="1e9" velocity="1e9"/>
</joint>
</robot>"""
robot = KinDynComputations(URDF, ['joint_a', 'joint_b', 'joint_c', 'joint_d'], gravity=np.array([0.0, 0.0, -9.81] + [0, 0, 0]))
links = ['a', 'b', 'c', 'd']
cut = 6
def place(q):
    H = np.eye(4)
    if cut == 0:
        x, y, z, w = q[3:7]
        K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        H[:3, 3], H[:3, :3] = q[:3], np.eye(3) + 2 * w * K + 2 * K @ K
    return H, q[7 - 7 * (cut > 0):]

q = np.array([-1.0996201868492035, -0.7565606148471162, -0.45415795612897547, -0.8020666483629364])
value = []
for name in links:
    H = np.array(robot.forward_kinematics_fun(name)(*place(q)))
    value.append([*H[:3, 3], *H[:3, :3].flat])
value = np.array(value, dtype=float)
value = value[3, 0]
expected = 2.072954319273854
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 2.7e-12
