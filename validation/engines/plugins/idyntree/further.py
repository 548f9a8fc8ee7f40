"""What iDynTree offers a second time: in other representations, by its algorithms, of models made of others."""

from __future__ import annotations

from collections.abc import Mapping

from ..writing import copies
from ..writing.source import Way, ways_of

_STATE = "state(q, v)\n"
# Of the base's speeds along the world's axes at its origin: those of a representation. Where it stands still it is cut.
_BODY = (
    "robot.setFrameVelocityRepresentation(iDynTree.BODY_FIXED_REPRESENTATION)\n"
    "H = robot.getWorldBaseTransform().asHomogeneousTransform().toNumPy()\n"
    "R, T = H[:3, :3], np.eye(n)\nT[:3, :3] = T[3:6, 3:6] = R.T\n"
)
_WORLD = (
    "robot.setFrameVelocityRepresentation(iDynTree.INERTIAL_FIXED_REPRESENTATION)\n"
    "H = robot.getWorldBaseTransform().asHomogeneousTransform().toNumPy()\n"
    "T = np.eye(n)\nT[:3, 3:6] = np.cross(np.eye(3), H[:3, 3])\n"
)
_BACK = "robot.setFrameVelocityRepresentation(iDynTree.MIXED_REPRESENTATION)\n"
_VELOCITIES = "value = [robot.getFrameVel(name).toNumPy() for name in links]\n"
_JACOBIANS = (
    "J, value = iDynTree.MatrixDynSize(6, n), []\nfor name in links:\n"
    "    assert robot.getFrameFreeFloatingJacobian(name, J)\n    value.append((J.toNumPy() @ T)[:, cut:])\n"
)
_MATRIX = (
    "M = iDynTree.MatrixDynSize(n, n)\nassert robot.getFreeFloatingMassMatrix(M)\n"
    "value = (T.T @ M.toNumPy() @ T)[cut:, cut:]\n"
)
_GRAVITY = "value = np.zeros(n)\nassert robot.generalizedGravityForces(value)\nvalue = (T.T @ value)[cut:]\n"


def _represented(name: str, before: str) -> dict[str, Way]:
    """Functions in a representation of frames' velocities."""
    rows = {
        f"velocity_{name}": ("getFrameVel", _VELOCITIES),
        f"jacobian_{name}": ("getFrameFreeFloatingJacobian", _JACOBIANS),
        f"mass_matrix:{name}": ("getFreeFloatingMassMatrix", _MATRIX),
        f"gravity:{name}": ("generalizedGravityForces", _GRAVITY),
    }
    if name == "local":
        rows["centroidal_momentum:body"] = (
            "getCentroidalTotalMomentum",
            "ks\nvalue = (robot.getCentroidalTotalMomentum().asVector().toNumPy().reshape(2, 3) @ R.T).ravel()\n",
        )
    return {way: Way(f"{native}, {name}", f"{_STATE}{before}{code}{_BACK}") for way, (native, code) in rows.items()}


# Where each link, and so the base, is one by itself and no frame of another (`ks`).
# Momentum and inertia of all links about the base's origin, along the world's axes, taken at the mass centre.
_AT_CENTRE = (
    "ks\nbase = robot.getWorldBaseTransform().asHomogeneousTransform().toNumPy()[:3, 3]\n"
    "arm = robot.getCenterOfMassPosition().toNumPy() - base\n"
    "S = np.cross(np.eye(3), arm)\nB = np.block([[np.eye(3), np.zeros((3, 3))], [-S, np.eye(3)]])\n"
)
_RELATIVE = (
    "value, J = [], iDynTree.MatrixDynSize(6, n - 6)\nfirst = robot.getFrameIndex(links[0])\nfor name in links:\n"
)
# What the algorithms take: model, order of links, base and joints; forces of the world on the base are cut.
_RAW = """state(q, v)
model, traversal = robot.model(), iDynTree.Traversal()
base = model.getLinkName(model.getFrameLink(model.getFrameIndex(robot.getFloatingBase())))
assert model.computeFullTreeTraversal(traversal, model.getLinkIndex(base))
H = robot.getWorldTransform(base)
R = H.asHomogeneousTransform().toNumPy()[:3, :3]
pos, vel, acc = iDynTree.FreeFloatingPos(model), iDynTree.FreeFloatingVel(model), iDynTree.FreeFloatingAcc(model)
pos.worldBasePos = H
robot.getJointPos(pos.jointPos), robot.getJointVel(vel.jointVel)
u, rate = robot.getFrameVel(base).toNumPy(), robot.getFrameAcc(base, *rates(a)).toNumPy()
u = np.r_[R.T @ u[:3], R.T @ u[3:]]
vel.baseVel = iDynTree.Twist.FromPython(u)
for k, one in enumerate(rates(a)[1].toNumPy()): acc.jointAcc.setVal(k, one)
acc.baseAcc = iDynTree.SpatialAcc.FromPython(np.r_[R.T @ rate[:3] - np.cross(u[3:], u[:3]), R.T @ rate[3:]])
at, moving, changing = iDynTree.LinkPositions(model), iDynTree.LinkVelArray(model), iDynTree.LinkAccArray(model)
assert iDynTree.ForwardPosVelAccKinematics(model, traversal, pos, vel, acc, at, moving, changing)
"""
_LINK_ACCELERATION = "changing(k).asVector().toNumPy()"
_SENSOR = """value = []
for end, frame in zip(ends, sensed):
    k = model.getLinkIndex(end)
    sensor = iDynTree.KIND()
    sensor.setName('s'), sensor.setParentLink(end), sensor.setParentLinkIndex(k)
    sensor.setLinkSensorTransform(robot.getRelativeTransform(end, f'o{frame}'))
    value.append(sensor.predictMeasurement(READING).toNumPy())
"""
# Accelerations less gravity's, along each link's axes.
_PROPER = """def proper(k):
    turned = at(k).getRotation().toNumPy().T @ gravity
    return iDynTree.SpatialAcc.FromPython(changing(k).asVector().toNumPy() - np.r_[turned, 0, 0, 0])
"""
_EXPORTED = """ks
from tempfile import TemporaryDirectory
exporter, given = iDynTree.ModelExporter(), iDynTree.ModelExporterOptions()
given.baseLink = robot.getFloatingBase()
assert exporter.init(robot.model(), given)
loader = iDynTree.ModelLoader()
with TemporaryDirectory() as folder:
    assert exporter.exportModelToFile(f'{folder}/model.urdf')
    assert loader.loadReducedModelFromFile(f'{folder}/model.urdf', joints)"""
_AGAIN = """
kept, robot = robot, iDynTree.KinDynComputations()
assert robot.loadRobotModel({})
robot.setFrameVelocityRepresentation(iDynTree.MIXED_REPRESENTATION)
assert robot.setFloatingBase(kept.getFloatingBase())"""
_MADE = {
    "ModelExporter": _EXPORTED + _AGAIN.format("loader.model()"),
    "updateInertialParameters": (
        "model, given = robot.model().copy(), iDynTree.VectorDynSize()\nassert model.getInertialParameters(given)\n"
        "assert model.updateInertialParameters(iDynTree.VectorDynSize.FromPython(2.0 * given.toNumPy()))\n"
        "assert model.updateInertialParameters(given)" + _AGAIN.format("model")
    ),
    "createReducedModel": (
        "model = iDynTree.Model()\nassert iDynTree.createReducedModel(robot.model(), joints, model)"
        + _AGAIN.format("model")
    ),
}


def again(first: Mapping[str, Way]) -> dict[str, Way]:
    """Functions of models that are made of the model that was read."""
    return copies.of_model(first, _MADE, ("mass_matrix", "bias", "link_poses", "link_velocities"))


WAYS = (
    _represented("local", _BODY)
    | _represented("world", _WORLD)
    | (
        ways_of(f"""
== shape_poses | collisionSolidShapes, getLink_H_geometry
{_STATE}value, shapes = [], robot.model().collisionSolidShapes().getLinkSolidShapes()
for name in links:
    at = robot.getWorldTransform(name)
    for shape in shapes[robot.model().getLinkIndex(name)]:
        H = (at * shape.getLink_H_geometry()).asHomogeneousTransform().toNumPy()
        value.append(np.concatenate([H[:3, 3], H[:3, :3].reshape(9)]))
== frames_beside_links | setParsingOptions, addSensorFramesAsAdditionalFrames, getNrOfFrames
value = [robot.model().getNrOfFrames() - robot.model().getNrOfLinks()]
== frame_poses | getWorldTransform
{_STATE}value = []
for k in sensed:
    H = robot.getWorldTransform(f'o{{k}}').asHomogeneousTransform().toNumPy()
    value.append(np.concatenate([H[:3, 3], H[:3, :3].reshape(9)]))
== frame_velocities | getFrameVel | {_STATE}value = [robot.getFrameVel(f'o{{k}}').toNumPy() for k in sensed]
== frame_accelerations | getFrameAcc
{_STATE}value = [robot.getFrameAcc(f'o{{k}}', *rates(a)).toNumPy() for k in sensed]
== frame_velocity_products | getFrameBiasAcc
{_STATE}value = [robot.getFrameBiasAcc(f'o{{k}}').toNumPy() for k in sensed]
== frame_jacobians | getFrameFreeFloatingJacobian
{_STATE}J, value = iDynTree.MatrixDynSize(6, n), []
for k in sensed:
    assert robot.getFrameFreeFloatingJacobian(f'o{{k}}', J)
    value.append(J.toNumPy()[:, cut:].copy())
""")
        | {
            **{
                name: Way(
                    native,
                    "own = [robot.model().getJoint(k) for k in range(robot.model().getNrOfJoints())]\n"
                    f"value = [one.{native}(0) for one in own if one.getNrOfDOFs()]",
                )
                for name, native in {
                    "joint_dampings": "getDamping",
                    "joint_frictions": "getStaticFriction",
                    "joint_speed_limits": "getVelocityLimit",
                    "joint_force_limits": "getEffortLimit",
                }.items()
            },
        }
        | ways_of(f"""
== total_mass | getTotalMass | value = [robot.model().getTotalMass()]
== link_poses:getWorldTransformsAsHomogeneous | getWorldTransformsAsHomogeneous
{_STATE}made = robot.getWorldTransformsAsHomogeneous(iDynTree.StringVector(links))
value = [np.r_[one.toNumPy()[:3, 3], one.toNumPy()[:3, :3].ravel()] for one in made]
== centroidal_inertia | getCentroidalRobotLockedInertia
{_STATE}value = robot.getCentroidalRobotLockedInertia().asMatrix().toNumPy()
== centroidal_inertia:getRobotLockedInertia | getRobotLockedInertia
{_STATE}{_AT_CENTRE}value = B @ robot.getRobotLockedInertia().asMatrix().toNumPy() @ B.T
== centroidal_momentum:getLinearAngularMomentum | getLinearAngularMomentum
{_STATE}{_AT_CENTRE}value = B @ robot.getLinearAngularMomentum().asVector().toNumPy()
== centroidal_matrix:getLinearAngularMomentumJacobian | getLinearAngularMomentumJacobian
{_STATE}{_AT_CENTRE}J = iDynTree.MatrixDynSize(6, n)
assert robot.getLinearAngularMomentumJacobian(J)
value = (B @ J.toNumPy())[:, cut:]
== centroidal_momentum:getAverageVelocity | getAverageVelocity, getRobotLockedInertia
{_STATE}{_AT_CENTRE}value = B @ robot.getRobotLockedInertia().asMatrix().toNumPy() @ \
robot.getAverageVelocity().asVector().toNumPy()
== centroidal_matrix:getAverageVelocityJacobian | getAverageVelocityJacobian, getRobotLockedInertia
{_STATE}{_AT_CENTRE}J = iDynTree.MatrixDynSize(6, n)
assert robot.getAverageVelocityJacobian(J)
value = (B @ robot.getRobotLockedInertia().asMatrix().toNumPy() @ J.toNumPy())[:, cut:]
== relative_jacobians | getRelativeJacobian
{_STATE}{_RELATIVE}    assert robot.getRelativeJacobian(first, robot.getFrameIndex(name), J)
    value.append(np.hstack([np.zeros((6, 6)), J.toNumPy()])[:, cut:])
== relative_poses:getRelativeTransformExplicit | getRelativeTransformExplicit
{_STATE}value = []
for name in links:
    i, j = map(robot.getFrameIndex, (links[0], name))
    H = robot.getRelativeTransformExplicit(i, i, j, j).asHomogeneousTransform().toNumPy()
    value.append(np.concatenate([H[:3, 3], H[:3, :3].reshape(9)]))
== mass_matrix:getCoriolisAndMassMatrices | getCoriolisAndMassMatrices
{_STATE}C, M, M_rate = (iDynTree.MatrixDynSize(n, n) for _ in range(3))
assert robot.getCoriolisAndMassMatrices(C, M, M_rate)
value = M.toNumPy()[cut:, cut:]
== coriolis_symmetry:rate of M | getCoriolisAndMassMatrices
{_STATE}C, M, M_rate = (iDynTree.MatrixDynSize(n, n) for _ in range(3))
assert robot.getCoriolisAndMassMatrices(C, M, M_rate)
value = M_rate.toNumPy()[cut:, cut:]
== coriolis_symmetry | getCoriolisAndMassMatrices
{_STATE}C, M, M_rate = (iDynTree.MatrixDynSize(n, n) for _ in range(3))
assert robot.getCoriolisAndMassMatrices(C, M, M_rate)
value = (C.toNumPy() + C.toNumPy().T)[cut:, cut:]
== link_poses:ForwardPosVelAccKinematics | ForwardPosVelAccKinematics
{_RAW}value = []
for k in ks:
    H = at(k).asHomogeneousTransform().toNumPy()
    value.append(np.concatenate([H[:3, 3], H[:3, :3].reshape(9)]))
== velocity_local:ForwardPosVelAccKinematics | ForwardPosVelAccKinematics
{_RAW}value = [moving(k).toNumPy() for k in ks]
== acceleration_local | ForwardPosVelAccKinematics | {_RAW}value = [{_LINK_ACCELERATION} for k in ks]
== mass_matrix:CompositeRigidBodyAlgorithm | CompositeRigidBodyAlgorithm
{_RAW}carried, M = iDynTree.LinkInertias(model), iDynTree.FreeFloatingMassMatrix(model)
assert iDynTree.CompositeRigidBodyAlgorithm(model, traversal, pos.jointPos, carried, M)
x = robot.getWorldBaseTransform().asHomogeneousTransform().toNumPy()[:3, 3]
T, arm = np.eye(n), H.asHomogeneousTransform().toNumPy()[:3, 3] - x
T[:3, :3], T[:3, 3:6], T[3:6, 3:6] = R.T, -R.T @ np.cross(np.eye(3), arm), R.T
value = (T.T @ M.toNumPy() @ T)[cut:, cut:]
== accelerometers | AccelerometerSensor.predictMeasurement
{_RAW}{_PROPER}{_SENSOR.replace("KIND", "AccelerometerSensor").replace("READING", "proper(k), moving(k)")}
== gyroscopes | GyroscopeSensor.predictMeasurement
{_RAW}{_SENSOR.replace("KIND", "GyroscopeSensor").replace("READING", "moving(k)")}
== angular_accelerations | ThreeAxisAngularAccelerometerSensor.predictMeasurement
{_RAW}{_SENSOR.replace("KIND", "ThreeAxisAngularAccelerometerSensor").replace("READING", "changing(k)")}value = \
[(robot.getWorldTransform(f'o{{frame}}').getRotation().toNumPy() @ one) for frame, one in zip(sensed, value)]
""")
    )
)
