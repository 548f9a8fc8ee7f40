"""DART: skeletons by its API."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..interface import STEP, Array, Convention, Joint, Link, Slot, Statement, Tree, Unsupported
from . import features, turns
from .features import dart_features
from .loops import dart_bound, dart_frames, dart_joints, goals
from .turns import dart as turning
from .writing import copies
from .writing.numbering import numbered
from .writing.source import NO_SOLUTION, Source, SourcePlugin, Way, series, ways_of
from .writing.urdf import UNIT_AXIS, has_bare_link


class _Native(NamedTuple):
    """A joint of DART: name in its API, chart, number of coordinates, statements on the joint `j`."""

    name: str
    chart: str
    size: int
    settings: str = ""


# Screws advance by the pitch in a whole turn.
_JOINTS = {
    "revolute": _Native("RevoluteJoint", "angle", 1, "j.setAxis({axis})"),
    "prismatic": _Native("PrismaticJoint", "length", 1, "j.setAxis({axis})"),
    "helical": _Native("ScrewJoint", "screw angle", 1, "j.setAxis({axis}); j.setPitch({turn!r})"),
    "universal": _Native("UniversalJoint", "two angles", 2, "j.setAxis1({axis}); j.setAxis2({second})"),
    "euler": _Native("EulerJoint", "three angles", 3),
    "ball": _Native("BallJoint", "rotation vector, body speeds", 3),
    "translation": _Native("TranslationalJoint", "three lengths", 3),
    "planar": _Native("PlanarJoint", "planar angle", 3, "j.setXYPlane()"),
    "free": _Native("FreeJoint", "free rotation vector, angular and linear along the parent's axes", 6),
}

_IMPORTS = ("import numpy as np", "import dartpy as dart")
_Q = "s.setPositions(q)\n"
_QV = f"{_Q}s.setVelocities(v)\n"
_QVA = f"{_QV}s.setAccelerations(a)\n"
_STILL = f"{_QV}s.setAccelerations(0 * v)\n"
_INTEGRATED = f"{_Q}s.setVelocities(v2)\ns.integratePositions(1.0)\n"


def _linear_first(call: str, state: str) -> str:
    return f"{state}value = [np.roll({call}, 3, axis=0) for b in links]"


_FORWARD = f"{_QV}s.setForces(tau)\n"
# Dampers and springs of joints act as they will after the skeleton's time step; of none, as they do now.
_NOW = "s.setTimeStep(0.0)\n"
_WORLD = f"w = dart.simulation.World()\nw.setGravity(s.getGravity()); w.addSkeleton(s); w.setTimeStep({STEP})\n"

# Rotation vectors of balls and free joints, which DART keeps within half a turn, as the motion from `q` continues them.
_CONTINUED = f"""def near(x, place):
    for j in map(s.getJoint, range(s.getNumJoints())):
        if j.getType() in ('BallJoint', 'FreeJoint'):
            k = j.getIndexInSkeleton(0)
            r = x[k:k + 3]
            n = np.linalg.norm(r) or 1.0
            r += 2 * np.pi * np.round((place[k:k + 3] @ r / n - n) / (2 * np.pi)) * r / n
    return x
x, reached, speeds = q, s.getPositions(), s.getVelocities()
s.setPositions(q)
for _ in range(64):
    s.setVelocities(speeds)
    s.integratePositions({STEP} / 64)
    x = near(s.getPositions(), x)
"""

_GET_BODY_FORCE = _linear_first("b.getBodyForce()", f"{_QVA}s.computeInverseDynamics()\n")
_COMPUTE_FORWARD_DYNAMICS = _linear_first("b.getBodyForce()", f"{_FORWARD}{_NOW}s.computeForwardDynamics()\n")
WAYS = {
    "mass_matrix": Way("getMassMatrix", f"{_Q}value = s.getMassMatrix()"),
    "mass_matrix_inverse": Way("getInvMassMatrix", f"{_Q}value = s.getInvMassMatrix()"),
    "bias": Way("getCoriolisAndGravityForces", f"{_QV}value = s.getCoriolisAndGravityForces()"),
    "coriolis_forces": Way("getCoriolisForces", f"{_QV}value = s.getCoriolisForces()"),
    "gravity": Way("getGravityForces", f"{_Q}value = s.getGravityForces()"),
    "inverse_dynamics": Way("computeInverseDynamics", f"{_QVA}s.computeInverseDynamics()\nvalue = s.getForces()"),
    "joint_speed_limits": Way("getVelocityUpperLimits", "value = s.getVelocityUpperLimits()"),
    "joint_force_limits": Way("getForceUpperLimits", "value = s.getForceUpperLimits()"),
    **{
        name: Way(native, f"value = [s.getDof(k).{native}() for k in range(s.getNumDofs())]")
        for name, native in (
            ("joint_dampings", "getDampingCoefficient"),
            ("joint_frictions", "getCoulombFriction"),
            ("joint_stiffnesses", "getSpringStiffness"),
        )
    },
} | ways_of(f"""
== joint_limits | getPositionLowerLimits, getPositionUpperLimits
value = np.c_[s.getPositionLowerLimits(), s.getPositionUpperLimits()]
== joint_limits_of_some | getPositionLowerLimits, getPositionUpperLimits
x = np.c_[s.getPositionLowerLimits(), s.getPositionUpperLimits()]
value = np.where(np.isfinite(x), x, 0.0)
== joint_wrenches | getBodyForce | {_GET_BODY_FORCE}
== joint_wrenches_driven | computeForwardDynamics, getBodyForce | {_COMPUTE_FORWARD_DYNAMICS}
== forward_dynamics | computeForwardDynamics | {_FORWARD}{_NOW}s.computeForwardDynamics()\nvalue = s.getAccelerations()
== step_stiffness_implicit | World.step
import numpy as np
{_WORLD}{_FORWARD}w.step()
{_CONTINUED}value = np.r_[near(reached, x), speeds]
== kinetic_energy | computeKineticEnergy | {_QV}value = s.computeKineticEnergy()
== potential_energy | computePotentialEnergy | {_Q}value = s.computePotentialEnergy()
== link_poses | getTransform
{_Q}X = [b.getTransform() for b in links]
value = [[*x.translation(), *x.rotation().flat] for x in X]
== link_velocities | getLinearVelocity | {_QV}value = [[*b.getLinearVelocity(), *b.getAngularVelocity()] for b in links]
== link_turning | getAngularVelocity | {_QV}value = [b.getAngularVelocity() for b in links]
== velocity_local | getSpatialVelocity | {_linear_first("b.getSpatialVelocity()", _QV)}
== acceleration_local | getSpatialAcceleration | {_linear_first("b.getSpatialAcceleration()", _QVA)}
== link_accelerations | getLinearAcceleration
{_QVA}value = [[*b.getLinearAcceleration(), *b.getAngularAcceleration()] for b in links]
== link_jacobians | getJacobian, World | {_linear_first("s.getJacobian(b, dart.dynamics.Frame.World())", _Q)}
== jacobian_local | getJacobian | {_linear_first("s.getJacobian(b)", _Q)}
== link_jacobian_rates | getJacobianClassicDeriv, World
{_linear_first("s.getJacobianClassicDeriv(b, dart.dynamics.Frame.World())", _QV)}
== # Rates of spatial vectors, in the body's axes: those of the Jacobian at the world's origin, transformed.
== jacobian_rate_world | getJacobianSpatialDeriv
{_QV}value = []
for b in links:
    R, p = b.getTransform().rotation(), b.getTransform().translation()
    J = s.getJacobianSpatialDeriv(b)
    value.append([*(R @ J[3:] + np.cross(p, (R @ J[:3]).T).T), *(R @ J[:3])])
== mass_centre | getCOM | {_Q}value = s.getCOM()
== mass_centre_jacobian | getCOMLinearJacobian | {_Q}value = s.getCOMLinearJacobian()
== mass_centre_velocity_products | getCOMLinearJacobianDeriv | {_QV}value = s.getCOMLinearJacobianDeriv() @ v
== mass_centre_velocity_products:getCOMLinearAcceleration | getCOMLinearAcceleration
{_STILL}value = s.getCOMLinearAcceleration()
== integrate | integratePositions | {_INTEGRATED}value = s.getPositions()
== difference | getPositionDifferences | {_INTEGRATED}value = s.getPositionDifferences(s.getPositions(), q)
""")
_COPIED = {
    "clone": "s = s.clone()\nlinks = [s.getBodyNode(b.getName()) for b in links]\n",
    # Joints of a copy, along axes and at places of their own, are made as those that they copy.
    "Joint.copy": """first, s = s, s.clone()
links = [s.getBodyNode(b.getName()) for b in links]
for k in range(s.getNumJoints()):
    j = s.getJoint(k)
    if hasattr(j, 'copy'):
        j.setTransformFromParentBodyNode(dart.math.Isometry3(np.eye(3), np.array([1.0, -2.0, 0.5])))
        for name, axis in (('setAxis', (0.0, 0.6, 0.8)), ('setAxis1', (0.0, 0.6, 0.8)), ('setAxis2', (0.8, 0.0, 0.6))):
            if hasattr(j, name): getattr(j, name)(np.array(axis))
        j.copy(first.getJoint(k))
""",
}


def _array(values: object) -> str:
    return repr(np.asarray(values, dtype=float).tolist())


def _placement(R: Array, p: Array) -> str:
    return f"dart.math.Isometry3({_array(R)}, {_array(p)})"


def _native(joint: Joint) -> _Native | None:
    if joint.form or joint.mimics or any(joint.armature) or (joint.kind == "euler" and joint.sequence != "XYZ"):
        return None
    return _JOINTS.get(joint.kind)


def _changing(tree: Tree) -> list[str]:
    """Statements that give the skeleton a tree's numbers of what is changed."""
    if tree.changed == "gravity":
        return [f"s.setGravity({list(tree.gravity)!r})"]
    lines = []
    for k, link in enumerate(tree.links):
        if tree.changed == "mass":
            lines.append(f"b{k}.setMass({link.mass!r})")
        elif tree.changed == "inertia":
            lines.append(f"b{k}.setInertia({_inertia(link)})")
        else:
            at = _placement(np.array(link.joints[0].R), np.array(link.joints[0].p))
            lines.append(f"b{k}.getParentJoint().setTransformFromParentBodyNode({at})")
    return lines


def _inertia(link: Link) -> str:
    return f"dart.dynamics.Inertia({link.mass!r}, {_array(link.com)}, {_array(link.inertia)})"


def write(tree: Tree) -> Source | Unsupported:
    """Text that builds a skeleton; links without a joint hang on weld joints."""
    if tree.asked == "turns" or tree.asked in features.DART:
        return turns.source(*turning.IMPORTS)
    if tree.changed:
        first = write(tree.before)
        before = _changing(replace(tree.before, changed=tree.changed))
        closing = (*before, "s.getMassMatrix(); s.getCoriolisAndGravityForces()", *_changing(tree))
        return first if isinstance(first, Unsupported) else replace(first, closing=closing)
    lines = [*_IMPORTS, "s = dart.dynamics.Skeleton('tree')"]
    lines += _gravity(tree)
    slots: list[tuple[Slot, ...]] = []
    count = 0
    for k, link in enumerate(tree.links):
        steps, (R_end, p_end) = series(link.joints)
        if len(steps) > 1:
            return Unsupported("a body hangs on one joint", offered=False)
        R, p, native = R_end, p_end, _Native("WeldJoint", "", 0)
        if steps:
            R, p, joint = steps[0]
            known = _native(joint)
            if known is None:
                described = f"{joint.kind} {joint.form or joint.sequence}".strip()
                extra = " that mimics" if joint.mimics else " with armature" if any(joint.armature) else ""
                return Unsupported(f"no joint for {described}{extra}", offered=False)
            native = known
            if joint.kind == "free" and not np.array_equal(R, joint.R):
                return Unsupported("speeds of free joints are along the axes of the link before", offered=False)
        parent = "None" if link.parent < 0 else f"b{link.parent}"
        lines.append(f"j, b{k} = s.create{native.name}AndBodyNodePair({parent})")
        lines += [f"j.{name}" for name in (_forces(joint, native.size) if steps else ())]
        # The axis is z unless another is set.
        if native.settings and not (
            native.name in ("RevoluteJoint", "PrismaticJoint") and joint.axis == (0.0, 0.0, 1.0)
        ):
            axis, second = _array(joint.axis), _array(joint.second)
            lines.append(native.settings.format(axis=axis, second=second, turn=2 * math.pi * joint.pitch))
        if np.any(p) or not np.array_equal(R, np.eye(3)):
            lines.append(f"j.setTransformFromParentBodyNode({_placement(R, p)})")
        if steps and (np.any(p_end) or not np.array_equal(R_end, np.eye(3))):
            lines.append(f"j.setTransformFromChildBodyNode({_placement(R_end.T, -R_end.T @ p_end)})")
        lines.append(f"b{k}.setInertia({_inertia(link)})")
        places = tuple(range(count, count + native.size))
        slots.append((Slot(native.chart, places, places),) if steps else ())
        count += native.size
    links = f"links = [{', '.join(f'b{k}' for k in range(len(tree.links)))}]"
    optional = {"links": (links,)} | dart_frames.sensed(tree) | dart_bound.bound(tree)
    return Source(tuple(lines), tuple(slots), count, count, optional)


def _forces(joint: Joint, size: int) -> list[str]:
    """Calls on a joint that set its damper and spring."""
    calls = [f"setDampingCoefficient({k}, {joint.damping!r})" for k in range(size if joint.damping else 0)]
    if joint.stiffness:
        calls += [f"setSpringStiffness(0, {joint.stiffness!r})", f"setRestPosition(0, {joint.rest!r})"]
    return calls


def _gravity(tree: Tree) -> list[str]:
    """What sets the tree's gravity; nothing where it is DART's own."""
    return [] if tree.gravity == (0.0, 0.0, -9.81) else [f"s.setGravity({list(tree.gravity)!r})"]


_READERS = {
    "urdf": (
        "loader = dart.utils.DartLoader()",
        "loader.setOptions(dart.utils.DartLoaderOptions(defaultRootJointType=dart.utils.DartLoaderRootJointType.FIXED))",
        "s = loader.parseSkeletonString(TEXT, dart.common.Uri(''))",
    ),
    "sdf": (
        "from tempfile import NamedTemporaryFile",
        "file = NamedTemporaryFile('w', suffix='.sdf')",
        "print(TEXT, file=file, flush=True)",
        "options = dart.utils.SdfParser.Options(None, dart.utils.SdfParser.RootJointType.FIXED)",
        "s = dart.utils.SdfParser.readSkeleton(dart.common.Uri('file://' + file.name), options)",
    ),
    "mjcf": (
        "from tempfile import NamedTemporaryFile",
        "file = NamedTemporaryFile('w', suffix='.xml')",
        "print(TEXT, file=file, flush=True)",
        "world = dart.utils.MjcfParser.readWorld(dart.common.Uri('file://' + file.name))",
        "s = world and world.getSkeleton(0)",
    ),
    "skel": (
        "world = dart.utils.SkelParser.readWorldXML(TEXT, dart.common.Uri(''))",
        "s = world and world.getSkeleton(0)",
    ),
}


def write_reading(tree: Tree, form: str, text: str) -> Source | Unsupported:
    """Text that has DART read a file."""
    if any(joint.mimics for link in tree.links for joint in link.joints):
        return Unsupported("what mimics is a constraint of its simulation", offered=False)
    # Its hinges know no cosine and sine.
    charts = {(kind, shape): native.chart for kind, native in _JOINTS.items() for shape in ("", "unbounded")}
    made = numbered(tree, charts)
    if isinstance(made, Unsupported):
        return made
    slots, count, _ = made
    names = [link.name for link in tree.links]
    lines = [
        *_IMPORTS,
        *(line.replace("TEXT", repr(text)) for line in _READERS[form]),
        "if s is None: raise ValueError('no skeleton: see the log')",
        *([] if form in ("mjcf", "skel") else _gravity(tree)),
    ]
    # A body that it has not read has no pose to answer with.
    links = f"links = [b for name in {names!r} if (b := s.getBodyNode(name))]"
    return Source(tuple(lines), slots, count, count, {"links": (links,)})


PLUGIN = SourcePlugin(
    name="dart",
    package="dartpy",
    extra="symofros[engine-dart]",
    conventions=(
        Convention("ball joint", "rotation vector; angular velocity in the body"),
        Convention(
            "free joint", "rotation vector, position; angular and linear velocity along the axes of the link before"
        ),
        Convention("planar joint", "x, y, angle; their rates"),
        Convention("screw", "pitch for a whole turn"),
        Convention(
            "getJacobianSpatialDeriv", "rate of a spatial vector, in the body's axes: the body's turning is not in it"
        ),
        Convention("spatial vectors", "angular, then linear, in the body's axes unless a frame is named"),
        Convention("Euler angles", "x, y, z; the order can be set in C++, its Python type is not bound"),
        Convention("armature", "none"),
        Convention("dampers and springs", "as they will be after the skeleton's time step, in forward dynamics, too"),
    ),
    kinds={
        "revolute x": "RevoluteJoint",
        "revolute y": "RevoluteJoint",
        "revolute z": "RevoluteJoint",
        "revolute oblique": "RevoluteJoint",
        "prismatic": "PrismaticJoint",
        "prismatic oblique": "PrismaticJoint",
        "helical": "ScrewJoint",
        "helical oblique": "ScrewJoint",
        "universal": "UniversalJoint",
        "euler xyz": "EulerJoint",
        "ball": "BallJoint",
        "translation": "TranslationalJoint",
        "planar": "PlanarJoint",
        "free": "FreeJoint",
        "free between links": "FreeJoint",
    },
    ways=WAYS
    | dart_frames.WAYS
    | dart_bound.WAYS
    | copies.of_model(WAYS, _COPIED)
    | dart_joints.WAYS
    | goals.DART
    | turning.WAYS
    | dart_features.WAYS,
    write=write,
    constraints=dart_bound.KINDS,
    formats=tuple(_READERS),
    write_reading=write_reading,
    demands={
        **features.DART,
        "goals": "InverseKinematics",
        "turns": "rotations and placements",
        "sensors": "SimpleFrame",
        "a bound pair": "WeldJointConstraint, BallJointConstraint",
        "dampers": "setDampingCoefficient",
        "springs": "setSpringStiffness",
        "changed mass": "setMass",
        "changed inertia": "setInertia",
        "changed frame": "setTransformFromParentBodyNode",
        "changed gravity": "setGravity",
    },
    # Its parsers return no skeleton, and write why to the log.
    refusals=("no skeleton: see the log", NO_SOLUTION),
    statements=(
        Statement(
            "precondition",
            "links without <inertial> have the loader's defaultInertia, by default of 1 kg and 1 kg m^2",
            "dart 6.20, dart/utils/urdf/DartLoader.hpp: Options::mDefaultInertia",
            holds=has_bare_link,
        ),
        UNIT_AXIS,
    ),
)
