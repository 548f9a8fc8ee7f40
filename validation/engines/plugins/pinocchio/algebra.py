"""What Pinocchio offers of spatial algebra beside placements: moments, parameters of inertias, groups, quaternions."""

from __future__ import annotations

from ...truth.geometry.poses import MOMENTS
from ..writing.source import Way
from .poses import EYE, FLAT, INERTIA, TWIST, TWO

_F = "F = pin.Force(a, tau)\n"
_S = f"S = pin.Symmetric3(np.array({[*map(list, MOMENTS)]}))\n"
_RPY = "from pinocchio import rpy\n"
_LOG = "x = np.r_[v, a, tau, v2[:1]]\nC = pin.LogCholeskyParameters(x / (1 + x * x))\n"
_R = "R = pin.Quaternion(q)\n"
_ANGLE = f"{_R}R = pin.AngleAxis(R.matrix())\n"
_SE3 = "G, x, y = pin.liegroups.SE3(), np.r_[a, q], np.r_[tau, q2]\n"
_SO3 = "G = pin.liegroups.SO3()\n"
_OF_X = "value = {of}.ravel()"

WAYS = {
    "wrench_cross": Way("Motion.dualAction", f"{TWIST}value = V.dualAction"),
    "wrench_cross:cross": Way("Motion.cross of forces", f"{TWIST}value = {EYE.format(of='V.cross(pin.Force(e))')}"),
    "twist_cross:^": Way("Motion ^ Motion", f"{TWIST}value = {EYE.format(of='(V ^ pin.Motion(e))')}"),
    "wrench_transform_back": Way("SE3.actInv of forces", f"{TWO}value = {EYE.format(of='X.actInv(pin.Force(e))')}"),
    "power": Way("Motion.dot", f"{TWIST}{_F}value = [V.dot(F)]"),
    "power:Force": Way("Force.dot", f"{TWIST}{_F}value = [F.dot(V)]"),
    "body_energy": Way("Inertia.vtiv", f"{INERTIA}{TWIST}value = [I.vtiv(V) / 2]"),
    "inertia_parameters": Way("Inertia.toDynamicParameters", f"{INERTIA}value = I.toDynamicParameters()"),
    "inertia_parameters:PseudoInertia": Way(
        "PseudoInertia.toDynamicParameters", f"{INERTIA}value = I.toPseudoInertia().toDynamicParameters()"
    ),
    "pseudo_inertia": Way("Inertia.toPseudoInertia", f"{INERTIA}value = I.toPseudoInertia().toMatrix()"),
    "pseudo_inertia:FromInertia": Way(
        "PseudoInertia.FromInertia",
        f"{INERTIA}P = pin.PseudoInertia.FromInertia(I)\n"
        "value = np.block([[P.sigma, P.h.reshape(3, 1)], [P.h.reshape(1, 3), np.array([[P.mass]])]])",
    ),
    "pseudo_inertia:FromDynamicParameters": Way(
        "PseudoInertia.FromDynamicParameters",
        f"{INERTIA}value = pin.PseudoInertia.FromDynamicParameters(I.toDynamicParameters()).toMatrix()",
    ),
    "spatial_inertia:PseudoInertia": Way(
        "PseudoInertia.FromMatrix, toInertia",
        f"{INERTIA}value = pin.PseudoInertia.FromMatrix(I.toPseudoInertia().toMatrix()).toInertia().matrix()",
    ),
    "spatial_inertia_sum:-": Way(
        "Inertia - Inertia",
        f"{TWO}{INERTIA}J = I.se3Action(X)\nvalue = ((I + J + I) - I).matrix()",
    ),
    "spatial_inertia_inverse": Way("Inertia.inverse", f"{INERTIA}value = I.inverse()"),
    "momentum_rate_regressor": Way("bodyRegressor", f"{TWIST}A = pin.Motion(a, tau)\nvalue = pin.bodyRegressor(V, A)"),
    "logarithmic_inertia": Way(
        "Inertia.FromLogCholeskyParameters", f"{_LOG}value = pin.Inertia.FromLogCholeskyParameters(C).matrix()"
    ),
    "logarithmic_inertia:toInertia": Way("LogCholeskyParameters.toInertia", f"{_LOG}value = C.toInertia().matrix()"),
    "logarithmic_inertia:toPseudoInertia": Way(
        "LogCholeskyParameters.toPseudoInertia", f"{_LOG}value = C.toPseudoInertia().toInertia().matrix()"
    ),
    "logarithmic_parameters": Way(
        "LogCholeskyParameters.toDynamicParameters", f"{_LOG}value = C.toDynamicParameters()"
    ),
    "logarithmic_derivatives": Way("LogCholeskyParameters.calculateJacobian", f"{_LOG}value = C.calculateJacobian()"),
    "moments_product": Way("Symmetric3 * vector", f"{_S}value = S * v"),
    "moments_along": Way("Symmetric3.vtiv", f"{_S}value = [S.vtiv(v)]"),
    "moments_rotated": Way("Symmetric3.rotate", f"{_R}{_S}value = S.rotate(R.matrix()).matrix()"),
    "cross_matrix": Way("skew", "value = pin.skew(v)"),
    "cross_matrix:unSkew": Way("unSkew", "value = np.cross(pin.unSkew(pin.skew(v)), np.eye(3)).T"),
    "cross_matrices": Way("skewSquare", "value = pin.skewSquare(v, a)"),
    "turned_vector": Way("Quaternion * vector", f"{_R}value = R * v"),
    "turned_vector:AngleAxis": Way("AngleAxis * vector", f"{_ANGLE}value = R * v"),
    "turned_vector:SE3": Way("SE3.act", f"{_R}value = pin.SE3(R, a).act(v) - a"),
    "rotation_inverse": Way("Quaternion.inverse", f"{_R}{_OF_X.format(of='R.inverse().matrix()')}"),
    "rotation_inverse:conjugate": Way("Quaternion.conjugate", f"{_R}{_OF_X.format(of='R.conjugate().matrix()')}"),
    "rotation_inverse:AngleAxis": Way("AngleAxis.inverse", f"{_ANGLE}{_OF_X.format(of='R.inverse().matrix()')}"),
    "rotation_matrix:normalized": Way(
        "Quaternion.normalized", f"R = pin.Quaternion(2 * q).normalized()\n{_OF_X.format(of='R.matrix()')}"
    ),
    "rotation_matrix:normalize": Way(
        "Quaternion.normalize", f"R = pin.Quaternion(2 * q)\nR.normalize()\n{_OF_X.format(of='R.matrix()')}"
    ),
    "rotation_matrix:coeffs": Way("Quaternion.coeffs", f"{_R}{_OF_X.format(of='pin.Quaternion(R.coeffs()).matrix()')}"),
    "rotation_matrix:four numbers": Way(
        "Quaternion of w, x, y, z", f"R = pin.Quaternion(q[3], *q[:3])\n{_OF_X.format(of='R.matrix()')}"
    ),
    "rotation_matrix:AngleAxis": Way(
        "AngleAxis.toRotationMatrix", f"{_ANGLE}{_OF_X.format(of='R.toRotationMatrix()')}"
    ),
    "rotation_matrix:fromRotationMatrix": Way(
        "AngleAxis.fromRotationMatrix",
        f"{_R}X = pin.AngleAxis(0.5, np.eye(3)[0])\nX.fromRotationMatrix(R.matrix())\n{_OF_X.format(of='X.matrix()')}",
    ),
    "rotation_of_z:setFromTwoVectors": Way(
        "Quaternion.setFromTwoVectors",
        "R = pin.Quaternion(0.0, 1.0, 0.0, 0.0)\nR.setFromTwoVectors(np.eye(3)[2], v + [4.0, -8.0, 8.0])\n"
        f"{_OF_X.format(of='R.matrix()')}",
    ),
    "rotation_of_rpy:rotate": Way(
        "rpy.rotate",
        f"{_RPY}value = (rpy.rotate('z', v[2]) @ rpy.rotate('y', v[1]) @ rpy.rotate('x', v[0])).ravel()",
    ),
    "rotation_of_rpy:utils": Way(
        "utils.rotate",
        "from pinocchio.utils import rotate\n"
        "value = (rotate('z', v[2]) @ rotate('y', v[1]) @ rotate('x', v[0])).ravel()",
    ),
    "rotation_of_rpy:three angles": Way("rpy.rpyToMatrix", f"{_RPY}value = rpy.rpyToMatrix(*v).ravel()"),
    "rotation_of_rpy:Jacobian": Way(
        "rpy.computeRpyJacobian, LOCAL_WORLD_ALIGNED and LOCAL",
        f"{_RPY}J = [rpy.computeRpyJacobian(v, one) for one in (pin.LOCAL_WORLD_ALIGNED, pin.LOCAL)]\n"
        "value = (J[0] @ np.linalg.inv(J[1])).ravel()",
    ),
    "rpy_rates:WORLD": Way(
        "rpy.computeRpyJacobianInverse, WORLD", f"{_RPY}value = rpy.computeRpyJacobianInverse(v, pin.WORLD)"
    ),
    "rpy_rates_turned": Way(
        "rpy.computeRpyJacobianInverse, LOCAL", f"{_RPY}value = rpy.computeRpyJacobianInverse(v, pin.LOCAL)"
    ),
    "rpy_rates_turned:computeRpyJacobian": Way(
        "rpy.computeRpyJacobian, LOCAL", f"{_RPY}value = np.linalg.inv(rpy.computeRpyJacobian(v, pin.LOCAL))"
    ),
    "rpy_rates_turned_rate": Way(
        "rpy.computeRpyJacobianTimeDerivative, LOCAL",
        f"{_RPY}B = rpy.computeRpyJacobianInverse(v, pin.LOCAL)\n"
        "value = -B @ rpy.computeRpyJacobianTimeDerivative(v, a, pin.LOCAL) @ B",
    ),
    "rotation_vector_rates_along": Way("Hlog3", f"{_R}value = pin.Hlog3(R.matrix(), v)"),
    "rotation_exponential:exp": Way("exp", "value = pin.exp(v).ravel()"),
    "rotation_logarithm:log": Way("log", f"{_R}value = pin.log(R.matrix())"),
    "pose_exponential:exp": Way("exp of a motion", f"{TWIST}{FLAT.format(of='pin.exp(V)')}"),
    "pose_exponential:vector": Way("exp6 of a vector", FLAT.format(of="pin.exp6(np.r_[v, v2])")),
    "pose_logarithm:log": Way("log of a placement", f"{TWO}value = pin.log(X).vector"),
    "pose_composed:XYZQUAT": Way(
        "SE3ToXYZQUAT, SE3ToXYZQUATtuple, XYZQUATToSE3",
        f"{TWO}Y = pin.XYZQUATToSE3(pin.SE3ToXYZQUATtuple(Y))\n"
        f"{FLAT.format(of='pin.XYZQUATToSE3(pin.SE3ToXYZQUAT(X)) * Y')}",
    ),
    "pose_composed:homogeneous": Way(
        "SE3.homogeneous, SE3 of a matrix", f"{TWO}{FLAT.format(of='pin.SE3(X.homogeneous @ Y.homogeneous)')}"
    ),
    "pose_unset": Way("SE3.Identity", FLAT.format(of="pin.SE3.Identity()")),
    "pose_unset:setIdentity": Way("SE3.setIdentity", f"{TWO}X.setIdentity()\n{FLAT.format(of='X')}"),
    "twist_transform:toActionMatrix": Way("SE3.toActionMatrix", f"{TWO}value = X.toActionMatrix()"),
    "twist_transform:se3Action": Way("Motion.se3Action", f"{TWO}value = {EYE.format(of='pin.Motion(e).se3Action(X)')}"),
    "twist_transform_back:toActionMatrixInverse": Way(
        "SE3.toActionMatrixInverse", f"{TWO}value = X.toActionMatrixInverse()"
    ),
    "twist_transform_back:se3ActionInverse": Way(
        "Motion.se3ActionInverse", f"{TWO}value = {EYE.format(of='pin.Motion(e).se3ActionInverse(X)')}"
    ),
    "wrench_transform:toDualActionMatrix": Way("SE3.toDualActionMatrix", f"{TWO}value = X.toDualActionMatrix()"),
    "wrench_transform:se3Action": Way("Force.se3Action", f"{TWO}value = {EYE.format(of='pin.Force(e).se3Action(X)')}"),
    "wrench_transform_back:se3ActionInverse": Way(
        "Force.se3ActionInverse", f"{TWO}value = {EYE.format(of='pin.Force(e).se3ActionInverse(X)')}"
    ),
    "rotation_difference": Way("liegroups.SO3.difference", f"{_SO3}value = G.difference(q, q2)"),
    "rotation_difference_dq": Way("liegroups.SO3.dDifference", f"{_SO3}value = G.dDifference(q, q2, pin.ARG0)"),
    "rotation_difference_dq2": Way("liegroups.SO3.dDifference", f"{_SO3}value = G.dDifference(q, q2, pin.ARG1)"),
    "rotation_squared_distance": Way("liegroups.SO3.squaredDistance", f"{_SO3}value = [G.squaredDistance(q, q2)]"),
    "rotation_integrated": Way(
        "liegroups.SO3.integrate", f"{_SO3}value = pin.Quaternion(G.integrate(q, v)).matrix().ravel()"
    ),
    "rotation_integrated_dq": Way("liegroups.SO3.dIntegrate_dq", f"{_SO3}value = G.dIntegrate_dq(q, v)"),
    "rotation_vector_speeds:SO3": Way("liegroups.SO3.dIntegrate_dv", f"{_SO3}value = G.dIntegrate_dv(q, tau)"),
    "rotation_halfway:SO3": Way(
        "liegroups.SO3.interpolate", f"{_SO3}value = pin.Quaternion(G.interpolate(q, q2, 0.25)).matrix().ravel()"
    ),
    "pose_difference_dq": Way("liegroups.SE3.dDifference", f"{_SE3}value = G.dDifference(x, y, pin.ARG0)"),
    "pose_difference_dq2": Way("liegroups.SE3.dDifference", f"{_SE3}value = G.dDifference(x, y, pin.ARG1)"),
    "pose_squared_distance": Way("liegroups.SE3.squaredDistance", f"{_SE3}value = [G.squaredDistance(x, y)]"),
    "pose_integrated": Way(
        "liegroups.SE3.integrate", f"{_SE3}{FLAT.format(of='pin.XYZQUATToSE3(G.integrate(x, np.r_[v, v2]))')}"
    ),
    "pose_integrated_dq": Way("liegroups.SE3.dIntegrate_dq", f"{_SE3}value = G.dIntegrate_dq(x, np.r_[v, v2])"),
    "pose_exponential_speeds:SE3": Way(
        "liegroups.SE3.dIntegrate_dv", f"{_SE3}value = G.dIntegrate_dv(x, np.r_[v, v2])"
    ),
    "pose_halfway:SE3": Way(
        "liegroups.SE3.interpolate", f"{_SE3}{FLAT.format(of='pin.XYZQUATToSE3(G.interpolate(x, y, 0.25))')}"
    ),
}
