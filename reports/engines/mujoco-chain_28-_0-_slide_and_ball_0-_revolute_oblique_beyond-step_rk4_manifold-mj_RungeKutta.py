# mujoco 4.0.0, chain 28: 0: slide and ball, 0: revolute oblique beyond: mj_forward, mj_RungeKutta is wrong (q+, v+ (nq + nv) after a step: the same, of displacements (Munthe-Kaas)).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0"/><worldbody>
<body name="a" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="a" type="hinge" axis="0.0 0.0 1.0"/><body name="b0" pos="0.0 0.0 0.0" xyaxes="0.0 1.0 0.0 0.0 0.0 1.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint type="slide" axis="0.0 0.0 1.0"/><joint type="ball"/><body name="c0" pos="0.0 0.0 0.0" xyaxes="0.0 1.0 0.0 0.0 0.0 1.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="c0" type="hinge" axis="0.0 0.0 1.0"/></body></body></body>
</worldbody></mujoco>''')
d = mj.MjData(m)
bs = [m.body(name).id for name in ['a', 'b0', 'c0']]
q = np.array([0.0, -1.0, 0.2887209756040745, -0.34129830280374557, -0.6372954148539809, -0.6277023346743316, 0.0])
v = np.array([-89.0, 61.0, 63.0, -99.0, 0.0, -82.0])
tau = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
from copy import copy
n = copy(m)
n.opt.timestep, n.opt.integrator = 0.015625, mj.mjtIntegrator.mjINT_RK4
d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau
mj.mj_forward(n, d)
mj.mj_RungeKutta(n, d, 4)
value = np.r_[d.qpos, d.qvel]
if m.na: d.act[:] = states
import numpy as np
value, expected = np.reshape(value, (13,))[(2,)], 0.4620841689353505
assert abs(value - expected) <= 3.4e-10, f"{value = }, {expected = }"
