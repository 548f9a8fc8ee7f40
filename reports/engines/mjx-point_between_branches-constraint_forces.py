# mjx 3.17.0, point between branches: forward: efc_force is imprecise (f: M a + h = tau + J^T f, J a + J' v = 0).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0"/><worldbody>
<body name="a0" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="a0" type="hinge" axis="0.0 1.0 0.0"/><body name="a1" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="a1" type="hinge" axis="1.0 0.0 0.0"/><body name="a2" pos="0.0 1.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="a2" type="hinge" axis="1.0 0.0 0.0"/><site name="s0_0" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/></body></body></body>
<body name="b0" pos="0.0 1.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="b0" type="hinge" axis="1.0 0.0 0.0"/><body name="b2" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="b2" type="hinge" axis="0.0 1.0 0.0"/><site name="s0_1" pos="1.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/></body></body>
</worldbody><equality><connect site1="s0_0" site2="s0_1" solimp="0.9999 0.9999 0.001"/></equality></mujoco>''')
d = mj.MjData(m)
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
links = [m.body(name).id for name in ['a0', 'a1', 'a2', 'b0', 'b2']]
bs = [m.body(name).id for name in ['a0', 'a1', 'a2', 'b0', 'b2']]
def axes(): return block_diag(d.site_xmat[m.site('s0_0').id].reshape(3, 3).T)
def block_diag(*parts):
    n, at = sum(map(len, parts)), 0
    R = np.zeros((n, n))
    for part in parts:
        R[at:at + len(part), at:at + len(part)], at = part, at + len(part)
    return R
def ways_round(): return np.array(3 * [1])
q = np.array([0.9981456560596375, -5.235987755982989, -1.237716704978997, -2.324496626610653, 0.7555911308902866])
v = np.array([0.38508156689581896, 2.781032171467463e-15, 0.0, 0.2980450587254691, -0.26352731846973254])
tau = np.array([0.0, 0.0, 0.0, 0.0, 0.0])
e = bound(q, v, tau)
value = np.linalg.solve(axes().T, got(e, 'efc_force'))
import numpy as np
value, expected = np.reshape(value, (3,))[(2,)], 0.5187037716667795
assert abs(value - expected) <= 5.0e-02, f"{value = }, {expected = }"
