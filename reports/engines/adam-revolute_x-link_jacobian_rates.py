# adam 0.5.0, revolute x: jacobian_dot is wrong (their time derivatives).
import numpy as np
from adam.casadi import KinDynComputations
robot = KinDynComputations("""<robot name="tree"><link name="world"/><link name="a"><inertial><origin xyz="0 0 0"/>
<mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/><origin xyz="0 0 0" rpy="0 0 0"/>
<axis xyz="1 0 0"/></joint><link name="b"><inertial><origin xyz="0 0 0"/><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link><joint name="joint_b" type="continuous">
<parent link="a"/><child link="b"/><origin xyz="0 1 0" rpy="0 0 0"/><axis xyz="1 0 0"/></joint></robot>""", ['joint_a',
    'joint_b'], gravity=np.zeros(6))
v = np.eye(2)[1]
value, expected = np.array(robot.jacobian_dot_fun('b')(np.eye(4), np.zeros(2), np.zeros(6), v))[:, 6:][1, 0], 0.0
assert abs(value - expected) <= 1.4e-12, f'value = {value!r}, expected = {expected!r}'
