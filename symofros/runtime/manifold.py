"""The configuration manifold: integrate and difference along it, sample on it (conventions of Pinocchio)."""

from __future__ import annotations

import numpy as np

from symofros.runtime.kernel import Array
from symofros.runtime.record import ModelRecord

# Below this angle the closed forms lose digits to cancellation and series are exact to rounding.
_SMALL = 1e-4


def integrate(record: ModelRecord, q: Array, dq: Array) -> Array:
    """Follow a constant velocity dq for unit time.

    Args:
        record: For the segments.
        q: (..., nq).
        dq: (..., nv); the velocity times the time.
    """
    result = np.empty(np.broadcast_shapes(q.shape[:-1], dq.shape[:-1]) + (q.shape[-1],))
    for segment in record.segments:
        i, j, n = segment.q, segment.v, segment.size
        if segment.kind == "linear":
            result[..., i : i + n] = q[..., i : i + n] + dq[..., j : j + n]
        elif segment.kind == "quaternion":
            turn = quaternion_exp(dq[..., j : j + 3])
            result[..., i : i + 4] = _normalised(quaternion_product(q[..., i : i + 4], turn))
        else:
            position, quaternion = q[..., i : i + 3], q[..., i + 3 : i + 7]
            w = dq[..., j + 3 : j + 6]
            shift = rotate(quaternion, _left_jacobian(w, dq[..., j : j + 3]))
            result[..., i : i + 3] = position + shift
            result[..., i + 3 : i + 7] = _normalised(quaternion_product(quaternion, quaternion_exp(w)))
    return result


def difference(record: ModelRecord, q0: Array, q1: Array) -> Array:
    """The dq with integrate(q0, dq) = q1, of smallest turns.

    Args:
        record: For the segments.
        q0: (..., nq).
        q1: (..., nq).
    """
    result = np.empty(np.broadcast_shapes(q0.shape[:-1], q1.shape[:-1]) + (len(record.v_names),))
    for segment in record.segments:
        i, j, n = segment.q, segment.v, segment.size
        if segment.kind == "linear":
            result[..., j : j + n] = q1[..., i : i + n] - q0[..., i : i + n]
        elif segment.kind == "quaternion":
            result[..., j : j + 3] = quaternion_log(_relative(q0[..., i : i + 4], q1[..., i : i + 4]))
        else:
            a, b = q0[..., i + 3 : i + 7], q1[..., i + 3 : i + 7]
            w = quaternion_log(_relative(a, b))
            shift = rotate(_conjugate(a), q1[..., i : i + 3] - q0[..., i : i + 3])
            result[..., j : j + 3] = _left_jacobian_inverse(w, shift)
            result[..., j + 3 : j + 6] = w
    return result


def random_state(record: ModelRecord, rng: np.random.Generator) -> tuple[Array, Array]:
    """A configuration within its limits, quaternions uniform on the sphere, and normal speeds."""
    bounds = np.array(record.sampling_bounds()).reshape(-1, 2)
    q = rng.uniform(bounds[:, 0], bounds[:, 1])
    for segment in record.segments:
        if segment.kind != "linear":
            start = segment.q + (3 if segment.kind == "pose" else 0)
            q[start : start + 4] = _normalised(rng.standard_normal(4))
    return q, rng.standard_normal(len(record.v_names))


def quaternion_product(a: Array, b: Array) -> Array:
    """The product a b of quaternions, scalar last."""
    av, aw, bv, bw = a[..., :3], a[..., 3:], b[..., :3], b[..., 3:]
    vector = aw * bv + bw * av + np.cross(av, bv)
    scalar = aw * bw - np.sum(av * bv, axis=-1, keepdims=True)
    return np.concatenate([vector, scalar], axis=-1)


def quaternion_exp(w: Array) -> Array:
    """The quaternion of the rotation vector w [rad]."""
    angle = np.linalg.norm(w, axis=-1, keepdims=True)
    factor = np.where(angle < _SMALL, 0.5 - angle**2 / 48.0, np.sin(angle / 2) / np.where(angle < _SMALL, 1.0, angle))
    return np.concatenate([factor * w, np.cos(angle / 2)], axis=-1)


def quaternion_log(q: Array) -> Array:
    """The shortest rotation vector of a unit quaternion [rad]."""
    q = np.where(q[..., 3:] < 0.0, -q, q)
    size = np.linalg.norm(q[..., :3], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(size, q[..., 3:])
    factor = np.where(size < _SMALL, 2.0 + size**2 / 3.0, angle / np.where(size < _SMALL, 1.0, size))
    vector: Array = factor * q[..., :3]
    return vector


def rotate(q: Array, v: Array) -> Array:
    """R(q) v."""
    t = 2.0 * np.cross(q[..., :3], v)
    rotated: Array = v + q[..., 3:] * t + np.cross(q[..., :3], t)
    return rotated


def _conjugate(q: Array) -> Array:
    return np.concatenate([-q[..., :3], q[..., 3:]], axis=-1)


def _relative(a: Array, b: Array) -> Array:
    return quaternion_product(_conjugate(a), b)


def _normalised(q: Array) -> Array:
    unit: Array = q / np.linalg.norm(q, axis=-1, keepdims=True)
    return unit


def _left_jacobian(w: Array, v: Array) -> Array:
    """The translation of the screw motion with twist (v, w): v + A w x v + B w x (w x v)."""
    angle = np.linalg.norm(w, axis=-1, keepdims=True)
    small = angle < _SMALL
    safe = np.where(small, 1.0, angle)
    A = np.where(small, 0.5 - angle**2 / 24.0, (1.0 - np.cos(safe)) / safe**2)
    B = np.where(small, 1.0 / 6.0 - angle**2 / 120.0, (safe - np.sin(safe)) / safe**3)
    wv = np.cross(w, v)
    shift: Array = v + A * wv + B * np.cross(w, wv)
    return shift


def _left_jacobian_inverse(w: Array, p: Array) -> Array:
    """The v with _left_jacobian(w, v) = p: p - w x p / 2 + C w x (w x p)."""
    angle = np.linalg.norm(w, axis=-1, keepdims=True)
    small = angle < _SMALL
    safe = np.where(small, 1.0, angle)
    C = np.where(small, 1.0 / 12.0 + angle**2 / 720.0, (1.0 - safe / 2.0 / np.tan(safe / 2.0)) / safe**2)
    wp = np.cross(w, p)
    twist: Array = p - 0.5 * wp + C * np.cross(w, wp)
    return twist
