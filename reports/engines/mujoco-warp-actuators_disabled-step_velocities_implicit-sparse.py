# mujoco-warp 4.0.0, actuators disabled: step, mjINT_IMPLICIT is wrong (q+, v+ (nq + nv) after a step: M + h D in place of M, D = -df/dv).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0" actuatorgroupdisable="1"/><worldbody>
<body name="a" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="-0.19363549925678827 0.17992215962247687 0.15707617325004608" mass="1.2563911747131722" diaginertia="0.07879440491625532 0.10542779965857761 0.1428972946967548" xyaxes="0.6682640434895628 -0.32771536725241845 -0.6678516349052327 0.5205182987770598 -0.43540671647722407 0.7344941741666554"/><joint type="hinge" axis="0.0 0.0 1.0" damping="0.75"/><body name="b" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.1206164549494585 0.11683445731630915 0.15255028168814183" mass="0.7685137383172533" diaginertia="0.13742159834263545 0.16007628961480375 0.167456348885842" xyaxes="-0.596996999696463 -0.42495074013001954 0.6804494476567455 0.4355595131804873 -0.8839776423513666 -0.16991597423696375"/><joint type="slide" axis="0.0 0.0 1.0"/><body name="c" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="-0.14129166278090316 -0.15153591764389374 -0.12482394563973753" mass="0.8934710999773726" diaginertia="0.09132244073059369 0.12069347933356742 0.16903778247163131" xyaxes="-0.5580275949113387 0.5503039600999753 -0.6211044636900878 -0.8034688269953 -0.1711773953721285 0.5702071056733775"/><joint name="c" type="hinge" axis="0.0 0.0 1.0" stiffness="3.0" springref="0.25"/></body></body></body>
</worldbody><actuator><velocity kv="1.5" joint="c" gear="2.0" group="1"/></actuator></mujoco>''')
d = mj.MjData(m)
d.ctrl[:] = [0.5]
import warp as wp
wp.config.quiet, wp.config.log_level = True, 30
import mujoco_warp as mjw
def put(data, **fields):
    for name, value in fields.items():
        getattr(data, name).assign(np.asarray(value, np.float32)[None])
def got(data, name): return getattr(data, name).numpy()[0]
def fresh(model, **sizes):
    data = mjw.make_data(model, **sizes)
    if model.nu: put(data, ctrl=d.ctrl)
    if model.na: put(data, act=states)
    return data
def made(model, **sizes): return mjw.put_model(model), fresh(model, **sizes)
def sense(kind, b=None):
    one = m.sensor(f'{kind}:{m.body(b).name}' if b else kind)
    return got(dw, 'sensordata')[one.adr[0]:one.adr[0] + one.dim[0]]
wp.set_device('cpu')
mw, dw = made(m, njmax=0, nconmax=0)
bs = [m.body(name).id for name in ['a', 'b', 'c']]
q = np.array([-1.0996201868492035, -0.7565606148471162, -0.45415795612897547])
v = np.array([-0.8020666483629364, 0.9725767279334938, 0.3881357647151733])
tau = np.array([0.0, 0.0, 0.0])
if 'nw' not in globals():
    from copy import copy
    n = copy(m)
    n.opt.timestep, n.opt.integrator = 0.015625, mj.mjtIntegrator.mjINT_IMPLICIT
    n.opt.jacobian = mj.mjtJacobian.mjJAC_SPARSE
    nw = made(n)[0]
dn = fresh(n)
put(dn, qpos=q, qvel=v, qfrc_applied=tau)
mjw.step(nw, dn)
value = np.r_[got(dn, 'qpos'), got(dn, 'qvel')]
import numpy as np
value, expected = np.reshape(value, (6,))[(5,)], 0.6563211580969379
assert abs(value - expected) <= 8.4e-04, f"{value = }, {expected = }"
