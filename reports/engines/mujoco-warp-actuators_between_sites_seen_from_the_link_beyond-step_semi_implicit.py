# mujoco-warp 4.0.0, actuators between sites, seen from the link beyond: step, mjINT_EULER is wrong (q+, v+ (nq + nv) after a step: v+ = v + h M^-1 f, f = tau + Q - (bias); q+ where v+ leads in h).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0"/><worldbody>
<body name="a" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><joint type="hinge" axis="0.0 0.0 1.0"/><site name="u0_0" pos="-0.2462137928591217 0.15692586496629352 -0.02418158792402686" xyaxes="-0.36861653824808815 -0.864556215368734 -0.34156170481669496 -0.28972244170186684 -0.24228400676107698 0.9259370209912263"/><body name="c" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="-0.14129166278090316 -0.15153591764389374 -0.12482394563973753" mass="0.8934710999773726" diaginertia="0.09132244073059369 0.12069347933356742 0.16903778247163131" xyaxes="-0.5580275949113387 0.5503039600999753 -0.6211044636900878 -0.8034688269953 -0.1711773953721285 0.5702071056733775"/><joint type="hinge" axis="0.0 0.0 1.0"/><site name="u0_1" pos="0.2498098376334898 0.25684530691179447 -0.03808741457630349" xyaxes="-0.3964192512878423 -0.6622583537592845 0.6358188815098439 0.9129207611868112 -0.21111181823674013 0.34929569707465746"/></body></body>
</worldbody><actuator><general gainprm="0.5" biastype="affine" biasprm="0.25 -1.0 -0.75" site="u0_0" refsite="u0_1" gear="1.0 -2.0 1.5 0.0 0.0 0.0" ctrllimited="true" ctrlrange="-1.0 1.0"/></actuator></mujoco>''')
d = mj.MjData(m)
d.ctrl[:] = [2.0]
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
bs = [m.body(name).id for name in ['a', 'c']]
q = np.array([-1.0996201868492035, -0.45415795612897547])
v = np.array([0.0, 0.0])
tau = np.array([0.0, 0.0])
if 'nw' not in globals():
    from copy import copy
    n = copy(m)
    n.opt.timestep, n.opt.integrator = 0.015625, mj.mjtIntegrator.mjINT_EULER
    n.opt.disableflags = mj.mjtDisableBit.mjDSBL_EULERDAMP
    nw = made(n)[0]
dn = fresh(n)
put(dn, qpos=q, qvel=v, qfrc_applied=tau)
mjw.step(nw, dn)
value = np.r_[got(dn, 'qpos'), got(dn, 'qvel')]
import numpy as np
value, expected = np.reshape(value, (4,))[(3,)], -0.006564446700685198
assert abs(value - expected) <= 8.3e-04, f"{value = }, {expected = }"
