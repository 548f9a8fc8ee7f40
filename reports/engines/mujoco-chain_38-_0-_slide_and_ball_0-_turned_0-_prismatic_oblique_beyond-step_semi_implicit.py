# mujoco 4.0.0, chain 38: 0: slide and ball, 0: turned, 0: prismatic oblique beyond: mj_step, mjINT_EULER is imprecise (q+, v+ (nq + nv) after a step: v+ = v + h M^-1 f, f = tau + Q - (bias); q+ where v+ leads in h).
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
from copy import copy
n = copy(m)
n.opt.timestep, n.opt.integrator = 0.015625, mj.mjtIntegrator.mjINT_EULER
n.opt.disableflags = mj.mjtDisableBit.mjDSBL_EULERDAMP
d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau
mj.mj_step(n, d)
value = np.r_[d.qpos, d.qvel]
if m.na: d.act[:] = states
import numpy as np
value, expected = np.reshape(value, (11,))[(4,)], 0.03840199454026442
assert abs(value - expected) <= 8.5e-10, f"{value = }, {expected = }"
