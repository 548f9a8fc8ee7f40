# mjx 3.17.0, actuators with integrators with actearly: qfrc_actuator is wrong (what they do along the speeds).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0" timestep="0.015625"/><worldbody>
<body name="c" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><joint name="c" type="hinge" axis="0.0 0.0 1.0"/></body>
</worldbody><actuator><general gainprm="0.5" biastype="affine" biasprm="0.25 -1.0 -0.75" joint="c" gear="-1.5" ctrllimited="true" ctrlrange="-1.0 1.0" dyntype="integrator" actearly="true"/></actuator></mujoco>''')
d = mj.MjData(m)
d.ctrl[:] = [2.0]
states = [0.375]
d.act[:] = states
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
links = [m.body(name).id for name in ['c']]
q = np.array([0.0])
v = np.array([0.0])
tau = np.array([0.0])
value = got(forward(q, v, tau)[0], 'qfrc_actuator')
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], -0.66796875
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
