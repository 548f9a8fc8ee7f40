"""SAPIEN: articulations of PhysX on the CPU without a renderer, and the model of Pinocchio that it makes of one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..interface import SINGLE, STEP, Array, Convention, Joint, Slot, Tree, Unsupported
from . import turns
from .loops import goals
from .newton import quaternion
from .turns import sapien as turning
from .writing.numbering import numbered
from .writing.source import NO_SOLUTION, Source, SourcePlugin, Way, series, ways_of
from .writing.urdf import UNIT_AXIS, Described, describe, of_files, slots_of

# Its import warns of a system without Vulkan, which nothing here draws with.
_IMPORTS = (
    "import warnings",
    "import numpy as np",
    "with warnings.catch_warnings():",
    "    warnings.simplefilter('ignore')",
    "    import sapien",
    "    from sapien import physx",
)
# The solver TGS makes a step of several.
_SCENE = (
    "physx.set_scene_config(gravity={gravity}, enable_tgs=False)",
    "scene = sapien.Scene([physx.PhysxCpuSystem()])",
    "def pose(p, q): return sapien.Pose(p, q)",
)
# Joints in the tree's order; links have no dampers and no greatest speeds, and don't sleep.
_READY = """found = {{joint.name: k for k, joint in enumerate(robot.active_joints)}}
own = [found[name] for name in {joints}]
place = np.argsort(own)
links = [robot.find_link_by_name(name) for name in {links}]
robot.set_sleep_threshold(0.0)
for link in robot.links:
    link.set_linear_damping(0.0); link.set_angular_damping(0.0)
    link.set_max_linear_velocity(1e9); link.set_max_angular_velocity(1e9)
for joint in robot.active_joints: joint.set_max_velocity(1e9); joint.set_friction(0.0)
def put(q, v):
    robot.set_qpos(q[place].astype(np.float32)); robot.set_qvel(v[place].astype(np.float32))
def parts(x): return np.array(x)[own]"""
_FORCE = (
    "put(q, {v})\nvalue = parts(robot.compute_passive_force(gravity={gravity}, coriolis_and_centrifugal={coriolis}))"
)
_MATRIX = "def matrix(pose): return pose.to_transformation_matrix()\n"
_POSES = "value = [[*T[:3, 3], *T[:3, :3].flat] for T in ({of} for {each})]"
# Where servos are to hold their joints, and at what speed.
_PLACE, _SPEED = 0.25, -0.5
_AS_MADE = (("; joint.set_friction(0.0)", ""),)
_STEP = f"""scene.set_timestep({STEP})
put(q, v)
robot.set_qf((tau)[place].astype(np.float32))
scene.step()
value = [*parts(robot.get_qpos()), *parts(robot.get_qvel())]"""
_SHORT = 2.0**-60

WAYS = (
    ways_of(f"""
== bias | compute_passive_force | {_FORCE.format(v="v", gravity=True, coriolis=True)}
== gravity | compute_passive_force | {_FORCE.format(v="0 * v", gravity=True, coriolis=False)}
== coriolis_forces | compute_passive_force | {_FORCE.format(v="v", gravity=False, coriolis=True)}
== link_poses | entity_pose
{_MATRIX}put(q, 0 * v)
{_POSES.format(of="matrix(link.entity_pose)", each="link in links")}
== # Of the mass centres.
== link_velocities | linear_velocity, angular_velocity
{_MATRIX}put(q, v)
value = []
for link in links:
    w, arm = link.angular_velocity, matrix(link.entity_pose)[:3, :3] @ link.cmass_local_pose.p
    value.append([*(link.linear_velocity - np.cross(w, arm)), *w])
== step_semi_implicit | Scene.step | {_STEP}
== step_stiffness_implicit | Scene.step, set_drive_properties | {_STEP}
== # In the joint's frame on the child, with speeds that are those at the end of the step.
== joint_wrenches_driven ~ 0.001 | link_incoming_joint_forces
{_MATRIX}{_STEP.replace(repr(STEP), repr(_SHORT))}
held, value = robot.link_incoming_joint_forces, []
for link in links:
    X, wrench = matrix(link.joint.pose_in_child), held[link.index]
    force, moment = X[:3, :3] @ wrench[:3], X[:3, :3] @ wrench[3:]
    value.append([*force, *(moment + np.cross(X[:3, 3], force))])
""")
    | {
        # Friction as an argument of the joint, 0 unless stated.
        "step_semi_implicit:set_joint_properties": Way("set_joint_properties, Scene.step", _STEP, built=_AS_MADE),
    }
    | ways_of(f"""
== joint_limits | limits | value = parts([joint.limits[0] for joint in robot.active_joints])
== joint_dampings | damping | value = parts([joint.damping for joint in robot.active_joints])
== mass_matrix | PinocchioModel.compute_generalized_mass_matrix
value = model.compute_generalized_mass_matrix(q[place])[np.ix_(own, own)]
== inverse_dynamics | PinocchioModel.compute_inverse_dynamics
value = parts(model.compute_inverse_dynamics(q[place], v[place], a[place]))
== forward_dynamics | PinocchioModel.compute_forward_dynamics
value = parts(model.compute_forward_dynamics(q[place], v[place], tau[place]))
== coriolis_symmetry | PinocchioModel.compute_coriolis_matrix
C = model.compute_coriolis_matrix(q[place], v[place])[np.ix_(own, own)]
value = C + C.T
== coriolis_forces:PinocchioModel | PinocchioModel.compute_coriolis_matrix
value = parts(model.compute_coriolis_matrix(q[place], v[place]) @ v[place])
== link_poses:PinocchioModel | PinocchioModel.get_link_pose
{_MATRIX}model.compute_forward_kinematics(q[place])
{_POSES.format(of="matrix(model.get_link_pose(link.index))", each="link in links")}
== jacobian_local | PinocchioModel.compute_single_link_local_jacobian
value = [model.compute_single_link_local_jacobian(q[place], link.index)[:, own] for link in links]
""")
)


def _pose(R: Array, p: Array) -> str:
    return f"pose({p.tolist()!r}, {np.roll(quaternion(R), 1).tolist()!r})"


def _onto(axis: Array) -> Array:
    """A rotation (3, 3) whose first column is an axis."""
    x = axis / np.linalg.norm(axis)
    y = np.cross(np.eye(3)[int(np.argmin(np.abs(x)))], x)
    y /= np.linalg.norm(y)
    return np.column_stack([x, y, np.cross(x, y)])


def _principal(inertia: Array) -> tuple[Array, Array]:
    """Principal moments (3) and axes (3, 3)."""
    moments, axes = np.linalg.eigh(inertia)
    axes[:, 2] *= np.linalg.det(axes)
    return moments, axes


_CHARTS = {("revolute", ""): "angle", ("prismatic", ""): "length"}
_TYPES = {"revolute": "revolute_unwrapped", "prismatic": "prismatic"}
_FREE = "[[-np.inf, np.inf]]"


def _joint(k: int, steps: tuple[tuple[Array, Array, Joint], ...], end: tuple[Array, Array]) -> list[str]:
    """Statements of the joint before a link; its axis is the first of its frame."""
    if not steps:
        return [f"l{k}.set_joint_properties('fixed', [], {_pose(*end)}, pose([0, 0, 0], [1, 0, 0, 0]))"]
    R, p, joint = steps[0]
    A = _onto(np.array(joint.axis))
    child = _pose(end[0].T @ A, -end[0].T @ end[1])
    return [f"l{k}.set_joint_properties('{_TYPES[joint.kind]}', {_FREE}, {_pose(R @ A, p)}, {child})"]


def write(tree: Tree) -> Source | Unsupported:
    """Text that builds an articulation on a root that is fixed."""
    if tree.asked == "turns":
        return turns.source(*turning.IMPORTS)
    made = numbered(tree, _CHARTS)
    if isinstance(made, Unsupported):
        return made
    slots, nq, nv = made
    lines = [*_IMPORTS, *(line.format(gravity=list(tree.gravity)) for line in _SCENE)]
    lines += ["builder = scene.create_articulation_builder()", "base = builder.create_link_builder()"]
    after = []
    for k, link in enumerate(tree.links):
        steps, end = series(link.joints)
        if len(steps) > 1 or not link.mass or any(joint.mimics for joint in link.joints):
            return Unsupported("links have a joint each, and mass", offered=False)
        moments, axes = _principal(np.array(link.inertia))
        parent = "base" if link.parent < 0 else f"l{link.parent}"
        at = _pose(axes, np.array(link.com))
        lines += [
            f"l{k} = builder.create_link_builder({parent})",
            f"l{k}.set_name({link.name!r}); l{k}.set_joint_name({link.name!r})",
            f"l{k}.set_mass_and_inertia({link.mass!r}, {at}, {moments.tolist()!r})",
            *_joint(k, steps, end),
        ]
        armature = sum((joint.armature for joint in link.joints), ())
        if any(armature):
            after.append(f"robot.find_joint_by_name({link.name!r}).set_armature({list(armature)!r})")
    moving = [link.name for link, own in zip(tree.links, slots, strict=True) if own]
    if not all(one.is_plain and not one.force_limits for one in tree.actuators):
        return Unsupported("forces and servos along joints, without bounds", offered=False)
    if any(joint.force_limits for link in tree.links for joint in link.joints):
        return Unsupported("bounds of joints' forces are those of drives", offered=False)
    fed = dict.fromkeys(moving, 0.0)
    for one in tree.actuators:
        joint = f"robot.find_joint_by_name({one.link!r})"
        fed[one.link] = one.fed(_PLACE, _SPEED)
        after.append(f"{joint}.set_drive_properties({-one.bias[1]!r}, {-one.bias[2]!r})")
        after.append(f"{joint}.set_drive_target({_PLACE}); {joint}.set_drive_velocity_target({_SPEED})")
    has_servos = any(any(one.bias) for one in tree.actuators)
    if has_servos and len(moving) > 1:
        return Unsupported("how drives of several joints are solved for is not documented", offered=False)
    source = _source(tree, [*lines, "robot = builder.build(fix_root_link=True)", *after], slots, moving)
    # Its model of Pinocchio has no actuators.
    lacks = ("forward_dynamics", "step_semi_implicit:set_joint_properties") if tree.actuators else ()
    lacks = (*lacks, "step_semi_implicit" if has_servos else "step_stiffness_implicit")
    return replace(source, lacks=lacks, spelling={"(tau)": f"(tau + {list(fed.values())!r})"} if tree.actuators else {})


def _source(tree: Tree, lines: Sequence[str], slots: tuple[tuple[Slot, ...], ...], moving: Sequence[str]) -> Source:
    """The text with what all functions use."""
    ready = _READY.format(joints=list(moving), links=[link.name for link in tree.links])
    model = (f"model = robot.create_pinocchio_model(gravity={list(tree.gravity)})",)
    return Source((*lines, *ready.split("\n")), slots, len(moving), len(moving), {"model": model})


def _reading(tree: Tree, described: Described) -> Source:
    """Text that has SAPIEN read a file of URDF."""
    lines = (
        *_IMPORTS,
        *(line.format(gravity=list(tree.gravity)) for line in _SCENE),
        "from tempfile import NamedTemporaryFile",
        'file = NamedTemporaryFile("w", suffix=".urdf")',
        f"print({described.text!r}, file=file, flush=True)",
        "robot = scene.create_urdf_loader().load(file.name)",
    )
    return _source(tree, lines, slots_of(tree, described, described.moving), described.moving)


def write_reading(tree: Tree, form: str, text: str) -> Source | Unsupported:
    """Text that has SAPIEN read a file."""
    described = describe(tree)
    if isinstance(described, Described) and described.floating:
        return Unsupported("the pose of a floating root is none of its coordinates", offered=False)
    return of_files(_reading)(tree, form, text)


PLUGIN = SourcePlugin(
    name="sapien",
    package="sapien",
    extra="symofros[engine-sapien]",
    conventions=(
        Convention("precision", "single, of PhysX; its PinocchioModel reads decimals of these and counts in doubles"),
        Convention("axes", "the first of a joint's frame"),
        Convention("friction of joints", "a coefficient of PhysX, 0.05 unless set_friction says otherwise"),
        Convention("order of joints", "its own; found by names"),
        Convention("drives", "taken at the end of a step, with the coordinate there; asked of one joint alone"),
        Convention("velocities of links", "of the mass centre"),
        Convention("compute_passive_force", "forces that hold against gravity, Coriolis and centrifugal forces"),
        Convention("PinocchioModel", "of the package pin where that is installed, of a copy in SAPIEN where not"),
    ),
    kinds={
        "revolute x": "revolute_unwrapped",
        "revolute y": "revolute_unwrapped",
        "revolute z": "revolute_unwrapped",
        "revolute oblique": "revolute_unwrapped",
        "revolute with armature": "set_armature",
        "prismatic": "prismatic",
        "prismatic oblique": "prismatic",
    },
    ways=WAYS | turning.WAYS | goals.SAPIEN,
    write=write,
    formats=("urdf",),
    write_reading=write_reading,
    refusals=("failed to find a rendering device", NO_SOLUTION),
    demands={
        "goals": "compute_inverse_kinematics",
        "turns": "rotations and placements",
        "actuators": "set_qf, set_drive_properties",
    },
    statements=(UNIT_AXIS,),
    roundoff=SINGLE,
)
