# roboticstoolbox 1.5.0, urdf: lower limit left out: qlim is wrong (least and greatest coordinates).
import io
import numpy as np
import roboticstoolbox as rtb
Robot = getattr(rtb, 'ERobot', None) if getattr(rtb.Robot, '__abstractmethods__', ()) else rtb.Robot
from roboticstoolbox.models.URDF.URDFRobot import URDF_file
TEXT = '<robot name="r"><link name="world"/><link name="a"><inertial><origin xyz="0.1 -0.2 0.3"/><mass value="2"/><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/></inertial></link><link name="b"><inertial><origin xyz="0 0.1 0.2"/><mass value="1"/><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/></inertial></link><joint name="joint_a" type="revolute"><parent link="world"/><child link="a"/><origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5"/><axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="9" velocity="9"/></joint><joint name="joint_b" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0 0.5"/><axis xyz="0 1 0"/><limit upper="1.25" effort="7" velocity="3"/></joint></robot>'
links = {'a': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0]), 'b': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0, 1])}
robot = Robot(URDF_file(io.StringIO(TEXT))[0], gravity=[0.0, 0.0, -9.81])
value = np.transpose(robot.qlim)
import numpy as np
value, expected = np.reshape(value, (2, 2))[(1, 0)], 0.0
assert abs(value - expected) <= 9.0e-12, f"{value = }, {expected = }"
