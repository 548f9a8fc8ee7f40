"""The configuration manifold: integrate, difference, sampling (conventions of Pinocchio), and its charts.

The one definition of the manifold, over arrays of numbers or of terms, as `symofros.base.rotations` says; the C of
stepping loops is written of it (`generator/codegen/manifold.py`).

A chart's coordinates theta (nv) about a configuration q0 are the differences of linear coordinates, the rotation
vectors of quaternions, and for poses the displacement in the axes of q0 and the rotation vector
(docs/theory/simulation.md).

The equations hold for unit quaternions: results would err by twice the deviation of a length. So every function that
takes a state looks at them here: near unit length they are taken divided by their length, others are no rotations and
refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.base.rotations import (
    common_type,
    conjugate,
    quaternion_exp,
    quaternion_log,
    quaternion_product,
    rotate,
    rotation_vector_rate,
    screw_displacement,
    screw_twist,
)
from symofros.base.rotations import normalized as unit_quaternion
from symofros.errors import ShapeError
from symofros.native import native_number
from symofros.runtime.calls.extension import UNIT_ROUNDING, available_type, begin
from symofros.runtime.calls.kernel import Numbers
from symofros.runtime.record import ModelRecord, Segment

# Deviation from unit length up to which a quaternion counts as a rotation written in few digits.
UNIT_TOLERANCE = native_number("stepping/state/system.c", "SYM_QUATERNION_TOLERANCE")
# Numbers of a batch from which on another thread makes what looks at the next one faster than NumPy does.
_MANY = 1024


def integrate(segments: Sequence[Segment], q: Array, dq: Array) -> Array:
    """Follow a constant velocity dq for unit time.

    Args:
        segments: The configuration manifold.
        q: (..., nq).
        dq: (..., nv); the velocity times the time.

    Returns:
        The configuration (..., nq).
    """
    theta = dq
    for segment in segments:
        if segment.kind == "pose":
            theta = np.array(theta)
            linear, angular = _pose_speeds(segment)
            theta[..., linear] = screw_displacement(dq[..., angular], dq[..., linear])
    return retract(segments, q, theta)


def retract(segments: Sequence[Segment], q0: Array, theta: Array) -> Array:
    """The configurations (..., nq) at coordinates theta (..., nv) of the charts about q0 (..., nq)."""
    if _is_flat(segments):
        return np.asarray(q0 + theta)
    shape = (*np.broadcast_shapes(q0.shape[:-1], theta.shape[:-1]), q0.shape[-1])
    q = np.empty(shape, dtype=common_type(q0, theta))
    for segment in segments:
        i, j, n = segment.q, segment.v, segment.size
        if segment.kind == "linear":
            q[..., i : i + n] = q0[..., i : i + n] + theta[..., j : j + n]
        elif segment.kind == "quaternion":
            q[..., i : i + 4] = _rotated(q0[..., i : i + 4], theta[..., j : j + 3])
        else:
            linear, angular = _pose_speeds(segment)
            position, quaternion = slice(i, i + 3), slice(i + 3, i + 7)
            q[..., position] = q0[..., position] + rotate(q0[..., quaternion], theta[..., linear])
            q[..., quaternion] = _rotated(q0[..., quaternion], theta[..., angular])
    return q


def difference(segments: Sequence[Segment], q0: Array, q1: Array) -> Array:
    """The dq (..., nv) with integrate(q0, dq) = q1, of smallest rotations.

    Args:
        segments: The configuration manifold.
        q0: (..., nq).
        q1: (..., nq).
    """
    if _is_flat(segments):
        return np.asarray(q1 - q0)
    nv = sum(segment.speeds for segment in segments)
    dq = np.empty((*np.broadcast_shapes(q0.shape[:-1], q1.shape[:-1]), nv), dtype=common_type(q0, q1))
    for segment in segments:
        i, j, n = segment.q, segment.v, segment.size
        if segment.kind == "linear":
            dq[..., j : j + n] = q1[..., i : i + n] - q0[..., i : i + n]
        elif segment.kind == "quaternion":
            dq[..., j : j + 3] = _rotation_between(q0[..., i : i + 4], q1[..., i : i + 4])
        else:
            linear, angular = _pose_speeds(segment)
            quaternion = q0[..., i + 3 : i + 7]
            w = _rotation_between(quaternion, q1[..., i + 3 : i + 7])
            shift = rotate(conjugate(quaternion), q1[..., i : i + 3] - q0[..., i : i + 3])
            dq[..., linear] = screw_twist(w, shift)
            dq[..., angular] = w
    return dq


def chart_coordinates(segments: Sequence[Segment], q0: Array, q1: Array) -> Array:
    """The theta (..., nv) with retract(q0, theta) = q1, of smallest rotations."""
    theta = difference(segments, q0, q1)
    for segment in segments:
        if segment.kind == "pose":
            linear, angular = _pose_speeds(segment)
            theta[..., linear] = screw_displacement(theta[..., angular], theta[..., linear])
    return theta


def chart_rate(segments: Sequence[Segment], theta: Array, v: Array) -> Array:
    """The rates of theta (..., nv) in a chart, where the speeds are v (..., nv)."""
    if _is_flat(segments):
        return np.array(v if v.shape == theta.shape else np.broadcast_arrays(theta, v)[1])
    rate = np.empty(np.broadcast_shapes(theta.shape, v.shape), dtype=common_type(theta, v))
    for segment in segments:
        j, n = segment.v, segment.size
        if segment.kind == "linear":
            rate[..., j : j + n] = v[..., j : j + n]
        elif segment.kind == "quaternion":
            rate[..., j : j + 3] = rotation_vector_rate(theta[..., j : j + 3], v[..., j : j + 3])
        else:
            linear, angular = _pose_speeds(segment)
            rate[..., linear] = rotate(quaternion_exp(theta[..., angular]), v[..., linear])
            rate[..., angular] = rotation_vector_rate(theta[..., angular], v[..., angular])
    return rate


def along_speeds(segments: Sequence[Segment], q: Array, by_coordinates: Array) -> Array:
    """Derivatives along the motions of the speeds (..., nv), N^T of those by the coordinates (..., nq): q' = N v."""
    along = np.empty((*np.broadcast_shapes(q.shape, by_coordinates.shape)[:-1], sum(each.speeds for each in segments)))
    for segment in segments:
        i, j, n = segment.q, segment.v, segment.size
        if segment.kind == "linear":
            along[..., j : j + n] = by_coordinates[..., i : i + n]
            continue
        start, angular = i + segment.translations, j + segment.translations
        quaternion, weight = q[..., start : start + 4], by_coordinates[..., start : start + 4]
        # Of q' = q w / 2: the vector part of q* weight / 2.
        along[..., angular : angular + 3] = 0.5 * quaternion_product(conjugate(quaternion), weight)[..., :3]
        if segment.kind == "pose":
            along[..., j : j + 3] = rotate(conjugate(quaternion), by_coordinates[..., i : i + 3])
    return along


def random_state(record: ModelRecord, rng: np.random.Generator) -> tuple[Array, Array]:
    """A configuration within its limits, quaternions uniform on the sphere, and normal speeds."""
    bounds = np.array(record.sampling_bounds()).reshape(-1, 2)
    q = rng.uniform(bounds[:, 0], bounds[:, 1])
    for segment in record.segments:
        if segment.kind != "linear":
            start = segment.q + segment.translations
            q[start : start + 4] = unit_quaternion(rng.standard_normal(4))
    return q, rng.standard_normal(len(record.v_names))


def _is_flat(segments: Sequence[Segment]) -> bool:
    """Whether there are linear coordinates alone, in the order of the speeds."""
    return all(segment.kind == "linear" for segment in segments)


def _pose_speeds(segment: Segment) -> tuple[slice, slice]:
    """The linear and the angular speeds of a pose."""
    return slice(segment.v, segment.v + 3), slice(segment.v + 3, segment.v + 6)


def _rotated(quaternion: Array, w: Array) -> Array:
    return unit_quaternion(quaternion_product(quaternion, quaternion_exp(w)))


def _rotation_between(a: Array, b: Array) -> Array:
    """The rotation vector from one orientation to another, in the axes of both."""
    return quaternion_log(quaternion_product(conjugate(a), b))


def at_unit_length(record: ModelRecord, group: str, given: Numbers, name: str = "") -> Numbers:
    """Coordinates or inputs with their quaternions at unit length, in a copy where one was off by more than rounding.

    What is not finite stays as it is: it propagates to what depends on it.

    Args:
        record: What is known of the model.
        group: What they are: "q" or "u"; of others there are no quaternions.
        given: Coordinates (..., nq) or inputs (..., nu).
        name: What messages call them.

    Raises:
        ShapeError: A quaternion is no rotation: its length is not 1 to UNIT_TOLERANCE. With the one that is off most.
    """
    firsts = record.quaternions.get(group, ())
    if not firsts or are_unit(given, firsts):
        return given
    result = given
    for first in firsts:
        quaternions = given[..., first : first + 4]
        squares = _squared_lengths(quaternions)
        off = (np.abs(squares - 1.0) > _rounding(given)) & np.isfinite(quaternions).all(axis=-1)
        if not off.any():
            continue
        lengths = np.sqrt(squares[off])
        deviations = np.abs(lengths - 1.0)
        worst = int(np.argmax(deviations))
        if not deviations[worst] <= UNIT_TOLERANCE:
            raise _no_rotation(record, group, first, name or group, quaternions, np.argwhere(off)[worst])
        if result is given:
            result = given.copy(order="K")
        result[..., first : first + 4][off] /= lengths[:, np.newaxis]
    return result


def normalized(record: ModelRecord, q: Numbers) -> Numbers:
    """Configurations (..., nq) with each quaternion divided by its length.

    Raises:
        ShapeError: A quaternion is zero.
    """
    result = np.array(q, order="K")
    for first in record.quaternions.get("q", ()):
        quaternions = result[..., first : first + 4]
        largest = np.abs(quaternions).max(axis=-1, keepdims=True)
        if (largest == 0.0).any():
            raise _no_rotation(record, "q", first, "q", quaternions, np.argwhere(largest[..., 0] == 0.0)[0])
        with np.errstate(invalid="ignore"):  # Of what is not finite.
            quaternions /= largest  # Squares of the quotients neither overflow nor vanish.
            quaternions /= np.linalg.norm(quaternions, axis=-1, keepdims=True)
    return result


def are_unit(numbers: Numbers, firsts: tuple[int, ...]) -> bool:
    """Whether quaternions are known to be of unit length, up to rounding.

    Args:
        numbers: Arrays of coordinates or inputs (..., n).
        firsts: First index of each quaternion.
    """
    by_extension = available_type()
    if by_extension is not None and numbers.dtype == np.float64:
        return bool(by_extension.are_unit(numbers, firsts))
    if numbers.size >= _MANY:
        begin()
    deviations = [np.abs(_squared_lengths(numbers[..., first : first + 4]) - 1.0) for first in firsts]
    return not any(bool((deviation > _rounding(numbers)).any()) for deviation in deviations)


def _squared_lengths(quaternions: Numbers) -> Numbers:
    wide = quaternions.astype(np.float64, copy=False)
    with np.errstate(over="ignore", invalid="ignore"):
        return np.asarray(np.einsum("...i,...i->...", wide, wide))


def _rounding(numbers: Numbers) -> float:
    """Deviation of squared lengths that is rounding, in the precision of these numbers."""
    return UNIT_ROUNDING * float(np.finfo(numbers.dtype).eps / np.finfo(np.float64).eps)


def _no_rotation(
    record: ModelRecord, group: str, first: int, name: str, quaternions: Numbers, place: npt.NDArray[np.intp]
) -> ShapeError:
    """The quaternion at a place of some (..., 4) is none."""
    length = hypot(*quaternions[tuple(place)].tolist())
    of_batch = f" in row {', '.join(map(str, place))}" if len(place) else ""
    divide = "model.normalized(q) divides by it" if group == "q" else "divide by it"
    return ShapeError(
        f"model '{record.name}': {name} holds a quaternion that is no rotation",
        f"length {length:.6g} of {', '.join(record.vectors[group][first : first + 4])}{of_batch}",
        f"quaternions are of unit length, to {UNIT_TOLERANCE:g}",
        divide if length else "a body that is not turned has (0, 0, 0, 1), as in model.neutral()",
    )
