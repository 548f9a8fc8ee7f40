# mujoco 4.0.0, actuators between sites, seen from the link beyond: rollout is wrong (q+, v+ (nq + nv) after a step: M + h D in place of M, D of the joints' dampers).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0"/><worldbody>
<body name="a" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><joint type="hinge" axis="0.0 0.0 1.0"/><site name="u0_0" pos="-0.2462137928591217 0.15692586496629352 -0.02418158792402686" xyaxes="-0.36861653824808815 -0.864556215368734 -0.34156170481669496 -0.28972244170186684 -0.24228400676107698 0.9259370209912263"/><body name="c" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><joint type="hinge" axis="0.0 0.0 1.0"/><site name="u0_1" pos="0.2498098376334898 0.25684530691179447 -0.03808741457630349" xyaxes="-0.3964192512878423 -0.6622583537592845 0.6358188815098439 0.9129207611868112 -0.21111181823674013 0.34929569707465746"/></body></body>
</worldbody><actuator><general gainprm="0.5" biastype="affine" biasprm="0.25 -1.0 -0.75" site="u0_0" refsite="u0_1" gear="1.0 -2.0 1.5 0.0 0.0 0.0" ctrllimited="true" ctrlrange="-1.0 1.0"/></actuator></mujoco>''')
d = mj.MjData(m)
d.ctrl[:] = [2.0]
bs = [m.body(name).id for name in ['a', 'c']]
q = np.array([0.0, 0.0])
v = np.array([0.0, 0.0])
tau = np.array([0.0, 0.0])
from mujoco import rollout
from copy import copy
n = copy(m)
n.opt.timestep = 0.015625
d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau
FULL, APPLIED = mj.mjtState.mjSTATE_FULLPHYSICS, mj.mjtState.mjSTATE_CTRL | mj.mjtState.mjSTATE_QFRC_APPLIED
state, given = np.zeros(mj.mj_stateSize(n, FULL)), np.zeros(mj.mj_stateSize(n, APPLIED))
mj.mj_getState(n, d, state, FULL)
mj.mj_getState(n, d, given, APPLIED)
ends, _ = rollout.rollout(n, mj.MjData(n), state[None], given[None, None], control_spec=APPLIED)
e = mj.MjData(n)
mj.mj_setState(n, e, ends[0, -1], FULL)
value = np.r_[e.qpos, e.qvel]
import numpy as np
value, expected = np.reshape(value, (4,))[(3,)], 0.0018285334532977412
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
