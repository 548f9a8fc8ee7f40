# pybullet 3.2.7, huge before tiny masses: URDF_MERGE_FIXED_LINKS, calculateInverseDynamics raises (h: Coriolis, centrifugal and gravity forces).
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile("w", suffix=".urdf")
print('<robot name="tree">\n<link name="world"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>\n<link name="a"><inertial><origin xyz="-0.043857032141920355 -0.025771785288849852 0.18949070573878773"/><mass value="149152914.1632119"/>\n<inertia ixx="9765779.85204871" ixy="303033.19644972985" ixz="392273.05491541605" iyy="13379296.165810723" iyz="997742.3511289492" izz="10444614.484902825"/></inertial></link>\n<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>\n<origin xyz="-0.10630118327969384 0.4338787789537393 0.22442791313431198" rpy="-1.341585077579156 0.271557081433571 -2.403017756122648"/>\n<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>\n</joint>\n<link name="b"><inertial><origin xyz="-0.1283722546678156 0.0949056874359388 0.10892053953403968"/><mass value="1.8591085792217488"/>\n<inertia ixx="0.09653939730059097" ixy="-0.005210450773638072" ixz="0.010080265189673513" iyy="0.09444485801535862" iyz="-0.010289222977134565" izz="0.10898194686955133"/></inertial></link>\n<joint name="joint_b" type="continuous"><parent link="a"/><child link="b"/>\n<origin xyz="-0.29201092170432674 0.13683653478638447 0.463003385311357" rpy="0.11515837233568157 -0.116502610353313 -2.649674263193215"/>\n<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>\n</joint>\n<link name="c"><inertial><origin xyz="-0.019364999761275092 0.09971227485872952 0.04898263116168783"/><mass value="1.0037841658760902e-08"/>\n<inertia ixx="8.293886664275547e-10" ixy="4.4631022794028164e-11" ixz="1.7191491387894838e-12" iyy="1.077744671156496e-09" iyz="1.6169041300888305e-11" izz="7.448261148841643e-10"/></inertial></link>\n<joint name="joint_c" type="continuous"><parent link="b"/><child link="c"/>\n<origin xyz="0.34367642557584577 0.11571147817626115 -0.4279731263960814" rpy="-0.9770584858244157 -0.8928293526963702 2.9678483408936254"/>\n<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>\n</joint>\n</robot>', file=file, flush=True)
robot = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_MERGE_FIXED_LINKS | p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
gravity = True
p.setGravity(0.0, 0.0, -9.81)
joints = ()
moving = [0, 1, 2]
links = [0, 1, 2]
q = np.array([-1.0996201868492035, -1.8914015371177906, -0.45415795612897547])
v = np.array([-0.8020666483629364, 0.9725767279334938, 0.3881357647151733])
gravity
value = p.calculateInverseDynamics(robot, q.tolist(), v.tolist(), [0.0] * len(v))
