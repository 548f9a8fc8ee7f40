"""PyBullet: articulated bodies of Bullet, from URDF and SDF."""

from __future__ import annotations

import re

from ..interface import STEP, Convention, Statement, Tree, Unsupported
from . import turns
from .turns import pybullet as turning
from .writing.source import Source, SourcePlugin, Way
from .writing.urdf import KINDS, UNIT_AXIS, describe, has_bare_link, slots_of

# One client serves all models; its gravity stays.
_SETUP = """from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile("w", suffix=".{form}")
print({text!r}, file=file, flush=True)
robot = {load}"""
_JOINTS = "joints = [p.getJointInfo(robot, k) for k in range(p.getNumJoints(robot))]"
_LINKS = "links = [joint[0] for name in {links} for joint in joints if joint[12].decode() == name]"
_GRAVITY = "p.setGravity{gravity}"
_MOVING = "moving = [joint[0] for joint in joints if joint[2] != p.JOINT_FIXED]"
_LOADS = {
    "urdf": (
        "p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)"
    ),
    "urdf from shapes": "p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_MAINTAIN_LINK_ORDER)",
    "sdf": "p.loadSDF(file.name)[0]",
}
_MASSLESS = '<inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>'
_STATES = """joints
for k, position, speed in zip(moving, q, {v}): p.resetJointState(robot, k, position, speed)
states = [p.getLinkState(robot, k, computeLinkVelocity=1, computeForwardKinematics=1) for k in links]
"""
WAYS = {
    "mass_matrix": Way("calculateMassMatrix", "value = p.calculateMassMatrix(robot, q.tolist())"),
    "inverse_dynamics": Way(
        "calculateInverseDynamics",
        "gravity\nvalue = p.calculateInverseDynamics(robot, q.tolist(), v.tolist(), a.tolist())",
    ),
    "bias": Way(
        "calculateInverseDynamics",
        "gravity\nvalue = p.calculateInverseDynamics(robot, q.tolist(), v.tolist(), [0.0] * len(v))",
    ),
    "gravity": Way(
        "calculateInverseDynamics",
        "gravity\nvalue = p.calculateInverseDynamics(robot, q.tolist(), *[[0.0] * len(q)] * 2)",
    ),
    "joint_speed_limits": Way("getJointInfo", "joints\nvalue = [p.getJointInfo(robot, k)[11] for k in moving]"),
    "joint_force_limits": Way("getJointInfo", "joints\nvalue = [p.getJointInfo(robot, k)[10] for k in moving]"),
    "joint_limits": Way("getJointInfo", "joints\nvalue = [p.getJointInfo(robot, k)[8:10] for k in moving]"),
    "link_poses": Way(
        "getLinkState",
        f"{_STATES.format(v='0 * q')}value = [[*s[4], *p.getMatrixFromQuaternion(s[5])] for s in states]",
    ),
    "link_velocities": Way(
        "getLinkState",
        f"{_STATES.format(v='v')}"
        "def arm(s): return -np.reshape(p.getMatrixFromQuaternion(s[5]), (3, 3)) @ s[2]\n"
        "value = [[*(np.array(s[6]) + np.cross(s[7], arm(s))), *s[7]] for s in states]",
    ),
    # Points are stated from the link's origin, along the principal axes of its inertia.
    "link_jacobians": Way(
        "calculateJacobian",
        "joints\nzero = [0.0] * len(q)\n"
        "value = [np.concatenate(p.calculateJacobian(robot, k, [0, 0, 0], q.tolist(), zero, zero)) for k in links]",
    ),
}

# A joint has a motor that holds it still unless its greatest force is zero, and a greatest speed; a link has a damper.
_STEP = f"""gravity
joints
p.setTimeStep({STEP})
for k in range(-1, p.getNumJoints(robot)):
    p.changeDynamics(robot, k, linearDamping=0, angularDamping=0, maxJointVelocity=1e9)
for k, position, speed, force in zip(moving, q, v, tau):
    p.resetJointState(robot, k, position, speed)
    p.setJointMotorControl2(robot, k, p.VELOCITY_CONTROL, force=0)
    p.setJointMotorControl2(robot, k, p.TORQUE_CONTROL, force=force)
p.stepSimulation()
states = p.getJointStates(robot, moving)
value = [*(s[0] for s in states), *(s[1] for s in states)]"""
WAYS["step_semi_implicit"] = Way("stepSimulation", _STEP)


def write(tree: Tree) -> Source | Unsupported:
    """The tree through PyBullet's reader of URDF."""
    if tree.asked == "turns":
        return turns.source(*turning.IMPORTS, scalar_last=True)
    described = describe(tree)
    if isinstance(described, Unsupported):
        return described
    text = re.sub(r'<link name="([^"]*)"/>', rf'<link name="\1">{_MASSLESS}</link>', described.text)
    return write_reading(tree, "urdf", text)


def write_reading(tree: Tree, form: str, text: str) -> Source | Unsupported:
    """A file through PyBullet's reader."""
    described = describe(tree)
    if isinstance(described, Unsupported):
        return described
    if described.floating:
        return Unsupported("coordinates of floating bases are not documented", offered=False)
    setup = _SETUP.format(text=text, form=form.split()[0], load=_LOADS[form])
    count = len(described.moving)
    optional: dict[str, tuple[str, ...]] = {"gravity": ("gravity = True", _GRAVITY.format(gravity=tree.gravity))}
    if form.startswith("urdf") and all(len(link.joints) == 1 for link in tree.links):
        # Links, and the joints before them, are numbered as in the file.
        places = [k for k, link in enumerate(tree.links) if link.joints[0].kind != "fixed"]
        optional |= {"joints": ("joints = ()",), "moving": (f"moving = {places}",)}
        optional |= {"links": (f"links = {list(range(len(tree.links)))}",)}
    else:
        optional |= {"joints": (_JOINTS,), "moving": (_MOVING,)}
        optional |= {"links": (_LINKS.format(links=list(described.links)),)}
    slots = slots_of(tree, described, described.moving)
    # Its reader of SDF takes no joint with the world: one function asked says so.
    lacks = tuple(name for name in WAYS if name != "link_poses") if form == "sdf" else ()
    return Source(tuple(setup.split("\n")), slots, count, count, optional, lacks)


PLUGIN = SourcePlugin(
    name="pybullet",
    package="pybullet",
    extra="symofros[engine-pybullet]",
    conventions=(
        Convention("order of joints", "of the file's links, with URDF_MAINTAIN_LINK_ORDER"),
        Convention("inertias", "made up from shapes unless URDF_USE_INERTIA_FROM_FILE is given"),
        Convention("velocities of links", "of the mass centre"),
        Convention("points of Jacobians", "from the link's origin, along the principal axes of its inertia"),
        Convention("links without <inertial>", "get a mass of 1 kg and moments of 1 kg m^2, with a warning"),
        Convention("files", "cached by name"),
        Convention("armature", "none"),
        Convention("stepSimulation", "links are damped by 0.04 and joints held by motors unless both are set to zero"),
    ),
    kinds=KINDS,
    ways=WAYS | turning.WAYS,
    write=write,
    formats=tuple(_LOADS),
    write_reading=write_reading,
    demands={"turns": "rotations and placements", "dampers": "dynamics, damping"},
    statements=(
        Statement(
            "repairs",
            "links without <inertial> get a mass of 1 kg and moments of 1 kg m^2, with a warning",
            "bullet3 3.2.7, examples/Importers/ImportURDFDemo/UrdfParser.cpp: No inertial data for link",
            "mass_matrix|bias|gravity|inverse_dynamics",
            has_bare_link,
        ),
        UNIT_AXIS,
    ),
)
