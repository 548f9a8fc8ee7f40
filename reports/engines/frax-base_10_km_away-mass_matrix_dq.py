# frax 0.1.0, base 10 km away: jacfwd of mass_matrix is imprecise (derivative of M by q, the last index that of the derivative).
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
<link name="a"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>
<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>
<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>
<origin xyz="6400.0 -4800.0 6000.0" rpy="0.0 0.0 0.0"/>
<axis xyz="0.0 0.0 1.0"/>
</joint>
<link name="b"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>
<inertia ixx="2.0" ixy="0.0" ixz="0.0" iyy="3.0" iyz="0.0" izz="4.0"/></inertial></link>
<joint name="joint_b" type="continuous"><parent link="a"/><child link="b"/>
<origin xyz="0.0 0.0 0.0" rpy="1.5707963267948966 0.0 1.5707963267948966"/>
<axis xyz="0.0 0.0 1.0"/>
</joint>
</robot>"""
with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
    file.write(URDF)
    file.flush()
    robot = Robot(file.name, joint_ordering=['joint_a', 'joint_b'], floating_base=None)

def rates(q):
    if len(q) == 2: return np.eye(len(q))
    w, x, y, z = q[3:7]
    N = np.zeros((len(q), len(q) - 1))
    N[:3, :3], N[7:, 6:] = np.eye(3), np.eye(len(q) - 7)
    N[3:7, 3:6] = np.array([[-x, -y, -z], [w, -z, y], [z, w, -x], [-y, x, w]]) / 2
    return N
q = np.array([1.0, 1.0])
value = jax.jacfwd(robot.mass_matrix)(q) @ rates(q)
import numpy as np
value, expected = np.reshape(value, (2, 2, 2))[(1, 1, 0)], 0.0
assert abs(value - expected) <= 4.1e-12, f"{value = }, {expected = }"
