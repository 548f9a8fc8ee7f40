# mjx 3.17.0, actuators between sites, seen from the link beyond: put_data, actuator_moment is wrong (their derivatives (nu, nv)).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0"/><worldbody>
<body name="a" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="a" type="hinge" axis="0.0 0.0 1.0"/><site name="u0_0" pos="-0.2462137928591217 0.15692586496629352 -0.02418158792402686" xyaxes="-0.36861653824808815 -0.864556215368734 -0.34156170481669496 -0.28972244170186684 -0.24228400676107698 0.9259370209912263"/><body name="c" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="c" type="hinge" axis="0.0 0.0 1.0"/><site name="u0_1" pos="0.2498098376334898 0.25684530691179447 -0.03808741457630349" xyaxes="-0.3964192512878423 -0.6622583537592845 0.6358188815098439 0.9129207611868112 -0.21111181823674013 0.34929569707465746"/></body></body>
</worldbody><actuator><general gainprm="0.5" biastype="affine" biasprm="0.25 -1.0 -0.75" name="a0" site="u0_0" refsite="u0_1" gear="1.0 -2.0 1.5 0.0 0.0 0.0" ctrllimited="true" ctrlrange="-1.0 1.0"/></actuator></mujoco>''')
d = mj.MjData(m)
d.ctrl[:] = [2.0]
import os
os.environ['XLA_FLAGS'] = os.environ.get('XLA_FLAGS', '') + ' --xla_backend_optimization_level=0'
import jax
jax.config.update("jax_enable_x64", True)
from mujoco import mjx
def got(e, name): return np.array(getattr(e, name) if hasattr(e, name) else getattr(e._impl, name))
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
def stepped(q, v, tau, **options):
    from copy import copy
    n = copy(m)
    n.opt.timestep = 0.015625
    for name, value in options.items(): setattr(n.opt, name, value)
    if (name := str(options)) not in steps: steps[name] = mjx.put_model(n)
    return jax.jit(mjx.step)(steps[name], empty.replace(qpos=q, qvel=v, qfrc_applied=tau))
def slopes(q, v, tau, way, **options):
    after = np.array(stepped(q, v, tau, **options).qpos)
    def end(model, q, v, tau):
        e = mjx.step(model, empty.replace(qpos=q, qvel=v, qfrc_applied=tau))
        return jax.numpy.concatenate([e.qpos, e.qvel])
    compiled = steps.setdefault(way, jax.jit(way(end, (1, 2, 3))))
    by_q, by_v, by_tau = (np.array(one) for one in compiled(steps[str(options)], q, v, tau))
    N = along(after)
    back = np.linalg.solve(N.T @ N, N.T)
    D = np.hstack([by_q @ along(q), by_v, by_tau])
    return np.vstack([back @ D[:m.nq], D[m.nq:]])
def along(q):
    N = np.zeros((m.nq, m.nv))
    for kind, i, k in zip(m.jnt_type, m.jnt_qposadr, m.jnt_dofadr):
        kind = mj.mjtJoint(kind)
        if kind == mj.mjtJoint.mjJNT_FREE:
            N[i:i + 3, k:k + 3] = np.eye(3)
            i, k = i + 3, k + 3
        if kind in (mj.mjtJoint.mjJNT_FREE, mj.mjtJoint.mjJNT_BALL):
            w, x, y, z = q[i:i + 4]
            N[i:i + 4, k:k + 3] = np.array([[-x, -y, -z], [w, -z, y], [z, w, -x], [-y, x, w]]) / 2
        else: N[i, k] = 1.0
    return N
def bound(q, v, tau):
    m.eq_solref[:] = 0.0
    m.opt.jacobian, m.opt.tolerance = mj.mjtJacobian.mjJAC_DENSE, 0.0
    d.qpos[:] = q
    mj.mj_kinematics(m, d)
    if 'equal' not in steps: steps['equal'] = mjx.put_model(m)
    return jax.jit(mjx.forward)(steps['equal'], mjx.make_data(m).replace(qpos=q, qvel=v, qfrc_applied=tau))
def of_links(call, e):
    point = jax.jit(lambda mx, e, b: call(mx, e, e.xpos[b], b))
    return [np.vstack([np.array(J).T for J in point(mx, e, b)]) for b in links]
steps = {}
links = [m.body(name).id for name in ['a', 'c']]
bs = [m.body(name).id for name in ['a', 'c']]
q = np.array([0.0, 0.0])
v = np.array([0.0, 0.0])
tau = np.array([0.0, 0.0])
if globals().get('made_by') != 'put_data':
    made_by = 'put_data'
    def forward(q, v, tau):
        d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau
        mj.mj_forward(m, d)
        return (mjx.put_data(m, d),)
value = got(forward(q, v, tau)[0], 'actuator_moment').reshape(-1, m.nv)
import numpy as np
value, expected = np.reshape(value, (1, 2))[(0, 1)], -0.16517319957578488
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
