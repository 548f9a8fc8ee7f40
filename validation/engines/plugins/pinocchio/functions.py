"""What Pinocchio offers of trees: its functions, those of constraints apart."""

from __future__ import annotations

from ...functions import ALIGNED
from ...truth.sensed import WRENCH
from ..writing import copies
from ..writing.source import HALF_TURNS, ways_of

FRAMES = {"local": "pin.LOCAL", "aligned": "pin.LOCAL_WORLD_ALIGNED", "world": "pin.WORLD"}
_FK = "pin.forwardKinematics(m, d, q, v, a)\npin.updateFramePlacements(m, d)\n"
_FK_D = "pin.computeForwardKinematicsDerivatives(m, d, q, v, a)\npin.updateFramePlacements(m, d)\n"
_CENTROIDAL = "value = pin.computeCentroidalDynamicsDerivatives(m, d, q, v, a)"

WAYS = ways_of(f"""
== sizes | nq, nv | value = [m.nq, m.nv]
== mass_matrix | crba | value = pin.crba(m, d, q)
== mass_matrix:crba WORLD | crba in WORLD | value = pin.crba(m, d, q, pin.Convention.WORLD)
== mass_matrix:computeRNEADerivatives | computeRNEADerivatives | value = pin.computeRNEADerivatives(m, d, q, v, a)[2]
== mass_matrix:computeAllTerms | computeAllTerms | pin.computeAllTerms(m, d, q, v)\nvalue = d.M
== mass_matrix_inverse | computeMinverse | value = pin.computeMinverse(m, d, q)
== mass_matrix_inverse:computeABADerivatives | computeABADerivatives
value = pin.computeABADerivatives(m, d, q, v, tau)[2]
== bias | nonLinearEffects | value = pin.nonLinearEffects(m, d, q, v)
== gravity | computeGeneralizedGravity | value = pin.computeGeneralizedGravity(m, d, q)
== coriolis_forces | computeCoriolisMatrix | value = pin.computeCoriolisMatrix(m, d, q, v) @ v
== coriolis_symmetry | computeCoriolisMatrix | C = pin.computeCoriolisMatrix(m, d, q, v)\nvalue = C + C.T
== inverse_dynamics | rnea | value = pin.rnea(m, d, q, v, a)
== joint_wrenches | rnea: f | js\npin.rnea(m, d, q, v, a)\nvalue = np.array([d.f[j].vector for j in js])
== forward_dynamics | aba | value = pin.aba(m, d, q, v, tau)
== forward_dynamics:aba LOCAL | aba in LOCAL | value = pin.aba(m, d, q, v, tau, pin.Convention.LOCAL)
== kinetic_energy | computeKineticEnergy | value = pin.computeKineticEnergy(m, d, q, v)
== potential_energy | computePotentialEnergy | value = pin.computePotentialEnergy(m, d, q)
== link_poses | framesForwardKinematics
pin.framesForwardKinematics(m, d, q)
value = np.array([np.r_[d.oMf[f].translation, d.oMf[f].rotation.ravel()] for f in fs])
== frame_jacobians | computeFrameJacobian
value = [pin.computeFrameJacobian(m, d, q, f, pin.LOCAL_WORLD_ALIGNED) for f in sensed]
== # What the reader has left out is nowhere.
== frame_poses | framesForwardKinematics
pin.framesForwardKinematics(m, d, q)
at = [d.oMf[f] if f < m.nframes else None for f in sensed]
value = [[*X.translation, *X.rotation.flat] if X else [np.nan] * 12 for X in at]
== applied_wrenches | rnea with external forces
given = [pin.Force.Zero() for _ in range(m.njoints)]
for f in sensed:
    frame = m.frames[f]
    joint = frame.parentJoint if hasattr(frame, 'parentJoint') else frame.parent
    given[joint] += frame.placement.act(pin.Force(np.array({list(WRENCH[:3])}), np.array({list(WRENCH[3:])})))
value = pin.rnea(m, d, q, 0 * v, 0 * v) - pin.rnea(m, d, q, 0 * v, 0 * v, pin.StdVec_Force(given))
== joint_dampings | damping | value = m.damping
== joint_speed_limits | velocityLimit, upperVelocityLimit
value = m.upperVelocityLimit if hasattr(m, 'upperVelocityLimit') else m.velocityLimit
== joint_force_limits | effortLimit, upperEffortLimit
value = m.upperEffortLimit if hasattr(m, 'upperEffortLimit') else m.effortLimit
== joint_limits | lowerPositionLimit, upperPositionLimit | value = np.c_[m.lowerPositionLimit, m.upperPositionLimit]
== joint_limits_of_some | lowerPositionLimit, upperPositionLimit
x, value = np.c_[m.lowerPositionLimit, m.upperPositionLimit], np.zeros((m.nv, 2))
for j in m.joints[1:]:
    if j.nq == j.nv:
        own = x[j.idx_q : j.idx_q + j.nq]
        value[j.idx_v : j.idx_v + j.nv] = np.where(np.abs(own) < 1e300, own, 0.0)
== joint_frictions | friction, upperDryFrictionLimit
value = m.friction if hasattr(m, 'friction') else m.upperDryFrictionLimit
== rotation_logarithm | log3 | value = pin.log3(pin.Quaternion(q).matrix())
== rotation_logarithm:quaternion | log3 | value = pin.log3(pin.Quaternion(q))
== rotation_half_turns | Quaternion of a matrix
{HALF_TURNS}value = [pin.Quaternion(H).matrix().ravel() for H in half_turns]
== rotation_exponential | exp3 | value = pin.exp3(v).ravel()
== rotation_composed | Quaternion | value = (pin.Quaternion(q) * pin.Quaternion(q2)).matrix().ravel()
== rotation_angle | angularDistance | value = [pin.Quaternion(q).angularDistance(pin.Quaternion(q2))]
== rotation_vector_speeds | Jexp3 | value = pin.Jexp3(tau)
== rotation_vector_rates | Jlog3 | value = pin.Jlog3(pin.exp3(tau))
== rpy_rates | rpy.computeRpyJacobianInverse
from pinocchio import rpy
value = rpy.computeRpyJacobianInverse(v, pin.LOCAL_WORLD_ALIGNED)
== rotation_halfway | slerp | value = pin.Quaternion(q).slerp(0.25, pin.Quaternion(q2)).matrix().ravel()
== twist_transform | SE3.action | value = pin.SE3(pin.Quaternion(q).matrix(), a).action
== mass_centre | centerOfMass | value = pin.centerOfMass(m, d, q)
== mass_centre_jacobian | jacobianCenterOfMass | value = pin.jacobianCenterOfMass(m, d, q)
== mass_centre_velocity_dq | getCenterOfMassVelocityDerivatives
pin.computeAllTerms(m, d, q, v)
value = pin.getCenterOfMassVelocityDerivatives(m, d)
== link_accelerations | getFrameClassicalAcceleration
{_FK}value = np.array([pin.getFrameClassicalAcceleration(m, d, f, pin.LOCAL_WORLD_ALIGNED).vector for f in fs])
== centroidal_matrix | ccrba | value = pin.ccrba(m, d, q, v)
== centroidal_matrix_rate | dccrba | value = pin.dccrba(m, d, q, v)
== centroidal_momentum | computeCentroidalMomentum | value = pin.computeCentroidalMomentum(m, d, q, v).vector
== centroidal_momentum_rate | computeCentroidalMomentumTimeVariation
value = pin.computeCentroidalMomentumTimeVariation(m, d, q, v, a).vector
== centroidal_momentum_dq | computeCentroidalDynamicsDerivatives | {_CENTROIDAL}[0]
== centroidal_momentum_rate_dq | computeCentroidalDynamicsDerivatives | {_CENTROIDAL}[1]
== centroidal_momentum_rate_dv | computeCentroidalDynamicsDerivatives | {_CENTROIDAL}[2]
== centroidal_matrix:computeCentroidalDynamicsDerivatives | computeCentroidalDynamicsDerivatives | {_CENTROIDAL}[3]
== inverse_dynamics_dq | computeRNEADerivatives | value = pin.computeRNEADerivatives(m, d, q, v, a)[0]
== inverse_dynamics_dv | computeRNEADerivatives | value = pin.computeRNEADerivatives(m, d, q, v, a)[1]
== gravity_dq | computeGeneralizedGravityDerivatives | value = pin.computeGeneralizedGravityDerivatives(m, d, q)
== forward_dynamics_dq | computeABADerivatives | value = pin.computeABADerivatives(m, d, q, v, tau)[0]
== forward_dynamics_dv | computeABADerivatives | value = pin.computeABADerivatives(m, d, q, v, tau)[1]
== torque_regressor | computeJointTorqueRegressor | js\nvalue = pin.computeJointTorqueRegressor(m, d, q, v, a)
== kinetic_energy_regressor | computeKineticEnergyRegressor | js\nvalue = pin.computeKineticEnergyRegressor(m, d, q, v)
== potential_energy_regressor | computePotentialEnergyRegressor
js
value = pin.computePotentialEnergyRegressor(m, d, q)
== integrate | integrate | value = pin.integrate(m, q, v2)
== interpolate | interpolate | value = pin.interpolate(m, q, pin.integrate(m, q, v2), 0.25)
== difference | difference | value = pin.difference(m, q, pin.integrate(m, q, v2))
== integrate_dq | dIntegrate | value = pin.dIntegrate(m, q, v2, pin.ARG0)
== integrate_dv | dIntegrate | value = pin.dIntegrate(m, q, v2, pin.ARG1)
== difference_dq | dDifference | value = pin.dDifference(m, q, pin.integrate(m, q, v2), pin.ARG0)
== difference_dq2 | dDifference | value = pin.dDifference(m, q, pin.integrate(m, q, v2), pin.ARG1)
""")
for _frame, _rf in FRAMES.items():
    _names = ALIGNED if _frame == "aligned" else (f"jacobian_{_frame}", f"jacobian_rate_{_frame}", f"velocity_{_frame}")
    WAYS |= ways_of(f"""
== {_names[0]} | getFrameJacobian
pin.computeJointJacobians(m, d, q)
pin.updateFramePlacements(m, d)
value = np.array([pin.getFrameJacobian(m, d, f, {_rf}) for f in fs])
== {_names[1]} | getFrameJacobianTimeVariation
pin.computeJointJacobiansTimeVariation(m, d, q, v)
pin.updateFramePlacements(m, d)
value = np.array([pin.getFrameJacobianTimeVariation(m, d, f, {_rf}) for f in fs])
== jacobian_dq_{_frame} | getJointKinematicHessian
pin.computeJointJacobians(m, d, q)
pin.computeJointKinematicHessians(m, d)
value = np.array([pin.getJointKinematicHessian(m, d, j, {_rf}) for j in js])
== {_names[2]} | getFrameVelocity | {_FK}value = np.array([pin.getFrameVelocity(m, d, f, {_rf}).vector for f in fs])
== acceleration_{_frame} | getFrameAcceleration
{_FK}value = np.array([pin.getFrameAcceleration(m, d, f, {_rf}).vector for f in fs])
== velocity_dq_{_frame} | getFrameVelocityDerivatives
{_FK_D}value = np.array([pin.getFrameVelocityDerivatives(m, d, f, {_rf})[0] for f in fs])
== acceleration_dq_{_frame} | getFrameAccelerationDerivatives
{_FK_D}value = np.array([pin.getFrameAccelerationDerivatives(m, d, f, {_rf})[1] for f in fs])
== acceleration_dv_{_frame} | getFrameAccelerationDerivatives
{_FK_D}value = np.array([pin.getFrameAccelerationDerivatives(m, d, f, {_rf})[2] for f in fs])
""")

_SENSED = f"{_FK}value = np.array([pin.getFrame{{}}(m, d, f, pin.LOCAL).{{}} for f in sensed])"
_THERE = f"{_FK}value = np.array([pin.getFrame{{}}(m, d, f, pin.LOCAL_WORLD_ALIGNED).vector for f in sensed])"
WAYS |= ways_of(f"""
== frame_poses_seen | SE3.actInv
{_FK}at = [d.oMf[sensed[0]].actInv(d.oMf[f]) for f in sensed]
value = [[*X.translation, *X.rotation.flat] for X in at]
== frame_velocities | getFrameVelocity | {_THERE.format("Velocity")}
== frame_accelerations | getFrameClassicalAcceleration | {_THERE.format("ClassicalAcceleration")}
== gyroscopes | getFrameVelocity | {_SENSED.format("Velocity", "angular")}
== velocimeters | getFrameVelocity | {_SENSED.format("Velocity", "linear")}
== accelerometers | getFrameClassicalAcceleration less gravity
{_SENSED.format("ClassicalAcceleration", "linear - d.oMf[f].rotation.T @ m.gravity.linear")}
""")

# Of joints whose frames are the links'.
_JOINTS = "js\nvalue = np.array([{of} for j in js])"
WAYS |= ways_of(f"""
== mass_centre_velocity | centerOfMass | pin.centerOfMass(m, d, q, v)\nvalue = d.vcom[0]
== mass_centre_acceleration | centerOfMass | pin.centerOfMass(m, d, q, v, a)\nvalue = d.acom[0]
== mass_centre:computeAllTerms | computeAllTerms | pin.computeAllTerms(m, d, q, v)\nvalue = d.com[0]
== mass_centre_jacobian:computeAllTerms | computeAllTerms | pin.computeAllTerms(m, d, q, v)\nvalue = d.Jcom
== subtree_masses | computeSubtreeMasses | pin.computeSubtreeMasses(m, d)\n{_JOINTS.format(of="d.mass[j]")}
== subtree_centres | centerOfMass | pin.centerOfMass(m, d, q)\n{_JOINTS.format(of="d.oMi[j].act(d.com[j])")}
== subtree_centre_jacobians | jacobianSubtreeCenterOfMass
{_JOINTS.format(of="pin.jacobianSubtreeCenterOfMass(m, d, q, j)")}
== subtree_centre_jacobians:getJacobianSubtreeCenterOfMass | getJacobianSubtreeCenterOfMass
pin.jacobianCenterOfMass(m, d, q)
{_JOINTS.format(of="pin.getJacobianSubtreeCenterOfMass(m, d, j)")}
== carried_inertias | crba: Ycrb | pin.crba(m, d, q, pin.Convention.LOCAL)\n{_JOINTS.format(of="d.Ycrb[j].matrix()")}
== link_regressors | jointBodyRegressor
pin.rnea(m, d, q, v, a)
{_JOINTS.format(of="pin.jointBodyRegressor(m, d, j)")}
== static_regressor | computeStaticRegressor | js\nvalue = pin.computeStaticRegressor(m, d, q)
== mechanical_energy | computeMechanicalEnergy | value = pin.computeMechanicalEnergy(m, d, q, v)
== coordinate_rates | tangentMap | value = pin.tangentMap(m, q) @ v
== coordinate_rates:tangentMapProduct | tangentMapProduct
value = pin.tangentMapProduct(m, q, v.reshape(-1, 1)).ravel()
== squared_distance | squaredDistance | value = [np.sum(pin.squaredDistance(m, q, pin.integrate(m, q, v2)))]
== squared_distance:distance | distance | value = [pin.distance(m, q, pin.integrate(m, q, v2)) ** 2]
== mass_matrix_inverse:cholesky | cholesky.computeMinv
pin.crba(m, d, q, pin.Convention.WORLD)
pin.cholesky.decompose(m, d)
value = pin.cholesky.computeMinv(m, d)
== forward_dynamics:cholesky | cholesky.solve
pin.crba(m, d, q, pin.Convention.WORLD)
pin.cholesky.decompose(m, d)
value = pin.cholesky.solve(m, d, tau - pin.nonLinearEffects(m, d, q, v))
== centroidal_matrix:computeCentroidalMap | computeCentroidalMap | value = pin.computeCentroidalMap(m, d, q)
== centroidal_matrix_rate:computeCentroidalMapTimeVariation | computeCentroidalMapTimeVariation
value = pin.computeCentroidalMapTimeVariation(m, d, q, v)
== applied_wrenches:computeStaticTorque | computeStaticTorque
{WAYS["applied_wrenches"].code[: WAYS["applied_wrenches"].code.index("value =")]}value = \
pin.computeGeneralizedGravity(m, d, q) - pin.computeStaticTorque(m, d, q, pin.StdVec_Force(given))
""")
for _frame, _rf in FRAMES.items():
    _own = ALIGNED[0] if _frame == "aligned" else f"jacobian_{_frame}"
    _derived = f"{_FK_D}value = np.array([pin.getFrame{{}}Derivatives(m, d, f, {_rf})[{{}}] for f in fs])"
    WAYS |= ways_of(f"""
== {_own}:getFrameVelocityDerivatives | getFrameVelocityDerivatives | {_derived.format("Velocity", 1)}
== {_own}:getFrameAccelerationDerivatives | getFrameAccelerationDerivatives | {_derived.format("Acceleration", 3)}
""")

_DATA = "d = m.createData()\n"
_FILED = (
    "from tempfile import TemporaryDirectory\nn = pin.Model()\n"
    "with TemporaryDirectory() as folder:\n    m.saveTo{0}(folder + '/model'{1})\n"
    "    n.loadFrom{0}(folder + '/model'{1})\nm = n\n"
)
# Of the geometry that is made along with it nothing is asked here.
_SHAPED = (
    "import coal\ng = pin.GeometryModel()\n"
    "g.addGeometryObject(pin.GeometryObject('ball', 0, 0, pin.SE3.Identity(), coal.Sphere(0.25)))\n"
)
_MADE = {
    "copied": f"m = pin.Model(m)\n{_DATA}",
    "copy": f"m = m.copy()\n{_DATA}",
    "pickle": f"import pickle\nm = pickle.loads(pickle.dumps(m))\n{_DATA}",
    "saveToXML": _FILED.format("XML", ", 'model'") + _DATA,
    "saveToText": _FILED.format("Text", "") + _DATA,
    "saveToBinary": _FILED.format("Binary", "") + _DATA,
    "StreamBuffer": (
        "kept, n = pin.serialization.StreamBuffer(), pin.Model()\nm.saveToBinary(kept)\nn.loadFromBinary(kept)\n"
        f"m = n\n{_DATA}"
    ),
    "buildReducedModel with geometry": (f"{_SHAPED}m, g = pin.buildReducedModel(m, g, [], pin.neutral(m))\n{_DATA}"),
    "appendModel to nothing": (
        f"n = pin.Model()\nn.gravity = m.gravity\nm = pin.appendModel(n, m, 0, pin.SE3.Identity())\n{_DATA}"
    ),
    "appendModel with geometry": (
        f"{_SHAPED}m, g = pin.appendModel(m, pin.Model(), g, pin.GeometryModel(), 0, pin.SE3.Identity())\n{_DATA}"
    ),
    "saveToString": f"n = pin.Model()\nn.loadFromString(m.saveToString())\nm = n\n{_DATA}",
    "buildReducedModel": f"m = pin.buildReducedModel(m, [], pin.neutral(m))\n{_DATA}",
}
_PLAIN = ("copied", "saveToString", "buildReducedModel")
WAYS |= copies.of_model(WAYS, {name: _MADE[name] for name in _PLAIN})
# What may keep other numbers of joints and frames: links are asked by their masses and by what forces make.
WAYS |= copies.of_model(
    WAYS,
    {name: made for name, made in _MADE.items() if name not in _PLAIN},
    ("mass_matrix", "bias", "forward_dynamics"),
)
