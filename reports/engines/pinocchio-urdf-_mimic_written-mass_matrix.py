# pinocchio 4.1.0, urdf: mimic, written: crba crashes (M).
import numpy as np
import pinocchio as pin
TEXT = '<robot name="r"><link name="world"/><link name="a"><inertial><origin xyz="0.1 -0.2 0.3"/><mass value="2"/><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/></inertial></link><link name="b"><inertial><origin xyz="0 0.1 0.2"/><mass value="1"/><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/></inertial></link><joint name="joint_a" type="revolute"><parent link="world"/><child link="a"/><origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5"/><axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="9" velocity="9"/></joint><joint name="joint_b" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0 0.5"/><axis xyz="0 1 0"/><limit lower="-9" upper="9" effort="9" velocity="9"/><mimic joint="joint_a" multiplier="2" offset="0.5"/></joint></robot>'
written, m = pin.buildModelFromXML(TEXT, mimic=True), pin.Model()
m.loadFromString(written.saveToString())
fs = [m.getFrameId(name, pin.FrameType.BODY) for name in ['a', 'b']]
d = m.createData()
q = np.array([-1.0996201868492035])
value = pin.crba(m, d, q)
