"""Exudyn's rotations, placements, Lie groups and inertias of bodies: rigidBodyUtilities and lieGroupBasics."""

from __future__ import annotations

from ...truth.geometry.poses import CENTRE, MASS, MOMENTS
from ..writing.source import HALF_TURNS, ON_END, Way, ways_of
from . import exudyn_items, solids

IMPORTS = ("from exudyn import lieGroupBasics as lie", "from exudyn import rigidBodyUtilities as rbu")
_R = "R, Q = rbu.EulerParameters2RotationMatrix(q), rbu.EulerParameters2RotationMatrix(q2)\n"
_X = f"{_R}X, Y = rbu.HomogeneousTransformation(R, a), rbu.HomogeneousTransformation(Q, tau)\n"
_SWAPPED = "value = np.roll({of}, (3, 3), (0, 1))"
_INERTIA = (
    f"I = rbu.RigidBodyInertia({MASS}, np.array({[list(row) for row in MOMENTS]}), np.array({list(CENTRE)}), True)\n"
)
_MOMENTUM = "c = I.mass * rbu.Skew(I.com)\nvalue = np.block([[I.mass * np.eye(3), -c], [c, np.array(I.inertiaTensor)]])"


def _matrix(of: str, state: str = "") -> str:
    return f"{state}value = np.ravel({of})"


def _flat(of: str) -> str:
    return f"{_X}T = {of}\nvalue = [*T[:3, 3], *T[:3, :3].flat]"


def _half_turns(of: str) -> str:
    return f"{HALF_TURNS}value = [np.ravel({of}) for H in half_turns]"


_BACK = "rbu.EulerParameters2RotationMatrix(rbu.{}(R))"
_ROTATIONS = (
    ways_of(f"""
== rotation_matrix | EulerParameters2RotationMatrix | {_matrix("R", _R)}
== rotation_matrix:RotationMatrix2EulerParameters | RotationMatrix2EulerParameters
{_matrix(_BACK.format("RotationMatrix2EulerParameters"), _R)}
== rotation_matrix:RotationMatrix2RotXYZ | RotationMatrix2RotXYZ
{_matrix("rbu.RotXYZ2RotationMatrix(rbu.RotationMatrix2RotXYZ(R))", _R)}
== rotation_matrix:RotXYZ2EulerParameters | RotXYZ2EulerParameters
{_matrix("rbu.EulerParameters2RotationMatrix(rbu.RotXYZ2EulerParameters(rbu.RotationMatrix2RotXYZ(R)))", _R)}
""")
    | {
        **{
            f"rotation_matrix:RotationMatrix2RotZYZ{number}": Way(
                "RotationMatrix2RotZYZ",
                f"{_R}x, y, z = rbu.RotationMatrix2RotZYZ(R, {flip})\n"
                "value = np.ravel(rbu.RotationMatrixZ(x) @ rbu.RotationMatrixY(y) @ rbu.RotationMatrixZ(z))",
            )
            for number, flip in (("", False), (" flipped", True))
        },
    }
    | ways_of(f"""
== rotation_composed:CompositionRuleForEulerParameters | CompositionRuleForEulerParameters
{_matrix("rbu.EulerParameters2RotationMatrix(lie.CompositionRuleForEulerParameters(q, q2))")}
== rotation_composed:CompositionRuleForRotationVectors | CompositionRuleForRotationVectors
{_R}r, s = rbu.RotationMatrix2RotationVector(R), rbu.RotationMatrix2RotationVector(Q)
value = np.ravel(lie.ExpSO3(lie.CompositionRuleForRotationVectors(r, s)))
== rotation_composed:CompositionRuleRotXYZAnglesRotationVector | CompositionRuleRotXYZAnglesRotationVector
{_R}r, s = rbu.RotationMatrix2RotXYZ(R), rbu.RotationMatrix2RotationVector(Q)
value = np.ravel(rbu.RotXYZ2RotationMatrix(lie.CompositionRuleRotXYZAnglesRotationVector(r, s)))
== rotation_logarithm | RotationMatrix2RotationVector | {_R}value = rbu.RotationMatrix2RotationVector(R)
== rotation_logarithm:LogSO3 | LogSO3 | {_R}value = rbu.Skew2Vec(lie.LogSO3(R))
== rotation_half_turns | RotationMatrix2EulerParameters
{_half_turns(_BACK.format("RotationMatrix2EulerParameters").replace("R)", "H)"))}
== rotation_half_turns:RotationMatrix2RotXYZ | RotationMatrix2RotXYZ
{_half_turns("rbu.RotXYZ2RotationMatrix(rbu.RotationMatrix2RotXYZ(H))")}
== rotation_half_turns:RotationMatrix2RotationVector | RotationMatrix2RotationVector
{_half_turns("rbu.RotationVector2RotationMatrix(rbu.RotationMatrix2RotationVector(H))")}
""")
    | {
        **{
            name: Way(native, code.format(vector))
            for function, vector in (("rotation_exponential", "v"), ("rotation_exponential_of_turns", "16 * v"))
            for name, native, code in (
                (function, "RotationVector2RotationMatrix", "value = rbu.RotationVector2RotationMatrix({}).ravel()"),
                (f"{function}:ExpSO3", "ExpSO3", "value = lie.ExpSO3({}).ravel()"),
                (f"{function}:ExpS3", "ExpS3", "value = rbu.EulerParameters2RotationMatrix(lie.ExpS3({})).ravel()"),
            )
        },
        "rotation_vector_speeds": Way("TExpSO3", "value = lie.TExpSO3(tau)"),
        "rotation_vector_rates": Way("TExpSO3Inv", "value = lie.TExpSO3Inv(tau)"),
        "quaternion_rates": Way("EulerParameters2GLocal", "value = rbu.EulerParameters2GLocal(q).T @ v / 4"),
        "quaternion_rates_fixed": Way(
            "AngularVelocity2EulerParameters_t", "value = rbu.AngularVelocity2EulerParameters_t(v, q)"
        ),
    }
)
# Its angles are about x, y, z in turn: roll, pitch, yaw of R are their negatives for R^T, which turns as R does, the
# other way round and about the axes of its own.
_ROLLED = ways_of(f"""
== rotation_of_rpy | RotXYZ2RotationMatrix | value = rbu.RotXYZ2RotationMatrix(-v).T.ravel()
== rotations_on_end | RotationMatrix2RotXYZ
{ON_END}value = [rbu.RotXYZ2RotationMatrix(rbu.RotationMatrix2RotXYZ(H.T)).T.ravel() for H in on_end]
== rotation_to_rpy | RotationMatrix2RotXYZ | {_R}value = -rbu.RotationMatrix2RotXYZ(R.T)
== rpy_rates | RotXYZ2GLocal | value = np.linalg.inv(rbu.RotXYZ2GLocal(-v))
== rpy_rates:RotXYZ2G | RotXYZ2G | value = np.linalg.inv(rbu.RotXYZ2RotationMatrix(-v).T @ rbu.RotXYZ2G(-v))
== rpy_rates:AngularVelocity2RotXYZ_t | AngularVelocity2RotXYZ_t
R = rbu.RotXYZ2RotationMatrix(-v)
value = np.stack([rbu.AngularVelocity2RotXYZ_t(R @ e, -v) for e in np.eye(3)], axis=1)
== rpy_rates_rate | RotXYZ2GLocal_t
B = np.linalg.inv(rbu.RotXYZ2GLocal(-v))
value = -B @ rbu.RotXYZ2GLocal_t(-v, -a) @ B
== rpy_rates_rate:RotXYZ2G_t | RotXYZ2G_t
R, G = rbu.RotXYZ2RotationMatrix(-v), rbu.RotXYZ2G(-v)
B = np.linalg.inv(R.T @ G)
turning = R.T @ rbu.RotXYZ2G_t(-v, -a) - rbu.Skew(R.T @ G @ -a) @ R.T @ G
value = -B @ turning @ B
== rotation_of_zyz | RotationMatrixZ, RotationMatrixY
value = (rbu.RotationMatrixZ(v[0]) @ rbu.RotationMatrixY(v[1]) @ rbu.RotationMatrixZ(v[2])).ravel()
""")
_PLACEMENTS = ways_of(f"""
== pose_composed | HomogeneousTransformation | {_flat("X @ Y")}
== pose_composed:T66 | RotationTranslation2T66, T66toHT
{_flat("rbu.T66toHT(rbu.RotationTranslation2T66(R, a) @ rbu.RotationTranslation2T66(Q, tau))")}
== pose_composed:InverseT66toRotationTranslation | InverseT66toRotationTranslation
{_X}T, r = rbu.InverseT66toRotationTranslation(rbu.HT2T66Inverse(X @ Y))
value = [*r, *T.flat]
== pose_inverse | InverseHT | {_flat("rbu.InverseHT(X)")}
== pose_relative | InverseHT | {_flat("rbu.InverseHT(X) @ Y")}
== pose_logarithm | LogSE3 | {_X}T = lie.LogSE3(X)\nvalue = [*T[:3, 3], *rbu.Skew2Vec(T[:3, :3])]
== pose_exponential | ExpSE3 | T = lie.ExpSE3(np.r_[v, v2])\nvalue = [*T[:3, 3], *T[:3, :3].flat]
== pose_exponential_speeds | TExpSE3 | value = lie.TExpSE3(np.r_[v, v2])
== pose_logarithm_rates | TExpSE3Inv
{_X}T = lie.LogSE3(X)
value = lie.TExpSE3Inv(np.r_[T[:3, 3], rbu.Skew2Vec(T[:3, :3])])
== twist_transform | RotationTranslation2T66 | {_R}{_SWAPPED.format(of="rbu.RotationTranslation2T66(R, a)")}
== twist_transform_back | RotationTranslation2T66Inverse
{_R}{_SWAPPED.format(of="rbu.RotationTranslation2T66Inverse(R, a)")}
== twist_transform_back:T66Inverse | T66Inverse
{_R}{_SWAPPED.format(of="rbu.T66Inverse(rbu.RotationTranslation2T66(R, a))")}
== twist_transform_back:HT2T66Inverse | HT2T66Inverse | {_X}{_SWAPPED.format(of="rbu.HT2T66Inverse(X)")}
== spatial_inertia | RigidBodyInertia | {_INERTIA}{_MOMENTUM}
== spatial_inertia_placed | RigidBodyInertia.Transformed | {_X}{_INERTIA}I = I.Transformed(X)\n{_MOMENTUM}
== spatial_inertia_sum | RigidBodyInertia + | {_X}{_INERTIA}I = I.Transformed(X) + I\n{_MOMENTUM}
== spatial_inertia_sum:+= | RigidBodyInertia += | {_X}{_INERTIA}K = I.Transformed(X)\nI += K\n{_MOMENTUM}
""")
_TREES = "from exudyn import kinematicTree as kt\n"
_BODY66 = f"{_TREES}A = kt.MassCOMinertia2T66({MASS}, {list(CENTRE)}, np.array({[list(row) for row in MOMENTS]}))\n"
_TURNED = "value = [np.ravel({of}(x){part}) for {of}, x in zip(({names}), v)]"


def _elementary(names: str, part: str = "") -> Way:
    listed = ", ".join(f"rbu.{name}" for name in names.split(", "))
    return Way(names, _TURNED.format(of="turned", part=part, names=listed))


def _semidirect(parameters: str, make: str, back: str) -> Way:
    """X Y by the rule for a set of parameters, with the twist that leads along Y."""
    rule = f"CompositionRuleSemiDirectProductR3And{parameters}"
    return Way(
        rule,
        f"{_X}T = lie.LogSE3(Y)\nx = lie.{rule}(np.r_[a, {make}], np.r_[T[:3, 3], rbu.Skew2Vec(T[:3, :3])])\n"
        f"value = [*x[:3], *rbu.{back}(x[3:]).flat]",
    )


_MORE = {
    "quaternion_rates:EulerParameters2G": Way(
        "EulerParameters2G", f"{_R}value = rbu.EulerParameters2G(q).T @ R @ v / 4"
    ),
    "rotations_elementary": _elementary("RotationMatrixX, RotationMatrixY, RotationMatrixZ"),
    "rotations_elementary:T66": _elementary("RotationX2T66, RotationY2T66, RotationZ2T66", "[:3, :3]"),
    "rotations_elementary:T66, moments": _elementary("RotationX2T66, RotationY2T66, RotationZ2T66", "[3:, 3:]"),
    "rotation_exponential:ExpR3xSO3": Way(
        "ExpR3xSO3", "value = lie.R3xSO3Matrix2RotationMatrix(lie.ExpR3xSO3(np.r_[a, v])).ravel()"
    ),
    "rotation_vector_speeds:TExpR3xSO3": Way("TExpR3xSO3", "value = lie.TExpR3xSO3(np.r_[a, tau])[3:, 3:]"),
    "rotation_vector_rates:TExpR3xSO3Inv": Way("TExpR3xSO3Inv", "value = lie.TExpR3xSO3Inv(np.r_[a, tau])[3:, 3:]"),
    "pose_composed:S3": _semidirect("S3", "q", "EulerParameters2RotationMatrix"),
    "pose_composed:R3RotVec": _semidirect(
        "R3RotVec", "rbu.RotationMatrix2RotationVector(R)", "RotationVector2RotationMatrix"
    ),
    "pose_composed:R3RotXYZAngles": _semidirect(
        "R3RotXYZAngles", "rbu.RotationMatrix2RotXYZ(R)", "RotXYZ2RotationMatrix"
    ),
    "twist_cross": Way("CRM", f"{_TREES}{_SWAPPED.format(of='kt.CRM(np.r_[v2, v])')}"),
    "spatial_inertia:MassCOMinertia2T66": Way("MassCOMinertia2T66", _BODY66 + _SWAPPED.format(of="A")),
    "spatial_inertia:Inertia2T66": Way("Inertia2T66", _TREES + _INERTIA + _SWAPPED.format(of="kt.Inertia2T66(I)")),
    "spatial_inertia:Inertia66toMassCOMinertia": Way(
        "Inertia66toMassCOMinertia",
        _BODY66 + _SWAPPED.format(of="kt.MassCOMinertia2T66(*kt.Inertia66toMassCOMinertia(A))"),
    ),
    "spatial_momentum": Way("MassCOMinertia2T66", f"{_BODY66}value = np.roll(A @ np.r_[v2, v], 3)"),
    "spatial_momentum_cross": Way("CRF", f"{_BODY66}u = np.r_[v2, v]\nvalue = np.roll(kt.CRF(u) @ A @ u, 3)"),
    **{
        f"moments_cylinder:along {axis}": Way(
            f"InertiaCylinder, axis {k}",
            f"x = np.abs(v) + 0.5\nI = rbu.InertiaCylinder({MASS} / (np.pi * x[0] ** 2 * x[1]), x[1], x[0], {k})\n"
            f"value = np.roll(np.diag(I.inertiaTensor), {2 - k})",
        )
        for k, axis in enumerate("xy")
    },
}
WAYS = _ROTATIONS | _ROLLED | _PLACEMENTS | solids.EXUDYN | _MORE | exudyn_items.WAYS
