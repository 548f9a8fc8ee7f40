"""What Pinocchio offers of trees: its functions, those of constraints apart."""

from __future__ import annotations

from ...functions import ALIGNED
from ...truth.sensed import WRENCH
from ..writing import copies
from ..writing.source import HALF_TURNS, Way

FRAMES = {"local": "pin.LOCAL", "aligned": "pin.LOCAL_WORLD_ALIGNED", "world": "pin.WORLD"}
_FK = "pin.forwardKinematics(m, d, q, v, a)\npin.updateFramePlacements(m, d)\n"
_FK_D = "pin.computeForwardKinematicsDerivatives(m, d, q, v, a)\npin.updateFramePlacements(m, d)\n"
_CENTROIDAL = "value = pin.computeCentroidalDynamicsDerivatives(m, d, q, v, a)"

WAYS = {
    "sizes": Way("nq, nv", "value = [m.nq, m.nv]"),
    "mass_matrix": Way("crba", "value = pin.crba(m, d, q)"),
    "mass_matrix:crba WORLD": Way("crba in WORLD", "value = pin.crba(m, d, q, pin.Convention.WORLD)"),
    "mass_matrix:computeRNEADerivatives": Way(
        "computeRNEADerivatives", "value = pin.computeRNEADerivatives(m, d, q, v, a)[2]"
    ),
    "mass_matrix:computeAllTerms": Way("computeAllTerms", "pin.computeAllTerms(m, d, q, v)\nvalue = d.M"),
    "mass_matrix_inverse": Way("computeMinverse", "value = pin.computeMinverse(m, d, q)"),
    "mass_matrix_inverse:computeABADerivatives": Way(
        "computeABADerivatives", "value = pin.computeABADerivatives(m, d, q, v, tau)[2]"
    ),
    "bias": Way("nonLinearEffects", "value = pin.nonLinearEffects(m, d, q, v)"),
    "gravity": Way("computeGeneralizedGravity", "value = pin.computeGeneralizedGravity(m, d, q)"),
    "coriolis_forces": Way("computeCoriolisMatrix", "value = pin.computeCoriolisMatrix(m, d, q, v) @ v"),
    "coriolis_symmetry": Way("computeCoriolisMatrix", "C = pin.computeCoriolisMatrix(m, d, q, v)\nvalue = C + C.T"),
    "inverse_dynamics": Way("rnea", "value = pin.rnea(m, d, q, v, a)"),
    "joint_wrenches": Way("rnea: f", "js\npin.rnea(m, d, q, v, a)\nvalue = np.array([d.f[j].vector for j in js])"),
    "forward_dynamics": Way("aba", "value = pin.aba(m, d, q, v, tau)"),
    "forward_dynamics:aba LOCAL": Way("aba in LOCAL", "value = pin.aba(m, d, q, v, tau, pin.Convention.LOCAL)"),
    "kinetic_energy": Way("computeKineticEnergy", "value = pin.computeKineticEnergy(m, d, q, v)"),
    "potential_energy": Way("computePotentialEnergy", "value = pin.computePotentialEnergy(m, d, q)"),
    "link_poses": Way(
        "framesForwardKinematics",
        "pin.framesForwardKinematics(m, d, q)\n"
        "value = np.array([np.r_[d.oMf[f].translation, d.oMf[f].rotation.ravel()] for f in fs])",
    ),
    "frame_jacobians": Way(
        "computeFrameJacobian",
        "value = [pin.computeFrameJacobian(m, d, q, f, pin.LOCAL_WORLD_ALIGNED) for f in sensed]",
    ),
    "frame_poses": Way(
        "framesForwardKinematics",
        "pin.framesForwardKinematics(m, d, q)\n"
        # What the reader has left out is nowhere.
        "at = [d.oMf[f] if f < m.nframes else None for f in sensed]\n"
        "value = [[*X.translation, *X.rotation.flat] if X else [np.nan] * 12 for X in at]",
    ),
    "applied_wrenches": Way(
        "rnea with external forces",
        f"""given = [pin.Force.Zero() for _ in range(m.njoints)]
for f in sensed:
    frame = m.frames[f]
    joint = frame.parentJoint if hasattr(frame, 'parentJoint') else frame.parent
    given[joint] += frame.placement.act(pin.Force(np.array({list(WRENCH[:3])}), np.array({list(WRENCH[3:])})))
value = pin.rnea(m, d, q, 0 * v, 0 * v) - pin.rnea(m, d, q, 0 * v, 0 * v, pin.StdVec_Force(given))""",
    ),
    "joint_dampings": Way("damping", "value = m.damping"),
    "joint_speed_limits": Way(
        "velocityLimit, upperVelocityLimit",
        "value = m.upperVelocityLimit if hasattr(m, 'upperVelocityLimit') else m.velocityLimit",
    ),
    "joint_force_limits": Way(
        "effortLimit, upperEffortLimit",
        "value = m.upperEffortLimit if hasattr(m, 'upperEffortLimit') else m.effortLimit",
    ),
    "joint_limits": Way(
        "lowerPositionLimit, upperPositionLimit", "value = np.c_[m.lowerPositionLimit, m.upperPositionLimit]"
    ),
    "joint_limits_of_some": Way(
        "lowerPositionLimit, upperPositionLimit",
        """x, value = np.c_[m.lowerPositionLimit, m.upperPositionLimit], np.zeros((m.nv, 2))
for j in m.joints[1:]:
    if j.nq == j.nv:
        own = x[j.idx_q : j.idx_q + j.nq]
        value[j.idx_v : j.idx_v + j.nv] = np.where(np.abs(own) < 1e300, own, 0.0)""",
    ),
    "joint_frictions": Way(
        "friction, upperDryFrictionLimit", "value = m.friction if hasattr(m, 'friction') else m.upperDryFrictionLimit"
    ),
    "rotation_logarithm": Way("log3", "value = pin.log3(pin.Quaternion(q).matrix())"),
    "rotation_logarithm:quaternion": Way("log3", "value = pin.log3(pin.Quaternion(q))"),
    "rotation_half_turns": Way(
        "Quaternion of a matrix", f"{HALF_TURNS}value = [pin.Quaternion(H).matrix().ravel() for H in half_turns]"
    ),
    "rotation_exponential": Way("exp3", "value = pin.exp3(v).ravel()"),
    "rotation_composed": Way("Quaternion", "value = (pin.Quaternion(q) * pin.Quaternion(q2)).matrix().ravel()"),
    "rotation_angle": Way("angularDistance", "value = [pin.Quaternion(q).angularDistance(pin.Quaternion(q2))]"),
    "rotation_vector_speeds": Way("Jexp3", "value = pin.Jexp3(tau)"),
    "rotation_vector_rates": Way("Jlog3", "value = pin.Jlog3(pin.exp3(tau))"),
    "rpy_rates": Way(
        "rpy.computeRpyJacobianInverse",
        "from pinocchio import rpy\nvalue = rpy.computeRpyJacobianInverse(v, pin.LOCAL_WORLD_ALIGNED)",
    ),
    "rotation_halfway": Way("slerp", "value = pin.Quaternion(q).slerp(0.25, pin.Quaternion(q2)).matrix().ravel()"),
    "twist_transform": Way("SE3.action", "value = pin.SE3(pin.Quaternion(q).matrix(), a).action"),
    "mass_centre": Way("centerOfMass", "value = pin.centerOfMass(m, d, q)"),
    "mass_centre_jacobian": Way("jacobianCenterOfMass", "value = pin.jacobianCenterOfMass(m, d, q)"),
    "mass_centre_velocity_dq": Way(
        "getCenterOfMassVelocityDerivatives",
        "pin.computeAllTerms(m, d, q, v)\nvalue = pin.getCenterOfMassVelocityDerivatives(m, d)",
    ),
    "link_accelerations": Way(
        "getFrameClassicalAcceleration",
        f"{_FK}value = np.array("
        "[pin.getFrameClassicalAcceleration(m, d, f, pin.LOCAL_WORLD_ALIGNED).vector for f in fs])",
    ),
    "centroidal_matrix": Way("ccrba", "value = pin.ccrba(m, d, q, v)"),
    "centroidal_matrix_rate": Way("dccrba", "value = pin.dccrba(m, d, q, v)"),
    "centroidal_momentum": Way("computeCentroidalMomentum", "value = pin.computeCentroidalMomentum(m, d, q, v).vector"),
    "centroidal_momentum_rate": Way(
        "computeCentroidalMomentumTimeVariation",
        "value = pin.computeCentroidalMomentumTimeVariation(m, d, q, v, a).vector",
    ),
    "centroidal_momentum_dq": Way("computeCentroidalDynamicsDerivatives", f"{_CENTROIDAL}[0]"),
    "centroidal_momentum_rate_dq": Way("computeCentroidalDynamicsDerivatives", f"{_CENTROIDAL}[1]"),
    "centroidal_momentum_rate_dv": Way("computeCentroidalDynamicsDerivatives", f"{_CENTROIDAL}[2]"),
    "centroidal_matrix:computeCentroidalDynamicsDerivatives": Way(
        "computeCentroidalDynamicsDerivatives", f"{_CENTROIDAL}[3]"
    ),
    "inverse_dynamics_dq": Way("computeRNEADerivatives", "value = pin.computeRNEADerivatives(m, d, q, v, a)[0]"),
    "inverse_dynamics_dv": Way("computeRNEADerivatives", "value = pin.computeRNEADerivatives(m, d, q, v, a)[1]"),
    "gravity_dq": Way(
        "computeGeneralizedGravityDerivatives", "value = pin.computeGeneralizedGravityDerivatives(m, d, q)"
    ),
    "forward_dynamics_dq": Way("computeABADerivatives", "value = pin.computeABADerivatives(m, d, q, v, tau)[0]"),
    "forward_dynamics_dv": Way("computeABADerivatives", "value = pin.computeABADerivatives(m, d, q, v, tau)[1]"),
    "torque_regressor": Way(
        "computeJointTorqueRegressor", "js\nvalue = pin.computeJointTorqueRegressor(m, d, q, v, a)"
    ),
    "kinetic_energy_regressor": Way(
        "computeKineticEnergyRegressor", "js\nvalue = pin.computeKineticEnergyRegressor(m, d, q, v)"
    ),
    "potential_energy_regressor": Way(
        "computePotentialEnergyRegressor", "js\nvalue = pin.computePotentialEnergyRegressor(m, d, q)"
    ),
    "integrate": Way("integrate", "value = pin.integrate(m, q, v2)"),
    "interpolate": Way("interpolate", "value = pin.interpolate(m, q, pin.integrate(m, q, v2), 0.25)"),
    "difference": Way("difference", "value = pin.difference(m, q, pin.integrate(m, q, v2))"),
    "integrate_dq": Way("dIntegrate", "value = pin.dIntegrate(m, q, v2, pin.ARG0)"),
    "integrate_dv": Way("dIntegrate", "value = pin.dIntegrate(m, q, v2, pin.ARG1)"),
    "difference_dq": Way("dDifference", "value = pin.dDifference(m, q, pin.integrate(m, q, v2), pin.ARG0)"),
    "difference_dq2": Way("dDifference", "value = pin.dDifference(m, q, pin.integrate(m, q, v2), pin.ARG1)"),
}
for _frame, _rf in FRAMES.items():
    _names = ALIGNED if _frame == "aligned" else (f"jacobian_{_frame}", f"jacobian_rate_{_frame}", f"velocity_{_frame}")
    WAYS |= {
        _names[0]: Way(
            "getFrameJacobian",
            "pin.computeJointJacobians(m, d, q)\npin.updateFramePlacements(m, d)\n"
            f"value = np.array([pin.getFrameJacobian(m, d, f, {_rf}) for f in fs])",
        ),
        _names[1]: Way(
            "getFrameJacobianTimeVariation",
            "pin.computeJointJacobiansTimeVariation(m, d, q, v)\npin.updateFramePlacements(m, d)\n"
            f"value = np.array([pin.getFrameJacobianTimeVariation(m, d, f, {_rf}) for f in fs])",
        ),
        f"jacobian_dq_{_frame}": Way(
            "getJointKinematicHessian",
            "pin.computeJointJacobians(m, d, q)\npin.computeJointKinematicHessians(m, d)\n"
            f"value = np.array([pin.getJointKinematicHessian(m, d, j, {_rf}) for j in js])",
        ),
        _names[2]: Way(
            "getFrameVelocity", f"{_FK}value = np.array([pin.getFrameVelocity(m, d, f, {_rf}).vector for f in fs])"
        ),
        f"acceleration_{_frame}": Way(
            "getFrameAcceleration",
            f"{_FK}value = np.array([pin.getFrameAcceleration(m, d, f, {_rf}).vector for f in fs])",
        ),
        f"velocity_dq_{_frame}": Way(
            "getFrameVelocityDerivatives",
            f"{_FK_D}value = np.array([pin.getFrameVelocityDerivatives(m, d, f, {_rf})[0] for f in fs])",
        ),
        f"acceleration_dq_{_frame}": Way(
            "getFrameAccelerationDerivatives",
            f"{_FK_D}value = np.array([pin.getFrameAccelerationDerivatives(m, d, f, {_rf})[1] for f in fs])",
        ),
        f"acceleration_dv_{_frame}": Way(
            "getFrameAccelerationDerivatives",
            f"{_FK_D}value = np.array([pin.getFrameAccelerationDerivatives(m, d, f, {_rf})[2] for f in fs])",
        ),
    }

_SENSED = f"{_FK}value = np.array([pin.getFrame{{}}(m, d, f, pin.LOCAL).{{}} for f in sensed])"
_THERE = f"{_FK}value = np.array([pin.getFrame{{}}(m, d, f, pin.LOCAL_WORLD_ALIGNED).vector for f in sensed])"
WAYS |= {
    "frame_poses_seen": Way(
        "SE3.actInv",
        f"{_FK}at = [d.oMf[sensed[0]].actInv(d.oMf[f]) for f in sensed]\n"
        "value = [[*X.translation, *X.rotation.flat] for X in at]",
    ),
    "frame_velocities": Way("getFrameVelocity", _THERE.format("Velocity")),
    "frame_accelerations": Way("getFrameClassicalAcceleration", _THERE.format("ClassicalAcceleration")),
    "gyroscopes": Way("getFrameVelocity", _SENSED.format("Velocity", "angular")),
    "velocimeters": Way("getFrameVelocity", _SENSED.format("Velocity", "linear")),
    "accelerometers": Way(
        "getFrameClassicalAcceleration less gravity",
        _SENSED.format("ClassicalAcceleration", "linear - d.oMf[f].rotation.T @ m.gravity.linear"),
    ),
}

# Of joints whose frames are the links'.
_JOINTS = "js\nvalue = np.array([{of} for j in js])"
WAYS |= {
    "mass_centre_velocity": Way("centerOfMass", "pin.centerOfMass(m, d, q, v)\nvalue = d.vcom[0]"),
    "mass_centre_acceleration": Way("centerOfMass", "pin.centerOfMass(m, d, q, v, a)\nvalue = d.acom[0]"),
    "mass_centre:computeAllTerms": Way("computeAllTerms", "pin.computeAllTerms(m, d, q, v)\nvalue = d.com[0]"),
    "mass_centre_jacobian:computeAllTerms": Way("computeAllTerms", "pin.computeAllTerms(m, d, q, v)\nvalue = d.Jcom"),
    "subtree_masses": Way("computeSubtreeMasses", f"pin.computeSubtreeMasses(m, d)\n{_JOINTS.format(of='d.mass[j]')}"),
    "subtree_centres": Way(
        "centerOfMass",
        f"pin.centerOfMass(m, d, q)\n{_JOINTS.format(of='d.oMi[j].act(d.com[j])')}",
    ),
    "subtree_centre_jacobians": Way(
        "jacobianSubtreeCenterOfMass", _JOINTS.format(of="pin.jacobianSubtreeCenterOfMass(m, d, q, j)")
    ),
    "subtree_centre_jacobians:getJacobianSubtreeCenterOfMass": Way(
        "getJacobianSubtreeCenterOfMass",
        f"pin.jacobianCenterOfMass(m, d, q)\n{_JOINTS.format(of='pin.getJacobianSubtreeCenterOfMass(m, d, j)')}",
    ),
    "carried_inertias": Way(
        "crba: Ycrb", f"pin.crba(m, d, q, pin.Convention.LOCAL)\n{_JOINTS.format(of='d.Ycrb[j].matrix()')}"
    ),
    "link_regressors": Way(
        "jointBodyRegressor",
        f"pin.rnea(m, d, q, v, a)\n{_JOINTS.format(of='pin.jointBodyRegressor(m, d, j)')}",
    ),
    "static_regressor": Way("computeStaticRegressor", "js\nvalue = pin.computeStaticRegressor(m, d, q)"),
    "mechanical_energy": Way("computeMechanicalEnergy", "value = pin.computeMechanicalEnergy(m, d, q, v)"),
    "coordinate_rates": Way("tangentMap", "value = pin.tangentMap(m, q) @ v"),
    "coordinate_rates:tangentMapProduct": Way(
        "tangentMapProduct", "value = pin.tangentMapProduct(m, q, v.reshape(-1, 1)).ravel()"
    ),
    "squared_distance": Way("squaredDistance", "value = [np.sum(pin.squaredDistance(m, q, pin.integrate(m, q, v2)))]"),
    "squared_distance:distance": Way("distance", "value = [pin.distance(m, q, pin.integrate(m, q, v2)) ** 2]"),
    "mass_matrix_inverse:cholesky": Way(
        "cholesky.computeMinv",
        "pin.crba(m, d, q, pin.Convention.WORLD)\npin.cholesky.decompose(m, d)\nvalue = pin.cholesky.computeMinv(m, d)",
    ),
    "forward_dynamics:cholesky": Way(
        "cholesky.solve",
        "pin.crba(m, d, q, pin.Convention.WORLD)\npin.cholesky.decompose(m, d)\n"
        "value = pin.cholesky.solve(m, d, tau - pin.nonLinearEffects(m, d, q, v))",
    ),
    "centroidal_matrix:computeCentroidalMap": Way("computeCentroidalMap", "value = pin.computeCentroidalMap(m, d, q)"),
    "centroidal_matrix_rate:computeCentroidalMapTimeVariation": Way(
        "computeCentroidalMapTimeVariation", "value = pin.computeCentroidalMapTimeVariation(m, d, q, v)"
    ),
    "applied_wrenches:computeStaticTorque": Way(
        "computeStaticTorque",
        WAYS["applied_wrenches"].code[: WAYS["applied_wrenches"].code.index("value =")]
        + "value = pin.computeGeneralizedGravity(m, d, q) - pin.computeStaticTorque(m, d, q, pin.StdVec_Force(given))",
    ),
}
for _frame, _rf in FRAMES.items():
    _own = ALIGNED[0] if _frame == "aligned" else f"jacobian_{_frame}"
    _derived = f"{_FK_D}value = np.array([pin.getFrame{{}}Derivatives(m, d, f, {_rf})[{{}}] for f in fs])"
    WAYS |= {
        f"{_own}:getFrameVelocityDerivatives": Way("getFrameVelocityDerivatives", _derived.format("Velocity", 1)),
        f"{_own}:getFrameAccelerationDerivatives": Way(
            "getFrameAccelerationDerivatives", _derived.format("Acceleration", 3)
        ),
    }

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
