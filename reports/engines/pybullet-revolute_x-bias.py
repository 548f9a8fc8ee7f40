# pybullet 3.2.7, revolute x: calculateInverseDynamics is imprecise (h: Coriolis, centrifugal and gravity forces).
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile('w', suffix='.urdf')
print("""<robot name="tree"><link name="world"><inertial><mass value="0"/>
<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link><link name="a"><inertial>
<mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/></joint><link name="b"><inertial>
<mass value="1"/>
<inertia ixx="0.10427043973207122" ixy="-0.000454189254111427" ixz="-0.016110575320656788" iyy="0.13385750473995514"
iyz="-0.01328348092080805" izz="0.09889730873039354"/></inertial></link><joint name="joint_b" type="continuous">
<parent link="a"/><child link="b"/><origin rpy="0 0 1.5707963267948966"/></joint></robot>""", file=file, flush=True)
robot = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
p.setGravity(0.0, 0.0, 0.0)
q, v = np.zeros(2), np.eye(2)[1]
value, expected = p.calculateInverseDynamics(robot, q.tolist(), v.tolist(), [0.0] * len(v))[0], -0.016110575320656788
assert abs(value - expected) <= 5.5e-14, f'value = {value!r}, expected = {expected!r}'
