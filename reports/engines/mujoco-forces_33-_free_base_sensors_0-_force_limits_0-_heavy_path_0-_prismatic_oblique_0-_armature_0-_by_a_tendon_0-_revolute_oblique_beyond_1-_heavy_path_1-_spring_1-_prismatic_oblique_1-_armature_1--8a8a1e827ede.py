# mujoco 4.0.0, forces 33: free base, sensors, 0: force limits, 0: heavy path, 0: prismatic oblique, 0: armature, 0: by a tendon, 0: revolute oblique beyond, 1: heavy path, 1: spring, 1: prismatic oblique, 1: armature, 1: by a tendon, 1: revolute oblique beyond: mj_step1, mj_step2 with other forces, force, torque is wrong (wrench_sensors at the accelerations that tau makes (n, 6)).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0"/><worldbody>
<body name="a" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="a" type="free"/><body name="b1" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="b1" type="slide" axis="0.0 0.0 1.0" armature="1.0"/><site name="n0_1" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><body name="c1" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="c1" type="hinge" axis="0.0 0.0 1.0"/><site name="o0" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><site name="n0_2" pos="1.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/></body></body></body>
<site name="n0_0" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/>
</worldbody><tendon><spatial name="n0" stiffness="3.0" damping="0.5" springlength="0.25" armature="0.5"><site site="n0_0"/><site site="n0_1"/><site site="n0_2"/></spatial></tendon><sensor><accelerometer name="accelerometer0" site="o0"/><gyro name="gyro0" site="o0"/><velocimeter name="velocimeter0" site="o0"/><force name="force0" site="o0"/><torque name="torque0" site="o0"/><frameangacc name="frameangacc0" objtype="site" objname="o0"/><magnetometer name="magnetometer0" site="o0"/></sensor></mujoco>''')
d = mj.MjData(m)
bs = [m.body(name).id for name in ['a', 'b1', 'c1']]
sensed = range(1)
def data(kind, k): return d.sensor(f'{kind}{k}').data
q = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0])
v = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
a = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
e = mj.MjData(m)
e.ctrl[:] = d.ctrl
e.qpos[:], e.qvel[:], e.qfrc_applied[:] = q, v, a
mj.mj_step1(m, e); mj.mj_step2(m, e)
e.qpos[:], e.qvel[:] = q, v
mj.mj_step1(m, e)
e.qfrc_applied[:] = tau
mj.mj_step2(m, e)
value = [[*e.sensor(f'force{k}').data, *e.sensor(f'torque{k}').data] for k in sensed]
import numpy as np
value, expected = np.reshape(value, (1, 6))[(0, 0)], 5.25
assert abs(value - expected) <= 7.7e-12, f"{value = }, {expected = }"
