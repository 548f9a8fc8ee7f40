# pybullet 3.2.7, chain 1: 0: revolute oblique, 0: revolute oblique beyond: getLinkStates is imprecise (positions and rows of R).
# Known: https://github.com/bulletphysics/bullet3/issues/2246.
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile("w", suffix=".urdf")
print('<robot name="tree">\n<link name="world"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>\n<link name="a"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>\n<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>\n<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>\n<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>\n<axis xyz="0.0 0.0 1.0"/>\n</joint>\n</robot>', file=file, flush=True)
robot = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
gravity = True
p.setGravity(0.0, 0.0, 0.0)
joints = ()
moving = [0]
links = [0]
q = np.array([1.0])
joints
for k, position, speed in zip(moving, q, 0 * q): p.resetJointState(robot, k, position, speed)
states = [p.getLinkState(robot, k, computeLinkVelocity=1, computeForwardKinematics=1) for k in links]
states = p.getLinkStates(robot, links, computeForwardKinematics=1)
value = [[*s[4], *p.getMatrixFromQuaternion(s[5])] for s in states]
import numpy as np
value, expected = np.reshape(value, (1, 12))[(0, 3)], 0.5403023058681398
assert abs(value - expected) <= 1.4e-12, f"{value = }, {expected = }"
