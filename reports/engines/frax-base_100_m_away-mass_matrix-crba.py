# frax 0.1.0, base 100 m away: crba is imprecise (M).
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
<link name="a"><inertial><origin xyz="-0.043751762992496473 -0.1844729293362066 0.1707799604227791"/><mass value="1.8187017420963922"/>
<inertia ixx="0.07404893536252394" ixy="0.011777050735461883" ixz="0.005841387202879444" iyy="0.10741947676947003" iyz="-0.003784782121519158" izz="0.12648701812474122"/></inertial></link>
<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>
<origin xyz="64.0 -48.0 60.0" rpy="-0.2976990361282562 1.2911781519468946 -1.6524130499955616"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
<link name="b"><inertial><origin xyz="-0.0928185856251782 0.1325220813545292 0.006391162859845423"/><mass value="0.7734754996812343"/>
<inertia ixx="0.13910965735131725" ixy="-0.02510358457377781" ixz="-0.018588767412343218" iyy="0.1539231661941898" iyz="0.015871486910339756" izz="0.13342292270116682"/></inertial></link>
<joint name="joint_b" type="continuous"><parent link="a"/><child link="b"/>
<origin xyz="0.18938420825177382 -0.4592799278634755 0.407311603492464" rpy="-1.5941737840444576 0.7026236897863056 1.6726626389081887"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
</robot>"""
with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
    file.write(URDF)
    file.flush()
    robot = Robot(file.name, joint_ordering=['joint_a', 'joint_b'], floating_base=None)

q = np.array([0.0, 0.0])
value = robot.crba(q)
import numpy as np
value, expected = np.reshape(value, (2, 2))[(0, 0)], 0.4630144209543804
assert abs(value - expected) <= 6.7e-12, f"{value = }, {expected = }"
