# frax 0.1.0, free base 10 km away: jacfwd of rnea is imprecise (derivative of M a + h by q).
import os
import numpy as np
import tempfile
os.environ["JAX_ENABLE_X64"] = "1"
os.environ["FRAX_SUPPRESS_WARNINGS"] = "1"
import jax
jax.config.update("jax_enable_x64", True)
from frax import Robot
URDF = """<robot name="tree">
<link name="a"><inertial><origin xyz="0.0 1.0 0.0"/><mass value="1.3072465272079148"/>
<inertia ixx="0.1553797542131575" ixy="-0.0044451811542391174" ixz="0.01241527632493358" iyy="0.17112054821288586" iyz="0.0015728855041406767" izz="0.16062372850165374"/></inertial></link>
</robot>"""
with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
    file.write(URDF)
    file.flush()
    robot = Robot(file.name, joint_ordering=[], floating_base='quaternion')

def rates(q):
    if len(q) == 0: return np.eye(len(q))
    w, x, y, z = q[3:7]
    N = np.zeros((len(q), len(q) - 1))
    N[:3, :3], N[7:, 6:] = np.eye(3), np.eye(len(q) - 7)
    N[3:7, 3:6] = np.array([[-x, -y, -z], [w, -z, y], [z, w, -x], [-y, x, w]]) / 2
    return N
q = np.array([6399.5601519252605, -4800.077706580394, 5999.243439385153, 0.273294341638708, 0.3567708494566067, -0.42174035036639745, -0.7875022797929568])
v = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
a = np.array([-0.0651492847087436, 0.0, 0.8367877680350586, -0.8331206039820402, -0.710473452573168, -0.2428584944462442])
value = jax.jacfwd(lambda x: robot.rnea(x, v, a, np.array([0, 0, 9.81, 0, 0, 0]), None))(q) @ rates(q)
import numpy as np
value, expected = np.reshape(value, (6, 6))[(5, 3)], 0.0
assert abs(value - expected) <= 3.4e-08, f"{value = }, {expected = }"
