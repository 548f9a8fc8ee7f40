"""Conditions that a description states by formula: phi, G and gamma along the motion that constant speeds lead to.

Formulas are evaluated in Taylor series of the time that passes, to the second order: no step is chosen, and no digit is
lost. Coordinates move along their manifold: a quaternion turns by its speeds, and the position of a free joint moves
along its turning axes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

import symofros as sf

from ..contract.interface import States
from ..mechanics.assembly import Assembly
from ..mechanics.geometry import Array, quaternion_matrix, quaternion_product
from ..mechanics.parts import coordinate_symbols, speed_symbols
from .description import evaluate


class Series(NamedTuple):
    """A quantity as value + first s + second s^2, s the time that passes; each a number, or one a state (N,).

    Attributes:
        value: The value.
        first: The rate.
        second: Half of the second derivative.
    """

    value: Any
    first: Any = 0.0
    second: Any = 0.0


def _of(x: Any) -> Series:
    return x if isinstance(x, Series) else Series(x)


def _through(f: Callable[[Any], tuple[Any, Any, Any]]) -> Callable[[Any], Series]:
    """A function of one argument, by its value and its first two derivatives there."""

    def series(argument: Any) -> Series:
        x = _of(argument)
        value, slope, curvature = f(x.value)
        return Series(value, slope * x.first, slope * x.second + 0.5 * curvature * x.first**2)

    return series


def _sum(a: Any, b: Any) -> Series:
    return Series(*(x + y for x, y in zip(_of(a), _of(b), strict=True)))


def _negative(a: Any) -> Series:
    return Series(*(-x for x in _of(a)))


def _product(a: Any, b: Any) -> Series:
    (a0, a1, a2), (b0, b1, b2) = _of(a), _of(b)
    return Series(a0 * b0, a0 * b1 + a1 * b0, a0 * b2 + a1 * b1 + a2 * b0)


def _quotient(a: Any, b: Any) -> Series:
    (a0, a1, a2), (b0, b1, b2) = _of(a), _of(b)
    c0 = a0 / b0
    c1 = (a1 - c0 * b1) / b0
    return Series(c0, c1, (a2 - c1 * b1 - c0 * b2) / b0)


def _power(a: Any, b: Any) -> Series:
    n = _of(b)
    if isinstance(b, Series) and (np.any(n.first) or np.any(n.second)):
        return _OPERATIONS["exp"](_product(b, _OPERATIONS["log"](a)))

    def derivative(x: Any, order: int) -> Any:
        """Derivative of x^n; of a power that is differentiated away nothing is left, at zero either."""
        factor = n.value if order == 1 else n.value * (n.value - 1.0)
        return factor * np.power(np.where(factor == 0.0, 1.0, x), n.value - order)

    return _through(lambda x: (np.power(x, n.value), derivative(x, 1), derivative(x, 2)))(a)


def _angle(a: Any, b: Any) -> Series:
    """atan2(y, x): its rate is (x y' - y x')/(x^2 + y^2)."""
    (y0, y1, y2), (x0, x1, x2) = _of(a), _of(b)
    square, growth = x0**2 + y0**2, 2.0 * (x0 * x1 + y0 * y1)
    rate = (x0 * y1 - y0 * x1) / square
    return Series(np.arctan2(y0, x0), rate, (x0 * y2 - y0 * x2) / square - 0.5 * rate * growth / square)


def _chosen(sign: float) -> Callable[[Any, Any], Series]:
    """The larger (sign 1) or smaller (-1) of two; the mean of both where they are equal, as |x| has no slope at 0."""

    def series(a: Any, b: Any) -> Series:
        first, second = _of(a), _of(b)
        share = 0.5 + 0.5 * sign * np.sign(first.value - second.value)
        return Series(*(share * x + (1.0 - share) * y for x, y in zip(first, second, strict=True)))

    return series


def _tan(x: Any) -> tuple[Any, Any, Any]:
    t = np.tan(x)
    return t, 1.0 + t**2, 2.0 * t * (1.0 + t**2)


def _tanh(x: Any) -> tuple[Any, Any, Any]:
    t = np.tanh(x)
    return t, 1.0 - t**2, -2.0 * t * (1.0 - t**2)


def _asin(x: Any) -> tuple[Any, Any, Any]:
    c = np.sqrt(1.0 - x**2)
    return np.arcsin(x), 1.0 / c, x / c**3


# Operations of formulas -> what they make of series.
_OPERATIONS: Mapping[str, Callable[..., Series]] = {
    "add": _sum,
    "sub": lambda a, b: _sum(a, _negative(b)),
    "mul": _product,
    "div": _quotient,
    "pow": _power,
    "neg": _negative,
    "sqrt": _through(lambda x: (np.sqrt(x), 0.5 / np.sqrt(x), -0.25 / (x * np.sqrt(x)))),
    "exp": _through(lambda x: (np.exp(x),) * 3),
    "log": _through(lambda x: (np.log(x), 1.0 / x, -1.0 / x**2)),
    "sin": _through(lambda x: (np.sin(x), np.cos(x), -np.sin(x))),
    "cos": _through(lambda x: (np.cos(x), -np.sin(x), -np.cos(x))),
    "tan": _through(_tan),
    "asin": _through(_asin),
    "acos": lambda a: _sum(0.5 * np.pi, _negative(_OPERATIONS["asin"](a))),
    "atan": _through(lambda x: (np.arctan(x), 1.0 / (1.0 + x**2), -2.0 * x / (1.0 + x**2) ** 2)),
    "atan2": _angle,
    "sinh": _through(lambda x: (np.sinh(x), np.cosh(x), np.sinh(x))),
    "cosh": _through(lambda x: (np.cosh(x), np.sinh(x), np.cosh(x))),
    "tanh": _through(_tanh),
    "abs": _through(lambda x: (np.abs(x), np.sign(x), 0.0)),
    "sign": _through(lambda x: (np.sign(x), 0.0, 0.0)),
    "min": _chosen(-1.0),
    "max": _chosen(1.0),
}


@np.errstate(divide="ignore", invalid="ignore")
def coupling(
    item: sf.Coupling, parameters: Mapping[str, float], assembly: Assembly, states: States
) -> tuple[Array, Array, Array]:
    """phi(q) = 0: phi (N, 1), G (N, 1, nv) and gamma (N, 1) at v' = 0; NaN outside of the formula's domain."""
    n = len(states)

    def along(v: Array) -> Series:
        values = {**parameters, "pi": np.pi, **_coordinates(assembly, states.q, v)}
        return _spread(evaluate(item.residual, values, _OPERATIONS), n)

    units = np.eye(states.v.shape[1])
    G = np.stack([along(np.tile(unit, (n, 1))).first for unit in units], axis=1)
    phi = along(states.v)
    return phi.value[:, None], G[:, None], -2.0 * phi.second[:, None]


@np.errstate(divide="ignore", invalid="ignore")
def condition_on_speeds(
    item: sf.Nonholonomic, parameters: Mapping[str, float], assembly: Assembly, states: States
) -> tuple[Array, Array, Array]:
    """A(q, t) v = b(q, t) at t = 0: no phi, G (N, 1, nv), and gamma (N, 1) at v' = 0."""
    n, index = len(states), dict[str, int]()
    for described in assembly.joints:
        index |= dict(zip(speed_symbols(described.joint), range(described.v.start, described.v.stop), strict=True))
    values = {**parameters, "pi": np.pi, "t": Series(0.0, 1.0), **_coordinates(assembly, states.q, states.v)}
    G = np.zeros((n, 1, states.v.shape[1]))
    rate = -_spread(evaluate(item.right, values, _OPERATIONS), n).first
    for speed, formula in item.coefficients:
        coefficient = _spread(evaluate(formula, values, _OPERATIONS), n)
        G[:, 0, index[speed]] += coefficient.value
        rate = rate + coefficient.first * states.v[:, index[speed]]
    return np.zeros((n, 1)), G, -rate[:, None]


def _spread(x: Any, n: int) -> Series:
    """A series with arrays of one number a state."""
    return Series(*(np.broadcast_to(np.asarray(part, dtype=float), (n,)) for part in _of(x)))


def _coordinates(assembly: Assembly, q: Array, v: Array) -> dict[str, Series]:
    """Values of the coordinates' symbols along a motion from q (N, nq) at constant speeds (N, nv)."""
    moving = motion(assembly, q, v)
    return {
        name: Series(*(part[:, described.q.start + k] for part in moving))
        for described in assembly.joints
        for k, name in enumerate(coordinate_symbols(described.joint))
    }


def motion(assembly: Assembly, q: Array, v: Array) -> Series:
    """Coordinates along a motion from q (N, nq) at constant speeds (N, nv): three arrays (N, nq)."""
    first, second = np.zeros_like(q), np.zeros_like(q)
    for mover in assembly.movers:
        if not mover.has_quaternion:
            first[:, mover.q] += v[:, mover.v]
            continue
        last, own = slice(mover.q.stop - 4, mover.q.stop), v[:, mover.v]
        w = own[:, -3:]
        turned = np.concatenate([0.5 * w, np.zeros((len(w), 1))], axis=1)
        first[:, last] = quaternion_product(q[:, last], turned)
        second[:, last] = -0.125 * np.sum(w * w, axis=1, keepdims=True) * q[:, last]
        if own.shape[1] > 3:  # The position is in the frame that carries it, its velocity along the body's axes.
            R, place = quaternion_matrix(q[:, last]), slice(mover.q.start, last.start)
            first[:, place] = np.einsum("nij,nj->ni", R, own[:, :3])
            second[:, place] = 0.5 * np.einsum("nij,nj->ni", R, np.cross(w, own[:, :3]))
    return Series(q, first, second)
