"""MuJoCo's rotations: its functions of quaternions, vectors and matrices."""

from __future__ import annotations

from ...interface import Slot
from ...truth.geometry.poses import BACK, SEQUENCES
from ...truth.geometry.solutions import BOX
from ..turns import solids
from ..writing.source import HALF_TURNS, Source, Way, ways_of

_MATRIX = "value = np.zeros(9)\nmj.mju_quat2Mat(value, {of})"
_QUATERNION = "x = np.zeros(4)\n"
_HALF = "u = v + np.array([4.0, -8.0, 8.0])\nH = 2 * np.outer(u, u) / (u @ u) - np.eye(3)\n"
# The vector's length and direction, of which mju_axisAngle2Quat takes each.
_LENGTH = "r = {of}\nangle = np.linalg.norm(r)\naxis = r / angle if angle else np.array([1.0, 0, 0])\n"
_BY_AXIS = f"{_LENGTH}{_QUATERNION}mj.mju_axisAngle2Quat(x, axis, angle)\n{_MATRIX.format(of='x')}"
_INTEGRATED = f"x = np.array([1.0, 0, 0, 0])\nmj.mju_quatIntegrate(x, {{of}}, 1.0)\n{_MATRIX.format(of='x')}"
_OF_TAU = _LENGTH.format(of="tau") + f"{_QUATERNION}mj.mju_axisAngle2Quat(x, axis, angle)\n"
_D = "value = np.zeros((3, 3))\n"
_POSED = f"p, R = np.zeros(3), np.zeros(9)\n{_QUATERNION}mj.{{call}}\nmj.mju_quat2Mat(R, x)\nvalue = [*p, *R]"
_SEQUENCES = (
    f"{_QUATERNION}value = np.zeros((12, 9))\nfor row, order in zip(value, {SEQUENCES}):\n"
    "    mj.mju_euler2Quat(x, {angles}, {axes})\n    mj.mju_quat2Mat(row, x)"
)
_OF_Z = f"{_QUATERNION}mj.mju_quatZ2Vec(x, {{u}})\n{_MATRIX.format(of='x')}"
# Its iterations end by thresholds that know nothing of the problem's size, which goes down to 2^-27.
_STOPPED = 1e-4
WAYS = (
    ways_of(f"""
== rotation_matrix | mju_quat2Mat | {_MATRIX.format(of="q")}
== rotation_matrix:mju_rotVecQuat | mju_rotVecQuat
value = np.zeros((3, 3))
for column, unit in zip(value, np.eye(3)): mj.mju_rotVecQuat(column, unit, q)
value = value.T.ravel()
== rotation_matrix:mju_mat2Quat | mju_mat2Quat
R = np.zeros(9)
mj.mju_quat2Mat(R, q)
{_QUATERNION}mj.mju_mat2Quat(x, R)
{_MATRIX.format(of="x")}
== # Of a matrix that is scaled, the nearest rotation; it stops where a step would turn by less than 1e-9.
== rotation_matrix:mju_mat2Rot ~ 2e-09 | mju_mat2Rot
R = np.zeros(9)
mj.mju_quat2Mat(R, q)
x = np.array([1.0, 0, 0, 0])
for _ in range(9): mj.mju_mat2Rot(x, 2 * R)
{_MATRIX.format(of="x")}
== rotation_composed | mju_mulQuat | {_QUATERNION}mj.mju_mulQuat(x, q, q2)\n{_MATRIX.format(of="x")}
== rotation_composed:mju_mulPose | mju_mulPose
{_QUATERNION}mj.mju_mulPose(np.zeros(3), x, a, q, v, q2)
{_MATRIX.format(of="x")}
== rotation_angle | mju_subQuat | r = np.zeros(3)\nmj.mju_subQuat(r, q, q2)\nvalue = [np.linalg.norm(r)]
== rotation_logarithm | mju_quat2Vel | value = np.zeros(3)\nmj.mju_quat2Vel(value, q if q[0] > 0 else -q, 1.0)
== rotation_logarithm:longer | mju_quat2Vel | value = np.zeros(3)\nmj.mju_quat2Vel(value, -q, 1.0)
== rotation_logarithm:mju_subQuat | mju_subQuat
value = np.zeros(3)
mj.mju_subQuat(value, q, np.array([1.0, 0, 0, 0]))
== rotation_exponential | mju_quatIntegrate | {_INTEGRATED.format(of="v")}
== rotation_exponential:mju_axisAngle2Quat | mju_axisAngle2Quat | {_BY_AXIS.format(of="v")}
== rotation_exponential_of_turns | mju_quatIntegrate | {_INTEGRATED.format(of="16 * v")}
== rotation_half_turn | mju_mat2Quat | {_HALF}{_QUATERNION}mj.mju_mat2Quat(x, H.ravel())\n{_MATRIX.format(of="x")}
== rotation_half_turns | mju_mat2Quat
{HALF_TURNS}value, x = np.zeros((len(half_turns), 9)), np.zeros(4)
for row, H in zip(value, half_turns):
    mj.mju_mat2Quat(x, H.ravel())
    mj.mju_quat2Mat(row, x)
== rotation_vector_speeds | mjd_quatIntegrate
value = np.zeros(9)
mj.mjd_quatIntegrate(tau, 1.0, np.zeros(9), value, np.zeros(3))
value = value.reshape(3, 3)
== rotation_vector_rates | mjd_subQuat
{_OF_TAU}{_D}mj.mjd_subQuat(x, np.array([1.0, 0, 0, 0]), value, np.zeros((3, 3)))
== pose_composed | mju_mulPose | {_POSED.format(call="mju_mulPose(p, x, a, q, tau, q2)")}
== pose_inverse | mju_negPose | {_POSED.format(call="mju_negPose(p, x, a, q)")}
== pose_of_point | mju_trnVecPose | value = np.zeros(3)\nmj.mju_trnVecPose(value, a, q, v)
== quaternion_rates_fixed | mju_derivQuat | {_QUATERNION}mj.mju_derivQuat(x, q, v)\nvalue = x
== rotation_of_rpy | mju_euler2Quat | {_QUATERNION}mj.mju_euler2Quat(x, v, 'XYZ')\n{_MATRIX.format(of="x")}
== rotation_of_zyz | mju_euler2Quat | {_QUATERNION}mj.mju_euler2Quat(x, v, 'zyz')\n{_MATRIX.format(of="x")}
== rotations_of_three_angles | mju_euler2Quat | {_SEQUENCES.format(angles="v", axes="order")}
== rotations_of_three_angles:extrinsic | mju_euler2Quat, about fixed axes
{_SEQUENCES.format(angles="v[::-1].copy()", axes="order[::-1].upper()")}
== rotation_of_z | mju_quatZ2Vec | {_OF_Z.format(u="v + [4.0, -8.0, 8.0]")}
== rotation_of_z_back | mju_quatZ2Vec | {_OF_Z.format(u="v / 64 + " + str([*BACK]))}
== twist_transform | mju_transformSpatial
R = np.zeros(9)
mj.mju_quat2Mat(R, q)
R, value = R.reshape(3, 3), np.zeros((6, 6))
for column, unit in zip(value, np.eye(6)):
    x = np.zeros(6)
    mj.mju_transformSpatial(x, np.roll(unit, 3), 0, -R.T @ a, np.zeros(3), R.T.ravel())
    column[:] = np.roll(x, 3)
value = value.T
""")
    | solids.MUJOCO
)

_A = "B = np.array([v, a, v2])\nA, value = B @ B.T + np.eye(3), np.zeros(3)\n"
_BAND = (
    f"{_A}L = np.zeros({{size}})\nmj.mju_dense2Band(L, A, 3, {{shape}})\n"
    "mj.mju_cholFactorBand(L, 3, {shape}, 0.0, 0.0)\nmj.mju_cholSolveBand(value, L, tau, 3, {shape})"
)
_BOX = (
    f"{_A}side, R, index = np.full(3, {{side}}), np.zeros((3, 10)), np.zeros(3, np.int32)\n"
    "mj.mju_boxQP(value, R, index, A, -tau, -side, side)"
)
WAYS |= {
    "solution": Way("mju_cholFactor, mju_cholSolve", f"{_A}mj.mju_cholFactor(A, 0.0)\nmj.mju_cholSolve(value, A, tau)"),
    "solution:mju_cholUpdate": Way(
        "mju_cholUpdate",
        f"{_A}L = np.eye(3)\nfor column in B.T: mj.mju_cholUpdate(L, column.copy(), 1)\n"
        "mj.mju_cholSolve(value, L, tau)",
    ),
    "solution:band": Way("mju_dense2Band, mju_cholFactorBand", _BAND.format(size=9, shape="3, 0")),
    "solution:band and dense rows": Way("mju_dense2Band, mju_cholFactorBand", _BAND.format(size=7, shape="2, 1")),
    "solution:mju_boxQP": Way("mju_boxQP", _BOX.format(side=64.0), _STOPPED),
    "solution_in_a_box": Way("mju_boxQP", _BOX.format(side=BOX), _STOPPED),
}


def write() -> Source:
    """Text that imports it: a turn is a quaternion."""
    slots = ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),)
    return Source(("import numpy as np", "import mujoco as mj"), slots, 4, 3)
