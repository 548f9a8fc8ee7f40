"""PyBullet's rotations and placements, quaternions with the scalar last."""

from __future__ import annotations

from ..writing.source import Way
from . import solids

IMPORTS = ("import pybullet as p",)
_OF = "value = p.getMatrixFromQuaternion({of})"
_FLAT = "x, turn = {of}\nvalue = [*x, *p.getMatrixFromQuaternion(turn)]"
_VECTOR = (
    "axis, angle = p.getAxisAngleFromQuaternion(q)\nvalue = (angle - 2 * np.pi * (angle > np.pi)) * np.array(axis)"
)
WAYS = {
    "rotation_matrix": Way("getMatrixFromQuaternion", _OF.format(of="q")),
    "rotation_matrix:getEulerFromQuaternion": Way(
        "getEulerFromQuaternion", _OF.format(of="p.getQuaternionFromEuler(p.getEulerFromQuaternion(q))")
    ),
    "rotation_composed": Way(
        "multiplyTransforms", "x, turn = p.multiplyTransforms(0 * v, q, 0 * v, q2)\n" + _OF.format(of="turn")
    ),
    "rotation_angle": Way(
        "getDifferenceQuaternion",
        "angle = p.getAxisAngleFromQuaternion(p.getDifferenceQuaternion(q, q2))[1]\n"
        "value = [min(angle, 2 * np.pi - angle)]",
    ),
    "rotation_logarithm": Way("getAxisAngleFromQuaternion", _VECTOR),
    "rotation_exponential": Way(
        "getQuaternionFromAxisAngle",
        "n = np.linalg.norm(v)\n" + _OF.format(of="p.getQuaternionFromAxisAngle(v if n else [1, 0, 0], n)"),
    ),
    "rotation_difference": Way(
        "calculateVelocityQuaternion",
        "R = np.reshape(p.getMatrixFromQuaternion(q), (3, 3))\nvalue = R.T @ p.calculateVelocityQuaternion(q, q2, 1.0)",
    ),
    "rotation_inverse": Way("invertTransform", _OF.format(of="p.invertTransform([0, 0, 0], q)[1]")),
    "turned_vector": Way("rotateVector", "value = p.rotateVector(q, v)"),
    "pose_relative": Way(
        "invertTransform, multiplyTransforms",
        _FLAT.format(of="p.multiplyTransforms(*p.invertTransform(a, q), tau, q2)"),
    ),
    "rotation_halfway": Way("getQuaternionSlerp", _OF.format(of="p.getQuaternionSlerp(q, q2, 0.25)")),
    "rotation_of_rpy": Way("getQuaternionFromEuler", _OF.format(of="p.getQuaternionFromEuler(v)")),
    "rotation_to_rpy": Way("getEulerFromQuaternion", "value = p.getEulerFromQuaternion(q)"),
    "pose_composed": Way("multiplyTransforms", _FLAT.format(of="p.multiplyTransforms(a, q, tau, q2)")),
    "pose_inverse": Way("invertTransform", _FLAT.format(of="p.invertTransform(a, q)")),
    "pose_of_point": Way("multiplyTransforms", "value = p.multiplyTransforms(a, q, v, [0, 0, 0, 1])[0]"),
    "pose_of_point:rotateVector": Way("rotateVector", "value = np.array(p.rotateVector(q, v)) + a"),
} | solids.PYBULLET
