# pybullet 3.2.7, chain 1: 0: revolute oblique, 0: revolute oblique beyond: getJointState: joint reaction forces is wrong (joint_wrenches at the accelerations that tau makes).
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile("w", suffix=".urdf")
print('<robot name="tree">\n<link name="world"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>\n<link name="a"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>\n<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>\n<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>\n<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>\n<axis xyz="0.0 0.0 1.0"/>\n</joint>\n<link name="b0"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>\n<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>\n<joint name="joint_b0" type="continuous"><parent link="a"/><child link="b0"/>\n<origin xyz="1.0 0.0 0.0" rpy="0.0 0.0 0.0"/>\n<axis xyz="0.0 0.0 1.0"/>\n</joint>\n</robot>', file=file, flush=True)
robot = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
gravity = True
p.setGravity(0.0, 0.0, 0.0)
joints = ()
moving = [0, 1]
links = [0, 1]
q = np.array([0.0, 0.0])
v = np.array([1.0, 1.0])
tau = np.array([0.0, 0.0])
gravity
joints
p.setTimeStep(5.960464477539063e-08)
for k in range(-1, p.getNumJoints(robot)):
    p.changeDynamics(robot, k, linearDamping=0, angularDamping=0, maxJointVelocity=1e9)
for k, position, speed, force in zip(moving, q, v, tau):
    p.resetJointState(robot, k, position, speed)
    p.setJointMotorControl2(robot, k, p.VELOCITY_CONTROL, force=0)
    p.setJointMotorControl2(robot, k, p.TORQUE_CONTROL, force=force)
for k in links: p.enableJointForceTorqueSensor(robot, k, 1)
p.stepSimulation()
value = []
for k in links:
    info, held = p.getDynamicsInfo(robot, k), np.reshape(p.getJointState(robot, k)[2], (2, 3))
    force, moment = held @ np.reshape(p.getMatrixFromQuaternion(info[4]), (3, 3)).T
    value.append([*force, *(moment + np.cross(info[3], force))])
    p.enableJointForceTorqueSensor(robot, k, 0)
import numpy as np
value, expected = np.reshape(value, (2, 6))[(0, 0)], -1.0
assert abs(value - expected) <= 1.0e-06, f"{value = }, {expected = }"
