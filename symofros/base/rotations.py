"""Rotations in NumPy: unit quaternions (x, y, z, w), rotation vectors and matrices, with any leading batch dimensions.

The definition on the graph is `expr.quaternion`; a test compares the two, and the C of native/stepping/manifold.c.
"""

from __future__ import annotations

from collections.abc import Callable

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
    product = np.empty(np.broadcast_shapes(a.shape, b.shape))
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
    """The rotation matrix (3, 3) of a unit quaternion (4,)."""
    K = skew(quaternion[:3])
    return np.asarray(np.eye(3) + 2.0 * quaternion[3] * K + 2.0 * matrix_product(K, K))


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
    return np.asarray(quaternion / np.linalg.norm(quaternion, axis=-1, keepdims=True))


def quaternion_exp(w: Array) -> Array:
    """The unit quaternions (..., 4) of rotation vectors (..., 3) [rad]."""
    angle = np.linalg.norm(w, axis=-1, keepdims=True)
    return np.concatenate([_half_sinc(angle) * w, np.cos(angle / 2)], axis=-1)


def quaternion_log(quaternion: Array) -> Array:
    """The rotation vectors (..., 3), of at most pi, of unit quaternions (..., 4) [rad]."""
    upper = np.where(quaternion[..., 3:] < 0.0, -quaternion, quaternion)
    size = np.linalg.norm(upper[..., :3], axis=-1, keepdims=True)
    safe = np.where(size == 0.0, 1.0, size)
    return np.asarray(np.where(size == 0.0, 2.0, 2.0 * np.arctan2(size, upper[..., 3:]) / safe) * upper[..., :3])


def screw_displacement(w: Array, v: Array) -> Array:
    """The displacements J(w) v (..., 3) of motions with constant twists (v, w) in unit time, in the first frame's axes.

    J v = v + A w x v + B w x (w x v), A = (1 - cos a)/a^2, B = (a - sin a)/a^3, a = |w|.
    """
    angle = np.linalg.norm(w, axis=-1, keepdims=True)
    A = 2.0 * _half_sinc(angle) ** 2  # 1 - cos a = 2 sin^2(a/2): no digits cancel.
    closed = _where_large(angle, lambda a: (a - np.sin(a)) / a**3)
    B = np.where(angle < _SERIES, _polynomial(angle, 1 / 6, -1 / 120, 1 / 5040, -1 / 362880), closed)
    wv = cross(w, v)
    return np.asarray(v + A * wv + B * cross(w, wv))


def screw_twist(w: Array, p: Array) -> Array:
    """The v (..., 3) with screw_displacement(w, v) = p: v = p - w x p / 2 + C w x (w x p)."""
    wp = cross(w, p)
    return np.asarray(p - 0.5 * wp + _tangent_factor(w) * cross(w, wp))


def rotation_vector_rate(theta: Array, w: Array) -> Array:
    """The rates (..., 3) of rotation vectors theta, where the angular velocity in the rotated frame is w [rad/s].

    theta' = w + theta x w / 2 + C theta x (theta x w): the twist of a screw, with the other sign of theta.
    """
    return screw_twist(-theta, w)


# Angle [rad] below which four terms of the series are exact to rounding, and closed forms lose digits.
_SERIES = 0.1


def _half_sinc(angle: Array) -> Array:
    """The function sin(a/2)/a, which loses no digits but at zero."""
    zero = angle == 0.0
    return np.asarray(np.where(zero, 0.5, np.sin(angle / 2) / np.where(zero, 1.0, angle)))


def _tangent_factor(w: Array) -> Array:
    """The function C = (1 - (a/2) cot(a/2))/a^2 of a = |w|."""
    angle = np.linalg.norm(w, axis=-1, keepdims=True)
    closed = _where_large(angle, lambda a: (1.0 - a / 2.0 / np.tan(a / 2.0)) / a**2)
    series = _polynomial(angle, 1 / 12, 1 / 720, 1 / 30240, 1 / 1209600)
    return np.asarray(np.where(angle < _SERIES, series, closed))


def _where_large(angle: Array, function: Callable[[Array], Array]) -> Array:
    return function(np.where(angle < _SERIES, 1.0, angle))


def _polynomial(angle: Array, *coefficients: float) -> Array:
    """The polynomial in the angle's square."""
    square, total = angle * angle, np.zeros_like(angle)
    for coefficient in reversed(coefficients):
        total = total * square + coefficient
    return total
