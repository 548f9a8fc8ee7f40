# pinocchio 4.1.0, urdf: damping of a planar joint: damping is wrong (force of dampers for a unit of speed).
import numpy as np
import pinocchio as pin
TEXT = '<robot name="r"><link name="world"/><link name="a"><inertial><origin xyz="0.1 -0.2 0.3"/><mass value="2"/><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/></inertial></link><link name="b"><inertial><origin xyz="0 0.1 0.2"/><mass value="1"/><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/></inertial></link><joint name="joint_a" type="planar"><parent link="world"/><child link="a"/><origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5"/><axis xyz="0 0 1"/><dynamics damping="0.7"/></joint><joint name="joint_b" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0 0.5"/><axis xyz="0 1 0"/><limit lower="-9" upper="9" effort="9" velocity="9"/></joint></robot>'
try: m = pin.buildModelFromXML(TEXT, mimic=True)
except TypeError: m = pin.buildModelFromXML(TEXT)
fs = [m.getFrameId(name, pin.FrameType.BODY) for name in ['a', 'b']]
d = m.createData()
value = m.damping
import numpy as np
value, expected = np.reshape(value, (4,))[(0,)], 0.7
assert abs(value - expected) <= 9.0e-13, f"{value = }, {expected = }"
