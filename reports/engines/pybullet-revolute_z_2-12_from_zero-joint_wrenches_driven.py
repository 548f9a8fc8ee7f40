# pybullet 3.2.7, revolute z, 2^-12 from zero: getJointState: joint reaction forces is imprecise (joint_wrenches at the accelerations that tau makes).
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile("w", suffix=".urdf")
print('<robot name="tree">\n<link name="world"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>\n<link name="a"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>\n<inertia ixx="0.07133442261297289" ixy="-0.002104074483713474" ixz="-0.021915829957424506" iyy="0.0948390596036314" iyz="-0.004426401417523481" izz="0.08404951345326031"/></inertial></link>\n<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>\n<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>\n<axis xyz="1.0 0.0 0.0"/>\n</joint>\n</robot>', file=file, flush=True)
robot = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
gravity = True
p.setGravity(0.0, 0.0, 0.0)
joints = ()
moving = [0]
links = [0]
q = np.array([0.0])
v = np.array([-0.019581705282298252])
tau = np.array([0.0])
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
value, expected = np.reshape(value, (1, 6))[(0, 4)], 8.403475569847063e-06
assert abs(value - expected) <= 5.0e-07, f"{value = }, {expected = }"
