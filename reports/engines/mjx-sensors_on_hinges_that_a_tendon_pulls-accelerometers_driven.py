# mjx 3.17.0, sensors on hinges that a tendon pulls: forward, accelerometer is wrong (accelerometers at the accelerations that tau makes (n, 3)).
# Known: https://github.com/google-deepmind/mujoco/issues/2767 (why sensor_acc stands after the constraints; not its early return).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0"/><worldbody>
<body name="a" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="a" type="hinge" axis="0.0 0.0 1.0"/><site name="n0_0" pos="1.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><body name="b" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="b" type="hinge" axis="0.0 0.0 1.0"/><body name="c" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="0.0 0.0 0.0" mass="1.0" diaginertia="1.0 1.0 1.0" quat="1.0 0.0 0.0 0.0"/><joint name="c" type="hinge" axis="0.0 0.0 1.0"/><site name="o0" pos="0.21632981320829175 -0.27686732355241844 0.056451483406024794" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/><site name="n0_1" pos="1.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/></body></body></body>
</worldbody><tendon><spatial name="n0" stiffness="40.0" damping="0.5" springlength="0.25"><site site="n0_0"/><site site="n0_1"/></spatial></tendon><sensor><accelerometer name="accelerometer0" site="o0"/><gyro name="gyro0" site="o0"/><velocimeter name="velocimeter0" site="o0"/><force name="force0" site="o0"/><torque name="torque0" site="o0"/><frameangacc name="frameangacc0" objtype="site" objname="o0"/><magnetometer name="magnetometer0" site="o0"/></sensor></mujoco>''')
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
links = [m.body(name).id for name in ['a', 'b', 'c']]
bs = [m.body(name).id for name in ['a', 'b', 'c']]
sensed = range(1)
def data(e, kind, k):
    one = m.sensor(f'{kind}{k}')
    return np.array(e.sensordata)[one.adr[0]:one.adr[0] + one.dim[0]]
q = np.array([-1.0996201868492035, -1.8914015371177906, -0.45415795612897547])
v = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
e = forward(q, v, tau)[0]
value = [data(e, 'accelerometer', k) for k in sensed]
import numpy as np
value, expected = np.reshape(value, (1, 3))[(0, 0)], 6.840716546237207
assert abs(value - expected) <= 1.1e-11, f"{value = }, {expected = }"
