# mujoco-warp 4.0.0, affine gains: step, mjINT_IMPLICIT is imprecise (q+, v+ (nq + nv) after a step: M + h D in place of M, D = -df/dv).
# Known: https://github.com/google-deepmind/mujoco/pull/3606 (of MuJoCo, whose derivative clamps by another actuator's range; of MuJoCo Warp none was found on 2026-11-29).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 -9.81"/><worldbody>
<body name="b" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="b" type="slide" axis="0.0 0.0 1.0"/></body>
</worldbody><actuator><general gaintype="affine" gainprm="1.5 0.0 -3.0" biastype="affine" biasprm="0.0 0.0 0.0" name="a0" joint="b" gear="-0.5" ctrllimited="true" ctrlrange="-1.0 1.0"/></actuator></mujoco>''')
d = mj.MjData(m)
d.ctrl[:] = [2.0]
import warp as wp
wp.config.quiet, wp.config.log_level = True, 30
import mujoco_warp as mjw
wp.set_device('cpu')
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
mw, dw = made(m, njmax=0, nconmax=0)
bs = [m.body(name).id for name in ['b']]
q = np.array([0.0])
v = np.array([0.0])
tau = np.array([0.0])
if 'nw' not in globals():
    from copy import copy
    n = copy(m)
    n.opt.timestep, n.opt.integrator = 0.015625, mj.mjtIntegrator.mjINT_IMPLICIT
    nw = made(n)[0]
dn = fresh(n)
put(dn, qpos=q, qvel=v, qfrc_applied=tau)
mjw.step(nw, dn)
value = np.r_[got(dn, 'qpos'), got(dn, 'qvel')]
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], -0.1630888030888031
assert abs(value - expected) <= 5.4e-04, f"{value = }, {expected = }"
