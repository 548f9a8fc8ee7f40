# mujoco 4.0.0, revolute with armature: mj_rne is wrong (M a + h).
import numpy as np, mujoco as mj
m = mj.MjModel.from_xml_string("""<mujoco><compiler angle="radian"/><worldbody><body name="b">
<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><joint type="hinge" axis="0 1 0" armature="1"/></body>
</worldbody></mujoco>""")
d = mj.MjData(m)
mj.mj_forward(m, d)
d.qacc[:] = np.array([1.0])
value = np.zeros(m.nv)
mj.mj_rne(m, d, 1, value)
value, expected = np.array(value)[0], 2.0
assert abs(value - expected) <= 2.7e-12, f'value = {value!r}, expected = {expected!r}'
