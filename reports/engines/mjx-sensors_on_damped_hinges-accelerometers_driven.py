# mjx 3.17.0, sensors on damped hinges: forward, accelerometer is wrong (accelerometers at the accelerations that tau makes (n, 3)).
# Known: https://github.com/google-deepmind/mujoco/issues/2767 (why sensor_acc stands after the constraints; not its early return).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 -9.81"/><worldbody>
<body name="a" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><joint type="hinge" axis="0.0 0.0 1.0" damping="0.75"/><body name="b" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><joint type="hinge" axis="0.0 0.0 1.0" damping="0.75"/><site name="o0" pos="0.2852790538142756 -0.19892322044204852 -0.01739778456854274" xyaxes="-0.8080981309368743 -0.588903671535752 -0.013033665180654987 0.5553722799006138 -0.7690872044736131 0.31633289843605744"/><body name="c" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><joint type="hinge" axis="0.0 0.0 1.0" damping="0.75"/><site name="o1" pos="0.07283549898689523 0.05032380895110977 -0.27195417991899" xyaxes="-0.5701986226288075 0.0363290267290538 0.8207031939557263 0.6350446000937439 -0.6142638188175913 0.4683997403750415"/></body></body></body>
</worldbody><sensor><accelerometer name="accelerometer0" site="o0"/><gyro name="gyro0" site="o0"/><velocimeter name="velocimeter0" site="o0"/><force name="force0" site="o0"/><torque name="torque0" site="o0"/><frameangacc name="frameangacc0" objtype="site" objname="o0"/><accelerometer name="accelerometer1" site="o1"/><gyro name="gyro1" site="o1"/><velocimeter name="velocimeter1" site="o1"/><force name="force1" site="o1"/><torque name="torque1" site="o1"/><frameangacc name="frameangacc1" objtype="site" objname="o1"/></sensor></mujoco>''')
d = mj.MjData(m)
import os
os.environ['XLA_FLAGS'] = os.environ.get('XLA_FLAGS', '') + ' --xla_backend_optimization_level=0'
import jax
jax.config.update("jax_enable_x64", True)
from mujoco import mjx
mx, empty = mjx.put_model(m), mjx.make_data(m)
if m.nu: empty = empty.replace(ctrl=jax.numpy.array(d.ctrl))
if m.na: empty = empty.replace(act=jax.numpy.array(states))
def forward(q, v, tau):
    e = jax.jit(mjx.forward)(mx, empty.replace(qpos=q, qvel=v, qfrc_applied=tau))
    return e, jax.jit(mjx.full_m)(mx, e)
def inverse(q, v, a): return jax.jit(mjx.inverse)(mx, empty.replace(qpos=q, qvel=v, qacc=a)).qfrc_inverse
def read(q, v, a):
    e = empty.replace(qpos=q, qvel=v, qacc=a)
    calls = (mjx.fwd_position, mjx.fwd_velocity, mjx.sensor_pos, mjx.sensor_vel, mjx.sensor_acc)
    for one in calls: e = jax.jit(one)(mx, e)
    return e
def got(e, name): return np.array(getattr(e, name) if hasattr(e, name) else getattr(e._impl, name))
def stepped(q, v, tau, **options):
    from copy import copy
    n = copy(m)
    n.opt.timestep = 0.015625
    for name, value in options.items(): setattr(n.opt, name, value)
    if (name := str(options)) not in steps: steps[name] = mjx.put_model(n)
    return jax.jit(mjx.step)(steps[name], empty.replace(qpos=q, qvel=v, qfrc_applied=tau))
steps = {}
links = [m.body(name).id for name in ['a', 'b', 'c']]
sensed = range(2)
def data(e, kind, k):
    one = m.sensor(f'{kind}{k}')
    return np.array(e.sensordata)[one.adr[0]:one.adr[0] + one.dim[0]]
q = np.array([-1.0996201868492035, -1.8914015371177906, -0.45415795612897547])
v = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
e = forward(q, v, tau)[0]
value = [data(e, 'accelerometer', k) for k in sensed]
import numpy as np
value, expected = np.reshape(value, (2, 3))[(0, 2)], 9.305360917291056
assert abs(value - expected) <= 9.8e-12, f"{value = }, {expected = }"
