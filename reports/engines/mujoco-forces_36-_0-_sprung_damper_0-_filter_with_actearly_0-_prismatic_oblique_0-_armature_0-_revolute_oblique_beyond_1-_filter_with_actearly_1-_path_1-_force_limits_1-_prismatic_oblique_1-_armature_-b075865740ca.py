# mujoco 4.0.0, forces 36: 0: sprung damper, 0: filter with actearly, 0: prismatic oblique, 0: armature, 0: revolute oblique beyond, 1: filter with actearly, 1: path, 1: force limits, 1: prismatic oblique, 1: armature, 1: revolute oblique beyond: mj_step, mjINT_RK4 is wrong (actuators' states after a step (na)).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0" timestep="0.015625"/><worldbody>
<body name="b1" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="b1" type="slide" axis="0.0 0.0 1.0" armature="1.0" actuatorfrclimited="true" actuatorfrcrange="-0.125 0.25"/><site name="n0_1" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><body name="c1" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="c1" type="hinge" axis="0.0 0.0 1.0" actuatorfrclimited="true" actuatorfrcrange="-0.125 0.25"/><site name="n0_2" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/></body></body>
<site name="n0_0" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/>
</worldbody><tendon><spatial name="n0" stiffness="3.0" damping="0.5" springlength="0.25"><site site="n0_0"/><site site="n0_1"/><site site="n0_2"/></spatial></tendon><actuator><general gainprm="1.0" biastype="affine" biasprm="0.0 0.0 0.0" name="a0" joint="c1" gear="1.0" dyntype="filterexact" dynprm="0.125" actearly="true"/></actuator></mujoco>''')
d = mj.MjData(m)
d.ctrl[:] = [0.5]
states = [0.375]
d.act[:] = states
bs = [m.body(name).id for name in ['b1', 'c1']]
q = np.array([0.0, 0.0])
v = np.array([0.0, 0.0])
from copy import copy
n = copy(m)
n.opt.timestep, n.opt.integrator = 0.015625, mj.mjtIntegrator.mjINT_RK4
d.qpos[:], d.qvel[:] = q, v
mj.mj_step(n, d)
value = np.array(d.act)
if m.na: d.act[:] = states
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], 0.3896878871769256
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
