# pybullet 3.2.7, urdf of six oblique hinges: calculateMassMatrix is imprecise (M).
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile('w', suffix='.urdf')
print("""<robot name="tree"><link name="world"/><link name="a"><inertial><mass value="1"/>
<inertia ixx="0.12240694835632548" ixy="-0.011628602419154744" ixz="-0.009267433785669044" iyy="0.10139826419408347"
iyz="0.0028932276318135697" izz="0.15423795703901963"/></inertial></link><joint name="joint_a" type="revolute">
<limit effort="9" velocity="9"/><parent link="world"/><child link="a"/></joint></robot>""", file=file, flush=True)
robot = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
value = p.calculateMassMatrix(robot, np.zeros(1).tolist())
value, expected = np.array(value)[0, 0], 0.12240694835632548
assert abs(value - expected) <= 1.3e-13, f'value = {value!r}, expected = {expected!r}'
