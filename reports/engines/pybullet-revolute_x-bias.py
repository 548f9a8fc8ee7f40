"""pybullet 3.2.7: calculateInverseDynamics, revolute x.

Result: h (nv): Coriolis, centrifugal and gravity forces.
Known: none found.
"""

import tempfile
import numpy as np
import pybullet as p
TEXT = """<robot name="tree">
<link name="world"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
<link name="a"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>
<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>
<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>
<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>
<axis xyz="1.0 0.0 0.0"/>
</joint>
<link name="b"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>
<inertia ixx="0.10427043973207122" ixy="-0.0004541892541114282" ixz="-0.016110575320656798" iyy="0.13385750473995509" iyz="-0.01328348092080803" izz="0.09889730873039351"/></inertial></link>
<joint name="joint_b" type="continuous"><parent link="a"/><child link="b"/>
<origin xyz="0.0 0.0 0.0" rpy="-0.19309917752748396 -1.0365159419696233 -1.619279106526382"/>
<axis xyz="1.0 0.0 0.0"/>
</joint>
</robot>"""
if not p.isConnected():
    p.connect(p.DIRECT)
p.setGravity(*[0.0, 0.0, 0.0])
with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
    file.write(TEXT)
    file.flush()
    flags = p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER
    robot = p.loadURDF(file.name, useFixedBase=True, flags=flags)
named = {p.getJointInfo(robot, k)[12].decode(): k for k in range(p.getNumJoints(robot))}
links = [named[name] for name in ['a', 'b']]
moving = [k for k in range(p.getNumJoints(robot)) if p.getJointInfo(robot, k)[2] != p.JOINT_FIXED]

q = np.array([0.0, -1.8914015371177906])
v = np.array([0.0, 1.0])
value = p.calculateInverseDynamics(robot, q.tolist(), v.tolist(), [0.0] * len(v))
value = np.array(value, dtype=float)
expected = np.array([-0.008878573516621972, 0.0])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 1.7e-14
