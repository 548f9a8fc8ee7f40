# frax 0.1.0, offset hinges: jacfwd of mass_matrix raises (derivative of M by q, the last index that of the derivative).
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
<link name="a"><inertial><origin xyz="0.10070490876149052 -0.09472135384680494 -0.1851006400088805"/><mass value="1.5982677716365594"/>
<inertia ixx="0.1789210257741357" ixy="-0.014153114640722959" ixz="-0.00026334346085267815" iyy="0.1793968065308796" iyz="-0.0027568079511296976" izz="0.16685857047150984"/></inertial></link>
<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>
<origin xyz="-0.47899268658636407 0.26672661053528224 0.02928709121757611" rpy="-0.9373595693315839 1.022213362190634 -2.268604489572896"/>
<axis xyz="1.0 0.0 0.0"/>
</joint>
<link name="b_0"/>
<joint name="joint_b_0" type="continuous"><parent link="a"/><child link="b_0"/>
<origin xyz="0.4618655512741101 -0.2633963454663627 -0.47134364900359726" rpy="1.558130756463876 -1.031275791122896 3.1318401705099355"/>
<axis xyz="1.0 0.0 0.0"/>
</joint>
<link name="b"><inertial><origin xyz="-0.18636579434814712 0.19806998106111406 -0.11771000141627695"/><mass value="1.4493566413211931"/>
<inertia ixx="0.17344240848931775" ixy="0.01732570744243296" ixz="-0.003132241662416482" iyy="0.18423897712914947" iyz="-0.0023815039051600165" izz="0.16085563195928992"/></inertial></link>
<joint name="joint_b" type="continuous"><parent link="b_0"/><child link="b"/>
<origin xyz="0.25 0.5 -0.125" rpy="1.5707963267948966 0.0 1.5707963267948966"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
<link name="c"><inertial><origin xyz="0.01198790971587621 0.08678230244721247 -0.14789004515325646"/><mass value="0.9877817792822652"/>
<inertia ixx="0.13793041662683653" ixy="-0.017879433878851138" ixz="-0.01595197537432108" iyy="0.11344033765289553" iyz="-0.0009637944204604586" izz="0.10652282740938533"/></inertial></link>
<joint name="joint_c" type="continuous"><parent link="b"/><child link="c"/>
<origin xyz="-0.4573790821233513 -0.24956038632337407 -0.34926132397314114" rpy="-0.7323082483429761 -1.3248968081347814 -2.670235933604608"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
</robot>"""
with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
    file.write(URDF)
    file.flush()
    robot = Robot(file.name, joint_ordering=['joint_a', 'joint_b_0', 'joint_b', 'joint_c'], floating_base=None)

def rates(q):
    if len(q) == 4: return np.eye(len(q))
    w, x, y, z = q[3:7]
    N = np.zeros((len(q), len(q) - 1))
    N[:3, :3], N[7:, 6:] = np.eye(3), np.eye(len(q) - 7)
    N[3:7, 3:6] = np.array([[-x, -y, -z], [w, -z, y], [z, w, -x], [-y, x, w]]) / 2
    return N
