# adam 0.5.0, prismatic: forward_kinematics is wrong (positions and rows of R).
import numpy as np
from adam.casadi import KinDynComputations
robot = KinDynComputations("""<robot name="tree"><link name="world"/><link name="b"><inertial><origin xyz="0 0 0"/>
<mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="joint_b" type="prismatic"><parent link="world"/><child link="b"/>
<origin xyz="0 0 0" rpy="0 0 1.5707963267948966"/><axis xyz="1 0 0"/>
<limit lower="-100" upper="100" effort="1e9" velocity="1e9"/></joint></robot>""", ['joint_b'], gravity=np.zeros(6))
value = []
for name in ['b']:
    H = np.array(robot.forward_kinematics_fun(name)(np.eye(4), np.array([1.0])))
    value.append([*H[:3, 3], *H[:3, :3].flat])
value, expected = np.array(value)[0, 0], 0.0
assert abs(value - expected) <= 1.4e-12, f'value = {value!r}, expected = {expected!r}'
