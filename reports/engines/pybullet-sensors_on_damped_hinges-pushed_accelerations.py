# pybullet 3.2.7, sensors on damped hinges: applyExternalForce, applyExternalTorque, LINK_FRAME is imprecise (accelerations by tau and applied_wrenches).
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile("w", suffix=".urdf")
print('<robot name="tree">\n<link name="world"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>\n<link name="c"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>\n<inertia ixx="0.059919098917389495" ixy="-0.0060137079325191" ixz="-0.012562816999437332" iyy="0.06824262295639015" iyz="-0.006489971765421695" izz="0.05947494642865026"/></inertial></link>\n<joint name="joint_c" type="continuous"><parent link="world"/><child link="c"/>\n<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>\n<axis xyz="0.0 0.0 1.0"/>\n</joint>\n<link name="o0"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>\n<joint name="frame_0" type="fixed"><parent link="c"/><child link="o0"/>\n<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>\n</joint>\n</robot>', file=file, flush=True)
robot = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
gravity = True
p.setGravity(0.0, 0.0, 0.0)
joints = ()
moving = [0]
links = [0]
joints = [p.getJointInfo(robot, k) for k in range(p.getNumJoints(robot))]
sensed = [joint[0] for name in ['o0'] for joint in joints if joint[12].decode() == name]
q = np.array([0.0])
v = np.array([0.0])
tau = np.array([0.0])
gravity
joints
p.setTimeStep(0.015625)
for k in range(-1, p.getNumJoints(robot)):
    p.changeDynamics(robot, k, linearDamping=0, angularDamping=0, maxJointVelocity=1e9)
for k, position, speed, force in zip(moving, q, v, tau):
    p.resetJointState(robot, k, position, speed)
    p.setJointMotorControl2(robot, k, p.VELOCITY_CONTROL, force=0)
    p.setJointMotorControl2(robot, k, p.TORQUE_CONTROL, force=force)
for k in sensed:
    p.applyExternalForce(robot, k, [1.0, -2.0, 3.0], [0, 0, 0], p.LINK_FRAME)
    p.applyExternalTorque(robot, k, [0.5, -0.25, 0.75], p.LINK_FRAME)
p.stepSimulation()
value = (np.array([p.getJointState(robot, k)[1] for k in moving]) - v) / 0.015625
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], 12.610351837806954
assert abs(value - expected) <= 1.9e-11, f"{value = }, {expected = }"
