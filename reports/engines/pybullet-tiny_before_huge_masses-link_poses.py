"""pybullet 3.2.7: getLinkState, tiny before huge masses.

Result: positions and rows of R (L, 12).
Known: none found.
"""

import tempfile
import numpy as np
import pybullet as p
URDF = """<robot name="tree">
<link name="world"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
<link name="a"><inertial><origin xyz="-0.043857032141920355 -0.025771785288849852 0.18949070573878773"/><mass value="1.4915291416321192e-08"/>
<inertia ixx="9.765779852048707e-10" ixy="3.0303319644972916e-11" ixz="3.9227305491541414e-11" iyy="1.337929616581072e-09" iyz="9.977423511289496e-11" izz="1.0444614484902822e-09"/></inertial></link>
<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>
<origin xyz="-0.10630118327969384 0.4338787789537393 0.22442791313431198" rpy="-1.3415850775791558 0.271557081433571 -2.403017756122648"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
<link name="b"><inertial><origin xyz="-0.1283722546678156 0.0949056874359388 0.10892053953403968"/><mass value="1.8591085792217488"/>
<inertia ixx="0.096539397300591" ixy="-0.005210450773638082" ixz="0.010080265189673521" iyy="0.0944448580153586" iyz="-0.010289222977134582" izz="0.10898194686955136"/></inertial></link>
<joint name="joint_b" type="continuous"><parent link="a"/><child link="b"/>
<origin xyz="-0.29201092170432674 0.13683653478638447 0.463003385311357" rpy="0.11515837233568155 -0.116502610353313 -2.649674263193215"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
<link name="c"><inertial><origin xyz="-0.019364999761275092 0.09971227485872952 0.04898263116168783"/><mass value="100378416.58760902"/>
<inertia ixx="8293886.6642755475" ixy="446310.22794028063" ixz="17191.491387894825" iyy="10777446.711564956" iyz="161690.41300888296" izz="7448261.148841642"/></inertial></link>
<joint name="joint_c" type="continuous"><parent link="b"/><child link="c"/>
<origin xyz="0.34367642557584577 0.11571147817626115 -0.4279731263960814" rpy="-0.9770584858244159 -0.8928293526963702 2.9678483408936254"/>
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
def states(q, v):
    for k, position, speed in zip(moving, q, v):
        p.resetJointState(robot, k, position, speed)
    return [p.getLinkState(robot, k, computeLinkVelocity=1, computeForwardKinematics=1) for k in links]

q = np.array([-1.0996201868492035, -1.8914015371177906, -0.45415795612897547])
value = [[*s[4], *p.getMatrixFromQuaternion(s[5])] for s in states(q, np.zeros(len(q)))]
value = np.array(value, dtype=float)
value = value[2, 7]
expected = -0.24588888408361295
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 2.1e-12
