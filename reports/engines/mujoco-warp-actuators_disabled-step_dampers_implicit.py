# mujoco-warp 4.0.0, actuators disabled: step, mjINT_EULER is wrong (q+, v+ (nq + nv) after a step: M + h D in place of M, D of the joints' dampers).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0" actuatorgroupdisable="1"/><worldbody>
<body name="c" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><joint name="c" type="hinge" axis="0.0 0.0 1.0"/></body>
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
def made(model, **room):
    data = mjw.make_data(model, **room)
    if model.nu: put(data, ctrl=d.ctrl)
    if model.na: put(data, act=states)
    return mjw.put_model(model), data
wp.set_device('cpu')
mw, dw = made(m, njmax=0, nconmax=0)
bs = [m.body(name).id for name in ['c']]
q = np.array([0.0])
v = np.array([0.0])
tau = np.array([0.0])
from copy import copy
n = copy(m)
n.opt.timestep, n.opt.integrator = 0.015625, mj.mjtIntegrator.mjINT_EULER
nw, dn = made(n)
put(dn, qpos=q, qvel=v, qfrc_applied=tau)
mjw.step(nw, dn)
value = np.r_[got(dn, 'qpos'), got(dn, 'qvel')]
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], 0.0
assert abs(value - expected) <= 5.4e-04, f"{value = }, {expected = }"
