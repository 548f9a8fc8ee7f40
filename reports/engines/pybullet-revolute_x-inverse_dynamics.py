# pybullet 3.2.7, revolute x: calculateInverseDynamics is imprecise (M a + h).
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile('w', suffix='.urdf')
print("""<robot name="tree"><link name="world"><inertial><mass value="0"/>
<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link><link name="b"><inertial>
<mass value="1"/>
<inertia ixx="0.10427043973207122" ixy="-0.000454189254111427" ixz="-0.016110575320656788" iyy="0.13385750473995514"
iyz="-0.01328348092080805" izz="0.09889730873039354"/></inertial></link><joint name="joint_b" type="continuous">
<parent link="world"/><child link="b"/></joint></robot>""", file=file, flush=True)
robot = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
p.setGravity(0.0, 0.0, 0.0)
q, v, a = np.zeros(1), np.zeros(1), np.array([1.0])
value, expected = p.calculateInverseDynamics(robot, q.tolist(), v.tolist(), a.tolist())[0], 0.10427043973207122
assert abs(value - expected) <= 1.6e-13, f'value = {value!r}, expected = {expected!r}'
