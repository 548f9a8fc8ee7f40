# frax 0.1.0, free base 10 km away: jacfwd of mass_matrix is imprecise (derivative of M by q, the last index that of the derivative).
import os
import numpy as np
import tempfile
os.environ["JAX_ENABLE_X64"] = "1"
os.environ["FRAX_SUPPRESS_WARNINGS"] = "1"
import jax
jax.config.update("jax_enable_x64", True)
from frax import Robot
URDF = """<robot name="tree">
<link name="a"><inertial><origin xyz="-0.06269165207466462 -0.0523731040818487 -0.050201293764847055"/><mass value="1.3072465272079148"/>
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
value = jax.jacfwd(robot.mass_matrix)(q) @ rates(q)
import numpy as np
value, expected = np.reshape(value, (6, 6, 6))[(4, 4, 5)], 0.0
assert abs(value - expected) <= 3.2e-09, f"{value = }, {expected = }"
