"""PyBullet: articulated bodies of Bullet, from URDF and SDF."""

from __future__ import annotations

import re

from validation.engines.interface import Difference, Tree, Unsupported
from validation.engines.plugins.writing.source import Source, SourcePlugin, Way
from validation.engines.plugins.writing.urdf import KINDS, describe, slots_of

_SETUP = '''import tempfile
import numpy as np
import pybullet as p
TEXT = """{text}"""
if not p.isConnected():
    p.connect(p.DIRECT)
p.setGravity(*{gravity})
with tempfile.NamedTemporaryFile("w", suffix=".{form}") as file:
    file.write(TEXT)
    file.flush()
    flags = p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER
    robot = {load}
named = {{p.getJointInfo(robot, k)[12].decode(): k for k in range(p.getNumJoints(robot))}}
links = [named[name] for name in {links}]
moving = [k for k in range(p.getNumJoints(robot)) if p.getJointInfo(robot, k)[2] != p.JOINT_FIXED]
def states(q, v):
    for k, position, speed in zip(moving, q, v):
        p.resetJointState(robot, k, position, speed)
    return [p.getLinkState(robot, k, computeLinkVelocity=1, computeForwardKinematics=1) for k in links]
'''
_LOADS = {
    "urdf": "p.loadURDF(file.name, useFixedBase=True, flags=flags)",
    "sdf": "p.loadSDF(file.name)[0]",
}
_MASSLESS = '<inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>'
WAYS = {
    "mass_matrix": Way("calculateMassMatrix", "value = p.calculateMassMatrix(robot, q.tolist())"),
    "inverse_dynamics": Way(
        "calculateInverseDynamics", "value = p.calculateInverseDynamics(robot, q.tolist(), v.tolist(), a.tolist())"
    ),
    "bias": Way(
        "calculateInverseDynamics", "value = p.calculateInverseDynamics(robot, q.tolist(), v.tolist(), [0.0] * len(v))"
    ),
    "gravity": Way(
        "calculateInverseDynamics", "value = p.calculateInverseDynamics(robot, q.tolist(), *[[0.0] * len(q)] * 2)"
    ),
    "link_poses": Way(
        "getLinkState", "value = [[*s[4], *p.getMatrixFromQuaternion(s[5])] for s in states(q, np.zeros(len(q)))]"
    ),
    "link_velocities": Way(
        "getLinkState",
        "value = [[*(np.array(s[6]) + np.cross(s[7], np.array(s[4]) - s[0])), *s[7]] for s in states(q, v)]",
    ),
    # Points are stated from the link's origin, along the principal axes of its inertia.
    "link_jacobians": Way(
        "calculateJacobian",
        "zero = [0.0] * len(q)\n"
        "value = [np.concatenate(p.calculateJacobian(robot, k, [0, 0, 0], q.tolist(), zero, zero)) for k in links]",
    ),
}


def write(tree: Tree) -> Source | Unsupported:
    """The tree through PyBullet's reader of URDF."""
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
    setup = _SETUP.format(
        text=text, form=form, load=_LOADS[form], gravity=list(tree.gravity), links=list(described.links)
    )
    count = len(described.moving)
    return Source((setup,), slots_of(tree, described, described.moving), nq=count, nv=count)


PLUGIN = SourcePlugin(
    name="pybullet",
    package="pybullet",
    extra="symofros[engine-pybullet]",
    conventions=(
        Difference("order of joints", "of the file's links, with URDF_MAINTAIN_LINK_ORDER"),
        Difference("inertias", "made up from shapes unless URDF_USE_INERTIA_FROM_FILE is given"),
        Difference("velocities of links", "of the mass centre"),
        Difference("points of Jacobians", "from the link's origin, along the principal axes of its inertia"),
        Difference("links without <inertial>", "get a mass of 1 kg and moments of 1 kg m^2, with a warning"),
        Difference("files", "cached by name"),
        Difference("armature", "none"),
    ),
    kinds=KINDS,
    ways=WAYS,
    write=write,
    formats=tuple(_LOADS),
    write_reading=write_reading,
)
