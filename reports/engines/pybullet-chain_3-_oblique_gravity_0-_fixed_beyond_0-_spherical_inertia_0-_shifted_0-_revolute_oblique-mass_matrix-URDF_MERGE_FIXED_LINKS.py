# pybullet 3.2.7, chain 3: oblique gravity, 0: fixed beyond, 0: spherical inertia, 0: shifted, 0: revolute oblique: URDF_MERGE_FIXED_LINKS, calculateMassMatrix is wrong (M).
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile("w", suffix=".urdf")
print('<robot name="tree">\n<link name="world"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>\n<link name="a"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>\n<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>\n<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>\n<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>\n<axis xyz="0.0 0.0 1.0"/>\n</joint>\n<link name="c0"><inertial><origin xyz="1.0 0.0 0.0"/><mass value="1.0"/>\n<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>\n<joint name="joint_c0" type="fixed"><parent link="a"/><child link="c0"/>\n<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>\n</joint>\n</robot>', file=file, flush=True)
robot = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_MERGE_FIXED_LINKS | p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
gravity = True
p.setGravity(0.0, 0.0, 0.0)
joints = ()
moving = [0]
links = [0, 1]
q = np.array([0.0])
value = p.calculateMassMatrix(robot, q.tolist())
import numpy as np
value, expected = np.reshape(value, (1, 1))[(0, 0)], 3.0
assert abs(value - expected) <= 3.1e-12, f"{value = }, {expected = }"
