"""MuJoCo: models by its XML."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ...interface import Convention, End, Statement, Tendon, Tree, Unsupported
from ...tree import SOFT_LIMITS
from ...truth.devices import COMPILED, DEVICES
from ..writing import copies
from ..writing.numbering import attached, numbered
from ..writing.source import Source, SourcePlugin
from ..writing.urdf import UNIT_AXIS, has_bare_shape
from . import besides, devices, flex, forces, framed, functions, rays, rebuilt, soft, stages, turns, vectors
from . import elements as beside
from .document import CHARTS, document

# Fields of MuJoCo's model that state what is changed.
CHANGED = {
    "mass": ("body_mass",),
    "inertia": ("body_inertia", "body_ipos", "body_iquat"),
    "frame": ("body_pos", "body_quat"),
    "gravity": ("opt.gravity",),
    "anchor": ("eq_data[:, :3]",),
}


def _changing(tree: Tree, xml: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Statements that build the changed model beside the first, and those that turn this into it for each call."""
    lines = ("from copy import copy", "first = copy(m)", f"last = mj.MjModel.from_xml_string('''{xml}''')")
    closing = []
    for source in ("first", "last"):
        closing += [f"m.{name}[:] = {source}.{name}" for name in CHANGED[tree.changed]]
        closing += ["mj.mj_setConst(m, d)", *(["mj.mj_forward(m, d)"] if source == "first" else [])]
    return lines, tuple(closing)


def write(tree: Tree) -> Source | Unsupported:
    """Text that builds a tree."""
    if tree.asked == "flexible bodies":
        return flex.write(tree)
    if tree.asked in (DEVICES | COMPILED):
        return devices.write()
    if tree.asked in ("turns", "vectors"):
        return turns.write()
    if tree.changed:
        first, last = write(tree.before), document(replace(tree, changed=""), principal=True)
        if isinstance(first, Unsupported) or isinstance(last, Unsupported):
            return first if isinstance(first, Unsupported) else Unsupported("", offered=False)
        both, closing = _changing(tree, last[0])
        return replace(first, lines=(*first.lines, *both), closing=closing)
    made = document(tree, principal=True)
    if isinstance(made, Unsupported):
        return made
    xml, slots, nq, nv = made
    if tree.fused:
        xml = xml.replace("<compiler ", '<compiler fusestatic="true" ')
    lines = ["import numpy as np", "import mujoco as mj", *_compiled(tree, xml), "d = mj.MjData(m)"]
    lines += beside.controls(tree)
    # A model that is attached takes a prefix to its names; links that are fused are there no more.
    own = attached(tree)
    names = [("own_" if k in own else "") + link.name for k, link in enumerate(tree.links)]
    if tree.fused:
        return Source(tuple(lines), slots, nq, nv)
    optional = {"bs": (f"bs = [m.body(name).id for name in {names!r}]",)} | beside.optional(tree)
    if tree.sensors:
        optional["sensed"] = (
            f"sensed = range({len(tree.sensors)})",
            "def data(kind, k): return d.sensor(f'{kind}{k}').data",
        )
    spelling = beside.spelling(tree) if tree.constraints and not tree.asked else {}
    # What is attached already is not made in other ways.
    lacks = (*rebuilt.SENSED, *rebuilt.ways(_WAYS)) if own else ()
    if any(one.tendon is not None for one in tree.actuators):  # The sensor is of joints of one speed alone.
        lacks += ("actuated_forces:jointactuatorfrc",)
    kinds = {one.activation.kind for one in tree.actuators if one.activation}
    if kinds != {"exact filter"}:  # All others move by stages of the formula.
        lacks += ("activations_after_step:RK4",)
    return Source(tuple(lines), slots, nq, nv, optional, lacks, spelling=spelling, of_links="bs")


def _compiled(tree: Tree, xml: str) -> list[str]:
    """Statements that make the model `m`, of one document or of two, one attached to the other."""
    own = attached(tree)
    if not own:
        return [f"m = mj.MjModel.from_xml_string('''{xml}''')"]
    texts = []
    for part in (_part(tree, [k for k in range(len(tree.links)) if k not in own]), _part(tree, sorted(own))):
        made = document(part, principal=True)
        assert not isinstance(made, Unsupported)  # The whole is none, either.
        texts.append(made[0])
    holder = tree.links[tree.links[min(own)].parent].name
    return [
        f"s = mj.MjSpec.from_string('''{texts[0]}''')",
        f"own = mj.MjSpec.from_string('''{texts[1]}''')",
        f"s.body({holder!r}).add_frame().attach_body(own.body({tree.attached!r}), 'own_', '')",
        "m = s.compile()",
    ]


def _part(tree: Tree, kept: Sequence[int]) -> Tree:
    """Some links of a tree, with the tendons over no others, and the actuators that act on no others."""
    places = {k: place for place, k in enumerate(kept)}
    links = tuple(replace(tree.links[k], parent=places.get(tree.links[k].parent, -1)) for k in kept)
    names = {link.name for link in links}
    own = [k for k, one in enumerate(tree.tendons) if names.issuperset(end.link for end in _ends(one))]
    tendons = {k: place for place, k in enumerate(own)}
    actuators = []
    for one in tree.actuators:
        if one.tendon in tendons:
            actuators.append(replace(one, tendon=tendons[one.tendon]))
        elif one.link in names or (one.ends and names.issuperset(end.link for end in one.ends)):
            actuators.append(one)
    pulled = tuple(tree.tendons[k] for k in own)
    return replace(tree, links=links, attached="", tendons=pulled, actuators=tuple(actuators))


def _ends(tendon: Tendon) -> tuple[End, ...]:
    """The frames that a tendon's way is made of."""
    return (*tendon.ends, *(wrap.end for wrap in tendon.wraps))


_READERS = {
    "urdf": "mj.MjModel.from_xml_string({text})",
    "mjcf": "mj.MjModel.from_xml_string({text})",
    "mjcf written": "mj.MjModel.from_xml_string(written({text}))",
}
# By the specification, where the release has some; all releases write the file that was read last.
WRITING = """def parsed(text):
    try: return mj.MjSpec.from_string(text)
    except TypeError: spec = mj.MjSpec()  # First it was a method of specifications that are made.
    spec.from_string(text)
    return spec
def written(text):
    if hasattr(mj, 'MjSpec') and hasattr(mj.MjSpec, 'to_xml'):
        spec = parsed(text)
        spec.compile()
        return spec.to_xml()
    with tempfile.NamedTemporaryFile(suffix='.xml') as file:
        mj.mj_saveLastXML(file.name, mj.MjModel.from_xml_string(text))
        return file.read().decode()"""


def write_reading(tree: Tree, form: str, text: str) -> Source | Unsupported:
    """Text that has MuJoCo read a file."""
    if any(joint.mimics for link in tree.links for joint in link.joints):
        return Unsupported("a joint that mimics stays one, with an equality constraint", offered=False)
    # MuJoCo's hinges know no cosine and sine: a joint of URDF without limits is one without limits.
    charts = {(kind, shape): chart for kind, (chart, _, _) in CHARTS.items() for shape in ("", "unbounded")}
    made = numbered(tree, charts)
    if isinstance(made, Unsupported):
        return made
    slots, nq, nv = made
    names = [link.name for link in tree.links]
    writing = ("import tempfile", *WRITING.split("\n")) if form.endswith("written") else ()
    lines = (
        "import numpy as np",
        "import mujoco as mj",
        *writing,
        f"m = {_READERS[form].format(text=repr(text))}",
        "d = mj.MjData(m)",
        *beside.controls(tree),
    )
    # Links that don't move are fused into what they are fixed to (`fusestatic`): none of them is there to be asked.
    fused = form == "urdf" and not all(slots)
    optional = {} if fused else {"bs": (f"bs = [m.body(name).id for name in {names!r}]",)}
    if tree.sensors:
        optional["sensed"] = (f"sensed = range({len(tree.sensors)})",)
    return Source(lines, slots, nq, nv, optional)


_WAYS = (
    functions.WAYS
    | beside.WAYS
    | forces.WAYS
    | besides.WAYS
    | framed.WAYS
    | soft.WAYS
    | stages.WAYS
    | turns.WAYS
    | vectors.WAYS
    | devices.WAYS
    | rays.WAYS
    | rays.WITHIN_SITES
)
PLUGIN = SourcePlugin(
    name="mujoco",
    package="mujoco",
    extra="mujoco",
    conventions=(
        Convention("quaternion", "w, x, y, z"),
        Convention("free joint", "linear velocity in world axes, angular velocity in the axes of the body"),
        Convention(
            "constraints", "soft: a row's acceleration is aref - R f; R is least, not zero, at the impedance 0.9999"
        ),
        Convention("force, torque", "what holds the sensor's body, as cfrc_int: at rest the force is upwards"),
        Convention("armature", "part of the mass matrix; mj_rne leaves it out"),
    ),
    kinds={},
    ways=_WAYS | rebuilt.ways(_WAYS) | rebuilt.SENSED | copies.of_model(_WAYS, rebuilt.COPIED, copies.OF_MODELS[:-1]),
    write=write,
    constraints=beside.KINDS,
    demands={
        "attached": "MjSpec, attach_body",
        "turns": "rotations as quaternions and matrices",
        "vectors": "functions of vectors and matrices",
        **dict.fromkeys(DEVICES | COMPILED, "small models of MJCF"),
        "fused": "fusestatic",
        **{f"changed {name}": f"{', '.join(fields)}; mj_setConst" for name, fields in CHANGED.items()},
        "dampers": "damping",
        "springs": "stiffness, springref",
        "compensation": "gravcomp",
        "sensors": "sensor",
        "sensors of bound links": "cfrc_int, efc_force",
        "tendons": "tendon/fixed, tendon/spatial",
        "wrapped tendons": "tendon/spatial/geom",
        "heavy tendons": "tendon armature",
        "flexible bodies": "flexcomp",
        "scaled welds": "equality/weld torquescale",
        "points by bodies": "equality/connect anchor",
        "a lone body": "efc_diagApprox",
        SOFT_LIMITS: "limited, range, frictionloss",
        "a medium": "density, viscosity, wind",
        "actuators": "general, motor, position, velocity",
        "activations": "dyntype, dynprm, actearly, actrange",
        "affine gains": "gaintype affine",
    },
    formats=tuple(_READERS),
    write_reading=write_reading,
    statements=(
        Statement(
            "precondition",
            "where <inertial> is missing, mass and moments are inferred from geoms",
            "https://mujoco.readthedocs.io/en/stable/XMLreference.html#compiler-inertiafromgeom: auto",
            holds=has_bare_shape,
        ),
        Statement(
            "precondition",
            "mj_rne leaves armature out: mj_inverse adds armature*qacc, later M*qacc, to what it gives",
            "mujoco, src/engine/engine_inverse.c: mj_inverseSkip",
            "inverse_dynamics:mj_rne",
            lambda tree, text: any(any(joint.armature) for link in tree.links for joint in link.joints),
        ),
        Statement(
            "precondition",
            "a row's reference acceleration is -b v - k r: what the rate of its Jacobian adds, J'v, is left out",
            "https://mujoco.readthedocs.io/en/stable/computation/index.html#reference-acceleration",
            "constraint_(velocity|residual)_products(:.*)?|constrained_acceleration(:.*)?|constraint_forces",
            lambda tree, text: any(one.kind in ("path", "polynomial") for one in tree.constraints),
        ),
        Statement(
            "precondition",
            "mj_crb leaves the armature of tendons out, which mj_makeM adds",
            "mujoco, include/mujoco/mujoco.h: mj_crb, composite rigid bodies; mj_makeM, the inertia matrix",
            "mass_matrix:mj_crb",
            lambda tree, text: any(one.armature for one in tree.tendons),
        ),
        UNIT_AXIS,
    ),
)
