"""Drake's rotations, placements and spatial algebra."""

from __future__ import annotations

from ...truth.geometry.poses import CENTRE, MASS, MOMENTS
from ..writing.source import HALF_TURNS, ON_END, Way, ways_of
from . import solids

IMPORTS = ("import numpy as np", "import pydrake.all as drake")
_R = "R, Q = (drake.RotationMatrix(drake.Quaternion(x)) for x in (q, q2))\n"
_X = "X, Y = drake.RigidTransform(drake.Quaternion(q), a), drake.RigidTransform(drake.Quaternion(q2), tau)\n"
# Angular parts come first.
_V = "V = drake.SpatialVelocity(w=v2, v=v)\n"
_I = (
    f"J = drake.RotationalInertia({', '.join(repr(MOMENTS[k][k]) for k in range(3))}, "
    f"{MOMENTS[0][1]!r}, {MOMENTS[0][2]!r}, {MOMENTS[1][2]!r})\n"
    f"I = drake.SpatialInertia.MakeFromCentralInertia({MASS}, {list(CENTRE)}, J)\n"
)
_SWAPPED = "value = np.roll({of}, (3, 3), (0, 1))"


# Numbers with derivatives: of R along its angular velocity, of a vector by itself.
_AD = """from pydrake.autodiffutils import AutoDiffXd as AD, ExtractGradient, InitializeAutoDiff
from pydrake.common.eigen_geometry import AngleAxis_, Quaternion_
from pydrake.math import RollPitchYaw_, RotationMatrix_
"""
_SEEDED = f"""{_AD}w, x, y, z = q
N = np.array([[-x, -y, -z], [w, -z, y], [z, w, -x], [-y, x, w]]) / 2
Q = Quaternion_[AD](wxyz=InitializeAutoDiff(q, N).flatten())
R = RotationMatrix_[AD](Q)
"""
_U = f"{_AD}u = InitializeAutoDiff(v + [4, -8, 8], np.eye(3)).flatten()\nlength = np.sqrt(u.dot(u))\n"


def _along(of: str) -> str:
    return f"{_SEEDED}value = ExtractGradient(np.ravel({of}))"


def _by_vector(of: str) -> str:
    return f"{_U}value = ExtractGradient(np.ravel({of}))"


_AGAIN = "RotationMatrix_[AD](R.{}()).matrix()"
_DERIVATIVES = ways_of(f"""
== rotation_matrix_dq | RotationMatrix, AutoDiffXd | {_along("R.matrix()")}
== rotation_matrix_dq:ToQuaternion | ToQuaternion, AutoDiffXd | {_along(_AGAIN.format("ToQuaternion"))}
== rotation_matrix_dq:ToRollPitchYaw | ToRollPitchYaw, AutoDiffXd | {_along(_AGAIN.format("ToRollPitchYaw"))}
== rotation_to_rpy_dq | RollPitchYaw, AutoDiffXd | {_along("RollPitchYaw_[AD](R).vector()")}
== rotation_to_rpy_dq:Quaternion | RollPitchYaw of a Quaternion, AutoDiffXd | {_along("RollPitchYaw_[AD](Q).vector()")}
== rotation_of_rpy_du | RollPitchYaw, AutoDiffXd | {_by_vector("RollPitchYaw_[AD](u).ToRotationMatrix().matrix()")}
== rotation_of_rpy_du:ToQuaternion | RollPitchYaw.ToQuaternion, AutoDiffXd
{_by_vector("RotationMatrix_[AD](RollPitchYaw_[AD](u).ToQuaternion()).matrix()")}
== rotation_exponential_du | RotationMatrix of an AngleAxis, AutoDiffXd
{_by_vector("RotationMatrix_[AD](AngleAxis_[AD](length, u / length)).matrix()")}
""") | {
    **{
        name: Way(
            "MakeFromOneVector, AutoDiffXd",
            _by_vector(f"RotationMatrix_[AD].MakeFromOneVector(u, {k}).matrix()[:, {k}]"),
        )
        for k, name in enumerate(("unit_vector_du", "unit_vector_du:about y", "unit_vector_du:about z"))
    },
}


def _flat(of: str) -> str:
    return f"X = {of}\nvalue = [*X.translation(), *X.rotation().matrix().flat]"


# A body that is free, and what reads where it stands.
_FREE = f"""{_X}p = drake.MultibodyPlant(0.0)
b = p.AddRigidBody('b', drake.SpatialInertia(1.0, np.zeros(3), drake.UnitInertia(1.0, 1.0, 1.0)))
"""
_DONE = "p.Finalize()\nc = p.CreateDefaultContext()\n"
_STANDS = "p.EvalBodyPoseInWorld(c, b)"
_STANDING = _flat(f"{_STANDS}.inverse()")
_JOINED = "j = p.AddJoint(drake.{}Joint('j', p.world_frame(), b.body_frame()))\n"
_FRAME = "F = p.AddFrame(drake.FixedOffsetFrame('F', p.world_frame(), X))\n"
_PLACED = ways_of(f"""
== pose_inverse:SetFreeBodyPose | SetFreeBodyPose | {_FREE}{_DONE}p.SetFreeBodyPose(c, b, X)\n{_STANDING}
== pose_inverse:default | SetDefaultFreeBodyPose | {_FREE}p.SetDefaultFreeBodyPose(b, X)\n{_DONE}{_STANDING}
== pose_inverse:default after Finalize | SetDefaultFreeBodyPose after Finalize
{_FREE}p.Finalize()
p.SetDefaultFreeBodyPose(b, X)
c = p.CreateDefaultContext()
{_STANDING}
== pose_inverse:RpyFloatingJoint | RpyFloatingJoint.SetPose
{_FREE}{_JOINED.format("RpyFloating")}{_DONE}j.SetPose(c, X)
{_STANDING}
== pose_inverse:QuaternionFloatingJoint | QuaternionFloatingJoint.SetPose
{_FREE}{_JOINED.format("QuaternionFloating")}{_DONE}j.SetPose(c, X)
{_STANDING}
== pose_inverse:SetDefaultPose | Joint.SetDefaultPose
{_FREE}{_JOINED.format("RpyFloating")}j.SetDefaultPose(X)
{_DONE}{_STANDING}
== pose_inverse:default of a floating base | SetDefaultFloatingBaseBodyPose after Finalize
{_FREE}p.Finalize()
p.SetDefaultFloatingBaseBodyPose(b, X)
c = p.CreateDefaultContext()
{_STANDING}
== pose_inverse:SetFloatingBaseBodyPoseInWorldFrame | SetFloatingBaseBodyPoseInWorldFrame
{_FREE}{_DONE}p.SetFloatingBaseBodyPoseInWorldFrame(c, b, X)
{_STANDING}
== pose_inverse:WeldJoint | WeldFrames | {_FREE}p.WeldFrames(p.world_frame(), b.body_frame(), X)\n{_DONE}{_STANDING}
""")
_PLACED |= ways_of(f"""
== pose_inverse:GetFreeBodyPose | GetFreeBodyPose
{_FREE}{_DONE}p.SetFreeBodyPose(c, b, X)
{_flat("p.GetFreeBodyPose(c, b).inverse()")}
== pose_inverse:GetDefaultFreeBodyPose | GetDefaultFreeBodyPose
{_FREE}p.SetDefaultFreeBodyPose(b, X)
p.Finalize()
{_flat("p.GetDefaultFreeBodyPose(b).inverse()")}
== pose_inverse:GetPose | RpyFloatingJoint.GetPose
{_FREE}{_JOINED.format("RpyFloating")}{_DONE}j.SetPose(c, X)
{_flat("j.GetPose(c).inverse()")}
== pose_composed:FixedOffsetFrame | FixedOffsetFrame of a FixedOffsetFrame
{_FREE}{_FRAME}G = p.AddFrame(drake.FixedOffsetFrame('G', F, Y))
{_DONE}{_flat("G.CalcPoseInWorld(c)")}
== pose_composed:GetFixedPoseInBodyFrame | GetFixedPoseInBodyFrame of a FixedOffsetFrame of another
{_FREE}F = p.AddFrame(drake.FixedOffsetFrame('F', b.body_frame(), X))
G = p.AddFrame(drake.FixedOffsetFrame('G', F, Y))
{_DONE}{_flat("G.GetFixedPoseInBodyFrame()")}
== pose_composed:WeldFrames | WeldFrames on a FixedOffsetFrame
{_FREE}{_FRAME}p.WeldFrames(F, b.body_frame(), Y)
{_DONE}{_flat(_STANDS)}
== pose_composed:child frame | WeldFrames of a FixedOffsetFrame of the child
{_FREE}G = p.AddFrame(drake.FixedOffsetFrame('G', b.body_frame(), Y.inverse()))
p.WeldFrames(p.world_frame(), G, X)
{_DONE}{_flat(_STANDS)}
== pose_composed:AddJoint | AddJoint with frames on parent and child
{_FREE}j = p.AddJoint(drake.WeldJoint('j', p.AddFrame(drake.FixedOffsetFrame('F', p.world_frame(), X)), \
p.AddFrame(drake.FixedOffsetFrame('G', b.body_frame(), Y.inverse())), drake.RigidTransform()))
{_DONE}{_flat(_STANDS)}
== pose_composed:SetFreeBodyPoseInAnchoredFrame | SetFloatingBaseBodyPoseInAnchoredFrame
{_FREE}{_FRAME}{_DONE}p.SetFloatingBaseBodyPoseInAnchoredFrame(c, F, b, Y)
{_flat(_STANDS)}
== pose_composed:SetPoseInParentFrame | FixedOffsetFrame.SetPoseInParentFrame
{_FREE}F = p.AddFrame(drake.FixedOffsetFrame('F', p.world_frame(), Y))
G = p.AddFrame(drake.FixedOffsetFrame('G', F, Y))
{_DONE}F.SetPoseInParentFrame(c, X)
{_flat("G.CalcPoseInWorld(c)")}
== pose_composed:GetAsMatrix4 | RigidTransform.GetAsMatrix4
{_X}A = X.GetAsMatrix4() @ Y.GetAsMatrix4()
value = [*A[:3, 3], *A[:3, :3].flat]
== pose_composed:GetAsMatrix34 | RigidTransform of a matrix, GetAsMatrix34
{_X}A = drake.RigidTransform((X @ Y).GetAsMatrix34()).GetAsMatrix4()
value = [*A[:3, 3], *A[:3, :3].flat]
""")
WAYS = (
    (
        ways_of(f"""
== rotation_matrix | RotationMatrix of a Quaternion | {_R}value = R.matrix().ravel()
== rotation_matrix:ToQuaternion | RotationMatrix.ToQuaternion
{_R}value = drake.RotationMatrix(R.ToQuaternion()).matrix().ravel()
== rotation_matrix:ToAngleAxis | RotationMatrix.ToAngleAxis
{_R}value = drake.RotationMatrix(R.ToAngleAxis()).matrix().ravel()
== rotation_matrix:ToRollPitchYaw | RotationMatrix.ToRollPitchYaw
{_R}value = drake.RotationMatrix(R.ToRollPitchYaw()).matrix().ravel()
== rotation_matrix:Quaternion.ToRollPitchYaw | RollPitchYaw of a Quaternion
value = drake.RollPitchYaw(drake.Quaternion(q)).ToRotationMatrix().matrix().ravel()
== rotation_composed | RotationMatrix.multiply | {_R}value = (R @ Q).matrix().ravel()
== rotation_composed:Quaternion | Quaternion.multiply
value = drake.Quaternion(q).multiply(drake.Quaternion(q2)).rotation().ravel()
== rotation_cost | OrientationCost
{_R}p = drake.MultibodyPlant(0.0)
b = p.AddRigidBody('b', drake.SpatialInertia(1.0, np.zeros(3), drake.UnitInertia(1.0, 1.0, 1.0))).body_frame()
p.Finalize()
c, none = p.CreateDefaultContext(), drake.RotationMatrix()
value = 1 + drake.OrientationCost(p, p.world_frame(), R, b, none, 2.0, c).Eval([*q2, 0, 0, 0])
== rotation_angle | RotationMatrix.InvertAndCompose | {_R}value = [R.InvertAndCompose(Q).ToAngleAxis().angle()]
== rotation_logarithm | ToAngleAxis | {_R}x = R.ToAngleAxis()\nvalue = x.angle() * x.axis()
== rotation_exponential | AngleAxis
n = np.linalg.norm(v)
value = drake.AngleAxis(n, v / n if n else np.eye(3)[0]).rotation().ravel()
""")
        | {
            **_DERIVATIVES,
        }
        | ways_of(f"""
== rotation_half_turns | ToQuaternion
{HALF_TURNS}value = [drake.RotationMatrix(H).ToQuaternion().rotation().ravel() for H in half_turns]
== rotation_half_turns:ToAngleAxis | ToAngleAxis
{HALF_TURNS}value = [drake.RotationMatrix(H).ToAngleAxis().rotation().ravel() for H in half_turns]
== rotation_half_turns:ToRollPitchYaw | ToRollPitchYaw
{HALF_TURNS}value = [drake.RollPitchYaw(drake.RotationMatrix(H)).ToRotationMatrix().matrix().ravel() for H in \
half_turns]
== rotation_halfway | Quaternion.slerp
value = drake.Quaternion(q).slerp(0.25, drake.Quaternion(q2)).rotation().ravel()
== rotation_of_rpy | RollPitchYaw | value = drake.RollPitchYaw(v).ToRotationMatrix().matrix().ravel()
== rotation_of_rpy:ToQuaternion | RollPitchYaw.ToQuaternion
value = drake.RollPitchYaw(v).ToQuaternion().rotation().ravel()
== rotations_on_end | RollPitchYaw of a RotationMatrix
{ON_END}value = [drake.RollPitchYaw(drake.RotationMatrix(H)).ToRotationMatrix().matrix().ravel() for H in on_end]
== quaternion_rates | CalculateQuaternionDtFromAngularVelocityExpressedInB
from pydrake.math import CalculateQuaternionDtFromAngularVelocityExpressedInB as rates
value = rates(drake.Quaternion(q), v)
== rpy_rates:CalcAngularVelocityInChildFromRpyDt | CalcAngularVelocityInChildFromRpyDt
A = drake.RollPitchYaw(v)
R = A.ToRotationMatrix().matrix()
value = np.linalg.inv(np.stack([R @ A.CalcAngularVelocityInChildFromRpyDt(e) for e in np.eye(3)], axis=1))
== rotation_matrix:ProjectToRotationMatrix | RotationMatrix.ProjectToRotationMatrix
{_R}value = drake.RotationMatrix.ProjectToRotationMatrix(2 * R.matrix()).matrix().ravel()
== rotation_to_rpy | RollPitchYaw | {_R}value = drake.RollPitchYaw(R).vector()
== rpy_rates | CalcRpyDtFromAngularVelocityInParent
A = drake.RollPitchYaw(v)
value = np.stack([A.CalcRpyDtFromAngularVelocityInParent(e) for e in np.eye(3)], axis=1)
== rpy_rates:CalcAngularVelocityInParentFromRpyDt | CalcAngularVelocityInParentFromRpyDt
A = drake.RollPitchYaw(v)
value = np.linalg.inv(np.stack([A.CalcAngularVelocityInParentFromRpyDt(e) for e in np.eye(3)], axis=1))
== rpy_second_rates | CalcRpyDDtFromRpyDtAndAngularAccelInParent
value = drake.RollPitchYaw(v).CalcRpyDDtFromRpyDtAndAngularAccelInParent(a, tau)
== rpy_second_rates:CalcRpyDDtFromAngularAccelInChild | CalcRpyDDtFromAngularAccelInChild
A = drake.RollPitchYaw(v)
R = A.ToRotationMatrix().matrix()
value = A.CalcRpyDDtFromAngularAccelInChild(a, R.T @ tau)
== rotation_matrix_rate_of_rpy | CalcRotationMatrixDt | value = drake.RollPitchYaw(v).CalcRotationMatrixDt(a).ravel()
== rpy_rates:InChild | CalcRpyDtFromAngularVelocityInChild
A = drake.RollPitchYaw(v)
R = A.ToRotationMatrix().matrix()
value = np.stack([A.CalcRpyDtFromAngularVelocityInChild(R.T @ e) for e in np.eye(3)], axis=1)
== are_rotations | RotationMatrix.IsValid
{_R}R = R.matrix()
every = (drake.RotationMatrix.MakeUnchecked(A) for A in (R, R * [1, 1, -1], 1.25 * R))
value = [float(A.IsValid()) for A in every]
== pose_composed | RigidTransform.multiply | {_X}{_flat("X @ Y")}
== pose_unset | RigidTransform | {_flat("drake.RigidTransform()")}
== pose_inverse | RigidTransform.inverse | {_X}{_flat("X.inverse()")}
== pose_relative | RigidTransform.InvertAndCompose | {_X}{_flat("X.InvertAndCompose(Y)")}
== pose_of_point | RigidTransform.multiply | {_X}value = X.multiply(p_BoQ_B=v)
== wrench_transform | SpatialForce.Shift, Rotate
{_X}F = [drake.SpatialForce(tau=e[3:], f=e[:3]).Rotate(X.rotation()).Shift(-a) for e in np.eye(6)]
value = np.stack([[*f.translational(), *f.rotational()] for f in F], axis=1)
== twist_transform | SpatialVelocity.Shift, Rotate
{_X}F = [drake.SpatialVelocity(w=e[3:], v=e[:3]).Rotate(X.rotation()).Shift(-a) for e in np.eye(6)]
value = np.stack([[*f.translational(), *f.rotational()] for f in F], axis=1)
== spatial_inertia | SpatialInertia | {_I}{_SWAPPED.format(of="I.CopyToFullMatrix6()")}
== spatial_inertia_placed | SpatialInertia.ReExpress, Shift
{_X}{_I}{_SWAPPED.format(of="I.ReExpress(X.rotation()).Shift(-a).CopyToFullMatrix6()")}
== spatial_inertia_sum | SpatialInertia +=
{_X}{_I}K = I.ReExpress(X.rotation()).Shift(-a)
K += I
{_SWAPPED.format(of="K.CopyToFullMatrix6()")}
== spatial_momentum | SpatialInertia * SpatialVelocity
{_I}{_V}L = I * V
value = [*L.translational(), *L.rotational()]
""")
    )
    | _PLACED
    | solids.DRAKE
)
