"""mujoco 4.0.0: mj_rne, revolute with armature.

Result: M a + h (nv).
Known: none found.
"""

import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco><compiler angle="radian"/><option gravity="0.0 0.0 0.0"/><worldbody>
<body name="b" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" fullinertia="1.0 1.0 1.0 0.0 0.0 0.0"/><joint type="hinge" axis="0.0 1.0 0.0" armature="1.0"/></body>
</worldbody></mujoco>''')
d = mj.MjData(m)
q = np.array([0.0])
v = np.array([0.0])
a = np.array([1.0])
d.qpos[:], d.qvel[:] = q, v
mj.mj_forward(m, d)
d.qacc[:] = a
value = np.zeros(m.nv)
mj.mj_rne(m, d, 1, value)
value = np.array(value, dtype=float)
expected = np.array([2.0])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 2.4e-12
