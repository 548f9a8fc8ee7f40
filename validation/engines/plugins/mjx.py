"""MJX: MuJoCo in JAX, from MuJoCo's own compiler."""

from __future__ import annotations

from dataclasses import replace

from ..interface import DOUBLE, STEP, Convention, Tree, Unsupported
from ..models.covering import COVERING
from ..truth.devices import DEVICES
from ..truth.devices.bound import SOLVED
from ..truth.devices.device import model
from . import mujoco
from .mujoco import covered, elsewhere
from .mujoco.elements import BOUND, KINDS, SOFT_FORCES
from .writing import copies
from .writing.source import Source, SourcePlugin, Way

# What is compiled is asked a few times: the time is that of compiling. MJX's own functions are compiled, with the model
# as an argument: trees of one structure share what is compiled.
_STARTED = """import os
os.environ['XLA_FLAGS'] = os.environ.get('XLA_FLAGS', '') + ' --xla_backend_optimization_level=0'
import jax
jax.config.update("jax_enable_x64", True)
from mujoco import mjx
def got(e, name): return np.array(getattr(e, name) if hasattr(e, name) else getattr(e._impl, name))"""
_SETUP = (
    f"{_STARTED}\n"
    + """mx, empty = mjx.put_model(m), mjx.make_data(m)
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
    n.opt.timestep = STEP
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
links = [m.body(name).id for name in LINKS]"""
)
_ANSWER = (
    f"{_STARTED}\n"
    + """def prepared(m): return mjx.put_model(m), mjx.make_data(m)
def answer(text, field, steps, **given):
    (model, data), places = found(text, prepared)
    for name, numbers in given.items():
        values = np.array(getattr(data, name))
        values[places(name)] = numbers
        data = data.replace(**{name: jax.numpy.array(values)})
    if not steps: data = jax.jit(mjx.forward)(model, data)
    for _ in range(steps): data = jax.jit(mjx.step)(model, data)
    return got(data, field)[places(field)].ravel()"""
)
# "MJX can be thought of as a function that is MuJoCo's, in JAX": docs/mjx.rst, "Feature parity".
_STEPPED = (
    f"{_STARTED}\n"
    + """def stepped(m, given):
    model = mjx.put_model(m)
    data = mjx.make_data(m).replace(**{name: jax.numpy.array(values) for name, values in given.items()})
    data = jax.jit(mjx.step)(model, data)
    return lambda name: got(data, name)"""
)
# Devices that it says it does not support, and those whose options or steps would be compiled by themselves.
_UNSUPPORTED = (
    *(
        "drive_pid",
        "drive_dc_motor",
        "ball_oriented",
        "adhesion",
        "sensed_limit",
        "sensed_tendon_limit",
        "sensed_inside",
    ),
    *("sensed_distance", "sensed_contact", "sensed_range", "limit_force", "fluid"),
)
_PLAIN, _SOLVED = (model("", option=one).partition("<worldbody>")[0] for one in ("", SOLVED))
_UNKNOWN = {
    name
    for devices in DEVICES.values()
    for name, one in devices.items()
    if one.steps or name.startswith(_UNSUPPORTED) or not (_PLAIN in one.model or _SOLVED in one.model)
}
_DEVICES = elsewhere.ways(_UNKNOWN)
_SENSED = (
    "sensed = range({count})",
    "def data(e, kind, k):\n    one = m.sensor(f'{{kind}}{{k}}')\n"
    "    return np.array(e.sensordata)[one.adr[0]:one.adr[0] + one.dim[0]]",
)


def _field(name: str) -> Way:
    """A field of what mjx.forward answers."""
    return Way(name, f"value = got(forward(q, v, tau)[0], '{name}')")


def _sensor(kind: str) -> Way:
    return Way(kind, f"e = read(q, v, a)\nvalue = [data(e, '{kind}', k) for k in sensed]")


def _step(integrator: str) -> Way:
    code = f"e = stepped(q, v, tau, integrator=mj.mjtIntegrator.{integrator})"
    return Way(f"step, {integrator}", f"{code}\nvalue = np.r_[np.array(e.qpos), np.array(e.qvel)]")


def _slopes(way: str, columns: str) -> Way:
    """Derivatives of a step by JAX, coordinates along speeds."""
    given = f"jax.{way}, integrator=mj.mjtIntegrator.mjINT_EULER"
    return Way(f"{way} of step", f"value = slopes(q, v, tau, {given})[{columns}]")


# Rows of constraints as MuJoCo's own data turn them (`axes`).
_BOUND = {
    "constraint_jacobian": Way("efc_J", "e = bound(q, v, tau)\nvalue = axes() @ got(e, 'efc_J')"),
    "constraint_residuals": Way("efc_pos", "e = bound(q2, v, tau)\nvalue = got(e, 'efc_pos') * ways_round()"),
    # Its iterations leave more than MuJoCo's of where rows are weakest.
    "constrained_acceleration": Way("forward: qacc", "value = got(bound(q, v, tau), 'qacc')", SOFT_FORCES),
    "constraint_forces": Way(
        "forward: efc_force",
        "e = bound(q, v, tau)\nvalue = np.linalg.solve(axes().T, got(e, 'efc_force'))",
        SOFT_FORCES,
    ),
    "wrench_sensors:bound": Way(
        "inverse with constraints, rne_postconstraint: force, torque",
        BOUND.replace(
            "mj.mj_inverse(n, d)\nforces = d.efc_force\n",
            "e = jax.jit(mjx.inverse)(mjx.put_model(n), mjx.make_data(n).replace(qpos=q, qvel=v, qacc=a))\n"
            "forces = got(e, 'efc_force')\n",
        ).replace("data('", "data(e, '"),
    ),
}
_STEPS = {
    "step_dampers_implicit": _step("mjINT_EULER"),
    "step_forces_implicit": _step("mjINT_IMPLICITFAST"),
}
_SLOPES = {
    "step_dampers_implicit_derivative": _slopes("jacfwd", ":, :2 * m.nv"),
    "step_dampers_implicit_derivative:jacrev": _slopes("jacrev", ":, :2 * m.nv"),
    "step_dampers_implicit_force_derivative": _slopes("jacfwd", ":, 2 * m.nv:"),
}
WAYS = {
    "mass_matrix": Way("full_m", "value = forward(q, v, tau)[1]"),
    "bias": Way("qfrc_bias", "value = got(forward(q, v, tau)[0], 'qfrc_bias')"),
    "gravity": Way("qfrc_bias", "value = got(forward(q, 0 * v, tau)[0], 'qfrc_bias')"),
    "link_poses": Way(
        "xpos, xmat",
        "e = forward(q, v, tau)[0]\nvalue = [[*got(e, 'xpos')[k], *np.ravel(got(e, 'xmat')[k])] for k in links]",
    ),
    "forward_dynamics": Way("forward", "value = got(forward(q, v, tau)[0], 'qacc')"),
    "inverse_dynamics_acted": Way("inverse", "value = inverse(q, v, a)"),
    "mass_centre": Way("subtree_com", "value = got(forward(q, v, tau)[0], 'subtree_com')[0]"),
    "link_velocities": Way(
        "cvel",
        "e, value = forward(q, v, tau)[0], []\nfor b in links:\n    w, u = got(e, 'cvel')[b].reshape(2, 3)\n"
        "    value.append([*(u + np.cross(w, got(e, 'xpos')[b] - got(e, 'subtree_com')[m.body_rootid[b]])), *w])",
    ),
    "passive_forces": _field("qfrc_passive"),
    "tendon_lengths": _field("ten_length"),
    "tendon_arms": Way("ten_J", "value = got(forward(q, v, tau)[0], 'ten_J').reshape(-1, m.nv)"),
    "tendon_speeds": _field("ten_velocity"),
    "actuator_lengths": _field("actuator_length"),
    "actuator_speeds": _field("actuator_velocity"),
    "actuator_arms": Way("actuator_moment", "value = got(forward(q, v, tau)[0], 'actuator_moment').reshape(-1, m.nv)"),
    "actuator_forces": _field("actuator_force"),
    "actuated_forces": _field("qfrc_actuator"),
    "activation_rates": _field("act_dot"),
    "activations_after_step": Way(
        "step", "value = got(stepped(q, v, 0 * v, integrator=mj.mjtIntegrator.mjINT_EULER), 'act')"
    ),
    "accelerometers": _sensor("accelerometer"),
    "gyroscopes": _sensor("gyro"),
    "velocimeters": _sensor("velocimeter"),
    "angular_accelerations": _sensor("frameangacc"),
    "accelerometers_driven": Way(
        "forward, accelerometer", "e = forward(q, v, tau)[0]\nvalue = [data(e, 'accelerometer', k) for k in sensed]"
    ),
    "wrench_sensors": Way(
        "force, torque",
        "e = read(q, v, a)\nvalue = [[*data(e, 'force', k), *data(e, 'torque', k)] for k in sensed]",
    ),
    "frame_poses": Way(
        "site_xpos, site_xmat",
        "e, own = forward(q, v, tau)[0], [m.site(f'o{k}').id for k in sensed]\n"
        "value = np.hstack([got(e, 'site_xpos')[own], got(e, 'site_xmat')[own].reshape(-1, 9)])",
    ),
    "link_jacobians": Way("jac", "value = of_links(mjx.jac, forward(q, v, tau)[0])"),
    "link_jacobian_rates": Way(
        "jac_dot",
        "from mujoco.mjx._src.support import jac_dot\nvalue = of_links(jac_dot, forward(q, v, tau)[0])",
    ),
    **_STEPS,
    **_SLOPES,
    **_BOUND,
}

# What goes to JAX from MuJoCo's data, and comes from there.
_PUT = """def forward(q, v, tau):
    d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau
    mj.mj_forward(m, d)
    return (mjx.put_data(m, d),)
"""
_GOT = "def returned(q, v, tau): return (mjx.get_data(m, forward(q, v, tau)[0]),)\n"
_FIELDS = ("bias", "link_poses", "tendon_lengths", "frame_poses")
_RETURNED = {name: way._replace(code=way.code.replace("forward(q", "returned(q")) for name, way in WAYS.items()}
WAYS |= copies.of_model(WAYS, {"put_data": _PUT}, (*_FIELDS, "actuator_arms")) | copies.of_model(
    _RETURNED, {"get_data": _GOT}, _FIELDS
)


def write(tree: Tree) -> Source | Unsupported:
    """The text that builds the tree in MuJoCo, and puts it into JAX."""
    if tree.asked == COVERING:
        return covered.write(tree, "mujoco-mjx", DOUBLE, _STEPPED)
    if tree.asked in DEVICES:
        return elsewhere.write(tree.asked, _DEVICES, tuple(_ANSWER.split("\n")))
    source = covered.by_scenes() if tree.features else mujoco.write(tree)
    if isinstance(source, Unsupported):
        return source
    setup = _SETUP.replace("STEP", repr(STEP)).replace("LINKS", repr([link.name for link in tree.links]))
    optional = dict(source.optional)
    if tree.sensors:
        optional["sensed"] = tuple(line.format(count=len(tree.sensors)) for line in _SENSED)
    # What is compiled by itself takes seconds: it is asked of trees that forces act on, or that have sensors.
    lacks = () if tree.forces else tuple(_STEPS) if tree.sensors else (*_STEPS, "inverse_dynamics_acted")
    # Derivatives take longest: they are asked where JAX has most to divide by, of the few trees that turn any way.
    turns_any_way = any(joint.kind in ("ball", "free") for link in tree.links for joint in link.joints)
    lacks += () if turns_any_way and tree.forces <= {"dampers", "springs"} else tuple(_SLOPES)
    return replace(source, lines=(*source.lines, *setup.split("\n")), optional=optional, lacks=lacks)


_OFFERED = ("dampers", "springs", "compensation", "sensors", "tendons", "wrapped tendons", "heavy tendons")
_HELD = ("scaled welds", "points by bodies", "sensors of bound links")
_DRIVEN = ("actuators", "activations", "affine gains")
PLUGIN = SourcePlugin(
    name="mjx",
    package="mujoco-mjx",
    extra="symofros[engine-mjx]",
    conventions=(
        Convention("model", "of MuJoCo's compiler; conventions are MuJoCo's"),
        Convention("precision", "single unless JAX is told otherwise"),
    ),
    kinds=mujoco.PLUGIN.kinds,
    ways=WAYS | _DEVICES | covered.ways(("scene_qfrc_spring", "scene_qfrc_damper", "scene_energy")),
    write=write,
    constraints=KINDS,
    demands={name: mujoco.PLUGIN.demands[name] for name in (*_OFFERED, *_DRIVEN, *_HELD, *DEVICES, "a medium")}
    | {COVERING: "put_model, step"},
    statements=tuple(one for one in mujoco.PLUGIN.statements if "constraint" in one.functions),
    calls=4,
)
