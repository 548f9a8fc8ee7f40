"""Drake: MultibodyPlant by its API."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..interface import STEP, Array, Convention, End, Joint, Slot, Tendon, Tree, Unsupported
from . import features, turns
from .features import drake_bodies, drake_curves, drake_elements, drake_parameters, drake_systems
from .loops import drake_forces as forces
from .loops import drake_gradients as gradients
from .loops import drake_objects as objects
from .loops import drake_points as points
from .loops import goals
from .loops.drake_forces import FORCES, QV, Q
from .turns import drake as turning
from .writing import copies, urdf
from .writing.source import NO_SOLUTION, Source, SourcePlugin, series, ways_of
from .writing.urdf import MESH_WITHIN, UNIT_AXIS


class _Native(NamedTuple):
    """A joint of Drake: class with arguments, chart, coordinates, speeds."""

    call: str
    chart: str
    nq: int
    nv: int


_JOINTS = {
    ("revolute", ""): _Native("RevoluteJoint({frames}, {axis})", "angle", 1, 1),
    ("prismatic", ""): _Native("PrismaticJoint({frames}, {axis})", "length", 1, 1),
    # Screws advance by the pitch in a whole turn.
    ("helical", ""): _Native("ScrewJoint({frames}, {axis}, {turn!r}, 0)", "screw angle", 1, 1),
    ("universal", ""): _Native("UniversalJoint({frames})", "two angles", 2, 2),
    ("ball", ""): _Native("BallRpyJoint({frames})", "roll pitch yaw, parent speeds", 3, 3),
    ("planar", ""): _Native("PlanarJoint({frames}, [0, 0, 0])", "planar angle", 3, 3),
    ("free", ""): _Native(
        "QuaternionFloatingJoint({frames})", "free quaternion first, angular and linear before", 7, 6
    ),
    ("free", "roll pitch yaw"): _Native(
        "RpyFloatingJoint({frames})", "free roll pitch yaw, angular and linear before", 6, 6
    ),
}

_IMPORTS = ("import numpy as np", "import pydrake.all as drake", "p = drake.MultibodyPlant(0.0)")
_HELPERS = {
    "X": ("def X(R, r): return drake.RigidTransform(drake.RotationMatrix(np.array(R)), r)",),
    "inertia": (
        "def inertia(mass, com, I):",
        "    if mass == 0 and not np.any(I): return drake.SpatialInertia.Zero()",
        "    I = np.array(I)",
        "    about = drake.RotationalInertia(*I.diagonal(), I[0, 1], I[0, 2], I[1, 2])",
        "    return drake.SpatialInertia.MakeFromCentralInertia(mass, com, about)",
    ),
}
_KV = "W, kV = p.world_frame(), drake.JacobianWrtVariable.kV\n"
_FRAMES = f"{_KV}frames = [b.body_frame() for b in links]\n"
# The angular part comes first.
_JACOBIANS = (
    "value = [np.roll(p.CalcJacobianSpatialVelocity(c, kV, f, [0, 0, 0], W, {about}), 3, axis=0) for f in frames]"
)
WAYS = ways_of(f"""
== mass_matrix | CalcMassMatrix | {Q}value = p.CalcMassMatrix(c)
== mass_matrix:CalcMassMatrixViaInverseDynamics | CalcMassMatrixViaInverseDynamics
{Q}value = p.CalcMassMatrixViaInverseDynamics(c)
== coriolis_forces | CalcBiasTerm | {QV}value = p.CalcBiasTerm(c)
== gravity | CalcGravityGeneralizedForces | {Q}value = -p.CalcGravityGeneralizedForces(c)
== inverse_dynamics | CalcInverseDynamics | {QV}{FORCES}value = p.CalcInverseDynamics(c, a, forces)
== bias | CalcInverseDynamics | {QV}{FORCES}value = p.CalcInverseDynamics(c, 0 * v, forces)
== forward_dynamics | EvalTimeDerivatives
{QV}p.get_applied_generalized_force_input_port().FixValue(c, tau)
value = p.EvalTimeDerivatives(c).CopyToVector()[len(q):]
== kinetic_energy | CalcKineticEnergy | {QV}value = p.CalcKineticEnergy(c)
== potential_energy | CalcPotentialEnergy | {Q}value = p.CalcPotentialEnergy(c)
== link_poses | EvalBodyPoseInWorld
{Q}poses = [p.EvalBodyPoseInWorld(c, b) for b in links]
value = [[*x.translation(), *x.rotation().matrix().flat] for x in poses]
== link_velocities | EvalBodySpatialVelocityInWorld
{QV}twists = [p.EvalBodySpatialVelocityInWorld(c, b) for b in links]
value = [[*t.translational(), *t.rotational()] for t in twists]
== link_accelerations | CalcSpatialAccelerationsFromVdot
{QV}every = p.CalcSpatialAccelerationsFromVdot(c, a)
value = [[*every[b.index()].translational(), *every[b.index()].rotational()] for b in links]
== link_velocity_products | CalcBiasSpatialAcceleration
{QV}{_FRAMES}products = [p.CalcBiasSpatialAcceleration(c, kV, f, [0, 0, 0], W, W) for f in frames]
value = [[*x.translational(), *x.rotational()] for x in products]
== link_jacobians | CalcJacobianSpatialVelocity | {Q}{_FRAMES}{_JACOBIANS.format(about="W")}
== jacobian_local | CalcJacobianSpatialVelocity | {Q}{_FRAMES}{_JACOBIANS.format(about="f")}
== joint_dampings | default_damping_vector
value = np.zeros(p.num_velocities())
for j in map(p.get_joint, p.GetJointIndices()):
    value[j.velocity_start():][:j.num_velocities()] = j.default_damping_vector()
== mass_centre | CalcCenterOfMassPositionInWorld | {Q}value = p.CalcCenterOfMassPositionInWorld(c)
== mass_centre_jacobian | CalcJacobianCenterOfMassTranslationalVelocity
{Q}{_KV}value = p.CalcJacobianCenterOfMassTranslationalVelocity(c, kV, W, W)
== mass_centre_velocity_products | CalcBiasCenterOfMassTranslationalAcceleration
{QV}{_KV}value = p.CalcBiasCenterOfMassTranslationalAcceleration(c, kV, W, W)
== centroidal_momentum | CalcSpatialMomentumInWorldAboutPoint
{QV}L = p.CalcSpatialMomentumInWorldAboutPoint(c, p.CalcCenterOfMassPositionInWorld(c))
value = [*L.translational(), *L.rotational()]
""")

_OF_COPIES = ("mass_matrix", "bias", "potential_energy", "link_poses")
_COPIED = {
    "Clone": "p = p.Clone()\nc = p.CreateDefaultContext().Clone()\nlinks = [p.get_body(b.index()) for b in links]\n"
}


# Each call has a context of its own: no speeds, no forces of others.
_CONTEXT = "p.CreateDefaultContext()"
_CLOSING = (f"c = {_CONTEXT}",)
# What is changed stands in a context alone; those that a plant makes anew have its defaults.
_ANEW = (
    "def anew(p, c):",
    f"    d = {_CONTEXT}",
    "    d.get_mutable_parameters().SetFrom(c.get_parameters())",
    "    return d",
)


def _array(values: object) -> str:
    return repr(np.asarray(values, dtype=float).tolist())


def _native(joint: Joint) -> _Native | None:
    if joint.mimics:
        return None
    if joint.kind == "universal" and (joint.axis, joint.second) != ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)):
        return None
    return _JOINTS.get((joint.kind, joint.form))


def _frame(name: str, body: str, R: Array, p: Array) -> str:
    return f"p.AddFrame(drake.FixedOffsetFrame({name!r}, {body}, X({_array(R)}, {_array(p)})))"


def _damping(joint: Joint) -> str:
    """Arguments of a joint that state its damper."""
    if not joint.damping:
        return ""
    names = ("angular_damping", "translational_damping") if joint.kind == "free" else ("damping",)
    return "".join(f", {name}={joint.damping!r}" for name in names)


def _spring(tree: Tree, tendon: Tendon) -> str:
    """The spring and damper between two points."""
    bodies = {link.name: f"b{k}" for k, link in enumerate(tree.links)} | {"": "p.world_body()"}
    ends = ", ".join(f"{bodies[end.link]}, {list(end.p)}" for end in tendon.ends)
    numbers = f"{tendon.rest!r}, {tendon.stiffness!r}, {tendon.damping!r}"
    return f"p.AddForceElement(drake.LinearSpringDamper({ends}, {numbers}))"


_BINDINGS: dict[str, tuple[str, Callable[[End], str]]] = {
    "weld": ("AddWeldConstraint", lambda end: f"X({_array(end.R)}, {_array(end.p)})"),
    "point": ("AddBallConstraint", lambda end: _array(end.p)),
}


def _bound(tree: Tree) -> list[str]:
    """Statements that close loops, for the discrete solver that knows such conditions."""
    bodies = {link.name: f"b{k}" for k, link in enumerate(tree.links)} | {"": "p.world_body()"}
    lines = [*forces.SAP, "sap(p)"]
    for one in tree.constraints:
        add, place = _BINDINGS[one.kind]
        lines.append(f"p.{add}({', '.join(f'{bodies[end.link]}, {place(end)}' for end in one.ends)})")
    return lines


def _changing(tree: Tree) -> list[str]:
    """Statements that give the context a tree's numbers of what is changed."""
    lines = []
    for k, link in enumerate(tree.links):
        R, p, _ = series(link.joints).steps[0]
        if tree.changed == "frame":
            lines.append(f"p.GetFrameByName('P{k}').SetPoseInParentFrame(c, X({_array(R)}, {_array(p)}))")
        else:
            inertia = f"inertia({link.mass!r}, {list(link.com)!r}, {link.inertia!r})"
            lines.append(f"b{k}.SetSpatialInertiaInBodyFrame(c, {inertia})")
    return lines


def write(tree: Tree) -> Source | Unsupported:
    """Text that builds a plant; links without a joint are welded."""
    if tree.asked == "turns" or tree.asked in features.DRAKE:
        return turns.source(*turning.IMPORTS)
    if tree.changed:
        first = write(tree.before)
        if isinstance(first, Unsupported):
            return first
        closing = (*_CLOSING, "p.CalcMassMatrix(c)", *_changing(tree))
        defined, spelling = {**first.optional, "anew": _ANEW}, {**first.spelling, _CONTEXT: "anew(p, c)"}
        return replace(first, closing=closing, optional=defined, spelling=spelling)
    lines = [*_IMPORTS, *_HELPERS["X"], *_HELPERS["inertia"]]
    lines += _gravity(tree)
    chosen: list[list[_Native]] = []
    if isinstance(driven := forces.driven(tree), Unsupported):
        return driven
    for k, link in enumerate(tree.links):
        lines.append(
            f"b{k} = p.AddRigidBody({link.name!r}, inertia({link.mass!r}, {list(link.com)!r}, {link.inertia!r}))"
        )
        steps, (R_end, p_end) = series(link.joints)
        if len(steps) > 1:
            return Unsupported("a body hangs on one joint", offered=False)
        parent = "p.world_body()" if link.parent < 0 else f"b{link.parent}"
        if not steps:
            ends = f"{_frame(f'P{k}', parent, R_end, p_end)}, b{k}.body_frame()"
            lines.append(f"p.AddJoint(drake.WeldJoint('j{k}', {ends}, drake.RigidTransform()))")
            chosen.append([])
            continue
        R, p, joint = steps[0]
        native = _native(joint)
        if native is None:
            extra = " that mimics" if joint.mimics else ""
            return Unsupported(f"no joint for {joint.kind} {joint.form}".strip() + extra, offered=False)
        if any(joint.armature) and joint.kind not in ("revolute", "prismatic"):
            return Unsupported("rotors drive joints of one coordinate", offered=False)
        after = f"b{k}.body_frame()"
        if np.any(p_end) or not np.array_equal(R_end, np.eye(3)):
            after = _frame(f"C{k}", f"b{k}", R_end.T, -R_end.T @ p_end)
        frames = f"'j{k}', {_frame(f'P{k}', parent, R, p)}, {after}"
        turn = 2 * math.pi * joint.pitch
        call = native.call.format(frames=frames, axis=_array(joint.axis), turn=turn)[:-1] + _damping(joint) + ")"
        lines.append(f"j{k} = p.AddJoint(drake.{call})")
        if joint.stiffness:
            if joint.kind not in ("revolute", "prismatic"):
                return Unsupported("springs act on joints of one coordinate", offered=False)
            spring = f"{joint.kind.capitalize()}Spring(j{k}, {joint.rest!r}, {joint.stiffness!r})"
            lines.append(f"p.AddForceElement(drake.{spring})")
        chosen.append([native])
    if any(tendon.kind != "path" or len(tendon.ends) != 2 for tendon in tree.tendons):
        return Unsupported("springs run straight from point to point", offered=False)
    lines += [*(_spring(tree, tendon) for tendon in tree.tendons), *forces.actuators(tree)]
    for number, end in enumerate(tree.sensors):
        body = f"b{[link.name for link in tree.links].index(end.link)}"
        lines.append(_frame(f"o{number}", body, np.array(end.R), np.array(end.p)))
    if tree.constraints:
        lines = [line.replace("Plant(0.0)", f"Plant({STEP})") for line in lines]
        lines += _bound(tree)
    lines.append("p.Finalize()")
    if forces.has_servos(tree):
        for general, own in forces.DISCRETE.items():
            lines = [line.replace(general, own) for line in lines]
    links = f"links = [{', '.join(f'b{k}' for k in range(len(tree.links)))}]"
    slots, nq, nv = _slots(tree, chosen)
    optional: dict[str, tuple[str, ...]] = {"links": (links,)}
    optional["parents"] = (f"parents = {[link.parent for link in tree.links]}",)
    optional["js"] = (f"js = [p.GetJointByName(f'j{{k}}') for k in range({len(tree.links)})]",)
    if tree.sensors:
        places = [link.name for link in tree.links]
        frames = ", ".join(f"({places.index(end.link)}, {end.R!r}, {list(end.p)!r})" for end in tree.sensors)
        optional["sensed"] = (f"sensed, gravity = [{frames}], {list(tree.gravity)!r}",)
    spelling = forces.spelling(tree)
    return Source(tuple(lines), slots, nq, nv, optional, forces.lacks(tree), closing=_CLOSING, spelling=spelling)


_PARSERS = {"urdf": "urdf", "sdf": "sdf", "mjcf": "xml", "urdf of drake": "urdf", "sdf of drake": "sdf"}


def write_reading(tree: Tree, form: str, text: str) -> Source | Unsupported:
    """Text that has Drake's parser read a file; a base link of URDF that is not called "world" is welded to it."""
    if tree.actuators:  # Its inputs are joints' forces, not controls before a gear and a gain.
        return Unsupported("actuators of files: their controls are no input of a plant", offered=False)
    chosen: list[list[_Native]] = []
    for link in tree.links:
        natives = []
        for joint in link.joints:
            native = _JOINTS.get((joint.kind, ""))
            if joint.mimics:
                return Unsupported("what mimics is a constraint of its discrete solvers", offered=False)
            if native is not None:
                natives.append(native)
        chosen.append(natives)
    names = [link.name for link in tree.links]
    base = urdf.base(text) if _PARSERS[form] == "urdf" else ""
    lines = [
        *_IMPORTS,
        *([] if form == "mjcf" else _gravity(tree)),
        f"drake.Parser(p).AddModelsFromString({text!r}, {_PARSERS[form]!r})",
        *([f"p.WeldFrames(p.world_frame(), p.GetFrameByName({base!r}))"] if base not in ("", "world") else []),
        "p.Finalize()",
    ]
    links = f"links = [p.GetBodyByName(name) for name in {names!r}]"
    slots, nq, nv = _slots(tree, chosen)
    return Source(tuple(lines), slots, nq, nv, {"links": (links,)}, forces.lacks(tree), closing=_CLOSING)


def _gravity(tree: Tree) -> list[str]:
    """What sets the tree's gravity; nothing where it is Drake's own."""
    own = tree.gravity == (0.0, 0.0, -9.81)
    return [] if own else [f"p.mutable_gravity_field().set_gravity_vector({list(tree.gravity)!r})"]


def _slots(tree: Tree, chosen: list[list[_Native]]) -> tuple[tuple[tuple[Slot, ...], ...], int, int]:
    """Slots in the order of Drake's numbering of mobilized bodies: depth first."""
    slots: dict[int, tuple[Slot, ...]] = {}
    nq = nv = 0
    for k in _depth_first(tree):
        own = []
        for native in chosen[k]:
            own.append(Slot(native.chart, tuple(range(nq, nq + native.nq)), tuple(range(nv, nv + native.nv))))
            nq, nv = nq + native.nq, nv + native.nv
        slots[k] = tuple(own)
    return tuple(slots[k] for k in range(len(tree.links))), nq, nv


def _depth_first(tree: Tree) -> list[int]:
    order: list[int] = []

    def visit(parent: int) -> None:
        for k, link in enumerate(tree.links):
            if link.parent == parent:
                order.append(k)
                visit(k)

    visit(-1)
    return order


PLUGIN = SourcePlugin(
    name="drake",
    package="drake",
    extra="symofros[engine-drake]",
    conventions=(
        Convention("quaternion", "scalar first, before the position"),
        Convention("floating joints", "angular, then linear velocity, along the axes of the parent's frame"),
        Convention("ball joint", "roll, pitch, yaw with R = Rz Ry Rx; angular velocity along the axes before"),
        Convention("planar joint", "x, y, angle; their rates"),
        Convention("universal joint", "about x, then y; rates of the angles"),
        Convention("screw", "pitch for a whole turn"),
        Convention("gravity forces", "as applied: the negative of g"),
        Convention("armature", "of actuators, times gear ratio squared"),
        Convention("actuators", "their inputs are joints' forces: the gear ratio is no part of them"),
        Convention("actuators with gains", "discrete steps have them at their end, with the coordinates there"),
        Convention("bodies", "whose inertia no body can have are refused"),
    ),
    kinds={
        "revolute x": "RevoluteJoint",
        "revolute y": "RevoluteJoint",
        "revolute z": "RevoluteJoint",
        "revolute oblique": "RevoluteJoint",
        "revolute with armature": "RevoluteJoint with JointActuator",
        "prismatic": "PrismaticJoint",
        "prismatic oblique": "PrismaticJoint",
        "helical": "ScrewJoint",
        "helical oblique": "ScrewJoint",
        "universal": "UniversalJoint",
        "ball": "BallRpyJoint",
        "planar": "PlanarJoint",
        "free": "QuaternionFloatingJoint",
        "free between links": "QuaternionFloatingJoint",
        "free by roll, pitch, yaw": "RpyFloatingJoint",
    },
    ways=forces.continuous(
        WAYS
        | copies.of_model(WAYS, _COPIED, _OF_COPIES)
        | gradients.WAYS
        | points.WAYS
        | goals.DRAKE
        | objects.WAYS
        | forces.WAYS
        | turning.WAYS
        | drake_elements.WAYS
        | drake_bodies.WAYS
        | drake_parameters.WAYS
        | drake_systems.WAYS
        | drake_curves.WAYS
    ),
    write=write,
    refusals=(NO_SOLUTION,),
    constraints={kind: add for kind, (add, _) in _BINDINGS.items()},
    formats=tuple(_PARSERS),
    write_reading=write_reading,
    demands={
        **features.DRAKE,
        "goals": "InverseKinematics",
        "turns": "rotations and placements",
        "sensors": "Accelerometer, Gyroscope",
        "a bound pair": "AddWeldConstraint, AddBallConstraint",
        "changed mass": "SetSpatialInertiaInBodyFrame",
        "changed inertia": "SetSpatialInertiaInBodyFrame",
        "changed frame": "SetPoseInParentFrame",
        "dampers": "damping",
        "springs": "RevoluteSpring, PrismaticSpring",
        "tendons": "LinearSpringDamper",
        "actuators": "JointActuator",
    },
    statements=(UNIT_AXIS, MESH_WITHIN),
)
