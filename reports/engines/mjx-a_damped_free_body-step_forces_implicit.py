# mjx 3.17.0, a damped free body: step, mjINT_IMPLICITFAST is wrong (q+, v+ (nq + nv) after a step: M + h D in place of M, D = -dQ/dv, for lone free bodies -df/dv).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0"/><worldbody>
<body name="a" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.805373805955127" diaginertia="2.0 3.0 4.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><joint type="free" damping="0.5"/></body>
</worldbody></mujoco>''')
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
links = [m.body(name).id for name in ['a']]
q = np.array([-0.43984807473968135, -0.07770658039411571, -0.7565606148471162, 0.273294341638708, 0.3567708494566067, -0.42174035036639745, -0.7875022797929568])
v = np.array([-0.8948288577550136, 0.6149502567089378, 0.6266106715793658, -0.9900567750811642, -0.33988931180500503, -0.821826286778075])
tau = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
e = stepped(q, v, tau, integrator=mj.mjtIntegrator.mjINT_IMPLICITFAST)
value = np.r_[np.array(e.qpos), np.array(e.qvel)]
import numpy as np
value, expected = np.reshape(value, (13,))[(10,)], -0.988317725086913
assert abs(value - expected) <= 1.5e-12, f"{value = }, {expected = }"
