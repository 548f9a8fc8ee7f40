# pybullet 3.2.7, chain 1: 0: revolute oblique, 0: revolute oblique beyond: loadURDF: basePosition, baseOrientation is imprecise (positions and rows of R).
# Known: https://github.com/bulletphysics/bullet3/issues/2246.
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile("w", suffix=".urdf")
print('<robot name="tree">\n<link name="world"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>\n<link name="a"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>\n<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>\n<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>\n<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>\n<axis xyz="0.0 0.0 1.0"/>\n</joint>\n</robot>', file=file, flush=True)
robot = p.loadURDF(file.name, basePosition=[0.5, -0.25, 1.0], baseOrientation=[0.1, -0.7, 0.5, 0.5], useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
gravity = True
p.setGravity(0.0, 0.0, 0.0)
joints = ()
moving = [0]
links = [0]
q = np.array([0.0])
joints
for k, position, speed in zip(moving, q, 0 * q): p.resetJointState(robot, k, position, speed)
states = [p.getLinkState(robot, k, computeLinkVelocity=1, computeForwardKinematics=1) for k in links]
base = p.invertTransform([0.5, -0.25, 1.0], [0.1, -0.7, 0.5, 0.5])
at = [p.multiplyTransforms(*base, *s[4:6]) for s in states]
value = [[*x, *p.getMatrixFromQuaternion(turn)] for x, turn in at]
import numpy as np
value, expected = np.reshape(value, (1, 12))[(0, 0)], 0.0
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
