# mjx 3.17.0, actuators with integrators with actearly: forward is wrong (M^-1 (tau - h)).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 -9.81" timestep="0.015625"/><worldbody>
<body name="a" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><joint name="a" type="hinge" axis="0.6666666666666666 -0.3333333333333333 0.6666666666666666" damping="0.75"/><body name="b" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><joint name="b" type="slide" axis="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/><body name="c" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><joint name="c" type="hinge" axis="0.6666666666666666 -0.3333333333333333 0.6666666666666666" stiffness="3.0" springref="0.25"/></body></body></body>
</worldbody><actuator><general gainprm="1.0" biastype="affine" biasprm="0.0 0.0 0.0" joint="a" gear="3.0" dyntype="integrator" actearly="true"/><general gainprm="6.0" biastype="affine" biasprm="0.0 -6.0 0.0" joint="b" gear="0.5" dyntype="integrator" actearly="true"/><general gainprm="0.5" biastype="affine" biasprm="0.25 -1.0 -0.75" joint="c" gear="-1.5" ctrllimited="true" ctrlrange="-1.0 1.0" dyntype="integrator" actearly="true"/></actuator></mujoco>''')
d = mj.MjData(m)
d.ctrl[:] = [0.75, -0.5, 2.0]
states = [0.375, 0.375, 0.375]
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
links = [m.body(name).id for name in ['a', 'b', 'c']]
q = np.array([-1.0996201868492035, -0.7565606148471162, -0.45415795612897547])
v = np.array([-0.8020666483629364, 0.9725767279334938, 0.3881357647151733])
tau = np.array([-0.39625206603607555, -0.8533158648967247, -0.8948288577550136])
value = got(forward(q, v, tau)[0], 'qacc')
import numpy as np
value, expected = np.reshape(value, (3,))[(2,)], 0.6921017533298156
assert abs(value - expected) <= 8.7e-12, f"{value = }, {expected = }"
