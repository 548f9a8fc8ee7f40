"""iDynTree's rotations, placements, spatial vectors and inertias, axes, and parameters of Denavit and Hartenberg."""

from __future__ import annotations

from ...truth.geometry.poses import CENTRE, MASS, MOMENTS
from ..writing.source import HALF_TURNS, ON_END, Way

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

WAYS = {
    "rotation_matrix": Way("Rotation.RotationFromQuaternion", _R + _ROWS.format(of="R")),
    "rotation_matrix:asQuaternion": Way(
        "Rotation.asQuaternion", _R + _ROWS.format(of="iDynTree.Rotation.RotationFromQuaternion(R.asQuaternion())")
    ),
    "rotation_matrix:asRPY": Way(
        "Rotation.asRPY, RPY", _R + _ROWS.format(of="iDynTree.Rotation.RPY(*R.asRPY().toNumPy())")
    ),
    "rotation_half_turns": Way(
        "Rotation.asQuaternion of a half turn",
        f"{HALF_TURNS}value = [iDynTree.Rotation.RotationFromQuaternion("
        "iDynTree.Rotation.FromPython(H).asQuaternion()).toNumPy().ravel() for H in half_turns]",
    ),
    "rotation_composed": Way("Rotation * Rotation", _TWO + _ROWS.format(of="(R * Q)")),
    "rotation_composed:compose": Way("Rotation.compose", _TWO + _ROWS.format(of="iDynTree.Rotation.compose(R, Q)")),
    "rotation_inverse": Way("Rotation.inverse", _R + _ROWS.format(of="R.inverse()")),
    "turned_vector": Way("Rotation * Position", f"{_R}value = (R * iDynTree.Position(*v)).toNumPy()"),
    "rotation_logarithm": Way("Rotation.log", f"{_R}value = R.log().toNumPy()"),
    "rotation_of_rpy": Way("Rotation.RPY", _ROWS.format(of="iDynTree.Rotation.RPY(*v)")),
    "rotation_of_rpy:RotX": Way(
        "Rotation.RotX, RotY, RotZ",
        "turn = iDynTree.Rotation\n" + _ROWS.format(of="(turn.RotZ(v[2]) * turn.RotY(v[1]) * turn.RotX(v[0]))"),
    ),
    "rotation_to_rpy": Way("Rotation.asRPY", f"{_R}value = R.asRPY().toNumPy()"),
    "rotations_on_end": Way(
        "Rotation.asRPY, RPY",
        f"{ON_END}value = [iDynTree.Rotation.RPY(*iDynTree.Rotation.FromPython(H).asRPY().toNumPy())"
        ".toNumPy().ravel() for H in on_end]",
    ),
    "rpy_rates": Way(
        "Rotation.RPYRightTrivializedDerivativeInverse",
        "value = iDynTree.Rotation.RPYRightTrivializedDerivativeInverse(*v).toNumPy()",
    ),
    "rpy_rates:RPYRightTrivializedDerivative": Way(
        "Rotation.RPYRightTrivializedDerivative",
        "value = np.linalg.inv(iDynTree.Rotation.RPYRightTrivializedDerivative(*v).toNumPy())",
    ),
    "rpy_rates_rate": Way(
        "Rotation.RPYRightTrivializedDerivativeInverseRateOfChange",
        "value = iDynTree.Rotation.RPYRightTrivializedDerivativeInverseRateOfChange(*v, *a).toNumPy()",
    ),
    "rpy_rates_rate:RPYRightTrivializedDerivativeRateOfChange": Way(
        "Rotation.RPYRightTrivializedDerivativeRateOfChange",
        "B = iDynTree.Rotation.RPYRightTrivializedDerivativeInverse(*v).toNumPy()\n"
        "value = -B @ iDynTree.Rotation.RPYRightTrivializedDerivativeRateOfChange(*v, *a).toNumPy() @ B",
    ),
    "rotation_vector_speeds": Way(
        "Rotation.leftJacobian", f"value = iDynTree.Rotation.leftJacobian({_VECTOR.format('tau')}).toNumPy().T"
    ),
    "rotation_vector_rates_fixed": Way(
        "Rotation.leftJacobianInverse",
        f"value = iDynTree.Rotation.leftJacobianInverse({_VECTOR.format('v')}).toNumPy()",
    ),
    "pose_composed": Way("Transform * Transform", _X + _FLAT.format(of="(X * Y)")),
    "pose_composed:compose": Way("Transform.compose", _X + _FLAT.format(of="iDynTree.Transform.compose(X, Y)")),
    "pose_composed:fromHomogeneousTransform": Way(
        "Transform.fromHomogeneousTransform",
        f"{_X}Z = iDynTree.Transform.Identity()\n"
        "Z.fromHomogeneousTransform(Y.asHomogeneousTransform())\n" + _FLAT.format(of="(X * Z)"),
    ),
    "pose_inverse": Way("Transform.inverse", _X + _FLAT.format(of="X.inverse()")),
    "pose_relative": Way("Transform.inverse, *", _X + _FLAT.format(of="(X.inverse() * Y)")),
    "pose_unset": Way("Transform.Identity", _FLAT.format(of="iDynTree.Transform.Identity()")),
    "pose_of_point": Way("Transform * Position", f"{_X}value = (X * iDynTree.Position(*v)).toNumPy()"),
    "pose_logarithm": Way("Transform.log", f"{_X}value = X.log().asVector().toNumPy()"),
    "pose_difference": Way("Transform.log", f"{_X}value = (X.inverse() * Y).log().asVector().toNumPy()"),
    "pose_exponential": Way("Twist.exp", _V + _FLAT.format(of="V.exp()")),
    "twist_transform": Way("Transform.asAdjointTransform", f"{_X}value = X.asAdjointTransform().toNumPy()"),
    "twist_transform:Twist": Way("Transform * Twist", _X + _EYE.format(of="(X * iDynTree.Twist.FromPython(e))")),
    "twist_transform_back": Way(
        "Transform.inverse, asAdjointTransform", f"{_X}value = X.inverse().asAdjointTransform().toNumPy()"
    ),
    "wrench_transform": Way(
        "Transform.asAdjointTransformWrench", f"{_X}value = X.asAdjointTransformWrench().toNumPy()"
    ),
    "wrench_transform:Wrench": Way("Transform * Wrench", _X + _EYE.format(of="(X * iDynTree.Wrench.FromPython(e))")),
    "wrench_transform_back": Way(
        "Transform.inverse, asAdjointTransformWrench",
        f"{_X}value = X.inverse().asAdjointTransformWrench().toNumPy()",
    ),
    "twist_cross": Way("Twist.asCrossProductMatrix", f"{_V}value = V.asCrossProductMatrix().toNumPy()"),
    "twist_cross:cross": Way("Twist.cross", _V + _EYE.format(of="V.cross(iDynTree.Twist.FromPython(e))")),
    "wrench_cross": Way("Twist.asCrossProductMatrixWrench", f"{_V}value = V.asCrossProductMatrixWrench().toNumPy()"),
    "wrench_cross:cross": Way("Twist.cross of wrenches", _V + _EYE.format(of="V.cross(iDynTree.Wrench.FromPython(e))")),
    "power": Way("Twist.dot", f"{_V}{_F}value = [V.dot(F)]"),
    "power:Wrench": Way("Wrench.dot", f"{_V}{_F}value = [F.dot(V)]"),
    "spatial_inertia": Way("SpatialInertia.asMatrix", f"{_I}value = I.asMatrix().toNumPy()"),
    "spatial_inertia:fromRotationalInertiaWrtCenterOfMass": Way(
        "SpatialInertia.fromRotationalInertiaWrtCenterOfMass",
        _I + _AGAIN.format(f"fromRotationalInertiaWrtCenterOfMass({MASS}, iDynTree.Position(*c), body(about))"),
    ),
    "spatial_inertia:fromVector": Way(
        "SpatialInertia.asVector, fromVector", _I + _AGAIN.format("fromVector(I.asVector())")
    ),
    "spatial_inertia:RigidBodyInertiaNonLinearParametrization": Way(
        "RigidBodyInertiaNonLinearParametrization",
        f"{_I}N = iDynTree.RigidBodyInertiaNonLinearParametrization()\nN.fromRigidBodyInertia(I)\n"
        "value = N.toRigidBodyInertia().asMatrix().toNumPy()",
    ),
    "spatial_inertia:of the mass centre": Way(
        "SpatialInertia.getCenterOfMass, getRotationalInertiaWrtCenterOfMass",
        _I
        + _AGAIN.format(
            "fromRotationalInertiaWrtCenterOfMass("
            "I.getMass(), I.getCenterOfMass(), I.getRotationalInertiaWrtCenterOfMass())"
        ),
    ),
    "inertia_parameters": Way("SpatialInertia.asVector", f"{_I}value = I.asVector().toNumPy()[list({PARAMETERS})]"),
    "spatial_inertia_inverse": Way("SpatialInertia.getInverse", f"{_I}value = I.getInverse().toNumPy()"),
    "spatial_inertia_placed": Way("Transform * SpatialInertia", f"{_X}{_I}value = (X * I).asMatrix().toNumPy()"),
    "spatial_inertia_sum": Way("SpatialInertia + SpatialInertia", f"{_X}{_I}value = (I + X * I).asMatrix().toNumPy()"),
    "spatial_inertia_sum:combine": Way(
        "SpatialInertia.combine", f"{_X}{_I}value = iDynTree.SpatialInertia.combine(I, X * I).asMatrix().toNumPy()"
    ),
    "spatial_momentum": Way("SpatialInertia * Twist", f"{_I}{_V}value = (I * V).toNumPy()"),
    "spatial_momentum_cross": Way("SpatialInertia.biasWrench", f"{_I}{_V}value = I.biasWrench(V).toNumPy()"),
    "spatial_momentum_cross_dv": Way(
        "SpatialInertia.biasWrenchDerivative", f"{_I}{_V}value = I.biasWrenchDerivative(V).toNumPy()"
    ),
    "momentum_regressor": Way(
        "SpatialInertia.momentumRegressor",
        f"{_V}value = iDynTree.SpatialInertia.momentumRegressor(V).toNumPy()[:, list({PARAMETERS})]",
    ),
    "momentum_rate_regressor": Way(
        "SpatialInertia.momentumDerivativeRegressor",
        f"{_V}{_A}value = iDynTree.SpatialInertia.momentumDerivativeRegressor(V, A).toNumPy()[:, list({PARAMETERS})]",
    ),
    "pose_by_denavit": Way("TransformFromDH", _FLAT.format(of="iDynTree.TransformFromDH(*v, a[0])")),
    "pose_by_modified_denavit": Way(
        "TransformFromDHCraig1989", _FLAT.format(of="iDynTree.TransformFromDHCraig1989(*v, a[0])")
    ),
    "turn_about_line": Way(
        "Axis.getRotationTransform", _LINE.format("a") + _FLAT.format(of="line.getRotationTransform(tau[0])")
    ),
    "twist_about_line": Way(
        "Axis.getRotationTwist", f"{_LINE.format('a')}value = line.getRotationTwist(1.0).toNumPy()"
    ),
    "line_nearest": Way(
        "Axis.getPointOnAxisClosestToGivenPoint",
        f"{_LINE.format('a')}value = line.getPointOnAxisClosestToGivenPoint(iDynTree.Position(*tau)).toNumPy()",
    ),
}
