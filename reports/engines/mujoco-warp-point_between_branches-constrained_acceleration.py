# mujoco-warp 4.0.0, point between branches: forward: qacc is imprecise (a: M a + h = tau + J^T f, J a + J' v = 0).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0"/><worldbody>
<body name="a0" pos="0.43951206496028694 0.1221979965419675 0.41258091829190213" xyaxes="-0.7132254391000211 -0.07363590274232297 0.6970561145617369 0.6170602506315591 -0.5376813208070085 0.5745741417308546"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><joint type="hinge" axis="0.0 0.0 1.0"/><body name="a1" pos="0.3262059647884482 0.43397876644592914 -0.45105071742985425" xyaxes="-0.7039166584903055 0.5832593650904054 0.4053515152730773 0.34124141538558556 -0.2228101289407642 0.9131866966108532"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><joint type="hinge" axis="0.0 0.0 1.0"/><body name="a2" pos="-0.07085113064756554 -0.4888392251231495 -0.3825746488129891" xyaxes="-0.6137984795499327 -0.22862705662581903 -0.7556329105331538 -0.7481936326584587 -0.13695174553287798 0.6491921960751201"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><joint type="hinge" axis="0.0 0.0 1.0"/><site name="s0_0" pos="1.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/></body></body></body>
<body name="b2" pos="-0.3435286213348929 -0.3319181023671881 0.14031195818060405" xyaxes="-0.6323037077361143 -0.11941261308689166 0.7654623759656138 0.7737326088234093 -0.14722067580528675 0.6161687452790475"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><joint type="hinge" axis="0.0 0.0 1.0"/><site name="s0_1" pos="0.21010466849219306 -0.21631528469460626 -0.13923979212341936" xyaxes="-0.8668691070067259 -0.27942780176604054 -0.41286566207128417 0.4966277653848939 -0.5564043461103332 -0.6661644438712857"/></body>
</worldbody><equality><connect site1="s0_0" site2="s0_1" solimp="0.9999 0.9999 0.001"/></equality></mujoco>''')
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
bs = [m.body(name).id for name in ['a0', 'a1', 'a2', 'b2']]
def axes(): return block_diag(d.site_xmat[m.site('s0_0').id].reshape(3, 3).T)
def block_diag(*parts):
    n, at = sum(map(len, parts)), 0
    R = np.zeros((n, n))
    for part in parts:
        R[at:at + len(part), at:at + len(part)], at = part, at + len(part)
    return R
def ways_round(): return np.array(3 * [1])
q = np.array([-0.2066128035377561, -2.567798387414511, -2.007105049864775, -1.0999465529229902])
v = np.array([-0.3145120807360483, -0.10778733126205983, -0.24305937866738725, 0.09600359954198834])
tau = np.array([0.0, 0.0, 0.0, 0.0])
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
value, expected = np.reshape(value, (4,))[(3,)], 0.11443353877111766
assert abs(value - expected) <= 3.7e-03, f"{value = }, {expected = }"
