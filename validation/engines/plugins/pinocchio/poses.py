"""What Pinocchio offers of placements: SE3, its exponentials, spatial vectors and inertias."""

from __future__ import annotations

from ...truth.geometry.poses import BACK, CENTRE, MASS, MOMENTS
from ..turns import solids
from ..writing.source import ON_END, Way

# Placements X and Y, the twist, the body; columns of what is done to unit vectors; what a placement is answered as.
TWO = "X, Y = pin.SE3(pin.Quaternion(q).matrix(), a), pin.SE3(pin.Quaternion(q2).matrix(), tau)\n"
TWIST = "V = pin.Motion(v, v2)\n"
INERTIA = f"I = pin.Inertia({MASS}, np.array({list(CENTRE)}), np.array({[*map(list, MOMENTS)]}))\n"
_OF_Z = "value = pin.Quaternion.FromTwoVectors(np.eye(3)[2], {u}).matrix().ravel()"
EYE = "np.stack([{of}.vector for e in np.eye(6)], axis=1)"


FLAT = "X = {of}\nvalue = [*X.translation, *X.rotation.flat]"


def _flat(of: str) -> str:
    return FLAT.format(of=of)


WAYS = {
    "pose_composed": Way("SE3 * SE3", f"{TWO}{_flat('X * Y')}"),
    "pose_composed:act": Way("SE3.act", f"{TWO}{_flat('X.act(Y)')}"),
    "pose_inverse": Way("SE3.inverse", f"{TWO}{_flat('X.inverse()')}"),
    "pose_relative": Way("SE3.actInv", f"{TWO}{_flat('X.actInv(Y)')}"),
    "pose_of_point": Way("SE3.act", f"{TWO}value = X.act(v)"),
    "pose_logarithm": Way("log6", f"{TWO}value = pin.log6(X).vector"),
    "pose_logarithm:matrix": Way("log6 of a matrix", f"{TWO}value = pin.log6(X.homogeneous).vector"),
    "pose_logarithm:quaternion": Way("log6_quat", "value = pin.log6_quat(np.r_[a, q]).vector"),
    "pose_difference": Way("log6 of actInv", f"{TWO}value = pin.log6(X.actInv(Y)).vector"),
    "pose_difference:liegroups": Way(
        "liegroups.SE3.difference", "value = pin.liegroups.SE3().difference(np.r_[a, q], np.r_[tau, q2])"
    ),
    "pose_exponential": Way("exp6", f"{TWIST}{_flat('pin.exp6(V)')}"),
    "pose_exponential:quaternion": Way("exp6_quat", f"{_flat('pin.XYZQUATToSE3(pin.exp6_quat(np.r_[v, v2]))')}"),
    "pose_halfway": Way("SE3.Interpolate", f"{TWO}{_flat('pin.SE3.Interpolate(X, Y, 0.25)')}"),
    "pose_exponential_speeds": Way("Jexp6", f"{TWIST}value = pin.Jexp6(V)"),
    "pose_logarithm_rates": Way("Jlog6", f"{TWO}value = pin.Jlog6(X)"),
    "twist_transform:Motion": Way("SE3.act of motions", f"{TWO}value = {EYE.format(of='X.act(pin.Motion(e))')}"),
    "wrench_transform": Way("SE3.dualAction", f"{TWO}value = X.dualAction"),
    "wrench_transform:Force": Way("SE3.act of forces", f"{TWO}value = {EYE.format(of='X.act(pin.Force(e))')}"),
    "twist_transform_back": Way("SE3.actionInverse", f"{TWO}value = X.actionInverse"),
    "twist_transform_back:Motion": Way(
        "SE3.actInv of motions", f"{TWO}value = {EYE.format(of='X.actInv(pin.Motion(e))')}"
    ),
    "twist_cross": Way("Motion.action", f"{TWIST}value = V.action"),
    "twist_cross:cross": Way("Motion.cross", f"{TWIST}value = {EYE.format(of='V.cross(pin.Motion(e))')}"),
    "rotation_of_rpy": Way("rpy.rpyToMatrix", "from pinocchio import rpy\nvalue = rpy.rpyToMatrix(v).ravel()"),
    "rotations_on_end": Way(
        "rpy.matrixToRpy",
        f"from pinocchio import rpy\n{ON_END}value = [rpy.rpyToMatrix(rpy.matrixToRpy(H)).ravel() for H in on_end]",
    ),
    "rotation_of_z": Way("Quaternion.FromTwoVectors", _OF_Z.format(u="v + [4.0, -8.0, 8.0]")),
    "rotation_of_z_back": Way("Quaternion.FromTwoVectors", _OF_Z.format(u=f"v / 64 + {list(BACK)}")),
    "rotation_matrix": Way("Quaternion.toRotationMatrix", "value = pin.Quaternion(q).toRotationMatrix().ravel()"),
    "rotation_exponential:exp3_quat": Way(
        "exp3_quat", "value = pin.Quaternion(pin.exp3_quat(v)).toRotationMatrix().ravel()"
    ),
    "rotation_logarithm:AngleAxis": Way(
        "AngleAxis of a matrix", "x = pin.AngleAxis(pin.Quaternion(q).matrix())\nvalue = x.angle * x.axis"
    ),
    "rotation_to_rpy": Way(
        "rpy.matrixToRpy", "from pinocchio import rpy\nvalue = rpy.matrixToRpy(pin.Quaternion(q).matrix())"
    ),
    "rpy_rates:computeRpyJacobian": Way(
        "rpy.computeRpyJacobian",
        "from pinocchio import rpy\nvalue = np.linalg.inv(rpy.computeRpyJacobian(v, pin.LOCAL_WORLD_ALIGNED))",
    ),
    "rpy_rates_rate": Way(
        "rpy.computeRpyJacobianTimeDerivative",
        "from pinocchio import rpy\nB = rpy.computeRpyJacobianInverse(v, pin.LOCAL_WORLD_ALIGNED)\n"
        "value = -B @ rpy.computeRpyJacobianTimeDerivative(v, a, pin.LOCAL_WORLD_ALIGNED) @ B",
    ),
    "spatial_inertia": Way("Inertia.matrix", f"{INERTIA}value = I.matrix()"),
    "spatial_inertia:dynamic parameters": Way(
        "toDynamicParameters, FromDynamicParameters",
        f"{INERTIA}value = pin.Inertia.FromDynamicParameters(I.toDynamicParameters()).matrix()",
    ),
    "spatial_inertia:pseudo inertia": Way(
        "toPseudoInertia, FromPseudoInertia",
        f"{INERTIA}value = pin.Inertia.FromPseudoInertia(I.toPseudoInertia()).matrix()",
    ),
    "spatial_inertia_placed": Way("Inertia.se3Action", f"{TWO}{INERTIA}value = I.se3Action(X).matrix()"),
    "spatial_inertia_placed:se3ActionInverse": Way(
        "Inertia.se3ActionInverse", f"{TWO}{INERTIA}value = I.se3ActionInverse(X.inverse()).matrix()"
    ),
    "spatial_inertia_sum": Way("Inertia + Inertia", f"{TWO}{INERTIA}value = (I + I.se3Action(X)).matrix()"),
    "spatial_momentum": Way("Inertia * Motion", f"{INERTIA}{TWIST}value = (I * V).vector"),
    "spatial_momentum_cross": Way("Inertia.vxiv", f"{INERTIA}{TWIST}value = I.vxiv(V).vector"),
    "spatial_inertia_rate": Way("Inertia.variation", f"{INERTIA}{TWIST}value = I.variation(V)"),
    "spatial_inertia_rate:vxi, ivx": Way("Inertia.vxi, ivx", f"{INERTIA}{TWIST}value = I.vxi(V) - I.ivx(V)"),
} | solids.PINOCCHIO
