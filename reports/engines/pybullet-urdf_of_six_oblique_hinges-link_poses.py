# pybullet 3.2.7, urdf of six oblique hinges: getLinkState is imprecise (positions and rows of R).
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile('w', suffix='.urdf')
print("""<robot name="tree"><link name="world"/><link name="a"><inertial><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link><joint name="joint_a" type="revolute">
<limit effort="9" velocity="9"/><parent link="world"/><child link="a"/></joint></robot>""", file=file, flush=True)
robot = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
q = np.array([1.0])
for k, position, speed in zip([0], q, 0 * q):
    p.resetJointState(robot, k, position, speed)
states = [p.getLinkState(robot, k, computeLinkVelocity=1, computeForwardKinematics=1) for k in [0]]
value, expected = np.array([*states[0][4], *p.getMatrixFromQuaternion(states[0][5])])[7], 0.5403023058681398
assert abs(value - expected) <= 1.4e-12, f'value = {value!r}, expected = {expected!r}'
