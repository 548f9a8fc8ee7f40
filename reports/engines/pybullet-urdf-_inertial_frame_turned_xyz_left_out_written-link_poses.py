# pybullet 3.2.7, urdf: inertial frame turned, xyz left out, written: getLinkState is wrong (positions and rows of R).
# Known: https://github.com/bulletphysics/bullet3/issues/4240.
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile("w", suffix=".urdf")
print('<robot name="r"><link name="world" /><link name="a"><inertial><origin rpy="0.5 0.6 0.7" /><mass value="2" /><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4" /></inertial></link><link name="b"><inertial><origin xyz="0 0.1 0.2" /><mass value="1" /><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4" /></inertial></link><joint name="joint_a" type="revolute"><parent link="world" /><child link="a" /><origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5" /><axis xyz="0 0 1" /><limit lower="-9" upper="9" effort="9" velocity="9" /></joint><joint name="joint_b" type="revolute"><parent link="a" /><child link="b" /><origin xyz="0 0 0.5" /><axis xyz="0 1 0" /><limit lower="-9" upper="9" effort="9" velocity="9" /></joint></robot>', file=file, flush=True)
robot = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
from pybullet_utils.urdfEditor import UrdfEditor
editor, written = UrdfEditor(), NamedTemporaryFile("r", suffix=".urdf")
editor.initializeFromBulletBody(robot, 0)
editor.saveUrdf(written.name)
robot = p.loadURDF(written.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
gravity = True
p.setGravity(0.0, 0.0, -9.81)
joints = ()
moving = [0, 1]
links = [0, 1]
q = np.array([1.0, 0.0])
joints
for k, position, speed in zip(moving, q, 0 * q): p.resetJointState(robot, k, position, speed)
states = [p.getLinkState(robot, k, computeLinkVelocity=1, computeForwardKinematics=1) for k in links]
value = [[*s[4], *p.getMatrixFromQuaternion(s[5])] for s in states]
import numpy as np
value, expected = np.reshape(value, (2, 12))[(1, 8)], -0.43770193066667445
assert abs(value - expected) <= 1.5e-12, f"{value = }, {expected = }"
