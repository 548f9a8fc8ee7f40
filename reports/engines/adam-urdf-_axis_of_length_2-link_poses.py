# adam 0.5.0, urdf: axis of length 2: forward_kinematics is wrong (positions and rows of R).
import numpy as np
from adam.casadi import KinDynComputations
robot = KinDynComputations("""<robot name="r"><link name="w"/><link name="a"><inertial><origin xyz="0.1 -0.2 0.3"/>
<mass value="2"/><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/></inertial></link>
<joint name="joint_a" type="revolute"><parent link="w"/><child link="a"/>
<origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5"/><axis xyz="1.2 0 1.6"/>
<limit lower="-9" upper="9" effort="9" velocity="9"/></joint></robot>""", ['joint_a'], gravity=np.array([0.0, 0.0,
    -9.81, 0.0, 0.0, 0.0]))
value = []
for name in ['a']:
    H = np.array(robot.forward_kinematics_fun(name)(np.eye(4), np.array([1.0])))
    value.append([*H[:3, 3], *H[:3, :3].flat])
value, expected = np.array(value)[0, 7], -0.09507733606698382
assert abs(value - expected) <= 1.4e-12, f'value = {value!r}, expected = {expected!r}'
