# pybullet 3.2.7, mass changed: calculateInverseDynamics is wrong (h: Coriolis, centrifugal and gravity forces).
# Known: https://github.com/bulletphysics/bullet3/issues/4809.
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile("w", suffix=".urdf")
print('<robot name="tree">\n<link name="world"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>\n<link name="a"><inertial><origin xyz="0.0 1.0 0.0"/><mass value="2.0"/>\n<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>\n<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>\n<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>\n<axis xyz="1.0 0.0 0.0"/>\n</joint>\n</robot>', file=file, flush=True)
robot = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
gravity = True
p.setGravity(0.0, 0.0, -9.81)
joints = ()
moving = [0]
links = [0]
joints
for k, mass in zip(links, [2.0]): p.changeDynamics(robot, k, mass=mass, localInertiaDiagonal=p.getDynamicsInfo(robot, k)[2])
p.calculateMassMatrix(robot, [0.0]); p.calculateInverseDynamics(robot, [0.0], [0.0], [0.0])
for k, mass in zip(links, [1.0]): p.changeDynamics(robot, k, mass=mass, localInertiaDiagonal=p.getDynamicsInfo(robot, k)[2])
q = np.array([0.0])
v = np.array([0.0])
gravity
value = p.calculateInverseDynamics(robot, q.tolist(), v.tolist(), [0.0] * len(v))
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], 9.81
assert abs(value - expected) <= 1.4e-11, f"{value = }, {expected = }"
