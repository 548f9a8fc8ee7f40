"""Conditions that a description states by formula: phi, G and gamma along the motion that the speeds lead to.

Slopes are taken by complex steps, which lose no digits, along the manifold of q: a quaternion turns by its speeds, and
the position of a free joint moves along its turning axes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

import symofros as sf

from ..contract.interface import States
from ..mechanics.assembly import Assembly
from ..mechanics.geometry import Array, quaternion_matrix, quaternion_product, skew
from ..mechanics.parts import coordinate_symbols, speed_symbols
from .description import NUMPY, evaluate

# A complex step: its square is lost beside the value.
_TINY = 1e-30
# Differences of sixth order: their step, and weights of the steps 1 to 3.
_STEP = 1e-3
_SLOPE = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))
# Terms of the series of turns up to a radian: the next one is below rounding.
_TERMS = 9


def _magnitude(x: Any) -> Any:
    return np.where(np.real(x) < 0.0, -x, x)


def _angle(y: Any, x: Any) -> Any:
    """atan2 to first order in what is imaginary."""
    a, b = np.real(x), np.real(y)
    return np.arctan2(b, a) + 1j * (a * np.imag(y) - b * np.imag(x)) / (a * a + b * b)


# NumPy's own rules of these know no complex numbers, or mean the magnitude in the plane.
_COMPLEX: Mapping[str, Callable[..., Any]] = {
    **NUMPY,
    "abs": _magnitude,
    "sign": lambda x: np.sign(np.real(x)),
    "atan2": _angle,
    "min": lambda x, y: np.where(np.real(x) <= np.real(y), x, y),
    "max": lambda x, y: np.where(np.real(x) >= np.real(y), x, y),
}


def coupling(
    item: sf.Coupling, parameters: Mapping[str, float], assembly: Assembly, states: States
) -> tuple[Array, Array, Array]:
    """phi(q) = 0: phi (N, 1), G (N, 1, nv) and gamma (N, 1) at v' = 0."""
    n = len(states)
    known: dict[str, Any] = {**parameters, "pi": np.pi}

    def at(step: Any) -> Any:
        values = known | _coordinates(assembly, states.q, step)
        return np.broadcast_to(evaluate(item.residual, values, _COMPLEX), (n,))

    def rate(step: float) -> Any:
        return at((step + 1j * _TINY) * states.v).imag / _TINY

    units = np.eye(states.v.shape[1])
    G = np.stack([at(1j * _TINY * np.tile(unit, (n, 1))).imag / _TINY for unit in units], axis=1)
    curvature = sum(w * (rate(k * _STEP) - rate(-k * _STEP)) for k, w in _SLOPE) / _STEP
    return np.array(at(np.zeros_like(states.v)).real)[:, None], G[:, None], -np.asarray(curvature)[:, None]


def condition_on_speeds(
    item: sf.Nonholonomic, parameters: Mapping[str, float], assembly: Assembly, states: States
) -> tuple[Array, Array, Array]:
    """A(q, t) v = b(q, t) at t = 0: no phi, G (N, 1, nv), and gamma (N, 1) at v' = 0."""
    n, index = len(states), {}
    for described in assembly.joints:
        index |= dict(zip(speed_symbols(described.joint), range(described.v.start, described.v.stop), strict=True))

    def at(step: complex) -> tuple[Any, Any]:
        values: dict[str, Any] = {**parameters, "pi": np.pi, "t": step}
        values |= _coordinates(assembly, states.q, step * states.v)
        A = np.zeros((n, states.v.shape[1]), dtype=complex)
        for speed, value in item.coefficients:
            A[:, index[speed]] += evaluate(value, values, _COMPLEX)
        return A, np.broadcast_to(evaluate(item.right, values, _COMPLEX), (n,))

    A, right = at(1j * _TINY)
    rate = (np.einsum("nj,nj->n", A, states.v) - right).imag / _TINY
    return np.zeros((n, 1)), A.real[:, None], -np.asarray(rate)[:, None]


def _coordinates(assembly: Assembly, q: Array, step: Any) -> dict[str, Any]:
    """Values of the coordinates' symbols, moved from q by a step (N, nv) of the speeds."""
    moved = displaced(assembly, q, step)
    return {
        name: moved[:, described.q.start + k]
        for described in assembly.joints
        for k, name in enumerate(coordinate_symbols(described.joint))
    }


def displaced(assembly: Assembly, q: Array, step: Any) -> Any:
    """Coordinates (N, nq) that the speeds lead to within a unit of time.

    Args:
        assembly: The mechanism.
        q: Coordinates to begin with (N, nq).
        step: The constant speeds (N, nv), real or complex; they turn by a radian at most [rad, m].
    """
    moved = np.zeros(q.shape, dtype=np.result_type(q, step)) + q
    for mover in assembly.movers:
        own = step[:, mover.v]
        if not mover.has_quaternion:
            moved[:, mover.q] += own
            continue
        last = slice(mover.q.stop - 4, mover.q.stop)
        turn = own[:, -3:]
        half = 0.5 * turn
        quarter = np.sum(half * half, axis=1, keepdims=True)
        moved[:, last] = quaternion_product(
            q[:, last], np.concatenate([half * _even(quarter, 1), _even(quarter, 0)], axis=1)
        )
        if own.shape[1] > 3:  # Its position is in the frame that carries it, its velocity along its own axes.
            square, K = np.sum(turn * turn, axis=1)[:, None, None], skew(turn)
            mean = np.eye(3) + _even(square, 2) * K + _even(square, 3) * (K @ K)
            along = quaternion_matrix(q[:, last]) @ mean
            moved[:, mover.q.start : last.start] += np.einsum("nij,nj->ni", along, own[:, :3])
    return moved


def _even(square: Any, order: int) -> Any:
    """The sum over k of (-x^2)^k / (2k + order)!: cos x, sin x / x, (1 - cos x) / x^2, (x - sin x) / x^3."""
    return sum((-square) ** k / math.factorial(2 * k + order) for k in range(_TERMS))
