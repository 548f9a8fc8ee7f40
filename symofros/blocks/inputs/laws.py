"""Motion laws: how a share s goes from 0 to 1 over time, with its first two derivatives, as formulas without branches.

A path of several moves is the sum of its moves, each times its own share; moves that overlap blend their corner, and
the sum is as smooth as the law.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.tensor import Tensor, joined


class Share(NamedTuple):
    """A share, or several (n), and its rates: [1], [1/s], [1/s^2]."""

    s: Tensor
    rate: Tensor
    acceleration: Tensor


def _quintic(x: Tensor, raw: Tensor, accelerating: float) -> Share:
    """Acceleration is continuous; the peaks are 1.875 / T and 5.7735 / T^2."""
    y = 1.0 - x
    return Share(x**3 * (10.0 - 15.0 * x + 6.0 * x * x), 30.0 * (x * y) ** 2, 60.0 * x * y * (1.0 - 2.0 * x))


def _septic(x: Tensor, raw: Tensor, accelerating: float) -> Share:
    """Jerk is continuous too; the peaks are 2.1875 / T and 7.5132 / T^2."""
    y = 1.0 - x
    s = x**4 * (35.0 - 84.0 * x + 70.0 * x * x - 20.0 * x**3)
    return Share(s, 140.0 * (x * y) ** 3, 420.0 * (x * y) ** 2 * (1.0 - 2.0 * x))


def _trapezoidal(x: Tensor, raw: Tensor, accelerating: float) -> Share:
    """Constant acceleration, constant speed, constant deceleration; the acceleration jumps."""
    a = 1.0 / (accelerating * (1.0 - accelerating))
    late, last = (x - accelerating).apply("max", 0.0), (x - 1.0 + accelerating).apply("max", 0.0)
    jumps = [(raw - at).apply("step") for at in (0.0, accelerating, 1.0 - accelerating, 1.0)]
    s = 0.5 * a * (x * x - late * late - last * last)
    return Share(s, a * (x - late - last), a * (jumps[0] - jumps[1] - jumps[2] + jumps[3]))


LAWS: dict[str, Callable[[Tensor, Tensor, float], Share]] = {
    "quintic": _quintic,
    "septic": _septic,
    "trapezoidal": _trapezoidal,
}


def moves(t: Tensor, law: str, begin: Array, duration: Array, accelerating: float) -> Share:
    """Shares of several moves (n).

    Args:
        t: Time, a scalar.
        law: Name of the law, a key of LAWS.
        begin: Time when each move begins (n) [s].
        duration: Time that each takes (n) [s].
        accelerating: Share of the time that a trapezoidal law accelerates, 0 to 0.5.
    """
    raw = joined([(t - float(b)) / float(d) for b, d in zip(begin, duration, strict=True)])
    profile = LAWS[law](raw.clipped(0.0, 1.0), raw, accelerating)
    return Share(profile.s, profile.rate / duration, profile.acceleration / duration**2)


def spline(t: Tensor, times: Array, table: Array) -> Share:
    """Cubic splines through tables, at rest at both ends, with continuous acceleration between.

    Args:
        t: Time, a scalar.
        times: Times of the knots (k) [s].
        table: Values there (k, m).
    """
    slopes = _slopes(times, table)
    h = np.diff(times)
    c2, c3 = _coefficients(h, np.diff(table, axis=0), slopes)
    within = (t - float(times[0])).apply("step") * (float(times[-1]) - t).apply("step")
    s, rate, acceleration = t * 0.0 + table[0], t * 0.0 + slopes[0], t * 0.0 + 2.0 * c2[0]
    for i in range(len(h)):
        x = (t - float(times[i])).clipped(0.0, float(h[i]))
        s = s + x * (x * (x * c3[i] + c2[i]) + slopes[i])
        rate = rate + x * (x * (3.0 * c3[i]) + 2.0 * c2[i])
        acceleration = acceleration + x * (6.0 * c3[i])
    return Share(s, rate, acceleration * within)


def _slopes(times: Array, table: Array) -> Array:
    """Rates at the knots (k, m) that make the acceleration continuous, zero at both ends."""
    h = np.diff(times)
    chords = np.diff(table, axis=0) / h[:, np.newaxis]
    slopes, diagonal = np.zeros_like(table, dtype=np.float64), 2.0 * (h[:-1] + h[1:])
    # Elimination without pivots, which a dominant diagonal does not need: LAPACK's digits depend on the processor.
    for i in range(1, len(h)):
        slopes[i] = 3.0 * (h[i] * chords[i - 1] + h[i - 1] * chords[i])
        if i > 1:
            factor = h[i] / diagonal[i - 2]
            diagonal[i - 1] -= factor * h[i - 2]
            slopes[i] -= factor * slopes[i - 1]
    for i in range(len(h) - 1, 0, -1):
        slopes[i] = (slopes[i] - h[i - 1] * slopes[i + 1]) / diagonal[i - 1]
    return slopes


def _coefficients(h: Array, change: Array, slopes: Array) -> tuple[Array, Array]:
    """Spline coefficients of x^2 and x^3 in each interval, from its length h, its change and the end slopes."""
    h = h[:, np.newaxis]
    chord = change / h
    return (3.0 * chord - 2.0 * slopes[:-1] - slopes[1:]) / h, (slopes[:-1] + slopes[1:] - 2.0 * chord) / h**2


def through(begin: float, durations: Sequence[float], blend: float) -> Array:
    """When each of several moves begins, where each overlaps the one before by a share of the shorter of both."""
    instants = [begin]
    for before, after in zip(durations, durations[1:], strict=False):
        instants.append(instants[-1] + before - blend * min(before, after))
    return np.array(instants)
