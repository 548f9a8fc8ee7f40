"""What Pinocchio offers of spatial algebra beside placements: moments, parameters of inertias, groups, quaternions."""

from __future__ import annotations

from ...truth.geometry.poses import MOMENTS
from ..writing.source import ways_of
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

WAYS = ways_of(f"""
== wrench_cross | Motion.dualAction | {TWIST}value = V.dualAction
== wrench_cross:cross | Motion.cross of forces | {TWIST}value = {EYE.format(of="V.cross(pin.Force(e))")}
== twist_cross:^ | Motion ^ Motion | {TWIST}value = {EYE.format(of="(V ^ pin.Motion(e))")}
== wrench_transform_back | SE3.actInv of forces | {TWO}value = {EYE.format(of="X.actInv(pin.Force(e))")}
== power | Motion.dot | {TWIST}{_F}value = [V.dot(F)]
== power:Force | Force.dot | {TWIST}{_F}value = [F.dot(V)]
== body_energy | Inertia.vtiv | {INERTIA}{TWIST}value = [I.vtiv(V) / 2]
== inertia_parameters | Inertia.toDynamicParameters | {INERTIA}value = I.toDynamicParameters()
== inertia_parameters:PseudoInertia | PseudoInertia.toDynamicParameters
{INERTIA}value = I.toPseudoInertia().toDynamicParameters()
== pseudo_inertia | Inertia.toPseudoInertia | {INERTIA}value = I.toPseudoInertia().toMatrix()
== pseudo_inertia:FromInertia | PseudoInertia.FromInertia
{INERTIA}P = pin.PseudoInertia.FromInertia(I)
value = np.block([[P.sigma, P.h.reshape(3, 1)], [P.h.reshape(1, 3), np.array([[P.mass]])]])
== pseudo_inertia:FromDynamicParameters | PseudoInertia.FromDynamicParameters
{INERTIA}value = pin.PseudoInertia.FromDynamicParameters(I.toDynamicParameters()).toMatrix()
== spatial_inertia:PseudoInertia | PseudoInertia.FromMatrix, toInertia
{INERTIA}value = pin.PseudoInertia.FromMatrix(I.toPseudoInertia().toMatrix()).toInertia().matrix()
== spatial_inertia_sum:- | Inertia - Inertia | {TWO}{INERTIA}J = I.se3Action(X)\nvalue = ((I + J + I) - I).matrix()
== spatial_inertia_inverse | Inertia.inverse | {INERTIA}value = I.inverse()
== momentum_rate_regressor | bodyRegressor | {TWIST}A = pin.Motion(a, tau)\nvalue = pin.bodyRegressor(V, A)
== logarithmic_inertia | Inertia.FromLogCholeskyParameters
{_LOG}value = pin.Inertia.FromLogCholeskyParameters(C).matrix()
== logarithmic_inertia:toInertia | LogCholeskyParameters.toInertia | {_LOG}value = C.toInertia().matrix()
== logarithmic_inertia:toPseudoInertia | LogCholeskyParameters.toPseudoInertia
{_LOG}value = C.toPseudoInertia().toInertia().matrix()
== logarithmic_parameters | LogCholeskyParameters.toDynamicParameters | {_LOG}value = C.toDynamicParameters()
== logarithmic_derivatives | LogCholeskyParameters.calculateJacobian | {_LOG}value = C.calculateJacobian()
== moments_product | Symmetric3 * vector | {_S}value = S * v
== moments_along | Symmetric3.vtiv | {_S}value = [S.vtiv(v)]
== moments_rotated | Symmetric3.rotate | {_R}{_S}value = S.rotate(R.matrix()).matrix()
== cross_matrix | skew | value = pin.skew(v)
== cross_matrix:unSkew | unSkew | value = np.cross(pin.unSkew(pin.skew(v)), np.eye(3)).T
== cross_matrices | skewSquare | value = pin.skewSquare(v, a)
== turned_vector | Quaternion * vector | {_R}value = R * v
== turned_vector:AngleAxis | AngleAxis * vector | {_ANGLE}value = R * v
== turned_vector:SE3 | SE3.act | {_R}value = pin.SE3(R, a).act(v) - a
== rotation_inverse | Quaternion.inverse | {_R}{_OF_X.format(of="R.inverse().matrix()")}
== rotation_inverse:conjugate | Quaternion.conjugate | {_R}{_OF_X.format(of="R.conjugate().matrix()")}
== rotation_inverse:AngleAxis | AngleAxis.inverse | {_ANGLE}{_OF_X.format(of="R.inverse().matrix()")}
== rotation_matrix:normalized | Quaternion.normalized
R = pin.Quaternion(2 * q).normalized()
{_OF_X.format(of="R.matrix()")}
== rotation_matrix:normalize | Quaternion.normalize
R = pin.Quaternion(2 * q)
R.normalize()
{_OF_X.format(of="R.matrix()")}
== rotation_matrix:coeffs | Quaternion.coeffs | {_R}{_OF_X.format(of="pin.Quaternion(R.coeffs()).matrix()")}
== rotation_matrix:four numbers | Quaternion of w, x, y, z
R = pin.Quaternion(q[3], *q[:3])
{_OF_X.format(of="R.matrix()")}
== rotation_matrix:AngleAxis | AngleAxis.toRotationMatrix | {_ANGLE}{_OF_X.format(of="R.toRotationMatrix()")}
== rotation_matrix:fromRotationMatrix | AngleAxis.fromRotationMatrix
{_R}X = pin.AngleAxis(0.5, np.eye(3)[0])
X.fromRotationMatrix(R.matrix())
{_OF_X.format(of="X.matrix()")}
== rotation_of_z:setFromTwoVectors | Quaternion.setFromTwoVectors
R = pin.Quaternion(0.0, 1.0, 0.0, 0.0)
R.setFromTwoVectors(np.eye(3)[2], v + [4.0, -8.0, 8.0])
{_OF_X.format(of="R.matrix()")}
== rotation_of_rpy:rotate | rpy.rotate
{_RPY}value = (rpy.rotate('z', v[2]) @ rpy.rotate('y', v[1]) @ rpy.rotate('x', v[0])).ravel()
== rotation_of_rpy:utils | utils.rotate
from pinocchio.utils import rotate
value = (rotate('z', v[2]) @ rotate('y', v[1]) @ rotate('x', v[0])).ravel()
== rotation_of_rpy:three angles | rpy.rpyToMatrix | {_RPY}value = rpy.rpyToMatrix(*v).ravel()
== rotation_of_rpy:Jacobian | rpy.computeRpyJacobian, LOCAL_WORLD_ALIGNED and LOCAL
{_RPY}J = [rpy.computeRpyJacobian(v, one) for one in (pin.LOCAL_WORLD_ALIGNED, pin.LOCAL)]
value = (J[0] @ np.linalg.inv(J[1])).ravel()
== rpy_rates:WORLD | rpy.computeRpyJacobianInverse, WORLD | {_RPY}value = rpy.computeRpyJacobianInverse(v, pin.WORLD)
== rpy_rates_turned | rpy.computeRpyJacobianInverse, LOCAL | {_RPY}value = rpy.computeRpyJacobianInverse(v, pin.LOCAL)
== rpy_rates_turned:computeRpyJacobian | rpy.computeRpyJacobian, LOCAL
{_RPY}value = np.linalg.inv(rpy.computeRpyJacobian(v, pin.LOCAL))
== rpy_rates_turned_rate | rpy.computeRpyJacobianTimeDerivative, LOCAL
{_RPY}B = rpy.computeRpyJacobianInverse(v, pin.LOCAL)
value = -B @ rpy.computeRpyJacobianTimeDerivative(v, a, pin.LOCAL) @ B
== rotation_vector_rates_along | Hlog3 | {_R}value = pin.Hlog3(R.matrix(), v)
== rotation_exponential:exp | exp | value = pin.exp(v).ravel()
== rotation_logarithm:log | log | {_R}value = pin.log(R.matrix())
== pose_exponential:exp | exp of a motion | {TWIST}{FLAT.format(of="pin.exp(V)")}
== pose_exponential:vector | exp6 of a vector | {FLAT.format(of="pin.exp6(np.r_[v, v2])")}
== pose_logarithm:log | log of a placement | {TWO}value = pin.log(X).vector
== pose_composed:XYZQUAT | SE3ToXYZQUAT, SE3ToXYZQUATtuple, XYZQUATToSE3
{TWO}Y = pin.XYZQUATToSE3(pin.SE3ToXYZQUATtuple(Y))
{FLAT.format(of="pin.XYZQUATToSE3(pin.SE3ToXYZQUAT(X)) * Y")}
== pose_composed:homogeneous | SE3.homogeneous, SE3 of a matrix
{TWO}{FLAT.format(of="pin.SE3(X.homogeneous @ Y.homogeneous)")}
== pose_unset | SE3.Identity | {FLAT.format(of="pin.SE3.Identity()")}
== pose_unset:setIdentity | SE3.setIdentity | {TWO}X.setIdentity()\n{FLAT.format(of="X")}
== twist_transform:toActionMatrix | SE3.toActionMatrix | {TWO}value = X.toActionMatrix()
== twist_transform:se3Action | Motion.se3Action | {TWO}value = {EYE.format(of="pin.Motion(e).se3Action(X)")}
== twist_transform_back:toActionMatrixInverse | SE3.toActionMatrixInverse | {TWO}value = X.toActionMatrixInverse()
== twist_transform_back:se3ActionInverse | Motion.se3ActionInverse
{TWO}value = {EYE.format(of="pin.Motion(e).se3ActionInverse(X)")}
== wrench_transform:toDualActionMatrix | SE3.toDualActionMatrix | {TWO}value = X.toDualActionMatrix()
== wrench_transform:se3Action | Force.se3Action | {TWO}value = {EYE.format(of="pin.Force(e).se3Action(X)")}
== wrench_transform_back:se3ActionInverse | Force.se3ActionInverse
{TWO}value = {EYE.format(of="pin.Force(e).se3ActionInverse(X)")}
== rotation_difference | liegroups.SO3.difference | {_SO3}value = G.difference(q, q2)
== rotation_difference_dq | liegroups.SO3.dDifference | {_SO3}value = G.dDifference(q, q2, pin.ARG0)
== rotation_difference_dq2 | liegroups.SO3.dDifference | {_SO3}value = G.dDifference(q, q2, pin.ARG1)
== rotation_squared_distance | liegroups.SO3.squaredDistance | {_SO3}value = [G.squaredDistance(q, q2)]
== rotation_integrated | liegroups.SO3.integrate | {_SO3}value = pin.Quaternion(G.integrate(q, v)).matrix().ravel()
== rotation_integrated_dq | liegroups.SO3.dIntegrate_dq | {_SO3}value = G.dIntegrate_dq(q, v)
== rotation_vector_speeds:SO3 | liegroups.SO3.dIntegrate_dv | {_SO3}value = G.dIntegrate_dv(q, tau)
== rotation_halfway:SO3 | liegroups.SO3.interpolate
{_SO3}value = pin.Quaternion(G.interpolate(q, q2, 0.25)).matrix().ravel()
== pose_difference_dq | liegroups.SE3.dDifference | {_SE3}value = G.dDifference(x, y, pin.ARG0)
== pose_difference_dq2 | liegroups.SE3.dDifference | {_SE3}value = G.dDifference(x, y, pin.ARG1)
== pose_squared_distance | liegroups.SE3.squaredDistance | {_SE3}value = [G.squaredDistance(x, y)]
== pose_integrated | liegroups.SE3.integrate | {_SE3}{FLAT.format(of="pin.XYZQUATToSE3(G.integrate(x, np.r_[v, v2]))")}
== pose_integrated_dq | liegroups.SE3.dIntegrate_dq | {_SE3}value = G.dIntegrate_dq(x, np.r_[v, v2])
== pose_exponential_speeds:SE3 | liegroups.SE3.dIntegrate_dv | {_SE3}value = G.dIntegrate_dv(x, np.r_[v, v2])
== pose_halfway:SE3 | liegroups.SE3.interpolate | {_SE3}{FLAT.format(of="pin.XYZQUATToSE3(G.interpolate(x, y, 0.25))")}
""")
