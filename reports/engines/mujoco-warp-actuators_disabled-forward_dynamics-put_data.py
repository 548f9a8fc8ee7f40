# mujoco-warp 4.0.0, actuators disabled: put_data, get_data_into is wrong (M^-1 (tau - h)).
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
bs = [m.body(name).id for name in ['c']]
q = np.array([0.0])
v = np.array([0.0])
tau = np.array([0.0])
d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau
mj.mj_forward(m, d)
e = mj.MjData(m)
dn = mjw.put_data(m, d)
mjw.forward(mw, dn)
mjw.get_data_into(e, m, dn)
value = e.qacc
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], 0.0
assert abs(value - expected) <= 1.8e-04, f"{value = }, {expected = }"
