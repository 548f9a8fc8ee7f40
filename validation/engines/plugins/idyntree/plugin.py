"""iDynTree: floating-base dynamics, from URDF."""

from __future__ import annotations

from functools import partial

from ...interface import Convention, Tree, Unsupported
from ...truth.sensed import WRENCH
from .. import turns
from ..turns import idyntree as turning
from ..writing.source import Source, SourcePlugin, Way, ways_of
from ..writing.urdf import KINDS, UNIT_AXIS, Described, base, of_files, slots_of, through_reader
from . import further

_SETUP = """import numpy as np
import idyntree.bindings as iDynTree
loader = iDynTree.ModelLoader()
options = loader.parsingOptions()
options.addSensorFramesAsAdditionalFrames = {frames}
loader.setParsingOptions(options)
if not loader.loadReducedModelFromString({text!r}, {joints}): raise ValueError('no model: see the log')
robot = iDynTree.KinDynComputations()
assert robot.loadRobotModel(loader.model())
robot.setFrameVelocityRepresentation(iDynTree.MIXED_REPRESENTATION)
assert robot.setFloatingBase("{root}"), "the reader has dropped the link {root}\""""
_FLOATING_STATE = (
    "def state(q, v, robot):",
    "    x, y, z, w = q[3:7]",
    "    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])",
    "    pose = np.eye(4)",
    "    pose[:3, 3], pose[:3, :3] = q[:3], np.eye(3) + 2 * w * K + 2 * K @ K",
    "    robot.setRobotState(pose, q[7:], v[:6], v[6:], {gravity})",
)
# The base is always there: where it stands still, its rows and columns are left out.
_FIXED = {
    "state(q, v)": "robot.setRobotState(np.eye(4), q, np.zeros(6), v, {gravity})",
    "*rates(a)": "iDynTree.Vector6.FromPython(np.zeros(6)), iDynTree.VectorDynSize.FromPython(a)",
    "rates(a)": "(iDynTree.Vector6.FromPython(np.zeros(6)), iDynTree.VectorDynSize.FromPython(a))",
    "cut": "6",
}
_FLOATING = {
    "state(q, v)": "state(q, v, robot)",
    "*rates(a)": "iDynTree.Vector6.FromPython(a[:6]), iDynTree.VectorDynSize.FromPython(a[6:])",
    "rates(a)": "(iDynTree.Vector6.FromPython(a[:6]), iDynTree.VectorDynSize.FromPython(a[6:]))",
    "[cut:, cut:]": "",
    "[:, cut:]": "",
    "[cut:]": "",
}

WAYS = ways_of("""
== mass_matrix | getFreeFloatingMassMatrix
state(q, v)
M = iDynTree.MatrixDynSize()
assert robot.getFreeFloatingMassMatrix(M)
value = M.toNumPy()[cut:, cut:]
== joint_limits | getMinPosLimit, getMaxPosLimit
own = [robot.model().getJoint(k) for k in range(robot.model().getNrOfJoints())]
value = [[one.getMinPosLimit(0), one.getMaxPosLimit(0)] for one in own if one.getNrOfDOFs()]
== coriolis_forces | getCoriolisAndMassMatrices
state(q, v)
C, M, M_rate = (iDynTree.MatrixDynSize(n, n) for _ in range(3))
assert robot.getCoriolisAndMassMatrices(C, M, M_rate)
value = C.toNumPy()[cut:, cut:] @ v
== bias | generalizedBiasForces
state(q, v)
value = np.zeros(n)
assert robot.generalizedBiasForces(value)
value = value[cut:]
== gravity | generalizedGravityForces
state(q, v)
value = np.zeros(n)
assert robot.generalizedGravityForces(value)
value = value[cut:]
== inverse_dynamics | inverseDynamics
state(q, v)
none = iDynTree.LinkWrenches(robot.model())
none.zero()
forces = iDynTree.FreeFloatingGeneralizedTorques(robot.model())
assert robot.inverseDynamics(*rates(a), none, forces)
value = np.concatenate([forces.baseWrench().asVector().toNumPy(), forces.jointTorques().toNumPy()])[cut:]
== joint_wrenches | inverseDynamicsWithInternalJointForceTorques
state(q, v)
none = iDynTree.LinkWrenches(robot.model())
none.zero()
forces = iDynTree.FreeFloatingGeneralizedTorques(robot.model())
held = iDynTree.LinkWrenches(robot.model())
assert robot.inverseDynamicsWithInternalJointForceTorques(*rates(a), none, forces, held)
value = []
for name, j in zip(links, js):
    R = robot.getWorldTransform(name).asHomogeneousTransform().toNumPy()[:3, :3]
    value.append((held(j).asVector().toNumPy().reshape(2, 3) @ R).flatten())
== link_poses | getWorldTransform
state(q, v)
value = []
for name in links:
    H = robot.getWorldTransform(name).asHomogeneousTransform().toNumPy()
    value.append(np.concatenate([H[:3, 3], H[:3, :3].reshape(9)]))
== link_jacobians | getFrameFreeFloatingJacobian
state(q, v)
J, value = iDynTree.MatrixDynSize(6, n), []
for name in links:
    assert robot.getFrameFreeFloatingJacobian(name, J)
    value.append(J.toNumPy()[:, cut:].copy())
== link_velocities | getFrameVel
state(q, v)
value = [robot.getFrameVel(name).toNumPy() for name in links]
== link_accelerations | getFrameAcc
state(q, v)
value = [robot.getFrameAcc(name, *rates(a)).toNumPy() for name in links]
== link_velocity_products | getFrameBiasAcc
state(q, v)
value = [robot.getFrameBiasAcc(name).toNumPy() for name in links]
== mass_centre | getCenterOfMassPosition
state(q, v)
value = robot.getCenterOfMassPosition().toNumPy()
== mass_centre_jacobian | getCenterOfMassJacobian
state(q, v)
J = iDynTree.MatrixDynSize(3, n)
assert robot.getCenterOfMassJacobian(J)
value = J.toNumPy()[:, cut:]
== mass_centre_velocity_products | getCenterOfMassBiasAcc
state(q, v)
value = robot.getCenterOfMassBiasAcc().toNumPy()
== centroidal_momentum | getCentroidalTotalMomentum
state(q, v)
value = robot.getCentroidalTotalMomentum().asVector().toNumPy()
== centroidal_matrix | getCentroidalTotalMomentumJacobian
state(q, v)
J = iDynTree.MatrixDynSize(6, n)
assert robot.getCentroidalTotalMomentumJacobian(J)
value = J.toNumPy()[:, cut:]
""")
# Along each link's own axes: what is applied turns with it.
WAYS["applied_wrenches"] = Way(
    "addNewContactInFrame, inverseDynamics",
    f"""robot.setFrameVelocityRepresentation(iDynTree.BODY_FIXED_REPRESENTATION)
v, a = 0 * v, 0 * a
state(q, v)
contacts = iDynTree.LinkContactWrenches(robot.model())
for k in sensed:
    one = iDynTree.ContactWrench()
    for place, number in enumerate({list(WRENCH)}):
        one.contactWrench.setVal(place, number)
    assert contacts.addNewContactInFrame(robot.model(), robot.model().getFrameIndex(f'o{{k}}'), one)
given, forces = iDynTree.LinkWrenches(robot.model()), iDynTree.FreeFloatingGeneralizedTorques(robot.model())
def held(given):
    assert robot.inverseDynamics(*rates(a), given, forces)
    return np.concatenate([forces.baseWrench().asVector().toNumPy(), forces.jointTorques().toNumPy()])
given.zero()
value = held(given).copy()
assert contacts.computeNetWrenches(given)
value = (value - held(given)).copy()
R = robot.getWorldBaseTransform().getRotation().toNumPy()
value[:6] = (value[:6].reshape(2, 3) @ R.T).ravel()
value = value[cut:]
robot.setFrameVelocityRepresentation(iDynTree.MIXED_REPRESENTATION)""",
)
_STATE = "state(q, v)\n"
_MATRIX = "J = iDynTree.MatrixDynSize(6, n)\nassert robot.{}(J)\n"
# Momentum about the mass centre by the inertia of all links as one body there, and by what velocity that has.
_LOCKED = "I = robot.getCentroidalRobotLockedInertia().asMatrix().toNumPy()\n"
WAYS |= ways_of(f"""
== mass_centre_velocity | getCenterOfMassVelocity | {_STATE}value = robot.getCenterOfMassVelocity().toNumPy()
== centroidal_momentum:average velocity | getCentroidalRobotLockedInertia, getCentroidalAverageVelocity
{_STATE}{_LOCKED}value = I @ robot.getCentroidalAverageVelocity().asVector().toNumPy()
== centroidal_matrix:average velocity | getCentroidalRobotLockedInertia, getCentroidalAverageVelocityJacobian
{_STATE}{_LOCKED}{_MATRIX.format("getCentroidalAverageVelocityJacobian")}value = I @ J.toNumPy()[:, cut:]
== relative_poses | getRelativeTransform
{_STATE}value = []
for name in links:
    H = robot.getRelativeTransform(links[0], name).asHomogeneousTransform().toNumPy()
    value.append(np.concatenate([H[:3, 3], H[:3, :3].reshape(9)]))
== torque_regressor | inverseDynamicsInertialParametersRegressor
{_STATE}Y = iDynTree.MatrixDynSize(n, 10 * robot.getNrOfLinks())
assert robot.inverseDynamicsInertialParametersRegressor(*rates(a), Y)
own = [10 * j + k for j in js for k in {turning.PARAMETERS}]
value = Y.toNumPy()[:, own][cut:]
""")
_BASE = "free xyzw, linear and angular before"


def read(tree: Tree, described: Described, frames: bool = False) -> Source:
    """A file through iDynTree's reader of URDF; `frames`: with frames of sensors."""
    count, floating = len(described.moving), described.floating
    root = described.links[0] if floating else base(described.text)
    setup = _SETUP.format(text=described.text, joints=list(described.moving), root=root, frames=frames)
    gravity = f"np.array({list(tree.gravity)!r})"
    spelling = _FLOATING if floating else _FIXED
    optional = {
        "links": (f"links = {list(described.links)}",),
        "n": ("n = 6 + robot.getNrOfDegreesOfFreedom()",),
        "state": tuple(line.replace("{gravity}", gravity) for line in _FLOATING_STATE),
        "gravity": (f"gravity = {gravity}",),
        "joints": (f"joints = {list(described.moving)}",),
    }
    if tree.sensors:
        optional["sensed"] = (f"sensed = range({len(tree.sensors)})",)
    # Links that don't move are frames of others, and nothing holds a floating base.
    if all(joint.kind != "fixed" for link in tree.links for joint in link.joints):
        optional["ks"] = ("ks = [robot.model().getLinkIndex(name) for name in links]",)
        optional["ends"] = (f"ends = {[end.link for end in tree.sensors]}",)
        if not floating:
            optional["js"] = (f"js = [robot.model().getLinkIndex(name) for name in {list(described.links)}]",)
    return Source(
        tuple(setup.split("\n")),
        slots_of(tree, described, described.moving, _BASE),
        nq=count + 7 * floating,
        nv=count + 6 * floating,
        optional=optional,
        # Far from the world's origin moments about it, as doubles, do not have the digits of those about the base.
        lacks=("mass_matrix:world",) if any(tree.away) else (),
        spelling={general: own.replace("{gravity}", gravity) for general, own in spelling.items()},
    )


_build = through_reader(read)


def write(tree: Tree) -> Source | Unsupported:
    """The tree through iDynTree's reader of URDF."""
    return turns.source(*turning.IMPORTS) if tree.asked == "turns" else _build(tree)


def write_reading(tree: Tree, form: str, text: str) -> Source | Unsupported:
    """Text that has iDynTree read a file."""
    return of_files(partial(read, frames="frames of sensors" in form))(tree, form, text)


PLUGIN = SourcePlugin(
    name="idyntree",
    package="idyntree",
    extra="symofros[engine-idyntree]",
    conventions=(
        Convention("order of joints", "as asked for when the model is loaded"),
        Convention(
            "floating base", "always there: pose apart from q; linear and angular in the world (mixed representation)"
        ),
        Convention("spatial vectors", "linear, then angular"),
        Convention("internal wrenches", "at the link's origin along the world's axes, in the mixed representation"),
        Convention("armature", "not in the dynamics"),
        Convention("gravity", "an argument of the state"),
    ),
    kinds=KINDS | {"free": "floating base"},
    ways=WAYS | further.WAYS | further.again(WAYS) | turning.WAYS,
    write=write,
    formats=("urdf", "urdf with frames of sensors"),
    write_reading=write_reading,
    # Its reader returns no model, and writes why to the log.
    refusals=("no model: see the log",),
    demands={"sensors": "frames", "turns": "Rotation, Transform"},
    statements=(UNIT_AXIS,),
)
