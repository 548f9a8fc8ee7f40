"""frax 0.1.0: centrifugal_coriolis_vector, huge before tiny masses.

Result: C v = h - g (nv), C the Coriolis matrix.
Known: none found.
"""

import os
import numpy as np
import tempfile
os.environ["JAX_ENABLE_X64"] = "1"
os.environ["FRAX_SUPPRESS_WARNINGS"] = "1"
import jax
jax.config.update("jax_enable_x64", True)
from frax import Robot
URDF = """<robot name="tree">
<link name="world"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<link name="a"><inertial><origin xyz="-0.043857032141920355 -0.025771785288849852 0.18949070573878773"/><mass value="149152914.1632119"/>
<inertia ixx="9765779.852048708" ixy="303033.19644972915" ixz="392273.05491541413" iyy="13379296.16581072" iyz="997742.3511289496" izz="10444614.484902823"/></inertial></link>
<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>
<origin xyz="-0.10630118327969384 0.4338787789537393 0.22442791313431198" rpy="-1.3415850775791558 0.271557081433571 -2.403017756122648"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
<link name="b"><inertial><origin xyz="-0.1283722546678156 0.0949056874359388 0.10892053953403968"/><mass value="1.8591085792217488"/>
<inertia ixx="0.096539397300591" ixy="-0.005210450773638082" ixz="0.010080265189673521" iyy="0.0944448580153586" iyz="-0.010289222977134582" izz="0.10898194686955136"/></inertial></link>
<joint name="joint_b" type="continuous"><parent link="a"/><child link="b"/>
<origin xyz="-0.29201092170432674 0.13683653478638447 0.463003385311357" rpy="0.11515837233568155 -0.116502610353313 -2.649674263193215"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
<link name="c"><inertial><origin xyz="-0.019364999761275092 0.09971227485872952 0.04898263116168783"/><mass value="1.0037841658760902e-08"/>
<inertia ixx="8.293886664275547e-10" ixy="4.463102279402807e-11" ixz="1.7191491387894826e-12" iyy="1.0777446711564957e-09" iyz="1.6169041300888298e-11" izz="7.448261148841643e-10"/></inertial></link>
<joint name="joint_c" type="continuous"><parent link="b"/><child link="c"/>
<origin xyz="0.34367642557584577 0.11571147817626115 -0.4279731263960814" rpy="-0.9770584858244159 -0.8928293526963702 2.9678483408936254"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
</robot>"""
with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
    file.write(URDF)
    file.flush()
    robot = Robot(file.name, joint_ordering=['joint_a', 'joint_b', 'joint_c'], floating_base=None)

q = np.array([-1.0996201868492035, -1.8914015371177906, -0.45415795612897547])
v = np.array([-0.8020666483629364, 0.9725767279334938, 0.3881357647151733])
value = robot.centrifugal_coriolis_vector(q, v)
value = np.array(value, dtype=float)
expected = np.array([-0.1733609425003475, -0.005230103970824989, -1.1204821329841815e-09])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 2.0e-13
