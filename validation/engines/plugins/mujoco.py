"""MuJoCo: models by its XML, joints of its own, several to a body."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from xml.sax.saxutils import escape

import numpy as np

from ..interface import Array, Constraint, Convention, Joint, Slot, Statement, Steps, Tendon, Tree, Unsupported
from .loops import mujoco as constrained
from .loops import mujoco_flex
from .loops import mujoco_forces as forces
from .loops.mujoco_forces import COPY, EXPLICIT, QV, QVA, SQUARE, Q, transition
from .writing.source import Source, SourcePlugin, Way, attached, numbered, series
from .writing.urdf import UNIT_AXIS, has_bare_shape

# Kind of a joint -> elements (type, axis), chart, coordinates, speeds.
_CHARTS: dict[str, tuple[str, int, int]] = {
    "revolute": ("angle", 1, 1),
    "prismatic": ("length", 1, 1),
    "universal": ("two angles", 2, 2),
    "euler": ("three angles", 3, 3),
    "translation": ("three lengths", 3, 3),
    "ball": ("quaternion wxyz, body speeds", 4, 3),
    "free": ("free wxyz, linear before and angular after", 7, 6),
}


def _text(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)


def _elements(joint: Joint) -> list[tuple[str, Array]]:
    """MuJoCo's joints for one of ours: type and axis."""
    unit = np.eye(3)
    match joint.kind:
        case "revolute":
            return [("hinge", np.array(joint.axis))]
        case "prismatic":
            return [("slide", np.array(joint.axis))]
        case "universal":
            return [("hinge", np.array(joint.axis)), ("hinge", np.array(joint.second))]
        case "euler":
            return [("hinge", unit["XYZ".index(letter)]) for letter in joint.sequence]
        case "translation":
            return [("slide", axis) for axis in unit]
        case _:
            return [(joint.kind, unit[2])]


def _name(name: str) -> str:
    """A name escaped for an XML attribute within a triple-quoted Python string."""
    return escape(name, {"'": "&apos;", '"': "&quot;", "\\": "&#92;"})


def _frame(R: Array, p: Array) -> str:
    return f'pos="{_text(p)}" xyaxes="{_text([*R[:, 0], *R[:, 1]])}"'


class _Bodies:
    """Elements of a tree's bodies, with the slots of their joints, which MuJoCo numbers depth first."""

    def __init__(self, tree: Tree, principal: bool) -> None:
        self.tree, self.principal = tree, principal
        self.children: dict[int, list[int]] = {k: [] for k in range(-1, len(tree.links))}
        for k, link in enumerate(tree.links):
            self.children[link.parent].append(k)
        self.slots: dict[int, tuple[Slot, ...]] = {}
        self.nq = self.nv = 0
        lines: tuple[Constraint | Tendon, ...] = (*tree.constraints, *tree.tendons)
        self.coupled = {end.link for one in lines if one.kind == "coupling" for end in one.ends}
        self.coupled |= {one.link for one in tree.actuators}

    def element(self, k: int) -> str | Unsupported:
        """The element of a link and of what it carries."""
        link = self.tree.links[k]
        steps, (R, p) = series(link.joints)
        if steps:
            if not _is_identity(R, p):
                return Unsupported("a link's frame stands at its joints", offered=False)
            R, p = steps[0][:2]
        joints = self._joints(k, steps)
        if isinstance(joints, Unsupported):
            return joints
        inertial = f'<inertial pos="{_text(link.com)}" mass="{link.mass!r}" {self._inertia(np.array(link.inertia))}/>'
        inner = self.elements(k)
        if isinstance(inner, Unsupported):
            return inner
        own = [inertial if link.mass else "", *joints, constrained.sites(self.tree, link.name), *inner]
        borne = f' gravcomp="{link.compensation!r}"' if link.compensation else ""
        return f'<body name="{_name(link.name)}" {_frame(R, p)}{borne}>' + "".join(own) + "</body>"

    def elements(self, k: int) -> list[str] | Unsupported:
        """The elements of a link's children; -1 is the world."""
        made = []
        for child in self.children[k]:
            text = self.element(child)
            if isinstance(text, Unsupported):
                return text
            made.append(text)
        return made

    def _inertia(self, inertia: Array) -> str:
        """MJCF attributes of an inertia: its entries, or its principal moments and axes."""
        if not self.principal:
            return f'fullinertia="{_text(inertia[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))}"'
        moments, axes = np.linalg.eigh(inertia)
        axes[:, 2] *= np.linalg.det(axes)
        return f'diaginertia="{_text(moments)}" xyaxes="{_text([*axes[:, 0], *axes[:, 1]])}"'

    def _joints(self, k: int, steps: Sequence[tuple[Array, Array, Joint]]) -> list[str] | Unsupported:
        """The elements of a link's joints."""
        link, own, elements = self.tree.links[k], [], []
        for number, (R, p, joint) in enumerate(steps):
            if joint.kind not in _CHARTS or joint.form or joint.mimics:
                return Unsupported(f"no joint of kind {joint.kind} {joint.form}".strip(), offered=False)
            if number and not _is_identity(R, p):
                return Unsupported("joints of one body share its frame", offered=False)
            if joint.kind == "free" and (link.parent >= 0 or not _is_identity(*steps[0][:2])):
                return Unsupported("a free joint stands in the world", offered=False)
            chart, nq, nv = _CHARTS[joint.kind]
            q, v = range(self.nq, self.nq + nq), range(self.nv, self.nv + nv)
            own.append(Slot(chart, tuple(q), tuple(v)))
            self.nq, self.nv = q.stop, v.stop
            armature = f' armature="{joint.armature[0]!r}"' if joint.armature else ""
            named = f' name="{link.name}"' if link.name in self.coupled else ""
            for kind, axis in _elements(joint):
                about = f' axis="{_text(axis)}"' if kind in ("hinge", "slide") else ""
                elements.append(f'<joint{named} type="{kind}"{about}{armature}{constrained.forces(joint)}/>')
        self.slots[k] = tuple(own)
        return elements


def _is_identity(R: Array, p: Array) -> bool:
    return np.array_equal(R, np.eye(3)) and not np.any(p)


def document(tree: Tree, principal: bool = False) -> tuple[str, tuple[tuple[Slot, ...], ...], int, int] | Unsupported:
    """MJCF of a tree, with the slots of its joints, nq and nv.

    Inertias are stated by their entries, or by principal moments: MuJoCo's own diagonalisation stops at 1e-12, which
    shows in the light bodies of a hand; LAPACK's does not.

    MuJoCo numbers joints depth first, so links must stand in that order to have their slots in series; others are found
    by walking.
    """
    made = _Bodies(tree, principal)
    elements = made.elements(-1)
    if isinstance(elements, Unsupported):
        return elements
    bodies = "\n".join([*elements, *filter(None, [constrained.sites(tree, "")])])
    option = f'<option gravity="{_text(tree.gravity)}"{constrained.options(tree)}/>'
    xml = f'<mujoco model="tree"><compiler angle="radian"/>{option}<worldbody>\n{bodies}\n</worldbody>'
    xml += f"{constrained.elements(tree)}</mujoco>"
    return xml, tuple(made.slots[k] for k in range(len(tree.links))), made.nq, made.nv


# Fields of MuJoCo's model that state what is changed.
_CHANGED = {
    "mass": ("body_mass",),
    "inertia": ("body_inertia", "body_ipos", "body_iquat"),
    "frame": ("body_pos", "body_quat"),
    "gravity": ("opt.gravity",),
}


def _changing(tree: Tree, xml: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Statements that build the changed model beside the first, and those that turn this into it for each call."""
    lines = ("from copy import copy", "first = copy(m)", f"last = mj.MjModel.from_xml_string('''{xml}''')")
    closing = []
    for source in ("first", "last"):
        closing += [f"m.{name}[:] = {source}.{name}" for name in _CHANGED[tree.changed]]
        closing += ["mj.mj_setConst(m, d)", *(["mj.mj_forward(m, d)"] if source == "first" else [])]
    return lines, tuple(closing)


def write(tree: Tree) -> Source | Unsupported:
    """Text that builds a tree."""
    if tree.asked == "flexible bodies":
        return mujoco_flex.write(tree)
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
    lines += constrained.controls(tree)
    # A model that is attached takes a prefix to its names; links that are fused are there no more.
    own = attached(tree)
    names = [("own_" if k in own else "") + link.name for k, link in enumerate(tree.links)]
    if tree.fused:
        return Source(tuple(lines), slots, nq, nv)
    optional = {"bs": (f"bs = [m.body(name).id for name in {names!r}]",)} | constrained.optional(tree)
    if tree.sensors:
        optional["sensed"] = (
            f"sensed = range({len(tree.sensors)})",
            "def data(kind, k): return d.sensor(f'{kind}{k}').data",
        )
    spelling = constrained.spelling(tree) if tree.constraints else {}
    return Source(tuple(lines), slots, nq, nv, optional, spelling=spelling)


def _compiled(tree: Tree, xml: str) -> list[str]:
    """Statements that make the model `m`, of one document or of two, one attached to the other."""
    own = attached(tree)
    if not own:
        return [f"m = mj.MjModel.from_xml_string('''{xml}''')"]
    first = min(own)
    kept = {k: place for place, k in enumerate(k for k in range(len(tree.links)) if k not in own)}
    places = {k: place for place, k in enumerate(sorted(own))}
    rest = tuple(replace(tree.links[k], parent=kept.get(tree.links[k].parent, -1)) for k in kept)
    branch = tuple(replace(tree.links[k], parent=places.get(tree.links[k].parent, -1)) for k in sorted(own))
    texts = []
    for links in (rest, branch):
        part = document(replace(tree, links=links, attached=""), principal=True)
        assert not isinstance(part, Unsupported)  # The whole is none, either.
        texts.append(part[0])
    holder = tree.links[tree.links[first].parent].name
    return [
        f"s = mj.MjSpec.from_string('''{texts[0]}''')",
        f"own = mj.MjSpec.from_string('''{texts[1]}''')",
        f"s.body({holder!r}).add_frame().attach_body(own.body({tree.attached!r}), 'own_', '')",
        "m = s.compile()",
    ]


_TWISTS = "value = np.zeros((len(bs), 6))\nfor k, b in enumerate(bs):\n    "
_JACOBIANS = "value = np.zeros((len(bs), 6, m.nv))\nfor k, b in enumerate(bs):\n    "
_INVERSE_FD = f"{QVA}{SQUARE}mj.mjd_inverseFD(m, d, 1e-6, False, "
_TRANSITION = transition(1.0, EXPLICIT)
# One-sided differences are off by the step times the second derivative, centred ones by its square times the third.
_INVERSE_STEPS = Steps("inverse_dynamics", 1e-6, 1e-4)
_FORWARD_STEPS = Steps("forward_dynamics", 1e-6, 1e-9)


WAYS = {
    "sizes": Way("nq, nv", "value = [m.nq, m.nv]"),
    "mass_matrix": Way("mj_fullM", f"{Q}{SQUARE}mj.mj_fullM(m, *((value, d.qM) if hasattr(d, 'qM') else (d, value)))"),
    "mass_matrix:mj_mulM": Way(
        "mj_mulM", f"{Q}{SQUARE}for row, unit in zip(value, np.eye(m.nv)):\n    mj.mj_mulM(m, d, row, unit)"
    ),
    "mass_matrix:mjd_inverseFD": Way(
        "mjd_inverseFD", f"{_INVERSE_FD}None, None, value, None, None, None, None)", _INVERSE_STEPS
    ),
    # Of a square root X of M, by rows: X X^T is M. Scaled rows are roots of the inverse.
    "mass_matrix:mj_mulM2": Way(
        "mj_mulM2",
        f"{Q}root = np.zeros((m.nv, m.nv))\nfor row, unit in zip(root, np.eye(m.nv)):\n"
        "    mj.mj_mulM2(m, d, row, unit)\nvalue = root @ root.T",
    ),
    "mass_matrix_inverse:mj_solveM2": Way(
        "mj_solveM2",
        f"{Q}root = np.zeros((m.nv, m.nv))\n"
        "mj.mj_solveM2(m, d, root, np.eye(m.nv), np.sqrt(d.qLDiagInv))\nvalue = root @ root.T",
    ),
    "mass_matrix_inverse": Way("mj_solveM", f"{Q}{SQUARE}mj.mj_solveM(m, d, value, np.eye(m.nv))"),
    "bias": Way("qfrc_bias", f"{QV}value = d.qfrc_bias"),
    "inverse_dynamics": Way("mj_inverse", f"{QVA}mj.mj_inverse(m, d)\nvalue = d.qfrc_inverse"),
    "inverse_dynamics:mj_rne": Way("mj_rne", f"{QVA}value = np.zeros(m.nv)\nmj.mj_rne(m, d, 1, value)"),
    "forward_dynamics": Way("mj_forward", f"d.qfrc_applied[:] = tau\n{QV}value = d.qacc"),
    "kinetic_energy": Way("mj_energyVel", f"{QV}mj.mj_energyVel(m, d)\nvalue = d.energy[1]"),
    "potential_energy": Way("mj_energyPos", f"{Q}mj.mj_energyPos(m, d)\nvalue = d.energy[0]"),
    "link_poses": Way("xpos, xmat", f"{Q}value = np.hstack([d.xpos[bs], d.xmat[bs]])"),
    "mass_centre": Way("subtree_com", f"{Q}value = d.subtree_com[0]"),
    "mass_centre_jacobian": Way(
        "mj_jacSubtreeCom", f"{Q}value = np.zeros((3, m.nv))\nmj.mj_jacSubtreeCom(m, d, value, 0)"
    ),
    "link_jacobians": Way("mj_jacBody", f"{Q}{_JACOBIANS}mj.mj_jacBody(m, d, value[k, :3], value[k, 3:], b)"),
    "link_jacobian_rates": Way(
        "mj_jacDot", f"{QV}{_JACOBIANS}mj.mj_jacDot(m, d, value[k, :3], value[k, 3:], d.xpos[b], b)"
    ),
    "link_velocities": Way(
        "mj_objectVelocity",
        f"{QV}{_TWISTS}mj.mj_objectVelocity(m, d, mj.mjtObj.mjOBJ_XBODY, b, value[k], 0)\n"
        "value = np.roll(value, 3, axis=1)",
    ),
    "velocity_local": Way(
        "mj_objectVelocity",
        f"{QV}{_TWISTS}mj.mj_objectVelocity(m, d, mj.mjtObj.mjOBJ_XBODY, b, value[k], 1)\n"
        "value = np.roll(value, 3, axis=1)",
    ),
    "link_accelerations": Way(
        "mj_objectAcceleration",
        f"{QVA}mj.mj_rnePostConstraint(m, d)\n"
        f"{_TWISTS}mj.mj_objectAcceleration(m, d, mj.mjtObj.mjOBJ_XBODY, b, value[k], 0)\n"
        "value = np.roll(value, 3, axis=1) + np.r_[m.opt.gravity, np.zeros(3)]",
    ),
    "centroidal_matrix": Way(
        "mj_jacSubtreeCom, mj_angmomMat",
        f"{Q}J = np.zeros((3, m.nv))\nmj.mj_jacSubtreeCom(m, d, J, 0)\n"
        "A = np.zeros((3, m.nv))\nmj.mj_angmomMat(m, d, A, 0)\nvalue = np.vstack([m.body_subtreemass[0] * J, A])",
    ),
    "centroidal_momentum": Way(
        "mj_subtreeVel",
        f"{QV}mj.mj_subtreeVel(m, d)\nvalue = np.r_[m.body_subtreemass[0] * d.subtree_linvel[0], d.subtree_angmom[0]]",
    ),
    "inverse_dynamics_dq": Way(
        "mjd_inverseFD", f"{_INVERSE_FD}value, None, None, None, None, None, None)\nvalue = value.T", _INVERSE_STEPS
    ),
    "inverse_dynamics_dv": Way(
        "mjd_inverseFD", f"{_INVERSE_FD}None, value, None, None, None, None, None)\nvalue = value.T", _INVERSE_STEPS
    ),
    "inverse_dynamics_dv:qDeriv": Way(
        "mj_implicit",
        f"{COPY}n.opt.integrator = mj.mjtIntegrator.mjINT_IMPLICIT\n"
        f"{QV}mj.mj_implicit(n, d)\n{SQUARE}for i in range(m.nv):\n"
        "    row = slice(m.D_rowadr[i], m.D_rowadr[i] + m.D_rownnz[i])\n    value[i, m.D_colind[row]] = -d.qDeriv[row]",
    ),
    "forward_dynamics_dq": Way("mjd_transitionFD", f"{_TRANSITION}value = A[m.nv:, :m.nv]", _FORWARD_STEPS),
    "forward_dynamics_dv": Way(
        "mjd_transitionFD", f"{_TRANSITION}value = A[m.nv:, m.nv:] - np.eye(m.nv)", _FORWARD_STEPS
    ),
    "integrate": Way("mj_integratePos", "value = q\nmj.mj_integratePos(m, value, v2, 1.0)"),
    "difference": Way(
        "mj_differentiatePos",
        "q1, value = q.copy(), np.zeros(m.nv)\nmj.mj_integratePos(m, q1, v2, 1.0)\n"
        "mj.mj_differentiatePos(m, value, 1.0, q, q1)",
    ),
}


_READERS = {
    "urdf": "mj.MjModel.from_xml_string({text})",
    "mjcf": "mj.MjModel.from_xml_string({text})",
    "mjcf written": "mj.MjModel.from_xml_string(mj.MjSpec.from_string({text}).to_xml())",
}


def write_reading(tree: Tree, form: str, text: str) -> Source | Unsupported:
    """Text that has MuJoCo read a file."""
    if any(joint.mimics for link in tree.links for joint in link.joints):
        return Unsupported("a joint that mimics stays one, with an equality constraint", offered=False)
    # MuJoCo's hinges know no cosine and sine: a joint of URDF without limits is one without limits.
    charts = {(kind, shape): chart for kind, (chart, _, _) in _CHARTS.items() for shape in ("", "unbounded")}
    made = numbered(tree, charts)
    if isinstance(made, Unsupported):
        return made
    slots, nq, nv = made
    names = [link.name for link in tree.links]
    lines = (
        "import numpy as np",
        "import mujoco as mj",
        f"m = {_READERS[form].format(text=repr(text))}",
        "d = mj.MjData(m)",
        *constrained.controls(tree),
    )
    # Links that don't move are fused into what they are fixed to (`fusestatic`): none of them is there to be asked.
    fused = form == "urdf" and not all(slots)
    optional = {} if fused else {"bs": (f"bs = [m.body(name).id for name in {names!r}]",)}
    if tree.sensors:
        optional["sensed"] = (f"sensed = range({len(tree.sensors)})",)
    return Source(lines, slots, nq, nv, optional)


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
    ways=WAYS | constrained.WAYS | forces.WAYS,
    write=write,
    constraints=constrained.KINDS,
    demands={
        "attached": "MjSpec, attach_body",
        "fused": "fusestatic",
        **{f"changed {name}": f"{', '.join(fields)}; mj_setConst" for name, fields in _CHANGED.items()},
        "dampers": "damping",
        "springs": "stiffness, springref",
        "compensation": "gravcomp",
        "sensors": "sensor",
        "tendons": "tendon/fixed, tendon/spatial",
        "wrapped tendons": "tendon/spatial/geom",
        "heavy tendons": "tendon armature",
        "flexible bodies": "flexcomp",
        "scaled welds": "equality/weld torquescale",
        "a lone body": "efc_diagApprox",
        "actuators": "general, motor, position, velocity",
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
            "a row's reference acceleration is -b v - k r: what the rate of a tendon's Jacobian adds, J'v, is left out",
            "https://mujoco.readthedocs.io/en/stable/computation/index.html#reference-acceleration",
            "constraint_velocity_products|constrained_acceleration|constraint_forces",
            lambda tree, text: any(one.kind == "path" for one in tree.constraints),
        ),
        UNIT_AXIS,
    ),
)
