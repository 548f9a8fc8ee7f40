"""Numbers, vectors and matrices in many digits: with u = v + AWAY, and B of the rows v, a, tau.

The quintic of a sigmoid is y = x^3 (6 x^2 - 15 x + 10). A spring and damper of unit mass, x'' + d x' + k x = 0, decays
by exp(-d t / 2), times cosine and sine of t sqrt(k - d^2 / 4), their hyperbolic kin, or 1 and t. A force (n, t) within
a cone of friction mu is the sum of edges n +- mu t: of each tangent two edges of (n / (dimension - 1) +- t / mu) / 2.
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal

import numpy as np

from ..arithmetic import Exact, cos_sin, cross, exact, eye, root
from ..derived import TruthOf
from ..dynamics import Point, Truth
from .poses import AWAY

# Time of a spring's decay [s]; damping and stiffness of its roots.
DECAY = 0.25
ROOTS = {"complex": (2.0, 5.0), "equal": (4.0, 4.0), "real": (5.0, 4.0)}
# Time constants of a muscle that is activated, and that is not any more [s].
TIMES = (0.0625, 0.25)
# Friction of the two tangents of a contact.
FRICTION = (0.5, 0.25)


def of_state(function: Callable[[Point], object]) -> TruthOf:
    """A function of the state alone, as an array (n)."""

    def truth(t: Truth, s: Point) -> Exact:
        return np.atleast_1d(np.array(function(s), dtype=object))

    return truth


def away(s: Point) -> Exact:
    """U (3), which is never zero."""
    return s.v + exact(AWAY)


def rows(s: Point) -> Exact:
    """B (3, 3)."""
    return np.array([s.v, s.a, s.tau])


def gram(s: Point) -> Exact:
    """B B^T + 1 (3, 3)."""
    return rows(s) @ rows(s).T + eye(3)


def band(s: Point) -> Exact:
    """The same without its corners (3, 3)."""
    A = gram(s)
    A[0, 2] = A[2, 0] = Decimal(0)
    return A


def length(x: Exact) -> Exact:
    """Length of a vector."""
    return root(x @ x)


def product(p: Exact, q: Exact) -> Exact:
    """Product of two quaternions w, x, y, z (4)."""
    return np.array([p[0] * q[0] - p[1:] @ q[1:], *(p[0] * q[1:] + q[0] * p[1:] + cross(p[1:], q[1:]))])


def sigmoid(s: Point) -> object:
    """The quintic at |u| / (1 + |u|), and beyond both ends (5)."""
    parts = [abs(x) / (1 + abs(x)) for x in away(s)]
    return [*(x**3 * (x * (6 * x - 15) + 10) for x in parts), Decimal(0), Decimal(1)]


def decayed(s: Point, roots: str) -> object:
    """Where a spring and damper lead from v[0] at the rate a[0] in DECAY."""
    x, rate, h = s.v[0], s.a[0], Decimal(DECAY)
    damping, stiffness = exact(ROOTS[roots])
    slope, inner = rate + damping / 2 * x, damping * damping / 4 - stiffness
    faded = (-damping / 2 * h).exp()
    if not inner:
        return faded * (x + slope * h)
    turning = root(abs(inner))
    if inner < 0:
        cosine, sine = cos_sin(turning * h)
    else:
        grown, shrunk = (turning * h).exp(), (-turning * h).exp()
        cosine, sine = (grown + shrunk) / 2, (grown - shrunk) / 2
    return faded * (x * cosine + slope / turning * sine)


def muscle_rate(s: Point) -> object:
    """(u - w) / T, T = T0 (1/2 + 3/2 w) as w grows and T1 / (1/2 + 3/2 w) as it falls (`interface.Activation`)."""
    control, state = abs(s.v[0]) / (1 + abs(s.v[0])), abs(s.a[0]) / 2
    grows, falls = exact(TIMES)
    slower = (1 + 3 * state) / 2
    return (control - state) / (grows * slower if control > state else falls / slower)


def contact_force(s: Point) -> Exact:
    """A force (normal, two tangents) within the cone of FRICTION (3)."""
    return np.array([8 * (1 + abs(s.v[1]) + abs(s.v[2])), s.v[1], s.v[2]])


def edges(s: Point) -> object:
    """The four edges of that force."""
    normal, *tangents = contact_force(s)
    sides = [t / mu for t, mu in zip(tangents, exact(FRICTION), strict=True)]
    pairs = [((normal / 2 + side) / 2, (normal / 2 - side) / 2) for side in sides]
    return [edge for pair in pairs for edge in pair]
