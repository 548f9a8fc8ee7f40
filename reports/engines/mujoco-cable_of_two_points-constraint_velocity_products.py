# mujoco 4.0.0, cable of two points: -efc_aref is wrong (J' v).
import numpy as np, mujoco as mj
m = mj.MjModel.from_xml_string("""<mujoco><compiler angle="radian"/><worldbody><body name="a0" pos="1 0 0">
<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><joint type="hinge" axis="1 0 0"/><body name="a1" pos="0 1 0">
<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><joint type="hinge" axis="0 1 0"/><site name="s0_0"/></body>
</body><body name="b1" pos="0 1 0"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
<joint type="hinge" axis="0 1 0"/><site name="s0_1" pos="0 0 1"/></body></worldbody><tendon><spatial name="t0">
<site site="s0_0"/><site site="s0_1"/></spatial></tendon><equality>
<tendon tendon1="t0" solimp="0.9999 0.9999 0.001"/></equality></mujoco>""")
d = mj.MjData(m)
tau = np.zeros(3)
m.eq_solref[:] = 0.0
m.opt.jacobian, m.opt.tolerance = mj.mjtJacobian.mjJAC_DENSE, 0.0
d.qpos[:], d.qvel[:], d.qfrc_applied[:] = np.zeros(3), np.array([0.425173749971883, 0.0, -0.42517374997188323]), tau
mj.mj_forward(m, d)
value, expected = (-d.efc_aref)[0], 0.12782561451455107
assert abs(value - expected) <= 2.6e-13, f'value = {value!r}, expected = {expected!r}'
