"""SYMOFROS itself: generated C, by its public names, as one engine among the others."""

from __future__ import annotations

from typing import Any

import symofros

from ..interface import Convention, Joint, Link, Slot, Tree, Unsupported
from .writing.numbering import numbered
from .writing.source import Source, SourcePlugin, series, ways_of

_SETUP = """import numpy as np
import symofros as sf
from symofros.tools import DEFAULT_FLAGS
# To optimise takes longer than all calls here; checks compile as users do.
FLAGS = tuple("-O0" if flag.startswith("-O") else flag for flag in DEFAULT_FLAGS)
def body(name, parent, kind, R, p, more, mass, com, moments):
    joint = sf.Joint(f"joint {name}", kind, parent, position=p, rotation=sf.Rotation.matrix(R), **more)
    return sf.RigidBody(name, joint, sf.Inertia(mass, com, moments), waive={"nonphysical_inertia"})
"""
_EACH = "value = np.array([{} for name in links])"
_RATES = "m.inverse_dynamics_derivatives(q, v, a)"
_TORQUES = "m.forward_dynamics_derivatives(q, v, tau)"
_BOUNDS = "bounds = [b.joint.limits for b in system.bodies if b.joint and b.joint.limits]\n"
WAYS = ways_of(f"""
== sizes | nq, nv | value = [m.nq, m.nv]
== mass_matrix | mass_matrix | value = m.mass_matrix(q)
== bias | bias | value = m.bias(q, v)
== gravity | gravity_force | value = m.gravity_force(q)
== coriolis_forces | coriolis_matrix | value = m.coriolis_matrix(q, v) @ v
== coriolis_symmetry | coriolis_matrix | C = m.coriolis_matrix(q, v)\nvalue = C + C.T
== inverse_dynamics | inverse_dynamics | value = m.inverse_dynamics(q, v, a)
== joint_wrenches | joint_wrenches | value = m.joint_wrenches(q, v, a, tau, [])[own]
== joint_wrenches_driven | forward_dynamics, joint_wrenches
value = m.joint_wrenches(q, v, m.forward_dynamics(q, v, tau), tau, [])[own]
== forward_dynamics | forward_dynamics | value = m.forward_dynamics(q, v, tau)
== kinetic_energy | kinetic_energy | value = m.kinetic_energy(q, v)
== potential_energy | potential_energy | value = m.potential_energy(q)
== link_poses | frame_pose | value = [np.append(*m.frame_pose(name, q)) for name in links]
== link_velocities | frame_velocity | {_EACH.format("m.frame_velocity(name, q, v)")}
== link_accelerations | frame_acceleration | {_EACH.format("m.frame_acceleration(name, q, v, a)")}
== link_jacobians | frame_jacobian | {_EACH.format("m.frame_jacobian(name, q)")}
== link_jacobian_rates | frame_jacobian_rate | {_EACH.format("m.frame_jacobian_rate(name, q, v)")}
== mass_centre | center_of_mass | value = m.center_of_mass(q)
== centroidal_matrix | centroidal_momentum_matrix | value = m.centroidal_momentum_matrix(q)
== centroidal_momentum | centroidal_momentum | value = m.centroidal_momentum(q, v)
== centroidal_momentum_rate | centroidal_momentum_rate | value = m.centroidal_momentum_rate(q, v, a)
== inverse_dynamics_dq | inverse_dynamics_derivatives | value = {_RATES}[0]
== inverse_dynamics_dv | inverse_dynamics_derivatives | value = {_RATES}[1]
== forward_dynamics_dq | forward_dynamics_derivatives | value = {_TORQUES}[0]
== forward_dynamics_dv | forward_dynamics_derivatives | value = {_TORQUES}[1]
== joint_speed_limits | Joint.limits | {_BOUNDS}value = [one.velocity for one in bounds]
== joint_force_limits | Joint.limits | {_BOUNDS}value = [one.effort for one in bounds]
== joint_limits | Joint.limits | {_BOUNDS}value = [[one.lower, one.upper] for one in bounds]
== integrate | integrate | value = m.integrate(q, v2)
== difference | difference | value = m.difference(q, m.integrate(q, v2))
""")
_ASKED = (
    "mass_matrix bias gravity_force coriolis_matrix inverse_dynamics joint_wrenches forward_dynamics kinetic_energy"
    " potential_energy frame_pose frame_velocity frame_acceleration frame_jacobian frame_jacobian_rate center_of_mass"
    " centroidal_momentum centroidal_momentum_matrix centroidal_momentum_rate inverse_dynamics_derivatives"
    " forward_dynamics_derivatives"
).split()

_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
# Kind of a joint -> our kind, chart, coordinates, speeds.
_KINDS = {
    "revolute": ("revolute", "angle", 1, 1),
    "prismatic": ("prismatic", "length", 1, 1),
    "helical": ("screw", "screw angle", 1, 1),
    "universal": ("universal", "two angles", 2, 2),
    "ball": ("ball", "quaternion xyzw, body speeds", 4, 3),
    "free": ("free", "free xyzw, body speeds", 7, 6),
    "planar": ("planar", "planar angle", 3, 3),
    "translation": ("general", "three lengths", 3, 3),
    "euler": ("general", "three angles", 3, 3),
}


def _stated(joint: Joint, name: str) -> dict[str, Any] | Unsupported:
    """What our description says of a joint, its placement apart."""
    if joint.kind not in _KINDS or joint.form or joint.mimics or joint.sequence not in ("", "ZYX"):
        return Unsupported(f"no joint of kind {joint.kind} {joint.form or joint.sequence}".strip(), offered=False)
    if len(set(joint.armature)) > 1:
        return Unsupported("one armature for all speeds of a joint", offered=False)
    more: dict[str, Any] = {"actuated": True}
    if joint.armature:
        more["armature"] = joint.armature[0]
    if joint.kind in ("revolute", "prismatic", "helical", "universal"):
        more["axis"] = joint.axis
    if joint.kind == "helical":
        more["pitch"] = joint.pitch
    if joint.kind == "universal":
        more["axis2"] = joint.second
    if joint.kind in ("translation", "euler"):
        more["coordinates"] = tuple(f"{name}{letter}" for letter in "xyz")
        more["moving_position" if joint.kind == "translation" else "moving_rotation"] = more["coordinates"]
    return more


class _Bodies:
    """Bodies of a tree, in the order of its links, with the slots of their joints, which we number depth first."""

    def __init__(self, tree: Tree) -> None:
        self.tree = tree
        self.children: dict[int, list[int]] = {k: [] for k in range(-1, len(tree.links))}
        for k, link in enumerate(tree.links):
            self.children[link.parent].append(k)
        self.bodies: list[str] = []
        self.slots: dict[int, tuple[Slot, ...]] = {}
        self.own: dict[int, int] = {}  # Rows of joint wrenches.
        self.nq = self.nv = self.joints = 0

    def add(self, k: int, parent: str) -> Unsupported | None:
        """Add a link, each of its joints but the last on a body without mass, and what it carries."""
        link, slots = self.tree.links[k], []
        steps, (R, p) = series(link.joints)
        placed = [*steps, (R, p, Joint("fixed"))] if not steps or not _is_identity(R, p) else steps
        for number, (R, p, joint) in enumerate(placed):
            last = number + 1 == len(placed)
            name = link.name if last else f"{link.name} {number}"
            more = {} if joint.kind == "fixed" else _stated(joint, f"j{k}_{number}_")
            if isinstance(more, Unsupported):
                return more
            kind = "fixed"
            if joint.kind != "fixed":
                kind, chart, nq, nv = _KINDS[joint.kind]
                q, v = range(self.nq, self.nq + nq), range(self.nv, self.nv + nv)
                slots.append(Slot(chart, tuple(q), tuple(v)))
                self.nq, self.nv, self.joints = q.stop, v.stop, self.joints + 1
            rotation = more.pop("moving_rotation", None)
            turned = f", moving_rotation=sf.Rotation.rpy(*{rotation[::-1]!r})" if rotation else ""
            stated = f"dict({', '.join(f'{key}={value!r}' for key, value in more.items())}{turned})".replace("(, ", "(")
            place = f"{kind!r}, {R.tolist()!r}, {p.tolist()!r}, {stated}"
            self.bodies.append(f"body({name!r}, {parent!r}, {place}, {_inertia(link) if last else _NOTHING})")
            parent = name
        self.slots[k], self.own[k] = tuple(slots), self.joints - 1
        for child in self.children[k]:
            obstacle = self.add(child, parent)
            if obstacle is not None:
                return obstacle
        return None


_NOTHING = "0.0, (0, 0, 0), (0,) * 6"


def _inertia(link: Link) -> str:
    J = link.inertia
    moments = J[0][0], J[1][1], J[2][2], J[0][1], J[0][2], J[1][2]
    return f"{link.mass!r}, {link.com!r}, {moments!r}"


def _is_identity(R: Any, p: Any) -> bool:
    return not p.any() and R.tolist() == [list(_X), list(_Y), list(_Z)]


def write(tree: Tree) -> Source | Unsupported:
    """Text that builds a tree."""
    made = _Bodies(tree)
    for k in made.children[-1]:
        obstacle = made.add(k, "world")
        if obstacle is not None:
            return obstacle
    names = [link.name for link in tree.links]
    whole = all(made.slots[k] for k in range(len(names)))
    asked = [name for name in _ASKED if whole or name != "joint_wrenches"]
    lines = (
        _SETUP,
        "bodies = [\n    {},\n]".format(",\n    ".join(made.bodies)),
        f"links = {names!r}",
        f"system = sf.System('tree', bodies, gravity={tree.gravity!r})",
        f"m = sf.compile(system, sf.Options(functions={asked!r}, frames=links, flags=FLAGS, batch='loop'))",
    )
    own = [made.own[k] for k in range(len(names))]
    return Source(
        lines,
        tuple(made.slots[k] for k in range(len(names))),
        made.nq,
        made.nv,
        {"own": (f"own = {own!r}",)},
        lacks=() if whole else ("joint_wrenches", "joint_wrenches_driven"),
    )


_SUFFIXES = {"urdf": ".urdf", "mjcf": ".xml", "sdf": ".sdf", "usd": ".usda"}


def write_reading(tree: Tree, form: str, text: str) -> Source | Unsupported:
    """Script in which our importers read a file; what it states is interpreted, not compiled."""
    if any(joint.mimics for link in tree.links for joint in link.joints):
        return Unsupported("what mimics is a coupling, a constraint", offered=False)
    charts = {(kind, form): made[1] for kind, made in _KINDS.items() for form in ("", "unbounded")}
    made = numbered(tree, charts)
    if isinstance(made, Unsupported):
        return made
    links = [link.name for link in tree.links]
    lines = (
        "from tempfile import NamedTemporaryFile",
        "import numpy as np",
        "import symofros as sf",
        f"TEXT = {text!r}",
        f"file = NamedTemporaryFile('w', suffix={_SUFFIXES[form]!r})",
        "print(TEXT, file=file, flush=True)",
        "system = sf.load(file.name, waive=['massless_tip'])",
        # Links of a model within the model bear its name, too.
        f"links = [next(b.name for b in system.bodies if b.name.split('::')[-1] == name) for name in {links!r}]",
        f"asked = {list(_READ)!r}",
        "m = sf.compile(system, sf.Options(functions=asked, frames=links, backend='interpreter'))",
    )
    # Drives of USD are no part of the mechanism that is read.
    is_driven = any(joint.drive for link in tree.links for joint in link.joints)
    return Source(lines, *made, lacks=("joint_force_limits",) if is_driven else ())


_READ = ("mass_matrix", "bias", "gravity_force", "frame_pose")

PLUGIN = SourcePlugin(
    name="symofros",
    package="symofros",
    extra="symofros",
    conventions=(
        Convention("quaternion", "x, y, z, w"),
        Convention("free joint", "linear and angular velocity in the axes of the body"),
        Convention("planar joint", "three coordinates, x, y and an angle; their rates"),
        Convention("several joints of a link", "each on a body of its own, without mass"),
        Convention("armature", "the same for all speeds of a joint; it counts in the kinetic energy"),
    ),
    kinds={},
    ways=WAYS,
    write=write,
    formats=tuple(_SUFFIXES),
    write_reading=write_reading,
    find=lambda: symofros.__version__,
)
