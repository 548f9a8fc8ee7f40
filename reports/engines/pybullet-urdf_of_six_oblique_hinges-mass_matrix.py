"""pybullet 3.2.7: calculateMassMatrix, urdf of six oblique hinges.

Result: M (nv, nv).
Known: none found.
"""

import tempfile
import numpy as np
import pybullet as p
TEXT = """<robot name="tree">
<link name="world"/>
<link name="a"><inertial><origin xyz="0.14278158331427288 0.04196637594131275 0.030994887309065966"/><mass value="1.958879878851547"/>
<inertia ixx="0.1224069483563255" ixy="-0.011628602419154753" ixz="-0.00926743378566904" iyy="0.10139826419408349" iyz="0.00289322763181357" izz="0.15423795703901963"/></inertial></link>
<joint name="joint_a" type="revolute"><limit lower="-100" upper="100" effort="1e9" velocity="1e9"/><parent link="world"/><child link="a"/>
<origin xyz="0.4251267354686801 -0.4065070910715157 0.03575902711846135" rpy="1.5609144082888189 0.07560875977755452 -2.9340930464220265"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
<link name="b"><inertial><origin xyz="0.19599634045069747 0.11990693366431315 0.18728393439558916"/><mass value="1.1875955282066122"/>
<inertia ixx="0.11378928815148479" ixy="-0.007031663351734548" ixz="0.01916364793030287" iyy="0.12459731624656191" iyz="-0.00030172694346266985" izz="0.10688163349390029"/></inertial></link>
<joint name="joint_b" type="revolute"><limit lower="-100" upper="100" effort="1e9" velocity="1e9"/><parent link="a"/><child link="b"/>
<origin xyz="-0.4728087612025075 -0.06584169359436276 -0.21499683257618707" rpy="0.569889213900827 0.8360131821416522 2.2385621657822026"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
<link name="c"><inertial><origin xyz="0.04653629515361096 -0.10096865521140007 0.05572741289455563"/><mass value="1.1326423262331269"/>
<inertia ixx="0.0967953282483475" ixy="-0.005545898205040607" ixz="-0.023711433545020907" iyy="0.1276575208066392" iyz="-0.0014062797489538792" izz="0.08672843853853733"/></inertial></link>
<joint name="joint_c" type="revolute"><limit lower="-100" upper="100" effort="1e9" velocity="1e9"/><parent link="b"/><child link="c"/>
<origin xyz="-0.3852507367758685 -0.11321987404753353 -0.17921588183564796" rpy="-0.29178702686870767 -0.22031240044980316 2.9895134388550777"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
<link name="d"><inertial><origin xyz="0.13682755628084176 0.13897905398206223 0.1340557546801328"/><mass value="0.8386305353908096"/>
<inertia ixx="0.13401469616110778" ixy="-0.017878786585045714" ixz="-0.004588104770198323" iyy="0.12193768744626927" iyz="-0.025081594532004224" izz="0.09297602172311123"/></inertial></link>
<joint name="joint_d" type="revolute"><limit lower="-100" upper="100" effort="1e9" velocity="1e9"/><parent link="c"/><child link="d"/>
<origin xyz="-0.07778272883744453 -0.48596702665941705 -0.1068608723910971" rpy="-1.5979947659748672 -0.9107714651566244 -2.074852265052646"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
<link name="e"><inertial><origin xyz="0.047041557556793206 -0.11971988222730211 0.08417778730158021"/><mass value="1.8378975301814644"/>
<inertia ixx="0.11864237904211732" ixy="-0.0024125713193824923" ixz="0.0191391356511282" iyy="0.09562807109568419" iyz="-0.011168099654714844" izz="0.1411162291960272"/></inertial></link>
<joint name="joint_e" type="revolute"><limit lower="-100" upper="100" effort="1e9" velocity="1e9"/><parent link="d"/><child link="e"/>
<origin xyz="-0.2625966452370956 -0.46897164377793643 0.12607775925950038" rpy="-1.4570925872680582 -0.746616634870251 3.0421176296620565"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
<link name="f"><inertial><origin xyz="-0.11237209815081349 0.11891945327588271 -0.020137822126002375"/><mass value="1.71806319992605"/>
<inertia ixx="0.15727047121949073" ixy="0.019310295934101718" ixz="-0.014111754060132993" iyy="0.14520200744996636" iyz="-0.010279360262678982" izz="0.13847677033957329"/></inertial></link>
<joint name="joint_f" type="revolute"><limit lower="-100" upper="100" effort="1e9" velocity="1e9"/><parent link="e"/><child link="f"/>
<origin xyz="-0.35204059774373153 0.3484303658991934 -0.09713627998503938" rpy="0.7247328080205684 -0.29760541917751465 -1.8033072384010345"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
</robot>"""
if not p.isConnected():
    p.connect(p.DIRECT)
p.setGravity(*[0.0, 0.0, -9.81])
with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
    file.write(TEXT)
    file.flush()
    flags = p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER
    robot = p.loadURDF(file.name, useFixedBase=True, flags=flags)
named = {p.getJointInfo(robot, k)[12].decode(): k for k in range(p.getNumJoints(robot))}
links = [named[name] for name in ['a', 'b', 'c', 'd', 'e', 'f']]
moving = [k for k in range(p.getNumJoints(robot)) if p.getJointInfo(robot, k)[2] != p.JOINT_FIXED]

q = np.array([-1.0996201868492035, -1.8914015371177906, -0.45415795612897547, -2.005166620907341, 0.9703394117879331, 0.7008840429488101])
value = p.calculateMassMatrix(robot, q.tolist())
value = np.array(value, dtype=float)
value = value[0, 1]
expected = -1.9760551970934144
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 7.6e-12
