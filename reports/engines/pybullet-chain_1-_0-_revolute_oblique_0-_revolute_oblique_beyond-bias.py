# pybullet 3.2.7, chain 1: 0: revolute oblique, 0: revolute oblique beyond: calculateInverseDynamics is imprecise (h: Coriolis, centrifugal and gravity forces).
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile("w", suffix=".urdf")
print('<robot name="tree">\n<link name="world"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>\n<link name="a"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>\n<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>\n<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>\n<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>\n<axis xyz="0.0 0.0 1.0"/>\n</joint>\n<link name="b0"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>\n<inertia ixx="0.12337353724302569" ixy="0.0022322109530813396" ixz="0.0047732866321875764" iyy="0.12338345770538674" iyz="-0.009708313207070189" izz="0.08837039481138036"/></inertial></link>\n<joint name="joint_b0" type="continuous"><parent link="a"/><child link="b0"/>\n<origin xyz="0.0 0.0 0.0" rpy="1.5707963267948966 0.0 1.5707963267948966"/>\n<axis xyz="0.0 0.0 1.0"/>\n</joint>\n</robot>', file=file, flush=True)
robot = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
gravity = True
p.setGravity(0.0, 0.0, 0.0)
joints = ()
moving = [0, 1]
links = [0, 1]
q = np.array([0.0, 0.0])
v = np.array([0.0, 1.0])
gravity
value = p.calculateInverseDynamics(robot, q.tolist(), v.tolist(), [0.0] * len(v))
import numpy as np
value, expected = np.reshape(value, (2,))[(0,)], 0.0047732866321875764
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
