"""Linear systems, their controllers and their steps, in many digits.

f is x / (1 + |x|) of each component, which no state makes large. A has the rows f(v), f(a), f(v2) less twice the unit
matrix, so that equations of Lyapunov have one solution for nearly all of them; x = tau.
"""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal
from fractions import Fraction

import numpy as np

from ...interface import STEP
from ..arithmetic import Exact, cos_sin, cross, exact, eye, root, rotation, solve, zeros
from ..derived import TruthOf
from ..dynamics import Point, Truth
from ..geometry.bodies import sizes
from ..geometry.turns import turn

# Weights and gains: of places, sums and rates.
GAINS = (3.0, 0.5, 1.25)
# Mass, length of a pendulum and the acceleration of gravity.
PENDULUM = (2.0, 0.75, 9.0)
PERIOD = 0.25
_STEP = Decimal(STEP)
# Steps of integrators of x' = A x + b: x+ = x + h phi(h A) (A x + b), phi a quotient of polynomials, constants first.
INTEGRATORS: dict[str, tuple[Sequence[Fraction], Sequence[Fraction]]] = {
    "explicit_euler": ((Fraction(1),), (Fraction(1),)),
    "runge_kutta2": ((Fraction(1), Fraction(1, 2)), (Fraction(1),)),
    "runge_kutta3": ((Fraction(1), Fraction(1, 2), Fraction(1, 6)), (Fraction(1),)),
    "bogacki_shampine3": ((Fraction(1), Fraction(1, 2), Fraction(1, 6)), (Fraction(1),)),
    # Dormand and Prince's method of order 5 has z^6 / 600 in its stability polynomial.
    "runge_kutta5": (
        tuple(Fraction(1, n) for n in (1, 2, 6, 24, 120, 600)),
        (Fraction(1),),
    ),
    "radau1": ((Fraction(1),), (Fraction(1), Fraction(-1))),
    # Radau IIA of order 3: (1 + z/3) / (1 - 2 z/3 + z^2/6).
    "radau3": ((Fraction(1), Fraction(-1, 6)), (Fraction(1), Fraction(-2, 3), Fraction(1, 6))),
}


def bounded(x: Exact) -> Exact:
    """X / (1 + |x|) of each component."""
    return x / (1 + abs(x))


def matrix(s: Point) -> Exact:
    """A (3, 3)."""
    return np.array([bounded(s.v), bounded(s.a), bounded(s.v2)]) - 2 * eye(3)


def _polynomial(coefficients: Sequence[Fraction], A: Exact) -> Exact:
    total, power = zeros(3, 3), eye(3)
    for one in coefficients:
        total = total + power * Decimal(one.numerator) / Decimal(one.denominator)
        power = power @ A
    return total


def stepped(name: str) -> TruthOf:
    """X after a step of an integrator of x' = A x + f(v) (3)."""
    above, below = INTEGRATORS[name]

    def function(t: Truth, s: Point) -> Exact:
        A = matrix(s)
        rate = A @ s.tau + bounded(s.v)
        return s.tau + _STEP * solve(_polynomial(below, _STEP * A), _polynomial(above, _STEP * A) @ rate)

    return function


def after_update(t: Truth, s: Point) -> Exact:
    """A x + f(v), which a discrete system with that A has after a period (3)."""
    return matrix(s) @ s.tau + bounded(s.v)


def output(t: Truth, s: Point) -> Exact:
    """C x + D u with C = A^T, D = A, u = f(v) (3)."""
    return matrix(s).T @ s.tau + matrix(s) @ bounded(s.v)


def pendulum(t: Truth, s: Point) -> Exact:
    """A and B (2, 3) of a pendulum at the angle tau[0], the rate v[1] and the torque that holds it there.

    With z up, gravity pulls by -m g l sin x; a unit of torque accelerates by 1 / (m l^2).
    """
    mass, length, gravity = (Decimal(x) for x in PENDULUM)
    cosine, _ = cos_sin(s.tau[0])
    inertia = mass * length**2
    return np.array([[Decimal(0), Decimal(1), Decimal(0)], [-gravity / length * cosine, Decimal(0), 1 / inertia]])


def pendulum_torque(t: Truth, s: Point) -> Exact:
    """The torque (1) that makes the acceleration a[0] at the angle tau[0]."""
    mass, length, gravity = (Decimal(x) for x in PENDULUM)
    return np.array([mass * length**2 * s.a[0] + mass * gravity * length * cos_sin(s.tau[0])[1]])


def pendulum_holding(t: Truth, s: Point) -> Exact:
    """The torque (1) that holds it at tau[0]."""
    return pendulum_torque(t, s._replace(a=0 * s.a))


def pendulum_stiffness(t: Truth, s: Point) -> Exact:
    """Torque that GAINS of the angle and the rate lack to v (1)."""
    lacking = s.v[:2] - s.tau[:2]
    return pendulum_holding(t, s) + Decimal(GAINS[0]) * lacking[0] + Decimal(GAINS[2]) * lacking[1]


def regulator(t: Truth, s: Point) -> Exact:
    """K (2) and S (2, 2) of x'' = u with the weights x = |v| + 1/2 of places, rates and u (6).

    A^T S + S A - S B B^T S / r + Q = 0 has S12 = sqrt(q1 r), S22 = sqrt(r (q2 + 2 S12)), S11 = S12 S22 / r;
    K = B^T S / r.
    """
    x = sizes(s)
    beside = root(x[0] * x[2])
    last = root(x[2] * (x[1] + 2 * beside))
    return np.array([beside / x[2], last / x[2], beside * last / x[2], beside, beside, last])


def discrete_regulator(t: Truth, s: Point) -> Exact:
    """K and S (2) of x+ = a x + b u with a = x[0], b = x[1], of the weights x[2] and 1.

    S = a^2 S - (a b S)^2 / (1 + b^2 S) + q is b^2 S^2 + (1 - a^2 - q b^2) S - q = 0; K = a b S / (1 + b^2 S).
    """
    a, b, q = sizes(s)
    half = (1 - a**2 - q * b**2) / 2
    S = (root(half**2 + q * b**2) - half) / b**2
    return np.array([a * b * S / (1 + b**2 * S), S])


def _symmetric(s: Point) -> Exact:
    x = bounded(s.tau)
    return np.outer(x, x) + eye(3)


def solution(t: Truth, s: Point) -> Exact:
    """X = f(tau) f(tau)^T + 1 (3, 3), which equations are made of that it solves."""
    return _symmetric(s)


def controllability(t: Truth, s: Point) -> Exact:
    """(B, A B, A^2 B) of B = f(v) (3, 3)."""
    A, b = matrix(s), bounded(s.v)
    return np.stack([b, A @ b, A @ A @ b], axis=1)


def controlled(t: Truth, s: Point) -> Exact:
    """GAINS of e = a - v, of its integral tau and of its rate v2 - tau (3)."""
    place, total, rate = (Decimal(x) for x in GAINS)
    return place * (s.a - s.v) + total * s.tau + rate * (s.v2 - s.tau)


def filtered_rate(t: Truth, s: Point) -> Exact:
    """(v - tau) / time constant (3)."""
    return (s.v - s.tau) / Decimal(GAINS[2])


def waves(t: Truth, s: Point) -> Exact:
    """2 sin(3 z + 1/2) at z = f(v[0]), its first and its second derivative (3)."""
    cosine, sine = cos_sin(3 * bounded(s.v)[0] + Decimal("0.5"))
    return np.array([2 * sine, 6 * cosine, -18 * sine])


def velocity_composed(t: Truth, s: Point) -> Exact:
    """Velocity of B (6), linear then angular: A has the twist (v; a), B that (v2; tau) in A, at the place f(tau)."""
    return np.concatenate([s.v + cross(s.a, bounded(s.tau)) + s.v2, s.a + s.tau])


def acceleration_composed(t: Truth, s: Point) -> Exact:
    """Acceleration of B (6) with those of A and of B in A (v2; tau) and (v; a), the place f(tau), as above."""
    p, w, u = bounded(s.tau), s.a, s.v2
    linear = s.v2 + cross(s.tau, p) + cross(w, cross(w, p)) + 2 * cross(w, u) + s.v
    return np.concatenate([linear, s.tau + s.a + cross(w, s.tau)])


def acceleration_shifted(t: Truth, s: Point) -> Exact:
    """The acceleration (v; a) at the place f(tau) of a frame that turns with v2 (6)."""
    p = bounded(s.tau)
    return np.concatenate([s.v + cross(s.a, p) + cross(s.v2, cross(s.v2, p)), s.a])


def power(t: Truth, s: Point) -> Exact:
    """Power (1) of the wrench (tau; v2) along the twist (v; a)."""
    return np.array([s.tau @ s.v + s.v2 @ s.a])


def nearest_quaternion(t: Truth, s: Point) -> Exact:
    """What q is made, of the quaternions q and -q, to be near to q2; then with a part w that is not negative (8)."""
    near = s.q if s.q @ s.q2 >= 0 else -s.q
    return np.concatenate([near, s.q if s.q[0] >= 0 else -s.q])


def axes_of_turns(t: Truth, s: Point) -> Exact:
    """Rows of Rx(f(v[0])) Ry(f(v[1])) Rz(f(v[2])) R (9)."""
    total = eye(3)
    for k, angle in enumerate(bounded(s.v)):
        total = total @ rotation(exact(np.eye(3))[k], *cos_sin(angle))
    return (total @ turn(t, s.q)).reshape(9)
