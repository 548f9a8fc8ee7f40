"""What Pinocchio offers of placements: SE3, its exponentials, spatial vectors and inertias."""

from __future__ import annotations

from ...truth.geometry.poses import BACK, CENTRE, MASS, MOMENTS
from ..turns import solids
from ..writing.source import ON_END, Way, ways_of

# Placements X and Y, the twist, the body; columns of what is done to unit vectors; what a placement is answered as.
TWO = "X, Y = pin.SE3(pin.Quaternion(q).matrix(), a), pin.SE3(pin.Quaternion(q2).matrix(), tau)\n"
TWIST = "V = pin.Motion(v, v2)\n"
INERTIA = f"I = pin.Inertia({MASS}, np.array({list(CENTRE)}), np.array({[*map(list, MOMENTS)]}))\n"
_OF_Z = "value = pin.Quaternion.FromTwoVectors(np.eye(3)[2], {u}).matrix().ravel()"
EYE = "np.stack([{of}.vector for e in np.eye(6)], axis=1)"


FLAT = "X = {of}\nvalue = [*X.translation, *X.rotation.flat]"


def _flat(of: str) -> str:
    return FLAT.format(of=of)


WAYS = (
    ways_of(f"""
== pose_composed | SE3 * SE3 | {TWO}{_flat("X * Y")}
== pose_composed:act | SE3.act | {TWO}{_flat("X.act(Y)")}
== pose_inverse | SE3.inverse | {TWO}{_flat("X.inverse()")}
== pose_relative | SE3.actInv | {TWO}{_flat("X.actInv(Y)")}
== pose_of_point | SE3.act | {TWO}value = X.act(v)
== pose_logarithm | log6 | {TWO}value = pin.log6(X).vector
== pose_logarithm:matrix | log6 of a matrix | {TWO}value = pin.log6(X.homogeneous).vector
== pose_logarithm:quaternion | log6_quat | value = pin.log6_quat(np.r_[a, q]).vector
== pose_difference | log6 of actInv | {TWO}value = pin.log6(X.actInv(Y)).vector
== pose_difference:liegroups | liegroups.SE3.difference
value = pin.liegroups.SE3().difference(np.r_[a, q], np.r_[tau, q2])
== pose_exponential | exp6 | {TWIST}{_flat("pin.exp6(V)")}
== pose_exponential:quaternion | exp6_quat | {_flat("pin.XYZQUATToSE3(pin.exp6_quat(np.r_[v, v2]))")}
== pose_halfway | SE3.Interpolate | {TWO}{_flat("pin.SE3.Interpolate(X, Y, 0.25)")}
== pose_exponential_speeds | Jexp6 | {TWIST}value = pin.Jexp6(V)
== pose_logarithm_rates | Jlog6 | {TWO}value = pin.Jlog6(X)
== twist_transform:Motion | SE3.act of motions | {TWO}value = {EYE.format(of="X.act(pin.Motion(e))")}
== wrench_transform | SE3.dualAction | {TWO}value = X.dualAction
== wrench_transform:Force | SE3.act of forces | {TWO}value = {EYE.format(of="X.act(pin.Force(e))")}
== twist_transform_back | SE3.actionInverse | {TWO}value = X.actionInverse
== twist_transform_back:Motion | SE3.actInv of motions | {TWO}value = {EYE.format(of="X.actInv(pin.Motion(e))")}
== twist_cross | Motion.action | {TWIST}value = V.action
== twist_cross:cross | Motion.cross | {TWIST}value = {EYE.format(of="V.cross(pin.Motion(e))")}
== rotation_of_rpy | rpy.rpyToMatrix | from pinocchio import rpy\nvalue = rpy.rpyToMatrix(v).ravel()
== rotations_on_end | rpy.matrixToRpy
from pinocchio import rpy
{ON_END}value = [rpy.rpyToMatrix(rpy.matrixToRpy(H)).ravel() for H in on_end]
== rotation_of_z | Quaternion.FromTwoVectors | {_OF_Z.format(u="v + [4.0, -8.0, 8.0]")}
""")
    | {
        "rotation_of_z_back": Way("Quaternion.FromTwoVectors", _OF_Z.format(u=f"v / 64 + {list(BACK)}")),
    }
    | ways_of(f"""
== rotation_matrix | Quaternion.toRotationMatrix | value = pin.Quaternion(q).toRotationMatrix().ravel()
== rotation_exponential:exp3_quat | exp3_quat | value = pin.Quaternion(pin.exp3_quat(v)).toRotationMatrix().ravel()
== rotation_logarithm:AngleAxis | AngleAxis of a matrix
x = pin.AngleAxis(pin.Quaternion(q).matrix())
value = x.angle * x.axis
== rotation_to_rpy | rpy.matrixToRpy | from pinocchio import rpy\nvalue = rpy.matrixToRpy(pin.Quaternion(q).matrix())
== rpy_rates:computeRpyJacobian | rpy.computeRpyJacobian
from pinocchio import rpy
value = np.linalg.inv(rpy.computeRpyJacobian(v, pin.LOCAL_WORLD_ALIGNED))
== rpy_rates_rate | rpy.computeRpyJacobianTimeDerivative
from pinocchio import rpy
B = rpy.computeRpyJacobianInverse(v, pin.LOCAL_WORLD_ALIGNED)
value = -B @ rpy.computeRpyJacobianTimeDerivative(v, a, pin.LOCAL_WORLD_ALIGNED) @ B
== spatial_inertia | Inertia.matrix | {INERTIA}value = I.matrix()
== spatial_inertia:dynamic parameters | toDynamicParameters, FromDynamicParameters
{INERTIA}value = pin.Inertia.FromDynamicParameters(I.toDynamicParameters()).matrix()
== spatial_inertia:pseudo inertia | toPseudoInertia, FromPseudoInertia
{INERTIA}value = pin.Inertia.FromPseudoInertia(I.toPseudoInertia()).matrix()
== spatial_inertia_placed | Inertia.se3Action | {TWO}{INERTIA}value = I.se3Action(X).matrix()
== spatial_inertia_placed:se3ActionInverse | Inertia.se3ActionInverse
{TWO}{INERTIA}value = I.se3ActionInverse(X.inverse()).matrix()
== spatial_inertia_sum | Inertia + Inertia | {TWO}{INERTIA}value = (I + I.se3Action(X)).matrix()
== spatial_momentum | Inertia * Motion | {INERTIA}{TWIST}value = (I * V).vector
== spatial_momentum_cross | Inertia.vxiv | {INERTIA}{TWIST}value = I.vxiv(V).vector
== spatial_inertia_rate | Inertia.variation | {INERTIA}{TWIST}value = I.variation(V)
== spatial_inertia_rate:vxi, ivx | Inertia.vxi, ivx | {INERTIA}{TWIST}value = I.vxi(V) - I.ivx(V)
""")
) | solids.PINOCCHIO
