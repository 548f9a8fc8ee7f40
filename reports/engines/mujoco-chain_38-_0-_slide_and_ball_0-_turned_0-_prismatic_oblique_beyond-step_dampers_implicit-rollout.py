# mujoco 4.0.0, chain 38: 0: slide and ball, 0: turned, 0: prismatic oblique beyond: rollout is imprecise (q+, v+ (nq + nv) after a step: M + h D in place of M, D of the joints' dampers).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0"/><worldbody>
<body name="a" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="a" type="hinge" axis="1.0 0.0 0.0"/><body name="b0" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="0.10091247857555377 0.11017692819092144 0.16552759425208605" quat="0.2967047378805276 -0.35857996980965917 -0.022474114341982824 -0.8848059775764937"/><joint name="b0" type="ball"/><body name="c0" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="2.0" diaginertia="0.07211513497606176 0.11182860829674106 0.12691167619648303" quat="0.5616913800848413 -0.77831348190814 0.21811191034369307 -0.17651660540764613"/><joint name="c0" type="slide" axis="0.0 0.0 1.0"/></body></body></body>
</worldbody></mujoco>''')
d = mj.MjData(m)
bs = [m.body(name).id for name in ['a', 'b0', 'c0']]
q = np.array([0.0, 0.1, 0.5, 0.5, 0.7, 1.0])
v = np.array([-89.0, 0.0, -99.0, 0.0, -82.0])
tau = np.array([0.0, 0.0, 0.0, 0.0, 0.0])
from mujoco import rollout
from copy import copy
n = copy(m)
n.opt.timestep = 0.015625
d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau
FULL, APPLIED = mj.mjtState.mjSTATE_FULLPHYSICS, mj.mjtState.mjSTATE_CTRL | mj.mjtState.mjSTATE_QFRC_APPLIED
state, given = np.zeros(mj.mj_stateSize(n, FULL)), np.zeros(mj.mj_stateSize(n, APPLIED))
mj.mj_getState(n, d, state, FULL)
mj.mj_getState(n, d, given, APPLIED)
reached, _ = rollout.rollout(n, mj.MjData(n), state[None], given[None, None], control_spec=APPLIED)
e = mj.MjData(n)
mj.mj_setState(n, e, reached[0, -1], FULL)
value = np.r_[e.qpos, e.qvel]
import numpy as np
value, expected = np.reshape(value, (11,))[(4,)], 0.03840199454026442
assert abs(value - expected) <= 8.5e-10, f"{value = }, {expected = }"
