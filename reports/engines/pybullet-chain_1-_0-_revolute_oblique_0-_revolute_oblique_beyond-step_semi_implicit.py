# pybullet 3.2.7, chain 1: 0: revolute oblique, 0: revolute oblique beyond: stepSimulation is imprecise (q+, v+ (nq + nv) after a step: v+ = v + h M^-1 f, f = tau + Q - (bias); q+ where v+ leads in h).
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile("w", suffix=".urdf")
print('<robot name="tree">\n<link name="world"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>\n<link name="b0"><inertial><origin xyz="0.0 1.0 0.0"/><mass value="1.0"/>\n<inertia ixx="0.12337353724302569" ixy="0.0022322109530813396" ixz="0.0047732866321875764" iyy="0.12338345770538674" iyz="-0.009708313207070189" izz="0.08837039481138036"/></inertial></link>\n<joint name="joint_b0" type="continuous"><parent link="world"/><child link="b0"/>\n<origin xyz="0.0 0.0 0.0" rpy="1.5707963267948966 0.0 1.5707963267948966"/>\n<axis xyz="0.0 0.0 1.0"/>\n</joint>\n</robot>', file=file, flush=True)
robot = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
gravity = True
p.setGravity(0.0, 0.0, -9.81)
joints = ()
moving = [0]
links = [0]
q = np.array([1.0])
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
p.stepSimulation()
states = p.getJointStates(robot, moving)
value = [*(s[0] for s in states), *(s[1] for s in states)]
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], 0.11850903424512803
assert abs(value - expected) <= 1.4e-12, f"{value = }, {expected = }"
