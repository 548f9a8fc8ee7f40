# pybullet 3.2.7, huge before tiny masses: getLinkState is imprecise (spatial velocities of the links).
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile('w', suffix='.urdf')
print("""<robot name="tree"><link name="world"><inertial><mass value="0"/>
<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link><link name="a"><inertial>
<origin xyz="1 0 0"/><mass value="1"/>
<inertia ixx="9765779.85204871" ixy="303033.19644972985" ixz="392273.05491541605" iyy="13379296.165810723"
iyz="997742.3511289492" izz="10444614.484902825"/></inertial></link><joint name="joint_a" type="continuous">
<parent link="world"/><child link="a"/></joint></robot>""", file=file, flush=True)
robot = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
for k, position, speed in zip([0], np.array([1.0]), np.array([1.0])):
    p.resetJointState(robot, k, position, speed)
states = [p.getLinkState(robot, k, computeLinkVelocity=1, computeForwardKinematics=1) for k in [0]]
value, expected = np.array([*np.array(states[0][6]) + np.cross(states[0][7], np.array(states[0][4]) - states[0][0]),
    *states[0][7]])[2], 0.0
assert abs(value - expected) <= 1.4e-12, f'value = {value!r}, expected = {expected!r}'
