# mujoco 4.0.0, forces 33: free base, sensors, 0: force limits, 0: heavy path, 0: prismatic oblique, 0: armature, 0: by a tendon, 0: revolute oblique beyond, 1: heavy path, 1: spring, 1: prismatic oblique, 1: armature, 1: by a tendon, 1: revolute oblique beyond: attach, force, torque is wrong (force that holds the link and its subtree, and its moment about the sensor (n, 6)).
import numpy as np
import mujoco as mj
def made(text):
    child, parent = mj.MjSpec.from_string(text), mj.MjSpec()
    for name in ('gravity', 'timestep', 'disableactuator', 'density', 'viscosity', 'wind'):
        setattr(parent.option, name, getattr(child.option, name))
    parent.attach(child, prefix='own_', frame=parent.worldbody.add_frame())
    return parent.compile()
m = made('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0"/><worldbody>
<body name="a" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="a" type="free"/><body name="b1" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="b1" type="slide" axis="0.0 0.0 1.0" armature="1.0"/><site name="n0_1" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><body name="c1" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="c1" type="hinge" axis="0.0 0.0 1.0"/><site name="o0" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><site name="n0_2" pos="1.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/></body></body></body>
<site name="n0_0" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/>
</worldbody><tendon><spatial name="n0" stiffness="3.0" damping="0.5" springlength="0.25" armature="0.5"><site site="n0_0"/><site site="n0_1"/><site site="n0_2"/></spatial></tendon><sensor><accelerometer name="accelerometer0" site="o0"/><gyro name="gyro0" site="o0"/><velocimeter name="velocimeter0" site="o0"/><force name="force0" site="o0"/><torque name="torque0" site="o0"/><frameangacc name="frameangacc0" objtype="site" objname="o0"/><magnetometer name="magnetometer0" site="o0"/></sensor></mujoco>''')
d = mj.MjData(m)
bs = [m.body('own_' + name).id for name in ['a', 'b1', 'c1']]
sensed = range(1)
def data(kind, k): return d.sensor(f'own_{kind}{k}').data
q = np.array([0.0, 0.0, 1.0, 0.6, 0.8, 0.0, 0.0, 0.0, 0.0])
v = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0])
a = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
d.qpos[:], d.qvel[:] = q, v
mj.mj_forward(m, d)
d.qacc[:] = a
mj.mj_rnePostConstraint(m, d)
mj.mj_sensorVel(m, d); mj.mj_sensorAcc(m, d)
value = [[*data('force', k), *data('torque', k)] for k in sensed]
import numpy as np
value, expected = np.reshape(value, (1, 6))[(0, 0)], 5.11
assert abs(value - expected) <= 7.3e-12, f"{value = }, {expected = }"
