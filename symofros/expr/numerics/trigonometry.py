"""Sine and cosine by polynomials: the same as native/model/sincos.c.in, for NumPy, and the coefficients of both.

x = n pi/2 + r, |r| <= pi/4, pi/2 as a sum of three parts: products of n with the first two are exact, so that r and
what is left beyond its last digit are right even where x is next to a multiple of pi/2. Then polynomials in r^2. Every
operation is one IEEE operation, so that this and the C agree bit for bit (docs/theory/code.md).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

# Beyond, n has more than 16 digits and its products are not exact: the C library takes over, as for infinities and NaN.
FAR = 1e5
TWO_BY_PI = 0.6366197723675814
# Adding it rounds to a whole number, whose last digits are then those of the sum.
ROUNDER = 6755399441055744.0  # 1.5 * 2^52
HALF_PI = tuple(map(float.fromhex, ("0x1.921fb5444p+0", "0x1.68c234c4cp-39", "0x1.98a2e03707345p-77")))
# Minimax fits on |r| <= pi/4 (Remez in 60 digits): (sin r - r)/r^3 to 2^-58 of sin r / r,
# (cos r - 1 + r^2/2)/r^4 to 2^-64 of cos r.
SINE = tuple(
    map(
        float.fromhex,
        (
            "-0x1.5555555555549p-3",
            "0x1.111111110f87fp-7",
            "-0x1.a01a019c12422p-13",
            "0x1.71de35784f52fp-19",
            "-0x1.ae5e66b6b8f45p-26",
            "0x1.5d93263960a76p-33",
        ),
    )
)
COSINE = tuple(
    map(
        float.fromhex,
        (
            "0x1.555555555554cp-5",
            "-0x1.6c16c16c15183p-10",
            "0x1.a01a019cb24c3p-16",
            "-0x1.27e4f80a5c2cep-22",
            "0x1.1ee9ec3537108p-29",
            "-0x1.8faec545de228p-37",
        ),
    )
)
# Coefficients for floats, minimax fits as well: to 2^-27.9 of sin r / r, to 2^-33 of cos r.
SINE_SINGLE = tuple(map(float.fromhex, ("-0x1.555546p-3", "0x1.11073ap-7", "-0x1.994388p-13")))
COSINE_SINGLE = tuple(map(float.fromhex, ("0x1.55554ap-5", "-0x1.6c0c32p-10", "0x1.99eb4ap-16")))

_SIGN = np.uint64(62)


def sine(x: Array) -> Array:
    """Sine of x, elementwise; NaN for infinities and NaN."""
    return _with_libm(x, sine_and_cosine(x)[0], math.sin)


def cosine(x: Array) -> Array:
    """Cosine of x, elementwise; NaN for infinities and NaN."""
    return _with_libm(x, sine_and_cosine(x)[1], math.cos)


def _with_libm(x: Array, near: Array, function: Callable[[float], float]) -> Array:
    far = ~(np.abs(x) <= FAR)
    if far.any():
        near[far] = [function(value) if math.isfinite(value) else math.nan for value in x[far].tolist()]
    return near


def sine_and_cosine(x: Array) -> tuple[Array, Array]:
    """Both for |x| <= FAR; anything beyond.

    Args:
        x: Angles [rad], any shape.
    """
    with np.errstate(invalid="ignore", over="ignore", under="ignore"):
        shifted = x * TWO_BY_PI + ROUNDER
        n = shifted - ROUNDER
        # x - n pi/2 = r - tail: differences whose rounding error is kept (Moller, Knuth).
        t, w = x - n * HALF_PI[0], n * HALF_PI[1]
        r = t - w
        b = t - r
        tail = n * HALF_PI[2] - ((t - (r + b)) + (b - w))
        z = r * r
        zz = z * z
        half = 0.5 * z
        most = 1.0 - half
        sin_r = r - (tail * most - r * z * _polynomial(SINE, z, zz))
        cos_r = most + (((1.0 - most) - half) + (zz * _polynomial(COSINE, z, zz) + r * tail))
    quarter = np.asarray(shifted).view(np.uint64)
    odd = (quarter & np.uint64(1)).astype(bool)
    sign = (quarter & np.uint64(2)) << _SIGN
    other = ((quarter + np.uint64(1)) & np.uint64(2)) << _SIGN
    return _negated(np.where(odd, cos_r, sin_r), sign), _negated(np.where(odd, sin_r, cos_r), other)


def _polynomial(c: tuple[float, ...], z: Array, zz: Array) -> Array:
    """Evaluate a polynomial of degree 5 by pairs of coefficients: a shorter dependency chain than Horner's scheme."""
    return (c[0] + z * c[1]) + zz * ((c[2] + z * c[3]) + zz * (c[4] + z * c[5]))


def _negated(x: Array, sign: npt.NDArray[np.uint64]) -> Array:
    return (np.ascontiguousarray(x).view(np.uint64) ^ sign).view(np.float64)
