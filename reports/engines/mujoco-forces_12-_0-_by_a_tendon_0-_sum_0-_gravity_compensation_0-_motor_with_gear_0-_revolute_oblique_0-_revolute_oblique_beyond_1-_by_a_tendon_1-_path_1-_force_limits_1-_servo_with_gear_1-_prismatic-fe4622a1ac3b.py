# mujoco 4.0.0, forces 12: 0: by a tendon, 0: sum, 0: gravity compensation, 0: motor with gear, 0: revolute oblique, 0: revolute oblique beyond, 1: by a tendon, 1: path, 1: force limits, 1: servo with gear, 1: prismatic oblique, 1: prismatic oblique beyond, 1: armature: mj_step, mjINT_DISCRETE is wrong (q+, v+ (nq + nv) after a step: the same, for lone free bodies D = -df/dv).
# Known: https://github.com/google-deepmind/mujoco/pull/3430 (closed by its author, without an answer).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0"/><worldbody>
<body name="c0" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="c0" type="hinge" axis="1.0 0.0 0.0"/></body>
<body name="b1" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="b1" type="slide" axis="1.0 0.0 0.0" armature="1.0" actuatorfrclimited="true" actuatorfrcrange="-0.125 0.25"/><site name="n1_1" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><body name="c1" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="c1" type="slide" axis="1.0 0.0 0.0" actuatorfrclimited="true" actuatorfrcrange="-0.125 0.25"/><site name="n1_2" pos="1.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/></body></body>
<site name="n1_0" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/>
</worldbody><tendon><fixed name="n0" stiffness="3.0" damping="0.5" springlength="0.25"><joint joint="c0" coef="0.75"/></fixed><spatial name="n1" stiffness="3.0" damping="0.5" springlength="0.25"><site site="n1_0"/><site site="n1_1"/><site site="n1_2"/></spatial></tendon><actuator><general gainprm="3.0" biastype="affine" biasprm="0.25 -3.0 -0.5" name="a0" tendon="n1" gear="0.5"/></actuator></mujoco>''')
d = mj.MjData(m)
d.ctrl[:] = [0.5]
bs = [m.body(name).id for name in ['c0', 'b1', 'c1']]
q = np.array([0.0, 1.0, 0.0])
v = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
from copy import copy
n = copy(m)
n.opt.timestep, n.opt.integrator = 0.015625, mj.mjtIntegrator.mjINT_DISCRETE
n.opt.tolerance = 0.0
d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau
mj.mj_step(n, d)
value = np.r_[d.qpos, d.qvel]
if m.na: d.act[:] = states
import numpy as np
value, expected = np.reshape(value, (6,))[(5,)], -0.0832728152989591
assert abs(value - expected) <= 1.4e-12, f"{value = }, {expected = }"
