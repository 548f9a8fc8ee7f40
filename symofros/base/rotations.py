"""Rotations: unit quaternions (x, y, z, w), rotation vectors and matrices, with any leading batch dimensions.

The one definition of them. Formulas of quaternions and rotation vectors are free of branches, so that arrays of numbers
take them as they are, and so do arrays of objects with arithmetic and methods `sqrt`, `sin`, `cos`, `tan`, `arctan2`,
`choose`: with the terms of `expr.terms` they become formulas of the graph, of which the C of stepping loops is written.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from symofros.base.arrays import Array


def skew(w: Array) -> Array:
    """The matrices K (..., 3, 3) with K x = w x x."""
    w = np.asarray(w, dtype=np.float64)
    K = np.zeros((*w.shape, 3))
    K[..., 0, 1], K[..., 0, 2], K[..., 1, 2] = -w[..., 2], w[..., 1], -w[..., 0]
    return K - np.swapaxes(K, -1, -2)


def cross(a: Array, b: Array) -> Array:
    """The products a x b (..., 3): the bits of `numpy.cross`, in less than half its time for a few vectors."""
    product = np.empty(np.broadcast_shapes(a.shape, b.shape), dtype=common_type(a, b))
    product[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    product[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    product[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return product


def matrix_product(R: Array, x: Array) -> Array:
    """The product of a matrix (3, 3) with a vector (3,) or a matrix (3, 3), with the same rounding on every machine."""
    columns = R[:, :, np.newaxis] if x.ndim == 2 else R
    return np.asarray(columns[:, 0] * x[0] + columns[:, 1] * x[1] + columns[:, 2] * x[2])


# Rows of a rotation are orthonormal to within a few roundings of its entries.
_ORTHONORMAL = 1e-15


def nearest_rotation(R: Array) -> Array:
    """The rotation nearest to a matrix (3, 3) that is one but for noise: its polar factor.

    Newton's iteration X <- X (3 - X^T X)/2 squares the defect X^T X - 1 each time; it is written out so that every
    machine rounds alike. A matrix that is a rotation to rounding is returned as it is.

    Args:
        R: Matrix (3, 3) with |R^T R - 1| well below 1, and a positive determinant.
    """
    X = np.asarray(R, dtype=np.float64)
    for _ in range(_NEWTON_STEPS):
        defect = np.eye(3) - matrix_product(X.T, X)
        if np.abs(defect).max() <= _ORTHONORMAL:
            break
        X = X + 0.5 * matrix_product(X, defect)
    return X


# A defect of 1e-2 is below rounding after four steps.
_NEWTON_STEPS = 6


def unit_scale(x: Array) -> Array:
    """A vector times the power of two that brings its largest entry to between 1/2 and 1: squares keep their digits."""
    return np.asarray(np.ldexp(x, -np.frexp(np.abs(x).max())[1]))


def axis_rotation(axis: Array, cosine: float, sine: float) -> Array:
    """The rotation matrix (3, 3) about a unit axis (3,) by the angle of that cosine and sine: Rodrigues' formula."""
    K = skew(axis)
    return np.asarray(np.eye(3) + sine * K + (1.0 - cosine) * matrix_product(K, K))


def quaternion_matrix(quaternion: Array) -> Array:
    """The rotation matrices (..., 3, 3) of unit quaternions (..., 4)."""
    x, y, z, w = (quaternion[..., i : i + 1] for i in range(4))
    tx, ty, tz = x + x, y + y, z + z
    xx, yy, zz, xy, xz, yz = tx * x, ty * y, tz * z, tx * y, tx * z, ty * z
    wx, wy, wz = tx * w, ty * w, tz * w
    first = 1.0 - (yy + zz), xy - wz, xz + wy
    second = xy + wz, 1.0 - (xx + zz), yz - wx
    third = xz - wy, yz + wx, 1.0 - (xx + yy)
    return np.concatenate([*first, *second, *third], axis=-1).reshape((*quaternion.shape[:-1], 3, 3))


def matrix_quaternion(R: Array) -> Array:
    """The unit quaternion (4) of one rotation matrix, of numbers; by its largest entry, which loses no digits."""
    K = np.array(
        [
            [R[0, 0] - R[1, 1] - R[2, 2], R[0, 1] + R[1, 0], R[0, 2] + R[2, 0], R[2, 1] - R[1, 2]],
            [0.0, R[1, 1] - R[0, 0] - R[2, 2], R[1, 2] + R[2, 1], R[0, 2] - R[2, 0]],
            [0.0, 0.0, R[2, 2] - R[0, 0] - R[1, 1], R[1, 0] - R[0, 1]],
            [0.0, 0.0, 0.0, R[0, 0] + R[1, 1] + R[2, 2]],
        ]
    )
    outer = K + K.T - np.diag(np.diag(K)) + np.eye(4)  # 4 q q^T
    largest = outer[int(np.argmax(np.diag(outer)))]
    return np.asarray(largest / math.hypot(*largest))


def rotate(quaternion: Array, x: Array) -> Array:
    """The vectors R x (..., 3) of unit quaternions (..., 4)."""
    t = 2.0 * cross(quaternion[..., :3], x)
    return np.asarray(x + quaternion[..., 3:] * t + cross(quaternion[..., :3], t))


def quaternion_product(a: Array, b: Array) -> Array:
    """The quaternions (..., 4) of the rotations R_a R_b."""
    av, aw, bv, bw = a[..., :3], a[..., 3:], b[..., :3], b[..., 3:]
    vector = aw * bv + bw * av + cross(av, bv)
    scalar = aw * bw - np.sum(av * bv, axis=-1, keepdims=True)
    return np.concatenate([vector, scalar], axis=-1)


def conjugate(quaternion: Array) -> Array:
    """The quaternions (..., 4) of the inverse rotations."""
    return np.concatenate([-quaternion[..., :3], quaternion[..., 3:]], axis=-1)


def normalized(quaternion: Array) -> Array:
    """The quaternions (..., 4) divided by their length."""
    return np.asarray(quaternion / np.sqrt(np.sum(quaternion * quaternion, axis=-1, keepdims=True)))


def quaternion_rate(quaternion: Array, w: Array) -> Array:
    """The rates (..., 4) of quaternions of any length at angular velocities w (..., 3) in the rotated frame."""
    return 0.5 * quaternion_product(quaternion, np.concatenate([w, np.zeros_like(w[..., :1])], axis=-1))


def quaternion_exp(w: Array) -> Array:
    """The unit quaternions (..., 4) of rotation vectors (..., 3) [rad]."""
    half = 0.5 * _length(w)
    return np.concatenate([0.5 * np.sin(half) / half * w, np.cos(half)], axis=-1)


def quaternion_log(quaternion: Array) -> Array:
    """The rotation vectors (..., 3), of at most pi, of quaternions (..., 4) of any length [rad]."""
    upper = choose(quaternion[..., 3:], 1.0, -1.0) * quaternion
    size = _length(upper[..., :3])
    return np.asarray(2.0 * np.arctan2(size, upper[..., 3:]) / size * upper[..., :3])


def screw_displacement(w: Array, v: Array) -> Array:
    """The displacements J(w) v (..., 3) of motions with constant twists (v, w) in unit time, in the first frame's axes.

    J v = v + A w x v + B w x (w x v), A = (1 - cos a)/a^2, B = (a - sin a)/a^3, a = |w|.
    """
    angle, a, small = _angles(w)
    half_sinc = np.sin(0.5 * angle) / angle
    A = 2.0 * half_sinc * half_sinc  # 1 - cos a = 2 sin^2(a/2): no digits cancel.
    closed = (a - np.sin(a)) / (a * a * a)
    B = choose(small, _polynomial(angle, small, 1 / 6, -1 / 120, 1 / 5040, -1 / 362880), closed)
    wv = cross(w, v)
    return np.asarray(v + A * wv + B * cross(w, wv))


def screw_twist(w: Array, p: Array) -> Array:
    """The v (..., 3) with screw_displacement(w, v) = p: v = p - w x p / 2 + C w x (w x p).

    C = (1 - (a/2) cot(a/2))/a^2 of a = |w|.
    """
    angle, a, small = _angles(w)
    closed = (1.0 - 0.5 * a / np.tan(0.5 * a)) / (a * a)
    C = choose(small, _polynomial(angle, small, 1 / 12, 1 / 720, 1 / 30240, 1 / 1209600), closed)
    wp = cross(w, p)
    return np.asarray(p - 0.5 * wp + C * cross(w, wp))


def rotation_vector_rate(theta: Array, w: Array) -> Array:
    """The rates (..., 3) of rotation vectors theta, where the angular velocity in the rotated frame is w [rad/s].

    theta' = w + theta x w / 2 + C theta x (theta x w): the twist of a screw, with the other sign of theta.
    """
    return screw_twist(-theta, w)


def choose(sign: Array, at_least_zero: Any, below: Any) -> Array:
    """One of two arrays, or numbers, entry by entry: the first where `sign` is at least zero."""
    if sign.dtype == object:
        return np.asarray(_choose_terms(sign, at_least_zero, below))
    return np.asarray(np.where(sign >= 0.0, at_least_zero, below))


_choose_terms = np.frompyfunc(lambda sign, at_least_zero, below: sign.choose(at_least_zero, below), 3, 1)


def common_type(*arrays: Array) -> np.dtype[Any]:
    """Common type of arrays: objects if one of them holds objects, otherwise doubles."""
    return np.dtype(object if any(array.dtype == object for array in arrays) else np.float64)


# Added to a squared length: its root, 1e-150, is lost beside any other length, and leaves sin(a)/a at 1 where a is 0.
TINY = 1e-300
# Square of the angle [rad] below which four terms of the series are exact to rounding, and closed forms lose digits.
_SERIES = 0.01


def _length(v: Array) -> Array:
    """The Euclidean norms (..., 1), never zero."""
    return np.asarray(np.sqrt(np.sum(v * v, axis=-1, keepdims=True) + TINY))


def _angles(w: Array) -> tuple[Array, Array, Array]:
    """The angles of rotation vectors; the same, but 1 where the series holds; what is at least zero where it does."""
    angle = _length(w)
    small = _SERIES - angle * angle
    return angle, choose(small, 1.0, angle), small


def _polynomial(angle: Array, small: Array, *coefficients: float) -> Array:
    """The polynomial in the angle's square; at zero where the series doesn't hold, so that nothing overflows."""
    angle = choose(small, angle, 0.0)
    square = angle * angle
    total: Any = coefficients[-1]
    for coefficient in reversed(coefficients[:-1]):
        total = total * square + coefficient
    return np.asarray(total)
