"""MuJoCo's models made in other ways: attached to another, compiled again, saved and loaded; with sensors of links."""

from __future__ import annotations

from collections.abc import Mapping

from ..writing.source import Way

# Options are those of the model that is attached to.
_ATTACHED = """
def made(text):
    child, parent = mj.MjSpec.from_string(text), mj.MjSpec()
    for name in ('gravity', 'timestep', 'disableactuator', 'density', 'viscosity', 'wind'):
        setattr(parent.option, name, getattr(child.option, name))
    parent.attach(child, prefix='own_', frame=parent.worldbody.add_frame())
    return parent.compile()"""
_AGAIN = """
def made(text):
    spec = mj.MjSpec.from_string(text)
    m = spec.compile()
    return spec.recompile(m, mj.MjData(m))[0]"""
_SAVED = """
def made(text):
    m = mj.MjModel.from_xml_string(text)
    written = np.zeros(mj.mj_sizeModel(m), np.uint8)
    mj.mj_saveModel(m, None, written)
    return mj.MjModel.from_binary_path('m.mjb', {'m.mjb': written.tobytes()})"""
_IMPORT, _READ = "import mujoco as mj", "mj.MjModel.from_xml_string("
_MADE = {
    "attach": (
        (_READ, "made("),
        (_IMPORT, _IMPORT + _ATTACHED),
        ("m.body(name)", "m.body('own_' + name)"),
        ("m.site(", "m.site('own_' + "),
        ("d.sensor(f'{kind}", "d.sensor(f'own_{kind}"),
    ),
    "recompile": ((_READ, "made("), (_IMPORT, _IMPORT + _AGAIN)),
    "mj_saveModel": ((_READ, "made("), (_IMPORT, _IMPORT + _SAVED)),
}
# Models and data that are stored in one string, and read again.
COPIED = {"pickle": "import pickle\nm, d = (pickle.loads(pickle.dumps(one)) for one in (m, d))\n"}
# What says most of a model's parts: bodies, sensors, tendons, actuators, constraints.
_ASKED = (
    *("mass_matrix", "link_poses", "passive_forces", "tendon_lengths", "tendon_arms", "actuator_lengths"),
    *("actuator_arms", "actuator_forces", "activation_rates", "actuated_forces", "accelerometers", "wrench_sensors"),
    *("constraint_jacobian", "constraint_residuals", "constrained_acceleration", "step_forces_implicit"),
    *("limited_acceleration", "limiting_forces", "gyroscopes", "magnetic_fields"),
)


def ways(first: Mapping[str, Way]) -> dict[str, Way]:
    """Functions of models that are made in these ways, by those of a model that is read."""
    return {
        f"{name}:{how}": first[name]._replace(native=f"{how}, {first[name].native}", built=built)
        for how, built in _MADE.items()
        for name in _ASKED
    }


_SENSED = """
def made(text):
    spec, kinds = mj.MjSpec.from_string(text), mj.mjtSensor
    bodies = [body.name for body in spec.bodies if body.name != 'world']
    def add(kind, name, one, **more):
        spec.add_sensor(name=f'{kind}:{name}', type=getattr(kinds, f'mjSENS_{kind}'), objtype=one, objname=name, **more)
    for name in bodies:
        for kind in KINDS: add(kind, name, mj.mjtObj.mjOBJ_XBODY, **MORE)
        for kind in SUBTREES: add(kind, name, mj.mjtObj.mjOBJ_BODY)
    for kind in ('CLOCK', 'E_POTENTIAL', 'E_KINETIC') * GLOBAL:
        spec.add_sensor(name=kind, type=getattr(kinds, f'mjSENS_{kind}'))
    return spec.compile()
def read(kind, b): return np.array(d.sensor(f'{kind}:{m.body(b).name}').data)"""
_FRAMES = ("FRAMEPOS", "FRAMEXAXIS", "FRAMEYAXIS", "FRAMEZAXIS", "FRAMEQUAT", "FRAMELINVEL", "FRAMEANGVEL")
_RATES = ("FRAMELINACC", "FRAMEANGACC")
_SUBTREES = ("SUBTREECOM", "SUBTREELINVEL", "SUBTREEANGMOM")


def _sensing(
    kinds: tuple[str, ...], subtrees: tuple[str, ...] = (), more: str = "{}", total: int = 0
) -> tuple[tuple[str, str], ...]:
    """A model with sensors at each link."""
    text = _SENSED.replace("KINDS", repr(kinds)).replace("SUBTREES", repr(subtrees)).replace("MORE", more)
    return ((_READ, "made("), (_IMPORT, _IMPORT + text.replace("GLOBAL", str(total))))


_OF_FRAMES = _sensing((*_FRAMES, *_RATES))
_SEEN = _sensing(_FRAMES, more="{'reftype': mj.mjtObj.mjOBJ_XBODY, 'refname': bodies[0]}")
_OF_SUBTREES = _sensing((), _SUBTREES)
_OF_ALL = _sensing((), total=1)
QV = "d.qpos[:], d.qvel[:] = q, v\nmj.mj_forward(m, d)\n"
QVA = f"{QV}d.qacc[:] = a\nmj.mj_rnePostConstraint(m, d)\nmj.mj_sensorAcc(m, d)\n"
_AXES = "np.array([read(f'FRAME{x}AXIS', b) for x in 'XYZ']).T.ravel()"
_OF_QUATERNION = (
    "value = np.zeros((len(bs), 12))\nfor row, b in zip(value, bs):\n"
    "    row[:3] = read('FRAMEPOS', b)\n    mj.mju_quat2Mat(row[3:], read('FRAMEQUAT', b))"
)
_TWISTS = "value = [[*read('FRAMELINVEL', b), *read('FRAMEANGVEL', b)] for b in bs]"

SENSED = {
    "link_poses:framepos": Way(
        "framepos, framexaxis", f"{QV}value = [[*read('FRAMEPOS', b), *{_AXES}] for b in bs]", built=_OF_FRAMES
    ),
    "link_poses:framequat": Way("framepos, framequat", QV + _OF_QUATERNION, built=_OF_FRAMES),
    "link_velocities:framelinvel": Way("framelinvel, frameangvel", QV + _TWISTS, built=_OF_FRAMES),
    "link_accelerations:framelinacc": Way(
        "framelinacc, frameangacc",
        f"{QVA}value = [[*(read('FRAMELINACC', b) + m.opt.gravity), *read('FRAMEANGACC', b)] for b in bs]",
        built=_OF_FRAMES,
    ),
    "link_poses_seen": Way(
        "framepos, framexaxis with reftype",
        f"{QV}value = [[*read('FRAMEPOS', b), *{_AXES}] for b in bs]",
        built=_SEEN,
    ),
    "link_poses_seen:framequat": Way("framepos, framequat with reftype", QV + _OF_QUATERNION, built=_SEEN),
    "link_velocities_seen": Way("framelinvel, frameangvel with reftype", QV + _TWISTS, built=_SEEN),
    "subtree_momenta:subtreelinvel": Way(
        "subtreelinvel, subtreeangmom",
        f"{QV}value = [[*(m.body_subtreemass[b] * read('SUBTREELINVEL', b)), *read('SUBTREEANGMOM', b)] for b in bs]",
        built=_OF_SUBTREES,
    ),
    "mass_centre:subtreecom": Way(
        "subtreecom",
        f"{QV}roots = [b for b in range(1, m.nbody) if m.body_parentid[b] == 0]\n"
        "value = sum(m.body_subtreemass[b] * read('SUBTREECOM', b) for b in roots) / m.body_subtreemass[0]",
        built=_OF_SUBTREES,
    ),
    "kinetic_energy:e_kinetic": Way("e_kinetic", f"{QV}value = d.sensor('E_KINETIC').data[0]", built=_OF_ALL),
    "potential_energy:e_potential": Way("e_potential", f"{QV}value = d.sensor('E_POTENTIAL').data[0]", built=_OF_ALL),
}

# A sensor of one kind on each tendon, actuator or joint of one speed, in their order.
_LINED = """
def made(text):
    m = mj.MjModel.from_xml_string(text)
    added = ''.join(f'<KIND OF="{m.OF(int(k)).name}"/>' for k in PLACES)
    return mj.MjModel.from_xml_string(text.replace('</mujoco>', f'<sensor>{added}</sensor></mujoco>'))"""
_PLACES = {
    "tendon": "range(m.ntendon)",
    "actuator": "range(m.nu)",
    "joint": "np.flatnonzero(m.jnt_type > int(mj.mjtJoint.mjJNT_BALL))",
}


def _lined(kind: str, of: str, constant: str) -> Way:
    """What sensors of a kind read; of joints along the speeds, zero along those of others."""
    text = _LINED.replace("KIND", kind).replace("OF", of).replace("PLACES", _PLACES[of])
    read = f"d.sensordata[m.sensor_adr[m.sensor_type == mj.mjtSensor.mjSENS_{constant}]]"
    value = "value = "
    if of == "joint":
        value = f"value = np.zeros(m.nv)\nvalue[m.jnt_dofadr[{_PLACES[of]}]] = "
    return Way(kind, QV + value + read, built=((_READ, "made("), (_IMPORT, _IMPORT + text)))


SENSED |= {
    "tendon_lengths:tendonpos": _lined("tendonpos", "tendon", "TENDONPOS"),
    "tendon_speeds:tendonvel": _lined("tendonvel", "tendon", "TENDONVEL"),
    "actuator_lengths:actuatorpos": _lined("actuatorpos", "actuator", "ACTUATORPOS"),
    "actuator_speeds:actuatorvel": _lined("actuatorvel", "actuator", "ACTUATORVEL"),
    "actuator_forces:actuatorfrc": _lined("actuatorfrc", "actuator", "ACTUATORFRC"),
    "actuated_forces:jointactuatorfrc": _lined("jointactuatorfrc", "joint", "JOINTACTFRC"),
}
