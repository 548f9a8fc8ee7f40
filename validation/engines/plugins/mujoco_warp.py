"""MuJoCo Warp: MuJoCo in Warp, on the CPU, from MuJoCo's own compiler."""

from __future__ import annotations

from dataclasses import replace

from ..interface import SINGLE, STEP, Convention, Tree, Unsupported
from ..models.covering import COVERING
from ..tree import SOFT_LIMITS
from ..truth.devices import DEVICES
from . import mujoco
from .mujoco import covered, elsewhere
from .mujoco.elements import KINDS
from .mujoco.forces import COPY, SPARSE
from .newton import QUIET
from .writing.source import Source, SourcePlugin, Way

# Trees without constraints need no memory for their rows; Warp then compiles no kernels of the solver.
_STARTED = f"""import warp as wp
{QUIET}
import mujoco_warp as mjw
wp.set_device('cpu')
def put(data, **fields):
    for name, value in fields.items():
        getattr(data, name).assign(np.asarray(value, np.float32)[None])
def got(data, name): return getattr(data, name).numpy()[0]"""
_SETUP = (
    f"{_STARTED}\n"
    + """def fresh(model, **sizes):
    data = mjw.make_data(model, **sizes)
    if model.nu: put(data, ctrl=d.ctrl)
    if model.na: put(data, act=states)
    return data
def made(model, **sizes): return mjw.put_model(model), fresh(model, **sizes)
mw, dw = made(m, njmax=0, nconmax=0)"""
)
_ANSWER = (
    f"{_STARTED}\n"
    + """def prepared(m): return m, mjw.put_model(m)
def answer(text, field, steps, **given):
    (m, model), places = found(text, prepared)
    data = mjw.make_data(m, njmax=256, nconmax=16)
    for name, numbers in given.items():
        values = got(data, name)
        values[places(name)] = numbers
        put(data, **{name: values})
    if not steps: mjw.forward(model, data)
    for _ in range(steps): mjw.step(model, data)
    return got(data, field)[places(field)].ravel()"""
)
_STEPPED = (
    f"{_STARTED}\n"
    + """def stepped(m, given):
    data = mjw.make_data(m, njmax=64, nconmax=8)
    put(data, **given)
    model = mjw.put_model(m)
    mjw.forward(model, data)  # Velocity products are those of the call before (causes/stated).
    mjw.step(model, data)
    return lambda name: got(data, name)"""
)
_UNKNOWN = {name for name in DEVICES["drives"] if name.startswith("drive_pid")} | {
    name for name in DEVICES["transmissions"] if name.startswith("ball_oriented")
}
_DEVICES = elsewhere.ways(_UNKNOWN)
_Q = "put(dw, qpos=q)\nmjw.fwd_position(mw, dw)\n"
_QV = "put(dw, qpos=q, qvel=v)\nmjw.fwd_position(mw, dw)\nmjw.fwd_velocity(mw, dw)\n"
_INVERSE = "put(dw, qpos=q, qvel=v, qacc=a)\nmjw.inverse(mw, dw)\n"
# About the mass centre of the whole mechanism that the body is in.
_HELD = """mjw.rne_postconstraint(mw, dw)
value = []
for b in bs:
    moment, force = got(dw, 'cfrc_int')[b].reshape(2, 3)
    R, arm = got(dw, 'xmat')[b], got(dw, 'subtree_com')[m.body_rootid[b]] - got(dw, 'xpos')[b]
    value.append([*(R.T @ force), *(R.T @ (moment + np.cross(arm, force)))])"""
# Rows by MuJoCo's numbering of M, of which the lower triangle is kept.
_FULL = """value, M = np.zeros((m.nv, m.nv)), got(dw, 'M')
for i in range(m.nv):
    row = slice(m.M_rowadr[i], m.M_rowadr[i] + m.M_rownnz[i])
    value[i, m.M_colind[row]] = value[m.M_colind[row], i] = M[row]"""
_JACOBIANS = """value = np.zeros((len(bs), 6, m.nv))
Jp, Jr = wp.zeros((1, 3, m.nv), dtype=float), wp.zeros((1, 3, m.nv), dtype=float)
for k, b in enumerate(bs):
    point = wp.array(got(dw, 'xpos')[b][None], dtype=wp.vec3)
    mjw.jac(mw, dw, Jp, Jr, point, wp.array([b], dtype=int))
    value[k] = np.vstack([Jp.numpy()[0], Jr.numpy()[0]])"""


def _step(integrator: str, settings: str = "", sizes: str = "") -> Way:
    """A step with options of a model of its own."""
    stated = f"n.opt.timestep, n.opt.integrator = {STEP}, mj.mjtIntegrator.{integrator}\n{settings}"
    code = (
        f"dn = fresh(n{sizes})\nput(dn, qpos=q, qvel=v, qfrc_applied=tau)\nmjw.step(nw, dn)\n"
        "value = np.r_[got(dn, 'qpos'), got(dn, 'qvel')]"
    )
    return Way(f"step, {integrator}{sizes}", f"{_kept(stated, sizes)}{code}")


def _kept(stated: str, sizes: str = "") -> str:
    """A model with options of its own, made once: data are new for each call."""
    made = f"{COPY}{stated}nw = made(n{sizes})[0]".replace("\n", "\n    ")
    return f"if 'nw' not in globals():\n    {made}\n"


# Rows of constraints as MuJoCo's own data turn them (`axes`).
_ROWS = """m.eq_solref[:] = 0.0
m.opt.tolerance, m.opt.jacobian = 0.0, mj.mjtJacobian.mjJAC_DENSE
d.qpos[:] = {at}
mj.mj_kinematics(m, d)
if 'mc' not in globals(): mc = made(m)[0]
dc = fresh(m)
put(dc, qpos={at}, qvel=v, qfrc_applied=tau)
mjw.forward(mc, dc)
{again}rows = int(dc.nefc.numpy()[0])
def row(name): return getattr(dc.efc, name).numpy()[0][:rows]
"""


def _bound(native: str, code: str, at: str = "q", again: str = "") -> Way:
    """A field of constraints."""
    return Way(native, _ROWS.format(at=at, again=again) + code)


_CONSTRAINED = {
    "constraint_jacobian": _bound("efc.J", "value = axes() @ row('J')[:, :m.nv]"),
    "constraint_velocity_products": _bound("-efc.aref", "value = -axes() @ row('aref')"),
    "constraint_residual_products": _bound(
        "-efc.aref after a second forward",
        "value = -row('aref') * ways_round()",
        at="q2",
        again="mjw.forward(mc, dc)\n",
    ),
    "constraint_points": Way("set_const, eq_data", "value = made(m)[0].eq_data.numpy()[0][:, :6]"),
}
WAYS = {
    "mass_matrix": Way("crb", f"{_Q}{_FULL}"),
    "inverse_dynamics": Way("inverse", f"{_INVERSE}value = got(dw, 'qfrc_inverse')"),
    "link_jacobians": Way("jac", f"{_Q}{_JACOBIANS}"),
    "joint_wrenches": Way("rne_postconstraint: cfrc_int", f"{_INVERSE}{_HELD}"),
    "step_dampers_implicit:njmax_0": _step("mjINT_EULER", sizes=", njmax=0"),
    "step_velocities_implicit": _step("mjINT_IMPLICIT"),
    "step_forces_implicit:sparse": _step("mjINT_IMPLICITFAST", SPARSE),
    "step_stiffness_implicit_lone": _step("mjINT_DISCRETE", "n.opt.tolerance = 0.0\n"),
    "inverse_dynamics_acted": Way("inverse", f"{_INVERSE}value = got(dw, 'qfrc_inverse')"),
    "forward_dynamics:put_data": Way(
        "put_data, get_data_into",
        "d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau\nmj.mj_forward(m, d)\ne = mj.MjData(m)\n"
        "dn = mjw.put_data(m, d)\nmjw.forward(mw, dn)\nmjw.get_data_into(e, m, dn)\nvalue = e.qacc",
    ),
    "actuator_arms": Way(
        "actuator_moment",
        f"{_QV}value = np.zeros((m.nu, m.nv))\n"
        "parts = (got(dw, name) for name in ('moment_rownnz', 'moment_rowadr', 'moment_colind', 'actuator_moment'))\n"
        "rows, firsts, columns, arms = parts\n"
        "for row, n, first in zip(value, rows, firsts):\n"
        "    row[columns[first:first + n]] = arms[first:first + n]",
    ),
    "actuator_forces": Way("actuator_force", f"{_QV}mjw.fwd_actuation(mw, dw)\nvalue = got(dw, 'actuator_force')"),
    **_CONSTRAINED,
}


def write(tree: Tree) -> Source | Unsupported:
    """The text that builds the tree in MuJoCo, and puts it into Warp."""
    if tree.asked == COVERING:
        return covered.write(tree, "mujoco-warp", SINGLE, _STEPPED)
    if tree.asked in DEVICES:
        return elsewhere.write(tree.asked, _DEVICES, tuple(_ANSWER.split("\n")))
    source = covered.by_scenes() if tree.features else mujoco.write(tree)
    if isinstance(source, Unsupported):
        return source
    setup = tuple(_SETUP.replace("njmax=0", f"njmax={'64' if tree.constraints else '0'}").split("\n"))
    if not tree.changed:
        return replace(source, lines=(*source.lines, *setup))
    made = _CHANGE.replace("FIELDS", repr([_place(name) for name in mujoco.CHANGED[tree.changed]]))
    return replace(source, lines=(*source.lines, *setup, *made.split("\n")), closing=())


def _place(name: str) -> tuple[str, str, int | None]:
    """Where a field of a model stands: in what of it, its name, and the number of columns that count."""
    field, _, columns = name.partition("[:, :")
    holder, _, own = field.rpartition(".")
    return holder, own, int(columns.rstrip("]")) if columns else None


# Warp's models are changed once they are made of MuJoCo's first: numbers of `last` replace those of the first.
_CHANGE = """plain = made
def made(model, **sizes):
    model, data = plain(model, **sizes)
    for holder, name, count in FIELDS:
        array = getattr(getattr(model, holder) if holder else model, name)
        numbers = array.numpy()
        numbers[0][..., :count] = getattr(getattr(last, holder) if holder else last, name)[..., :count]
        array.assign(numbers)
    mjw.set_const(model, data)
    return model, data
mw, dw = made(m, njmax=64, nconmax=0)"""
_UNOFFERED = ("flexible bodies", "a lone body", "turns", "vectors", "sensors of bound links", SOFT_LIMITS)
PLUGIN = SourcePlugin(
    name="mujoco-warp",
    package="mujoco-warp",
    extra="symofros[engine-mujoco-warp]",
    conventions=(
        Convention("model", "of MuJoCo's compiler; conventions are MuJoCo's"),
        Convention("data", "arrays of worlds, of which one is asked"),
        Convention("precision", "single"),
    ),
    kinds=mujoco.PLUGIN.kinds,
    ways=WAYS | _DEVICES | covered.ways(),
    write=write,
    constraints=KINDS,
    demands={name: words for name, words in mujoco.PLUGIN.demands.items() if name not in _UNOFFERED}
    | {COVERING: "put_model, step"},
    statements=tuple(one for one in mujoco.PLUGIN.statements if not one.functions.startswith("inverse_dynamics:")),
    roundoff=SINGLE,
    calls=1,
)
