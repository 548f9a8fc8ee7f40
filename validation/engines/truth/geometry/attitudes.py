"""Three parameters of a rotation in many digits: R of them, angular velocities of their rates, second rates.

The parameters x make R(x); with R' the rate along x', the angular velocity along the turned axes is

    w = S(x) x',  S(x) e_k = vee(R^T dR/dx_k),    x'' = S^-1 (w' - S' x')                                          (7)

x is tau, of Euler angles tau / 4 + ANGLES: far from where they are singular, and near zero where tau is.
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal

import numpy as np

from ..arithmetic import Exact, arc, cos_sin, exact, eye, quaternion_rotation, rate, rotation, solve, stack, vee
from ..derived import TruthOf
from ..dynamics import Point, Truth
from .turns import turned_by

ANGLES = (0.5, 1.0, -0.75)
SEQUENCES = "121 123 131 132 212 213 231 232 312 313 321 323".split()


def of_gibbs(g: Exact) -> Exact:
    """The rotation (3, 3) of the Gibbs vector: axis times the tangent of half the angle."""
    return quaternion_rotation(Decimal(1), *g)


def of_mrp(s: Exact) -> Exact:
    """The rotation (3, 3) of modified Rodrigues parameters: axis times the tangent of a quarter of the angle."""
    return quaternion_rotation(1 - s @ s, *(2 * s))


def about(axis: int, angle: Exact) -> Exact:
    """The rotation (3, 3) about x, y, z (0, 1, 2)."""
    return rotation(eye(3)[axis], *cos_sin(angle))


def of_euler(sequence: str) -> Callable[[Exact], Exact]:
    """Angles -> rotation (3, 3) about successive axes, such as 3, 2, 1 of yaw, pitch, roll."""
    one, two, three = (int(axis) - 1 for axis in sequence)
    return lambda x: about(one, x[0]) @ about(two, x[1]) @ about(three, x[2])


# Name -> rotation of the parameters.
SETS: dict[str, Callable[[Exact], Exact]] = {"gibbs": of_gibbs, "mrp": of_mrp, "prv": turned_by}
SETS |= {f"euler{sequence}": of_euler(sequence) for sequence in SEQUENCES}


def _parameters(name: str, s: Point) -> Exact:
    return s.tau / 4 + exact(ANGLES) if name.startswith("euler") else s.tau


def speeds_of(R: Callable[[Exact], Exact], x: Exact) -> Exact:
    """S (3, 3) of eq. (7)."""
    return stack([vee(R(x).T @ rate(R, x, axis)) for axis in eye(3)])


def of(name: str) -> TruthOf:
    """Rows of R (9)."""
    return lambda t, s: SETS[name](_parameters(name, s)).reshape(9)


def speeds(name: str) -> TruthOf:
    """S (3, 3)."""
    return lambda t, s: speeds_of(SETS[name], _parameters(name, s))


def rates(name: str) -> TruthOf:
    """S^-1 (3, 3)."""
    return lambda t, s: solve(speeds_of(SETS[name], _parameters(name, s)), eye(3))


def _turning(s: Point) -> Exact:
    """S' x' of modified Rodrigues parameters x = tau, x' = a (3)."""
    return rate(lambda x: speeds_of(of_mrp, x), s.tau, s.a) @ s.a


def mrp_rates_rate(t: Truth, s: Point) -> Exact:
    """(S^-1)' of modified Rodrigues parameters x = tau, x' = a (3, 3)."""
    return rate(lambda x: solve(speeds_of(of_mrp, x), eye(3)), s.tau, s.a)


def mrp_second_rates(t: Truth, s: Point) -> Exact:
    """X'' of modified Rodrigues parameters x = tau, x' = a, w' = v2 (3)."""
    return solve(speeds_of(of_mrp, s.tau), s.v2 - _turning(s))


def mrp_acceleration(t: Truth, s: Point) -> Exact:
    """W' of modified Rodrigues parameters x = tau, x' = a, x'' = v2 (3)."""
    return speeds_of(of_mrp, s.tau) @ s.v2 + _turning(s)


def mrp_switched(t: Truth, s: Point) -> Exact:
    """The modified Rodrigues parameters tau, or those of the same rotation that are at most 1 long (3)."""
    square = s.tau @ s.tau
    return -s.tau / square if square > 1 else s.tau


def elementary(t: Truth, s: Point) -> Exact:
    """Rows of the turns about x, y, z by v (3, 9)."""
    return np.array([about(k, s.v[k]).reshape(9) for k in range(3)])


def wrapped(t: Truth, s: Point) -> Exact:
    """The angles 16 v and v, less whole turns, within half a turn (6)."""
    return np.array([arc(*cos_sin(x)) for x in (*(16 * s.v), *s.v)])


ATTITUDES: dict[str, tuple[str, TruthOf]] = {
    "mrp_rates_rate": (
        "time derivative of S^-1 of modified Rodrigues parameters tau, of rates a (3, 3)",
        mrp_rates_rate,
    ),
    "mrp_second_rates": (
        "second rates of these at the angular acceleration v2 in the turned axes (3)",
        mrp_second_rates,
    ),
    "mrp_acceleration": ("that angular acceleration of second rates v2 (3)", mrp_acceleration),
    "mrp_switched": ("the parameters tau, or of the same rotation those within the unit ball (3)", mrp_switched),
    "rotations_elementary": ("rows of the turns about x, y, z by v (3, 9)", elementary),
    "angles_wrapped": ("the angles 16 v and v, within half a turn (6)", wrapped),
}
for _name in SETS:
    ATTITUDES |= {
        f"attitude_of_{_name}": (f"rows of R of the parameters {_name} (9)", of(_name)),
        f"attitude_speeds_{_name}": ("S: angular velocity in the turned axes of their rates (3, 3)", speeds(_name)),
        f"attitude_rates_{_name}": ("S^-1 (3, 3)", rates(_name)),
    }
