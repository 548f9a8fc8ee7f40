"""PyBullet: articulated bodies of Bullet, from URDF and SDF."""

from __future__ import annotations

import re
from dataclasses import replace

from ..interface import STEP, Convention, Statement, Tree, Unsupported
from ..truth.points import POINT
from ..truth.sensed import WRENCH
from . import turns
from .turns import pybullet as turning
from .writing import copies
from .writing.numbering import is_depth_first
from .writing.source import Source, SourcePlugin, Way, ways_of
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
_LINKS = "links = {base} + [joint[0] for name in {links} for joint in joints if joint[12].decode() == name]"
_GRAVITY = "p.setGravity{gravity}"
_MOVING = "moving = [joint[0] for joint in joints if joint[2] != p.JOINT_FIXED]"
_LOADS = {
    "urdf": (
        "p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)"
    ),
    "urdf from shapes": "p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_MAINTAIN_LINK_ORDER)",
    "sdf": "p.loadSDF(file.name)[0]",
}
_LOADS["urdf written"] = _LOADS["urdf"]
# What was read, written by the editor of URDF and read again.
_EDITED = """from pybullet_utils.urdfEditor import UrdfEditor
editor, written = UrdfEditor(), NamedTemporaryFile("r", suffix=".urdf")
editor.initializeFromBulletBody(robot, 0)
editor.saveUrdf(written.name)
robot = LOAD"""
_MASSLESS = '<inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>'
_STATES = """joints
for k, position, speed in zip(moving, q, {v}): p.resetJointState(robot, k, position, speed)
states = [p.getLinkState(robot, k, computeLinkVelocity=1, computeForwardKinematics=1) for k in links]
"""
_KEPT = (
    "p.resetJointState(robot, k, position, speed)\n",
    "kept = p.saveState()\nfor k in moving: p.resetJointState(robot, k, 0.0, 0.0)\np.restoreState(kept)\n"
    "p.removeState(kept)\n",
)
WAYS = ways_of(f"""
== mass_matrix | calculateMassMatrix | value = p.calculateMassMatrix(robot, q.tolist())
== inverse_dynamics | calculateInverseDynamics
gravity
value = p.calculateInverseDynamics(robot, q.tolist(), v.tolist(), a.tolist())
== bias | calculateInverseDynamics
gravity
value = p.calculateInverseDynamics(robot, q.tolist(), v.tolist(), [0.0] * len(v))
== gravity | calculateInverseDynamics
gravity
value = p.calculateInverseDynamics(robot, q.tolist(), *[[0.0] * len(v)] * 2)
== joint_speed_limits | getJointInfo | joints\nvalue = [p.getJointInfo(robot, k)[11] for k in moving]
== joint_force_limits | getJointInfo | joints\nvalue = [p.getJointInfo(robot, k)[10] for k in moving]
== joint_limits | getJointInfo | joints\nvalue = [p.getJointInfo(robot, k)[8:10] for k in moving]
== link_poses | getLinkState
{_STATES.format(v="0 * q")}value = [[*s[4], *p.getMatrixFromQuaternion(s[5])] for s in states]
== link_velocities | getLinkState
{_STATES.format(v="v")}def arm(s): return -np.reshape(p.getMatrixFromQuaternion(s[5]), (3, 3)) @ s[2]
value = [[*(np.array(s[6]) + np.cross(s[7], arm(s))), *s[7]] for s in states]
== # Points are stated from the link's origin, along the principal axes of its inertia.
== link_jacobians | calculateJacobian
joints
zero = [0.0] * len(q)
value = [np.concatenate(p.calculateJacobian(robot, k, [0, 0, 0], q.tolist(), zero, zero)) for k in links]
""")

# A joint has a motor that holds it still unless its greatest force is zero, and a greatest speed; a link has a damper.
_DRIVEN = """gravity
joints
p.setTimeStep(STEP)
for k in range(-1, p.getNumJoints(robot)):
    p.changeDynamics(robot, k, linearDamping=0, angularDamping=0, maxJointVelocity=1e9)
for k, position, speed, force in zip(moving, q, v, tau):
    p.resetJointState(robot, k, position, speed)
    p.setJointMotorControl2(robot, k, p.VELOCITY_CONTROL, force=0)
    p.setJointMotorControl2(robot, k, p.TORQUE_CONTROL, force=force)
"""
_STEP = f"""{_DRIVEN.replace("STEP", repr(STEP))}p.stepSimulation()
states = p.getJointStates(robot, moving)
value = [*(s[0] for s in states), *(s[1] for s in states)]"""
WAYS["step_semi_implicit"] = Way("stepSimulation", _STEP)
# Sensors read the wrench of the accelerations at the end of the step, at the mass centre along the principal axes: of a
# short step, they are those at its beginning.
_SHORT = 2.0**-24
_HELD = f"""{_DRIVEN.replace("STEP", repr(_SHORT))}for k in links: p.enableJointForceTorqueSensor(robot, k, 1)
p.stepSimulation()
value = []
for k in links:
    info, held = p.getDynamicsInfo(robot, k), np.reshape(p.getJointState(robot, k)[2], (2, 3))
    force, moment = held @ np.reshape(p.getMatrixFromQuaternion(info[4]), (3, 3)).T
    value.append([*force, *(moment + np.cross(info[3], force))])
    p.enableJointForceTorqueSensor(robot, k, 0)"""
_REACTIONS = "getJointState: joint reaction forces"
WAYS["joint_wrenches_driven"] = Way(_REACTIONS, _HELD, 1e-6)
WAYS["joint_wrenches_from_rest"] = Way(_REACTIONS, _HELD.replace("q, v, tau", "q, 0 * q, tau"), 1e-6)
# A free base stands where the frame of its inertia does: mass centre and principal axes. There its speeds are taken,
# the angular ones first, and its accelerations, which are those of the mass centre; forces have the linear part first.
_BASE = """joints
base, still = p.getDynamicsInfo(robot, -1), len(moving)
centre, own = np.array(base[3]), np.reshape(p.getMatrixFromQuaternion(base[4]), (3, 3))
about = np.eye(6 + still)
about[:6, :6] = np.block([[np.zeros((3, 3)), own.T], [own.T, own.T @ np.cross(np.eye(3), centre).T]])
def product(x, y): return [*(x[3] * y[:3] + y[3] * x[:3] + np.cross(x[:3], y[:3])), x[3] * y[3] - x[:3] @ y[:3]]
def inverse_dynamics(q, v, a):
    v, a = about @ v, about @ a
    a[3:6] += np.cross(v[:3], v[3:6])
    position = q[:3] + np.reshape(p.getMatrixFromQuaternion(q[3:7]), (3, 3)) @ centre
    place = [*position, *product(q[3:7], np.array(base[4]))]
    forces = np.array(p.calculateInverseDynamics(robot, [*place, *q[7:]], v.tolist(), a.tolist()))
    return about.T @ np.r_[forces[3:6], forces[:3], forces[6:]]
def stand(q, v):
    R = np.reshape(p.getMatrixFromQuaternion(q[3:7]), (3, 3))
    p.resetBasePositionAndOrientation(robot, *p.multiplyTransforms(q[:3], q[3:7], *base[3:5]))
    p.resetBaseVelocity(robot, R @ (v[:3] + np.cross(v[3:6], centre)), R @ v[3:6])
    place = p.getBasePositionAndOrientation(robot)
    link = p.multiplyTransforms(*place, *p.invertTransform(*base[3:5]))
    return *place, *base[3:5], *link, *p.getBaseVelocity(robot)"""
_LINK = "p.getLinkState(robot, k, computeLinkVelocity=1, computeForwardKinematics=1)"
_FREE = {
    "p.calculateInverseDynamics(robot, q.tolist()": "inverse_dynamics(q",
    "p.calculateMassMatrix(robot, q.tolist())": "about.T @ p.calculateMassMatrix(robot, q[7:].tolist()) @ about",
    "zip(moving, q, 0 * q)": "zip(moving, q[7:], 0 * q)",
    "zip(moving, q, v)": "zip(moving, q[7:], v[6:])",
    f"[{_LINK} for k in links]": f"[stand(q, v), *({_LINK} for k in links[1:])]",
}
# Links that don't move as one with those they hang on; a base that is turned and shifted.
_MERGED = (("p.URDF_USE_INERTIA_FROM_FILE", "p.URDF_MERGE_FIXED_LINKS | p.URDF_USE_INERTIA_FROM_FILE"),)
_BASED = (
    ("useFixedBase=True", "basePosition=[0.5, -0.25, 1.0], baseOrientation=[0.1, -0.7, 0.5, 0.5], useFixedBase=True"),
)
# A step's change of speeds, for a unit of time.
_CHANGE = _STEP[: _STEP.index("states = p.getJointStates")].replace("p.stepSimulation()", "{}p.stepSimulation()") + (
    f"value = (np.array([p.getJointState(robot, k)[1] for k in moving]) - v) / {STEP!r}"
)
_IN_LINK = f"for k in sensed:\n    p.applyExternalForce(robot, k, {list(WRENCH[:3])}, [0, 0, 0], p.LINK_FRAME)\n" + (
    f"    p.applyExternalTorque(robot, k, {list(WRENCH[3:])}, p.LINK_FRAME)\n"
)
_IN_WORLD = f"""for k in sensed:
    x, turn = p.getLinkState(robot, k, computeForwardKinematics=1)[4:6]
    R = np.reshape(p.getMatrixFromQuaternion(turn), (3, 3))
    p.applyExternalForce(robot, k, R @ {list(WRENCH[:3])}, x, p.WORLD_FRAME)
    p.applyExternalTorque(robot, k, R @ {list(WRENCH[3:])}, p.WORLD_FRAME)
"""
_POINTS = f"""joints
zero, value = [0.0] * len(q), []
for k in links:
    own = np.reshape(p.getMatrixFromQuaternion(p.getDynamicsInfo(robot, k)[4]), (3, 3))
    value.append(p.calculateJacobian(robot, k, list(own.T @ {list(POINT)}), q.tolist(), zero, zero)[0])"""
WAYS |= (
    ways_of(f"""
== total_mass | getDynamicsInfo
value = [sum(p.getDynamicsInfo(robot, k)[0] for k in range(-1, p.getNumJoints(robot)))]
== link_poses:getLinkStates | getLinkStates
{_STATES.format(v="0 * q")}states = p.getLinkStates(robot, links, computeForwardKinematics=1)
value = [[*s[4], *p.getMatrixFromQuaternion(s[5])] for s in states]
""")
    | {
        "link_poses:basePosition": Way(
            "loadURDF: basePosition, baseOrientation",
            f"{_STATES.format(v='0 * q')}base = p.invertTransform([0.5, -0.25, 1.0], [0.1, -0.7, 0.5, 0.5])\n"
            "at = [p.multiplyTransforms(*base, *s[4:6]) for s in states]\n"
            "value = [[*x, *p.getMatrixFromQuaternion(turn)] for x, turn in at]",
            0.0,
            _BASED,
        ),
        "mass_matrix:URDF_MERGE_FIXED_LINKS": WAYS["mass_matrix"]._replace(
            native="URDF_MERGE_FIXED_LINKS, calculateMassMatrix", built=_MERGED
        ),
        "bias:URDF_MERGE_FIXED_LINKS": WAYS["bias"]._replace(
            native="URDF_MERGE_FIXED_LINKS, calculateInverseDynamics", built=_MERGED
        ),
    }
    | ways_of(f"""
== # Shapes are stated in the frame of the link's inertia.
== shape_poses | getCollisionShapeData
{_STATES.format(v="0 * q")}value = []
for k, s in zip(links, states):
    for shape in p.getCollisionShapeData(robot, k):
        x, turn = p.multiplyTransforms(s[0], s[1], *shape[5:7])
        value.append([*x, *p.getMatrixFromQuaternion(turn)])
== point_jacobians | calculateJacobian | {_POINTS}
== pushed_accelerations | applyExternalForce, applyExternalTorque, LINK_FRAME | {_CHANGE.format(_IN_LINK)}
== pushed_accelerations:WORLD_FRAME | applyExternalForce, applyExternalTorque, WORLD_FRAME | {_CHANGE.format(_IN_WORLD)}
""")
)
# What is asked of free bases.
_OF_FREE = ("mass_matrix", "inverse_dynamics", "bias", "gravity", "link_poses", "link_velocities")


def write(tree: Tree) -> Source | Unsupported:
    """The tree through PyBullet's reader of URDF."""
    if tree.asked == "turns":
        return turns.source(*turning.IMPORTS, scalar_last=True)
    if tree.changed:
        first = write(tree.before)
        if isinstance(first, Unsupported):
            return first
        lacks = (*first.lacks, *(name for name in WAYS if ":URDF_MERGE" in name))
        return replace(first, closing=_weighing(tree, first.nv), lacks=lacks)
    described = describe(tree)
    if isinstance(described, Unsupported):
        return described
    text = re.sub(r'<link name="([^"]*)"/>', rf'<link name="\1">{_MASSLESS}</link>', described.text)
    return write_reading(tree, "urdf", text)


def _weighing(tree: Tree, count: int) -> tuple[str, ...]:
    """Statements that use the masses before a change, then state those of the tree, with the moments as they were."""
    before, after = ([link.mass for link in one.links] for one in (tree.before, tree))
    weighed = (
        f"for k, mass in zip(links, {masses}): p.changeDynamics(robot, k, mass=mass, "
        "localInertiaDiagonal=p.getDynamicsInfo(robot, k)[2])"
        for masses in (before, after)
    )
    still = [0.0] * count
    used = f"p.calculateMassMatrix(robot, {still}); p.calculateInverseDynamics(robot, {still}, {still}, {still})"
    return "joints", next(weighed), used, next(weighed)


def write_reading(tree: Tree, form: str, text: str) -> Source | Unsupported:
    """A file through PyBullet's reader."""
    described = describe(tree)
    if isinstance(described, Unsupported):
        return described
    free = described.floating
    if form == "urdf written" and re.search(r"<visual|<collision|\.\d{6}", text):
        return Unsupported("the editor is asked of bodies and joints in five decimals, which it writes", offered=False)
    if 'type="floating"' in text:
        return Unsupported("floating joints of files are made fixed, with a warning", offered=False)
    if free and not tree.links[0].mass:
        return Unsupported("bases without mass stand still", offered=False)
    setup = _SETUP.format(text=text, form=form.split()[0], load=_LOADS[form].replace("=True", f"={not free}", 1))
    count = len(described.moving)
    optional: dict[str, tuple[str, ...]] = {"gravity": ("gravity = True", _GRAVITY.format(gravity=tree.gravity))}
    if form.startswith("urdf") and all(len(link.joints) == 1 for link in tree.links):
        # Links, and the joints before them, are numbered as in the file.
        places = [k - free for k, link in enumerate(tree.links) if link.joints[0].kind not in ("fixed", "free")]
        optional |= {"joints": ("joints = ()",), "moving": (f"moving = {places}",)}
        optional |= {"links": (f"links = {list(range(-free, len(tree.links) - free))}",)}
    else:
        optional |= {"joints": (_JOINTS,), "moving": (_MOVING,)}
        optional |= {"links": (_LINKS.format(base=[-1] * free, links=list(described.links)),)}
    slots = slots_of(tree, described, described.moving, "free xyzw, body speeds")
    # Its reader of SDF takes no joint with the world: one function asked says so. Five decimals, as its editor of URDF
    # writes them, are enough for joints, not for axes of inertia.
    asked = ("link_poses",) if form in ("sdf", "urdf written") else _OF_FREE if free else tuple(WAYS)
    # Merged links are numbered anew.
    merged = is_depth_first(tree) and not free
    lacks = tuple(name for name in WAYS if name not in asked or (":URDF_MERGE" in name and not merged))
    if form == "urdf written":
        setup += "\n" + _EDITED.replace("LOAD", _LOADS[form].replace("file.name", "written.name"))
    lines = tuple(setup.split("\n"))
    if tree.sensors:
        frames = [f"o{k}" for k in range(len(tree.sensors))]
        optional["sensed"] = (
            _JOINTS,
            f"sensed = [joint[0] for name in {frames} for joint in joints if joint[12].decode() == name]",
        )
    if not free:
        return Source(lines, slots, count, count, optional, lacks)
    optional["about"] = tuple(_BASE.split("\n"))
    return Source(lines, slots, count + 7, count + 6, optional, lacks, spelling=_FREE)


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
        Convention(
            "free base",
            "the frame of its inertia; calculateInverseDynamics takes position and quaternion, then angular before"
            " linear velocity and acceleration of the mass centre, and gives the linear force first",
        ),
        Convention("armature", "none"),
        Convention("stepSimulation", "links are damped by 0.04 and joints held by motors unless both are set to zero"),
    ),
    kinds=KINDS,
    ways=WAYS | copies.of_state(WAYS, {"saveState": _KEPT}, ("link_poses", "link_velocities")) | turning.WAYS,
    write=write,
    formats=tuple(_LOADS),
    write_reading=write_reading,
    demands={
        "turns": "rotations and placements",
        "urdf written": "UrdfEditor.saveUrdf",
        "sensors": "links without mass",
        "dampers": "dynamics, damping",
        "changed mass": "changeDynamics: mass",
    },
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
