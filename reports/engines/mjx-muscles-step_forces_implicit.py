# mjx 3.17.0, muscles: step, mjINT_IMPLICITFAST is wrong (q+, v+ (nq + nv) after a step: M + h D in place of M, D = -dQ/dv, for lone free bodies -df/dv).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0"/><worldbody>
<body name="a" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="-0.19363549925678827 0.17992215962247687 0.15707617325004608" mass="1.2563911747131722" diaginertia="0.07879440491625532 0.10542779965857761 0.1428972946967548" xyaxes="0.6682640434895628 -0.32771536725241845 -0.6678516349052327 0.5205182987770598 -0.43540671647722407 0.7344941741666554"/><joint type="hinge" axis="0.0 0.0 1.0" damping="0.75"/><body name="b" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.1206164549494585 0.11683445731630915 0.15255028168814183" mass="0.7685137383172533" diaginertia="0.13742159834263545 0.16007628961480375 0.167456348885842" xyaxes="-0.596996999696463 -0.42495074013001954 0.6804494476567455 0.4355595131804873 -0.8839776423513666 -0.16991597423696375"/><joint name="b" type="slide" axis="0.0 0.0 1.0"/><body name="c" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="-0.14129166278090316 -0.15153591764389374 -0.12482394563973753" mass="0.8934710999773726" diaginertia="0.09132244073059369 0.12069347933356742 0.16903778247163131" xyaxes="-0.5580275949113387 0.5503039600999753 -0.6211044636900878 -0.8034688269953 -0.1711773953721285 0.5702071056733775"/><joint name="c" type="hinge" axis="0.0 0.0 1.0" stiffness="3.0" springref="0.25"/></body></body></body>
</worldbody><actuator><general gaintype="muscle" biastype="muscle" lengthrange="-0.25 0.25" gainprm="0.5 1.6 4.0 200.0 0.5 1.6 1.5 1.3 1.2" biasprm="0.5 1.6 4.0 200.0 0.5 1.6 1.5 1.3 1.2" joint="b" gear="-0.5"/><general gaintype="muscle" biastype="muscle" lengthrange="-0.5 0.5" gainprm="0.875 1.0 2.0 200.0 0.5 1.6 1.5 1.3 1.2" biasprm="0.875 1.0 2.0 200.0 0.5 1.6 1.5 1.3 1.2" joint="c" gear="2.0"/></actuator></mujoco>''')
d = mj.MjData(m)
d.ctrl[:] = [0.625, 0.625]
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
v = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
e = stepped(q, v, tau, integrator=mj.mjtIntegrator.mjINT_IMPLICITFAST)
value = np.r_[np.array(e.qpos), np.array(e.qvel)]
import numpy as np
value, expected = np.reshape(value, (6,))[(5,)], 0.029703357835488123
assert abs(value - expected) <= 1.5e-12, f"{value = }, {expected = }"
