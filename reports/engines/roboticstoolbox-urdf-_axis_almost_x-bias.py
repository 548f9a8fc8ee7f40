# roboticstoolbox 1.5.0, urdf: axis almost x: rne is wrong (h: Coriolis, centrifugal and gravity forces).
# Known: https://github.com/petercorke/robotics-toolbox-python/pull/441.
import io
import numpy as np
import roboticstoolbox as rtb
Robot = getattr(rtb, 'ERobot', None) if getattr(rtb.Robot, '__abstractmethods__', ()) else rtb.Robot
from roboticstoolbox.models.URDF.URDFRobot import URDF_file
TEXT = '<robot name="r"><link name="world"/><link name="a"><inertial><origin xyz="0.1 -0.2 0.3"/><mass value="2"/><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/></inertial></link><link name="b"><inertial><origin xyz="0 0.1 0.2"/><mass value="1"/><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/></inertial></link><joint name="joint_a" type="revolute"><parent link="world"/><child link="a"/><origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5"/><axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="9" velocity="9"/></joint><joint name="joint_b" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0 0.5"/><axis xyz="0.99999999995 0.00001 0"/><limit lower="-9" upper="9" effort="9" velocity="9"/></joint></robot>'
links = {'a': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0]), 'b': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0, 1])}
robot = Robot(URDF_file(io.StringIO(TEXT))[0], gravity=[0.0, 0.0, -9.81])
q = np.array([0.0, 0.0])
v = np.array([0.0, 0.0])
value = robot.rne(q, v, np.zeros(len(v)))
import numpy as np
value, expected = np.reshape(value, (2,))[(0,)], 1.680099150863995
assert abs(value - expected) <= 1.2e-11, f"{value = }, {expected = }"
