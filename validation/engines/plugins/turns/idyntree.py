"""iDynTree's rotations, placements, spatial vectors and inertias, axes, and parameters of Denavit and Hartenberg."""

from __future__ import annotations

from ...truth.geometry.poses import CENTRE, MASS, MOMENTS
from ..writing.source import HALF_TURNS, ON_END, ways_of

IMPORTS = ("import idyntree.bindings as iDynTree",)
# Mass, m c, Ixx, Ixy, Ixz, Iyy, Iyz, Izz of iDynTree, in the order that has Iyy before Ixz.
PARAMETERS = (0, 1, 2, 3, 4, 5, 7, 6, 8, 9)
_TURN = "iDynTree.Rotation.RotationFromQuaternion(iDynTree.Vector4.FromPython({}))"
_R = f"R = {_TURN.format('q')}\n"
_TWO = f"{_R}Q = {_TURN.format('q2')}\n"
_X = f"{_TWO}X, Y = iDynTree.Transform(R, iDynTree.Position(*a)), iDynTree.Transform(Q, iDynTree.Position(*tau))\n"
_ROWS = "value = {of}.toNumPy().ravel()"
_FLAT = "H = {of}.asHomogeneousTransform().toNumPy()\nvalue = [*H[:3, 3], *H[:3, :3].flat]"
_V = "V = iDynTree.Twist.FromPython(np.r_[v, v2])\n"
_F = "F = iDynTree.Wrench.FromPython(np.r_[a, tau])\n"
_A = "A = iDynTree.SpatialAcc.FromPython(np.r_[a, tau])\n"
_EYE = "value = np.stack([{of}.toNumPy() for e in np.eye(6)], axis=1)"
_VECTOR = "iDynTree.Vector3.FromPython({})"
_I = f"""def body(moments):
    made = iDynTree.RotationalInertia()
    for i, j in np.ndindex(3, 3): made.setVal(i, j, float(moments[i, j]))
    return made
about, c = np.array({[*map(list, MOMENTS)]}), np.array({list(CENTRE)})
I = iDynTree.SpatialInertia({MASS}, iDynTree.Position(*c), body(about + {MASS} * (c @ c * np.eye(3) - np.outer(c, c))))
"""
_AGAIN = "J = iDynTree.SpatialInertia()\nJ.{}\nvalue = J.asMatrix().toNumPy()"
_LINE = "u = v + [4.0, -8.0, 8.0]\nline = iDynTree.Axis(iDynTree.Direction(*u), iDynTree.Position(*{}))\n"

_AS_QUATERNION = (
    f"{HALF_TURNS}value = [iDynTree.Rotation.RotationFromQuaternion("
    "iDynTree.Rotation.FromPython(H).asQuaternion()).toNumPy().ravel() for H in half_turns]"
)
_FROM_ROTATIONAL_INERTIA_WRT_CENTER_OF_MASS = _I + _AGAIN.format(
    f"fromRotationalInertiaWrtCenterOfMass({MASS}, iDynTree.Position(*c), body(about))"
)
_GET_CENTER_OF_MASS = _I + _AGAIN.format(
    "fromRotationalInertiaWrtCenterOfMass(I.getMass(), I.getCenterOfMass(), I.getRotationalInertiaWrtCenterOfMass())"
)
WAYS = ways_of(f"""
== rotation_matrix | Rotation.RotationFromQuaternion | {_R}{_ROWS.format(of="R")}
== rotation_matrix:asQuaternion | Rotation.asQuaternion
{_R}{_ROWS.format(of="iDynTree.Rotation.RotationFromQuaternion(R.asQuaternion())")}
== rotation_matrix:asRPY | Rotation.asRPY, RPY | {_R}{_ROWS.format(of="iDynTree.Rotation.RPY(*R.asRPY().toNumPy())")}
== rotation_half_turns | Rotation.asQuaternion of a half turn | {_AS_QUATERNION}
== rotation_composed | Rotation * Rotation | {_TWO}{_ROWS.format(of="(R * Q)")}
== rotation_composed:compose | Rotation.compose | {_TWO}{_ROWS.format(of="iDynTree.Rotation.compose(R, Q)")}
== rotation_inverse | Rotation.inverse | {_R}{_ROWS.format(of="R.inverse()")}
== turned_vector | Rotation * Position | {_R}value = (R * iDynTree.Position(*v)).toNumPy()
== rotation_logarithm | Rotation.log | {_R}value = R.log().toNumPy()
== rotation_of_rpy | Rotation.RPY | {_ROWS.format(of="iDynTree.Rotation.RPY(*v)")}
== rotation_of_rpy:RotX | Rotation.RotX, RotY, RotZ
turn = iDynTree.Rotation
{_ROWS.format(of="(turn.RotZ(v[2]) * turn.RotY(v[1]) * turn.RotX(v[0]))")}
== rotation_to_rpy | Rotation.asRPY | {_R}value = R.asRPY().toNumPy()
== rotations_on_end | Rotation.asRPY, RPY
{ON_END}value = [iDynTree.Rotation.RPY(*iDynTree.Rotation.FromPython(H).asRPY().toNumPy()).toNumPy().ravel() for H in \
on_end]
== rpy_rates | Rotation.RPYRightTrivializedDerivativeInverse
value = iDynTree.Rotation.RPYRightTrivializedDerivativeInverse(*v).toNumPy()
== rpy_rates:RPYRightTrivializedDerivative | Rotation.RPYRightTrivializedDerivative
value = np.linalg.inv(iDynTree.Rotation.RPYRightTrivializedDerivative(*v).toNumPy())
== rpy_rates_rate | Rotation.RPYRightTrivializedDerivativeInverseRateOfChange
value = iDynTree.Rotation.RPYRightTrivializedDerivativeInverseRateOfChange(*v, *a).toNumPy()
== rpy_rates_rate:RPYRightTrivializedDerivativeRateOfChange | Rotation.RPYRightTrivializedDerivativeRateOfChange
B = iDynTree.Rotation.RPYRightTrivializedDerivativeInverse(*v).toNumPy()
value = -B @ iDynTree.Rotation.RPYRightTrivializedDerivativeRateOfChange(*v, *a).toNumPy() @ B
== rotation_vector_speeds | Rotation.leftJacobian
value = iDynTree.Rotation.leftJacobian({_VECTOR.format("tau")}).toNumPy().T
== rotation_vector_rates_fixed | Rotation.leftJacobianInverse
value = iDynTree.Rotation.leftJacobianInverse({_VECTOR.format("v")}).toNumPy()
== pose_composed | Transform * Transform | {_X}{_FLAT.format(of="(X * Y)")}
== pose_composed:compose | Transform.compose | {_X}{_FLAT.format(of="iDynTree.Transform.compose(X, Y)")}
== pose_composed:fromHomogeneousTransform | Transform.fromHomogeneousTransform
{_X}Z = iDynTree.Transform.Identity()
Z.fromHomogeneousTransform(Y.asHomogeneousTransform())
{_FLAT.format(of="(X * Z)")}
== pose_inverse | Transform.inverse | {_X}{_FLAT.format(of="X.inverse()")}
== pose_relative | Transform.inverse, * | {_X}{_FLAT.format(of="(X.inverse() * Y)")}
== pose_unset | Transform.Identity | {_FLAT.format(of="iDynTree.Transform.Identity()")}
== pose_of_point | Transform * Position | {_X}value = (X * iDynTree.Position(*v)).toNumPy()
== pose_logarithm | Transform.log | {_X}value = X.log().asVector().toNumPy()
== pose_difference | Transform.log | {_X}value = (X.inverse() * Y).log().asVector().toNumPy()
== pose_exponential | Twist.exp | {_V}{_FLAT.format(of="V.exp()")}
== twist_transform | Transform.asAdjointTransform | {_X}value = X.asAdjointTransform().toNumPy()
== twist_transform:Twist | Transform * Twist | {_X}{_EYE.format(of="(X * iDynTree.Twist.FromPython(e))")}
== twist_transform_back | Transform.inverse, asAdjointTransform | {_X}value = X.inverse().asAdjointTransform().toNumPy()
== wrench_transform | Transform.asAdjointTransformWrench | {_X}value = X.asAdjointTransformWrench().toNumPy()
== wrench_transform:Wrench | Transform * Wrench | {_X}{_EYE.format(of="(X * iDynTree.Wrench.FromPython(e))")}
== wrench_transform_back | Transform.inverse, asAdjointTransformWrench
{_X}value = X.inverse().asAdjointTransformWrench().toNumPy()
== twist_cross | Twist.asCrossProductMatrix | {_V}value = V.asCrossProductMatrix().toNumPy()
== twist_cross:cross | Twist.cross | {_V}{_EYE.format(of="V.cross(iDynTree.Twist.FromPython(e))")}
== wrench_cross | Twist.asCrossProductMatrixWrench | {_V}value = V.asCrossProductMatrixWrench().toNumPy()
== wrench_cross:cross | Twist.cross of wrenches | {_V}{_EYE.format(of="V.cross(iDynTree.Wrench.FromPython(e))")}
== power | Twist.dot | {_V}{_F}value = [V.dot(F)]
== power:Wrench | Wrench.dot | {_V}{_F}value = [F.dot(V)]
== spatial_inertia | SpatialInertia.asMatrix | {_I}value = I.asMatrix().toNumPy()
== spatial_inertia:fromRotationalInertiaWrtCenterOfMass | SpatialInertia.fromRotationalInertiaWrtCenterOfMass
{_FROM_ROTATIONAL_INERTIA_WRT_CENTER_OF_MASS}
== spatial_inertia:fromVector | SpatialInertia.asVector, fromVector | {_I}{_AGAIN.format("fromVector(I.asVector())")}
== spatial_inertia:RigidBodyInertiaNonLinearParametrization | RigidBodyInertiaNonLinearParametrization
{_I}N = iDynTree.RigidBodyInertiaNonLinearParametrization()
N.fromRigidBodyInertia(I)
value = N.toRigidBodyInertia().asMatrix().toNumPy()
== spatial_inertia:of the mass centre | SpatialInertia.getCenterOfMass, getRotationalInertiaWrtCenterOfMass
{_GET_CENTER_OF_MASS}
== inertia_parameters | SpatialInertia.asVector | {_I}value = I.asVector().toNumPy()[list({PARAMETERS})]
== spatial_inertia_inverse | SpatialInertia.getInverse | {_I}value = I.getInverse().toNumPy()
== spatial_inertia_placed | Transform * SpatialInertia | {_X}{_I}value = (X * I).asMatrix().toNumPy()
== spatial_inertia_sum | SpatialInertia + SpatialInertia | {_X}{_I}value = (I + X * I).asMatrix().toNumPy()
== spatial_inertia_sum:combine | SpatialInertia.combine
{_X}{_I}value = iDynTree.SpatialInertia.combine(I, X * I).asMatrix().toNumPy()
== spatial_momentum | SpatialInertia * Twist | {_I}{_V}value = (I * V).toNumPy()
== spatial_momentum_cross | SpatialInertia.biasWrench | {_I}{_V}value = I.biasWrench(V).toNumPy()
== spatial_momentum_cross_dv | SpatialInertia.biasWrenchDerivative | {_I}{_V}value = I.biasWrenchDerivative(V).toNumPy()
== momentum_regressor | SpatialInertia.momentumRegressor
{_V}value = iDynTree.SpatialInertia.momentumRegressor(V).toNumPy()[:, list({PARAMETERS})]
== momentum_rate_regressor | SpatialInertia.momentumDerivativeRegressor
{_V}{_A}value = iDynTree.SpatialInertia.momentumDerivativeRegressor(V, A).toNumPy()[:, list({PARAMETERS})]
== pose_by_denavit | TransformFromDH | {_FLAT.format(of="iDynTree.TransformFromDH(*v, a[0])")}
== pose_by_modified_denavit | TransformFromDHCraig1989
{_FLAT.format(of="iDynTree.TransformFromDHCraig1989(*v, a[0])")}
== turn_about_line | Axis.getRotationTransform
{_LINE.format("a")}{_FLAT.format(of="line.getRotationTransform(tau[0])")}
== twist_about_line | Axis.getRotationTwist | {_LINE.format("a")}value = line.getRotationTwist(1.0).toNumPy()
== line_nearest | Axis.getPointOnAxisClosestToGivenPoint
{_LINE.format("a")}value = line.getPointOnAxisClosestToGivenPoint(iDynTree.Position(*tau)).toNumPy()
""")
