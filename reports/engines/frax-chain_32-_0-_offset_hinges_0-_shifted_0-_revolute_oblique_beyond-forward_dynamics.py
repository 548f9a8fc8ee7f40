# frax 0.1.0, chain 32: 0: offset hinges, 0: shifted, 0: revolute oblique beyond: forward_dynamics raises (M^-1 (tau - h)).
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
<link name="a"><inertial><origin xyz="-0.006522250530700852 -0.013570201609868937 0.09097526380685422"/><mass value="0.8439659268135085"/>
<inertia ixx="0.16223222553150923" ixy="-0.013238640891344695" ixz="0.004932026940292749" iyy="0.17393679445463778" iyz="0.003366467502551558" izz="0.15579718267306997"/></inertial></link>
<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>
<origin xyz="-0.25006404153643635 0.4246613264931248 -0.26206881985497654" rpy="0.08326663678429098 0.64977082399224 -3.043790924752629"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
<link name="b0_0"/>
<joint name="joint_b0_0" type="continuous"><parent link="a"/><child link="b0_0"/>
<origin xyz="-0.11058598873918979 0.29438326445344476 0.28621740183673383" rpy="0.0 0.0 0.0"/>
<axis xyz="1.0 0.0 0.0"/>
</joint>
<link name="b0"><inertial><origin xyz="0.07072345881200304 0.08197322564838883 0.07763021977709877"/><mass value="1.942081826350654"/>
<inertia ixx="0.06844603489216713" ixy="-0.01523985774207084" ixz="-0.0021426558704180894" iyy="0.11489574797100514" iyz="-0.00020212844050798023" izz="0.11965911289686995"/></inertial></link>
<joint name="joint_b0" type="continuous"><parent link="b0_0"/><child link="b0"/>
<origin xyz="0.25 0.5 -0.125" rpy="1.5707963267948966 0.0 1.5707963267948966"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
<link name="c0"><inertial><origin xyz="0.006671542244722606 0.09773251770676566 -0.159412875455801"/><mass value="1.6959191117172983"/>
<inertia ixx="0.12801532886967473" ixy="0.02089619009813304" ixz="0.0010250606053727237" iyy="0.1623019565892683" iyz="-0.0020467199488768597" izz="0.11501822297057683"/></inertial></link>
<joint name="joint_c0" type="continuous"><parent link="b0"/><child link="c0"/>
<origin xyz="0.2720199526324568 0.22349522684005219 -0.47650436564456744" rpy="0.0 0.0 0.0"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
</robot>"""
with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
    file.write(URDF)
    file.flush()
    robot = Robot(file.name, joint_ordering=['joint_a', 'joint_b0_0', 'joint_b0', 'joint_c0'], floating_base=None)

def rates(q):
    if len(q) == 4: return np.eye(len(q))
    w, x, y, z = q[3:7]
    N = np.zeros((len(q), len(q) - 1))
    N[:3, :3], N[7:, 6:] = np.eye(3), np.eye(len(q) - 7)
    N[3:7, 3:6] = np.array([[-x, -y, -z], [w, -z, y], [z, w, -x], [-y, x, w]]) / 2
    return N
