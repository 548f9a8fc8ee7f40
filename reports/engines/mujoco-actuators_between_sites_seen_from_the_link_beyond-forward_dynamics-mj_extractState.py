# mujoco 4.0.0, actuators between sites, seen from the link beyond: mj_extractState is wrong (M^-1 (tau - h)).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0"/><worldbody>
<body name="a" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="a" type="hinge" axis="0.0 0.0 1.0"/><site name="u0_0" pos="-0.2462137928591217 0.15692586496629352 -0.02418158792402686" xyaxes="-0.36861653824808815 -0.864556215368734 -0.34156170481669496 -0.28972244170186684 -0.24228400676107698 0.9259370209912263"/><body name="c" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="c" type="hinge" axis="0.0 0.0 1.0"/><site name="u0_1" pos="0.2498098376334898 0.25684530691179447 -0.03808741457630349" xyaxes="-0.3964192512878423 -0.6622583537592845 0.6358188815098439 0.9129207611868112 -0.21111181823674013 0.34929569707465746"/></body></body>
</worldbody><actuator><general gainprm="0.5" biastype="affine" biasprm="0.25 -1.0 -0.75" name="a0" site="u0_0" refsite="u0_1" gear="1.0 -2.0 1.5 0.0 0.0 0.0" ctrllimited="true" ctrlrange="-1.0 1.0"/></actuator></mujoco>''')
d = mj.MjData(m)
d.ctrl[:] = [2.0]
bs = [m.body(name).id for name in ['a', 'c']]
q = np.array([0.0, 0.0])
v = np.array([0.0, 0.0])
tau = np.array([0.0, 0.0])
d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau
FULL, PART = mj.mjtState.mjSTATE_INTEGRATION, mj.mjtState.mjSTATE_FULLPHYSICS
whole, part = (np.zeros(mj.mj_stateSize(m, one)) for one in (FULL, PART))
mj.mj_getState(m, d, whole, FULL)
mj.mj_extractState(m, whole, FULL, part, PART)
e = mj.MjData(m)
e.ctrl[:], e.qfrc_applied[:] = d.ctrl, tau
mj.mj_setState(m, e, part, PART)
mj.mj_forward(m, e)
value = e.qacc
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], 0.11702614101105543
assert abs(value - expected) <= 3.9e-13, f"{value = }, {expected = }"
