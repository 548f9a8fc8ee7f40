"""Arithmetic of many digits: NumPy arrays of Python's decimal numbers, which are ten times as fast as mpmath's here."""

from __future__ import annotations

import decimal
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from decimal import Decimal
from functools import lru_cache
from typing import Any

import numpy as np

# Central differences are taken up to four deep. With step e each is off by O(e^2), which is smooth and so no worse
# after the next, and by 10^-DIGITS / e of rounding, which grows by 1 / e with each: 10^-36 and 10^(-130 + 72).
DIGITS = 130
STEP = Decimal(10) ** -18
# Angles are halved until they are smaller than 2^-_HALVINGS times their size, which shortens the series.
_HALVINGS = 12
# Newton's steps for an angle: each has three times as many digits as the one before, of which doubles have 15.
_TRIPLINGS = 3

# An array of dtype object, or one of its numbers.
Exact = Any


@contextmanager
def many_digits() -> Iterator[None]:
    """Arithmetic within carries DIGITS."""
    with decimal.localcontext() as context:
        context.prec = DIGITS
        yield


def exact(values: object) -> Exact:
    """Doubles (or numbers) as they are, in many digits."""
    return np.vectorize(Decimal, otypes=[object])(np.asarray(values, dtype=object))


@lru_cache(maxsize=4096)
def cos_sin(angle: Decimal) -> tuple[Decimal, Decimal]:
    """Cosine and sine: their series at a fraction of the angle, and the formulas of the double angle."""
    small = angle / 2**_HALVINGS
    # 1 - cos keeps the digits that cos would lose.
    versine, sine, term, k = Decimal(0), Decimal(0), small, 1
    while abs(term) > Decimal(10) ** -(DIGITS + 10):
        sine += term
        term = term * small / (k + 1)
        versine += term
        term = -term * small / (k + 2)
        k += 2
    for _ in range(_HALVINGS):
        versine, sine = 2 * sine * sine, 2 * sine * (1 - versine)
    return 1 - versine, sine


def arc(cosine: Exact, sine: Exact) -> Exact:
    """The angle of a direction (cosine, sine) of any length, in (-pi, pi]."""
    length = root(cosine * cosine + sine * sine)
    angle = Decimal(math.atan2(sine, cosine))
    for _ in range(_TRIPLINGS):
        c, s = cos_sin(angle)
        angle += (sine * c - cosine * s) / length
    return angle


def root(square: Exact) -> Exact:
    """The square root."""
    return square.sqrt()


def zeros(*shape: int) -> Exact:
    """Zeros."""
    array = np.empty(shape, dtype=object)
    array.fill(Decimal(0))
    return array


def eye(n: int) -> Exact:
    """The unit matrix (n, n)."""
    array = zeros(n, n)
    for k in range(n):
        array[k, k] = Decimal(1)
    return array


def skew(r: Exact) -> Exact:
    """The matrix (3, 3) of r x."""
    zero = Decimal(0)
    return np.array([[zero, -r[2], r[1]], [r[2], zero, -r[0]], [-r[1], r[0], zero]], dtype=object)


def vee(matrix: Exact) -> Exact:
    """The vector (3) of a skew matrix; of any other, that of its skew part."""
    pairs = ((2, 1), (0, 2), (1, 0))
    return np.array([(matrix[i, j] - matrix[j, i]) / 2 for i, j in pairs], dtype=object)


def cross(a: Exact, b: Exact) -> Exact:
    """The product a x b (3)."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]], dtype=object)


def rotation(axis: Exact, cosine: Exact, sine: Exact) -> Exact:
    """The rotation (3, 3) about an axis of unit length."""
    turned = skew(axis)
    return eye(3) + sine * turned + (1 - cosine) * (turned @ turned)


def quaternion_rotation(w: Exact, x: Exact, y: Exact, z: Exact) -> Exact:
    """The rotation (3, 3) of a quaternion of any length."""
    u = np.array([x, y, z], dtype=object)
    turned = skew(u)
    return eye(3) + (2 * w * turned + 2 * (turned @ turned)) / (w * w + u @ u)


def normalised(vector: Exact) -> Exact:
    """A vector at unit length."""
    return vector / root(vector @ vector)


@lru_cache(maxsize=256)
def unit(axis: tuple[float, ...]) -> Exact:
    """A direction at unit length, to all digits."""
    return normalised(exact(axis))


def orthonormal(rows: object) -> Exact:
    """The rotation that a matrix (3, 3) of doubles means: the nearest one, to all digits (Newton's iteration)."""
    R = exact(rows)
    for _ in range(6):  # The error squares: 1e-16, 1e-32, ..., beyond DIGITS.
        R = R @ (3 * eye(3) - R.T @ R) / 2
    return R


def solve(matrix: Exact, right: Exact) -> Exact:
    """matrix^-1 right, by elimination with pivots.

    Raises:
        ZeroDivisionError: The matrix is singular.
    """
    n = len(matrix)
    rows = np.concatenate([matrix, right.reshape(n, -1)], axis=1)
    for k in range(n):
        pivot = k + int(np.argmax([abs(x) for x in rows[k:, k]]))
        rows[[k, pivot]] = rows[[pivot, k]]
        if rows[k, k] == 0:
            raise ZeroDivisionError("the matrix is singular")
        rows[k] = rows[k] / rows[k, k]
        for i in range(n):
            if i != k and rows[i, k] != 0:
                rows[i] = rows[i] - rows[i, k] * rows[k]
    return rows[:, n:].reshape(right.shape)


def volume(matrix: Exact) -> Exact:
    """The absolute value of a determinant, by elimination with pivots."""
    rows, product = np.array(matrix), Decimal(1)
    for k in range(len(rows)):
        pivot = k + int(np.argmax([abs(x) for x in rows[k:, k]]))
        rows[[k, pivot]] = rows[[pivot, k]]
        product = product * abs(rows[k, k])
        if not product:
            break
        for i in range(k + 1, len(rows)):
            rows[i] = rows[i] - rows[i, k] / rows[k, k] * rows[k]
    return product


def rate(function: Callable[[Exact], Exact], point: Exact, direction: Exact) -> Exact:
    """The derivative of a function along a direction.

    Raises:
        ArithmeticError: Numbers do not carry enough digits (`many_digits`).
    """
    if decimal.getcontext().prec < DIGITS:
        raise ArithmeticError(f"differences need {DIGITS} digits")
    # What is off grows by the square of how far apart the points are: speeds of tiny bodies lead far.
    step = STEP / max((Decimal(1), *map(abs, np.ravel(direction))))
    difference = function(point + step * direction) - function(point - step * direction)
    return difference / (2 * step)


def stack(columns: Sequence[Exact]) -> Exact:
    """Arrays side by side along a new last axis."""
    return np.stack(columns, axis=-1)
