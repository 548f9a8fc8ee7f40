"""DART's rotations and placements."""

from __future__ import annotations

from ...truth.geometry.poses import CENTRE, MASS, MOMENTS, SEQUENCES
from ..writing.source import HALF_TURNS, ON_END, Way, ways_of
from . import solids

IMPORTS = ("import dartpy as dart",)
_R = "R, Q = (dart.math.Quaternion(*x).to_rotation_matrix() for x in (q, q2))\n"
_X = f"{_R}X, Y = dart.math.Isometry3(R, a), dart.math.Isometry3(Q, tau)\n"
_I = f"I = dart.dynamics.Inertia({MASS}, {list(CENTRE)}, {[*map(list, MOMENTS)]})\n"
_SWAPPED = "value = np.roll({of}, (3, 3), (0, 1))"
_ANGLES = ("XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX", "XYX")


def _flat(of: str) -> str:
    return f"X = {of}\nvalue = [*X.translation(), *X.rotation().flat]"


WAYS = (
    ways_of(f"""
== rotation_matrix | Quaternion.to_rotation_matrix | {_R}value = R.ravel()
== rotation_matrix:AngleAxis | AngleAxis of a Quaternion
value = dart.math.AngleAxis(dart.math.Quaternion(*q)).to_rotation_matrix().ravel()
== rotation_matrix:quatToExp | quatToExp, expToQuat
value = dart.math.expToQuat(dart.math.quatToExp(dart.math.Quaternion(*q))).to_rotation_matrix().ravel()
== rotation_composed | Quaternion.multiply
value = dart.math.Quaternion(*q).multiply(dart.math.Quaternion(*q2)).to_rotation_matrix().ravel()
== rotation_logarithm | quatToExp | value = dart.math.quatToExp(dart.math.Quaternion(*q))
== rotation_exponential | expMapRot | value = dart.math.expMapRot(v).ravel()
== rotation_exponential:expToQuat | expToQuat | value = dart.math.expToQuat(v).to_rotation_matrix().ravel()
== rotation_exponential_of_turns | expMapRot | value = dart.math.expMapRot(16 * v).ravel()
== # Its Jacobian is of the angular velocity along the axes before.
== rotation_vector_speeds | expMapJac | value = dart.math.expMapJac(tau).T
== rotation_half_turns | Quaternion of a matrix
{HALF_TURNS}value = [dart.math.Quaternion(H).to_rotation_matrix().ravel() for H in half_turns]
== rotation_of_rpy | eulerZYXToMatrix | value = dart.math.eulerZYXToMatrix(v[::-1]).ravel()
== rotation_of_zyz | eulerZYZToMatrix | value = dart.math.eulerZYZToMatrix(v).ravel()
== rotations_on_end | matrixToEulerZYX, eulerZYXToMatrix
{ON_END}value = [dart.math.eulerZYXToMatrix(dart.math.matrixToEulerZYX(H)).ravel() for H in on_end]
== rotations_of_three_angles | euler...ToMatrix
value = [getattr(dart.math, f'euler{{s.upper()}}ToMatrix')(v).ravel() for s in {SEQUENCES}]
== rotation_to_rpy | matrixToEulerZYX | {_R}value = dart.math.matrixToEulerZYX(R)[::-1]
== are_rotations | verifyRotation
{_R}value = [float(dart.math.verifyRotation(A)) for A in (R, R * [1, 1, -1], 1.25 * R)]
== pose_composed | Isometry3.multiply | {_X}{_flat("X.multiply(Y)")}
== pose_unset | Isometry3 | {_flat("dart.math.Isometry3()")}
== pose_inverse | Isometry3.inverse | {_X}{_flat("X.inverse()")}
== pose_exponential | expMap | {_flat("dart.math.expMap(np.r_[v2, v])")}
== spatial_inertia | Inertia.getSpatialTensor | {_I}{_SWAPPED.format(of="I.getSpatialTensor()")}
== spatial_inertia_placed | Inertia.transformed | {_X}{_I}{_SWAPPED.format(of="I.transformed(X).getSpatialTensor()")}
""")
    | {
        f"rotation_matrix:matrixToEuler{one}": Way(
            f"matrixToEuler{one}, euler{one}ToMatrix",
            f"{_R}value = dart.math.euler{one}ToMatrix(dart.math.matrixToEuler{one}(R)).ravel()",
        )
        for one in _ANGLES
    }
    | solids.DART
)
