# mujoco 4.0.0, forces 13: free base, sensors, 0: gain of speed, 0: sum, 0: force limits, 0: by a tendon, 0: armature beyond, 0: revolute oblique, 0: revolute oblique beyond, 1: control beyond limits, 1: path, 1: gravity compensation, 1: armature beyond, 1: ball, 1: revolute oblique beyond: mjd_transitionFD is imprecise (derivative of q+, v+ of that step by q, v along speeds (2 nv, 2 nv)).
# Known: https://github.com/google-deepmind/mujoco/pull/3430 (closed by its author, without an answer).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0"/><worldbody>
<body name="a" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="a" type="free"/><body name="b0" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="b0" type="hinge" axis="0.0 0.0 1.0" actuatorfrclimited="true" actuatorfrcrange="-0.125 0.25"/><site name="o0" pos="-0.05354692399350619 -0.2053581546448805 -0.2599299101452244" xyaxes="-0.6155706412719677 -0.6170479583846886 0.49022913281169445 -0.3825497337873699 -0.3098898347398192 -0.8704159876197932"/><body name="c0" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="c0" type="hinge" axis="0.0 0.0 1.0" armature="0.75" actuatorfrclimited="true" actuatorfrcrange="-0.125 0.25"/><site name="o1" pos="0.10753995328225263 -0.04791377019672727 0.16015371580599203" xyaxes="-0.5985138752848465 0.7916995886083602 -0.12244550824292619 -0.6022489501200777 -0.5454457505498125 -0.5829109153948105"/></body></body><body name="b1" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0" gravcomp="0.75"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="b1" type="ball"/><site name="o2" pos="-0.0034349023309280247 0.143875338989933 0.1518559111034533" xyaxes="-0.346098502604045 0.6998088392212477 0.6248867217688722 -0.09205796790200114 -0.6881666542060078 0.7196888123242317"/><site name="n1_1" pos="1.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><body name="c1" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0" gravcomp="0.75"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="c1" type="hinge" axis="0.0 0.0 1.0" armature="0.75"/><site name="o3" pos="0.08925977746988084 0.08349175440708928 -0.09639542605484108" xyaxes="-0.10954811502579158 -0.9319839456878081 -0.3455504818032828 0.9697997528742218 -0.1764322438186006 0.16840458030063268"/><site name="n1_2" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/></body></body></body>
<site name="n1_0" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/>
</worldbody><tendon><fixed name="n0" stiffness="3.0" damping="0.5" springlength="0.25"><joint joint="c0" coef="0.75"/></fixed><spatial name="n1" stiffness="3.0" damping="0.5" springlength="0.25"><site site="n1_0"/><site site="n1_1"/><site site="n1_2"/></spatial></tendon><actuator><general gaintype="affine" gainprm="1.0 -0.5 -1.0" biastype="affine" biasprm="0.0 0.0 0.0" name="a0" tendon="n0" gear="0.5"/></actuator><sensor><accelerometer name="accelerometer0" site="o0"/><gyro name="gyro0" site="o0"/><velocimeter name="velocimeter0" site="o0"/><force name="force0" site="o0"/><torque name="torque0" site="o0"/><frameangacc name="frameangacc0" objtype="site" objname="o0"/><magnetometer name="magnetometer0" site="o0"/><accelerometer name="accelerometer1" site="o1"/><gyro name="gyro1" site="o1"/><velocimeter name="velocimeter1" site="o1"/><force name="force1" site="o1"/><torque name="torque1" site="o1"/><frameangacc name="frameangacc1" objtype="site" objname="o1"/><magnetometer name="magnetometer1" site="o1"/><accelerometer name="accelerometer2" site="o2"/><gyro name="gyro2" site="o2"/><velocimeter name="velocimeter2" site="o2"/><force name="force2" site="o2"/><torque name="torque2" site="o2"/><frameangacc name="frameangacc2" objtype="site" objname="o2"/><magnetometer name="magnetometer2" site="o2"/><accelerometer name="accelerometer3" site="o3"/><gyro name="gyro3" site="o3"/><velocimeter name="velocimeter3" site="o3"/><force name="force3" site="o3"/><torque name="torque3" site="o3"/><frameangacc name="frameangacc3" objtype="site" objname="o3"/><magnetometer name="magnetometer3" site="o3"/></sensor></mujoco>''')
d = mj.MjData(m)
d.ctrl[:] = [0.75]
bs = [m.body(name).id for name in ['a', 'b0', 'c0', 'b1', 'c1']]
sensed = range(4)
def data(kind, k): return d.sensor(f'{kind}{k}').data
q = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
v = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
from copy import copy
n = copy(m)
n.opt.timestep = 0.015625
n.opt.integrator = mj.mjtIntegrator.mjINT_IMPLICITFAST
d.qfrc_applied[:] = tau
d.qpos[:], d.qvel[:] = q, v
mj.mj_forward(m, d)
A = np.zeros([2 * m.nv + m.na] * 2)
B = np.zeros((2 * m.nv + m.na, m.nu)) if m.nu else None
mj.mjd_transitionFD(n, d, 1e-6, True, A, B, None, None)
A = A[:2 * m.nv, :2 * m.nv]
value = A
import numpy as np
value, expected = np.reshape(value, (24, 24))[(19, 7)], -0.021019852082522383
assert abs(value - expected) <= 1.4e-06, f"{value = }, {expected = }"
