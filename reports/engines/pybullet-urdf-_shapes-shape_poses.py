# pybullet 3.2.7, urdf: shapes: getCollisionShapeData is imprecise (positions and rows of R of what links collide by, in the world (n, 12)).
# Known: https://github.com/bulletphysics/bullet3/issues/2246.
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile("w", suffix=".urdf")
print('<robot name="r"><link name="world"/><link name="a"><inertial><origin xyz="0.1 -0.2 0.3"/><mass value="2"/><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/></inertial><collision><origin xyz="0.25 -0.5 0.125" rpy="0.5 0.6 0.7"/><geometry><box size="0.4 0.6 1.2"/></geometry></collision></link><link name="b"><inertial><origin xyz="0 0.1 0.2"/><mass value="1"/><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/></inertial><collision><origin xyz="0 0.5 -0.25"/><geometry><cylinder radius="0.2" length="0.7"/></geometry></collision><collision><origin rpy="0.3 -0.4 0.5"/><geometry><sphere radius="0.25"/></geometry></collision></link><joint name="joint_a" type="revolute"><parent link="world"/><child link="a"/><origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5"/><axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="9" velocity="9"/></joint><joint name="joint_b" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0 0.5"/><axis xyz="0 1 0"/><limit lower="-9" upper="9" effort="9" velocity="9"/></joint></robot>', file=file, flush=True)
robot = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
gravity = True
p.setGravity(0.0, 0.0, -9.81)
joints = ()
moving = [0, 1]
links = [0, 1]
joints = [p.getJointInfo(robot, k) for k in range(p.getNumJoints(robot))]
sensed = [joint[0] for name in ['o0', 'o1', 'o2'] for joint in joints if joint[12].decode() == name]
q = np.array([0.0, 0.0])
joints
for k, position, speed in zip(moving, q, 0 * q): p.resetJointState(robot, k, position, speed)
states = [p.getLinkState(robot, k, computeLinkVelocity=1, computeForwardKinematics=1) for k in links]
value = []
for k, s in zip(links, states):
    for shape in p.getCollisionShapeData(robot, k):
        x, turn = p.multiplyTransforms(s[0], s[1], *shape[5:7])
        value.append([*x, *p.getMatrixFromQuaternion(turn)])
import numpy as np
value, expected = np.reshape(value, (3, 12))[(0, 7)], 0.3308743563625361
assert abs(value - expected) <= 1.3e-12, f"{value = }, {expected = }"
