"""pybullet 3.2.7: calculateInverseDynamics, revolute x.

Result: M a + h (nv).
Known: none found.
"""

import tempfile
import numpy as np
import pybullet as p
URDF = """<robot name="tree">
<link name="world"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
<link name="a"><inertial><origin xyz="-0.1404018666962753 -0.19092806659330575 0.17522556112929938"/><mass value="1.2266489680764823"/>
<inertia ixx="0.06982435939689073" ixy="-0.01658973427411999" ixz="0.006802938969565601" iyy="0.07976249076681999" iyz="0.0047817822142631585" izz="0.09209434540359615"/></inertial></link>
<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>
<origin xyz="0.4187227849100321 -0.042594863632843705 0.05137991330073177" rpy="0.16439146218858725 0.004498316417632601 3.038935131885521"/>
<axis xyz="1.0 0.0 0.0"/>
</joint>
<link name="b"><inertial><origin xyz="0.07960795520047353 -0.17660585198000947 0.14250302570126155"/><mass value="0.9580501576643867"/>
<inertia ixx="0.10427043973207122" ixy="-0.0004541892541114282" ixz="-0.016110575320656798" iyy="0.13385750473995509" iyz="-0.01328348092080803" izz="0.09889730873039351"/></inertial></link>
<joint name="joint_b" type="continuous"><parent link="a"/><child link="b"/>
<origin xyz="0.45703653643750863 -0.1993218035085843 -0.23063526949495872" rpy="-0.19309917752748396 -1.0365159419696233 -1.619279106526382"/>
<axis xyz="1.0 0.0 0.0"/>
</joint>
<link name="c"><inertial><origin xyz="-0.00973488583866261 0.07111595685193095 -0.07424041062068767"/><mass value="1.2996781469523988"/>
<inertia ixx="0.16731308113898885" ixy="0.0010441682295465914" ixz="0.008452832396993116" iyy="0.16164713652753115" iyz="0.0038486132399073655" izz="0.19295651436717715"/></inertial></link>
<joint name="joint_c" type="continuous"><parent link="b"/><child link="c"/>
<origin xyz="-0.05395744509196876 0.2985133784854379 -0.43561875058958266" rpy="0.7194512329146989 0.3111758911959692 2.3585835483220023"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
</robot>"""
if not p.isConnected():
    p.connect(p.DIRECT)
p.setGravity(*[0.0, 0.0, -9.81])
with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
    file.write(URDF)
    file.flush()
    flags = p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER
    robot = p.loadURDF(file.name, useFixedBase=True, flags=flags)
named = {p.getJointInfo(robot, k)[12].decode(): k for k in range(p.getNumJoints(robot))}
links = [named[name] for name in ['a', 'b', 'c']]
moving = [k for k in range(p.getNumJoints(robot)) if p.getJointInfo(robot, k)[2] != p.JOINT_FIXED]

q = np.array([-1.0996201868492035, -1.8914015371177906, -0.45415795612897547])
v = np.array([-0.8020666483629364, 0.9725767279334938, 0.3881357647151733])
a = np.array([-0.10262307947376259, 0.280353617179524, -0.45902228709100545])
value = p.calculateInverseDynamics(robot, q.tolist(), v.tolist(), a.tolist())
value = np.array(value, dtype=float)
expected = np.array([-5.526719824343532, 1.930739560432528, -0.4019206296455505])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 1.1e-11
