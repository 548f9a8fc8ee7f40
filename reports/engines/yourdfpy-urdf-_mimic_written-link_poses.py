# yourdfpy 0.0.60, urdf: mimic, written: get_transform is wrong (positions and rows of R).
# Known: https://github.com/clemense/yourdfpy/issues/57.
import io
import numpy as np
import yourdfpy
robot = yourdfpy.URDF.load(io.BytesIO(b'<robot name="r"><link name="world"/><link name="a"><inertial><origin xyz="0.1 -0.2 0.3"/><mass value="2"/><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/></inertial></link><link name="b"><inertial><origin xyz="0 0.1 0.2"/><mass value="1"/><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/></inertial></link><joint name="joint_a" type="revolute"><parent link="world"/><child link="a"/><origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5"/><axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="9" velocity="9"/></joint><joint name="joint_b" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0 0.5"/><axis xyz="0 1 0"/><limit lower="-9" upper="9" effort="9" velocity="9"/><mimic joint="joint_a" multiplier="2" offset="0.5"/></joint></robot>'))
robot = yourdfpy.URDF.load(io.BytesIO(robot.write_xml_string()))
moving = [next(j for j in robot.joint_map.values() if j.child == name) for name in ['a', 'b']]
links = ['a', 'b']
q = np.array([0.0])
robot.update_cfg({j.name: x for j, x in zip(moving, q)})
value = [[*T[:3, 3], *T[:3, :3].flat] for T in (robot.get_transform(name) for name in links)]
import numpy as np
value, expected = np.reshape(value, (2, 12))[(1, 9)], -0.0801108962286351
assert abs(value - expected) <= 1.4e-12, f"{value = }, {expected = }"
