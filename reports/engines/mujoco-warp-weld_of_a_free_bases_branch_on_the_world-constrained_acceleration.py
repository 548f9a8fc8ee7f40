# mujoco-warp 4.0.0, weld of a free base's branch on the world: forward: qacc is wrong (a: M a + h = tau + J^T f, J a + J' v = 0).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0"/><worldbody>
<body name="base" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="-0.19784206240344127 0.10667553205039426 -0.10908931736865074" mass="1.3540319537841043" diaginertia="0.10326941532568919 0.14178932933567767 0.14670245744849153" xyaxes="0.39658031530872717 -0.6884615188625715 -0.6072436006703331 0.91392318765392 0.2338257244626732 0.3317678972534916"/><joint type="free"/><body name="a1" pos="-0.033835219788612814 0.1829177645118033 0.11366801633476964" xyaxes="-0.931416053024383 -0.32532614986057895 0.16317791635319945 0.3632903378314063 -0.8581414102779893 0.3627856810907044"><inertial pos="0.12654216971831567 -0.14566928806133694 0.10225515132732238" mass="0.5024225204810208" diaginertia="0.06993944549311433 0.12878809832488483 0.13072793757413634" xyaxes="0.48767846264937 -0.847662815244569 -0.20889583222170646 -0.2635445424534544 0.08517390775710212 -0.9608796384461396"/><joint type="hinge" axis="0.0 0.0 1.0"/><site name="s0_0" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/></body></body>
<site name="s0_1" pos="-0.114420853981194 0.10109569888816794 0.22405612138854109" xyaxes="-0.0567033309452612 0.7458577912804943 -0.663687341634519 -0.9648228904658126 0.12999017836035054 0.22851552149260834"/>
</worldbody><equality><weld site1="s0_0" site2="s0_1" solimp="0.9999 0.9999 0.001"/></equality></mujoco>''')
d = mj.MjData(m)
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
mw, dw = made(m, njmax=64, nconmax=0)
bs = [m.body(name).id for name in ['base', 'a1']]
def turned(name):
    site, quaternion = m.site(name), np.zeros(4)
    mj.mju_mulQuat(quaternion, d.xquat[m.site_bodyid[site.id]], site.quat)
    return quaternion
def sign(a, b): return np.sign(turned(a) @ turned(b))
def axes(): return block_diag(d.site_xmat[m.site('s0_0').id].reshape(3, 3).T, 2 * sign('s0_0', 's0_1') * np.eye(3))
def block_diag(*parts):
    n, at = sum(map(len, parts)), 0
    R = np.zeros((n, n))
    for part in parts:
        R[at:at + len(part), at:at + len(part)], at = part, at + len(part)
    return R
def ways_round(): return np.array(3 * [1] + 3 * [sign('s0_0', 's0_1')])
q = np.array([-0.13084612349241606, 0.072833934975734, 0.008520435638681352, -0.28015033497745295, -0.09012723846279547, -0.545965602532586, -0.7844198056846355, 1.7901726105420424])
v = np.array([3.891983098101253, -1.4071518422683749, -0.11208481825296346, -0.7097070178005189, -12.809438084362405, -29.589038707515567, 32.25052867354398])
tau = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
m.eq_solref[:] = 0.0
m.opt.tolerance = 0.0
m.opt.jacobian = mj.mjtJacobian.mjJAC_DENSE
d.qpos[:] = q
mj.mj_kinematics(m, d)
if 'mc' not in globals(): mc = made(m)[0]
dc = fresh(m)
put(dc, qpos=q, qvel=v, qfrc_applied=tau)
mjw.forward(mc, dc)
rows = int(dc.nefc.numpy()[0])
def row(name): return getattr(dc.efc, name).numpy()[0][:rows]
value = got(dc, 'qacc')
import numpy as np
value, expected = np.reshape(value, (7,))[(6,)], 5.07931436520208e-28
assert abs(value - expected) <= 1.1e+00, f"{value = }, {expected = }"
