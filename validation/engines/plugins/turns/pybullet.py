"""PyBullet's rotations and placements, quaternions with the scalar last."""

from __future__ import annotations

from ..writing.source import ways_of
from . import solids

IMPORTS = ("import pybullet as p",)
_OF = "value = p.getMatrixFromQuaternion({of})"
_FLAT = "x, turn = {of}\nvalue = [*x, *p.getMatrixFromQuaternion(turn)]"
_VECTOR = (
    "axis, angle = p.getAxisAngleFromQuaternion(q)\nvalue = (angle - 2 * np.pi * (angle > np.pi)) * np.array(axis)"
)
WAYS = (
    ways_of(f"""
== rotation_matrix | getMatrixFromQuaternion | {_OF.format(of="q")}
== rotation_matrix:getEulerFromQuaternion | getEulerFromQuaternion
{_OF.format(of="p.getQuaternionFromEuler(p.getEulerFromQuaternion(q))")}
== rotation_composed | multiplyTransforms | x, turn = p.multiplyTransforms(0 * v, q, 0 * v, q2)\n{_OF.format(of="turn")}
== rotation_angle | getDifferenceQuaternion
angle = p.getAxisAngleFromQuaternion(p.getDifferenceQuaternion(q, q2))[1]
value = [min(angle, 2 * np.pi - angle)]
== rotation_logarithm | getAxisAngleFromQuaternion | {_VECTOR}
== rotation_exponential | getQuaternionFromAxisAngle
n = np.linalg.norm(v)
{_OF.format(of="p.getQuaternionFromAxisAngle(v if n else [1, 0, 0], n)")}
== rotation_difference | calculateVelocityQuaternion
R = np.reshape(p.getMatrixFromQuaternion(q), (3, 3))
value = R.T @ p.calculateVelocityQuaternion(q, q2, 1.0)
== rotation_inverse | invertTransform | {_OF.format(of="p.invertTransform([0, 0, 0], q)[1]")}
== turned_vector | rotateVector | value = p.rotateVector(q, v)
== pose_relative | invertTransform, multiplyTransforms
{_FLAT.format(of="p.multiplyTransforms(*p.invertTransform(a, q), tau, q2)")}
== rotation_halfway | getQuaternionSlerp | {_OF.format(of="p.getQuaternionSlerp(q, q2, 0.25)")}
== rotation_of_rpy | getQuaternionFromEuler | {_OF.format(of="p.getQuaternionFromEuler(v)")}
== rotation_to_rpy | getEulerFromQuaternion | value = p.getEulerFromQuaternion(q)
== pose_composed | multiplyTransforms | {_FLAT.format(of="p.multiplyTransforms(a, q, tau, q2)")}
== pose_inverse | invertTransform | {_FLAT.format(of="p.invertTransform(a, q)")}
== pose_of_point | multiplyTransforms | value = p.multiplyTransforms(a, q, v, [0, 0, 0, 1])[0]
== pose_of_point:rotateVector | rotateVector | value = np.array(p.rotateVector(q, v)) + a
""")
    | solids.PYBULLET
)
