"""Parts of spacecraft in many digits: wheels among others, a tank that shares its fuel, a source of gravity.

Sizes x are |v| + 1/2.
"""

from __future__ import annotations

from decimal import Decimal

import numpy as np

from ...interface import STEP
from ..arithmetic import Exact, exact, eye, root
from ..derived import TruthOf
from ..dynamics import Point, Truth
from ..geometry.bodies import sizes
from ..geometry.poses import AWAY

# Gravitational parameter, a unit of length, and the place of a source in these.
MU, LENGTH, SOURCE = 4e14, 1e6, (1.0, -0.5, 0.25)


def wheels(t: Truth, s: Point) -> Exact:
    """Angles, from zero, of two free wheels after a step, as parts of it, and speeds of four (6)."""
    return np.array([*s.v[:2], s.a[0], s.v[0], s.a[1], s.v[1]])


def sensed_first(t: Truth, s: Point) -> Exact:
    """1 + the acceleration without gravity (3) before any step: nothing acts."""
    return eye(3) @ exact(np.ones(3))


def shared_fuel(t: Truth, s: Point) -> Exact:
    """Masses of a tank and of a particle in it (2), of x[0], x[1], after a step with x[2] lost in each second."""
    x = sizes(s)
    whole = x[0] + x[1]
    return x[:2] * (1 - x[2] * Decimal(STEP) / whole)


def pull(t: Truth, s: Point) -> Exact:
    """Force (3) of the source on 1 kg at v2 + AWAY from it: it is the centre, wherever it stands."""
    r = (s.v2 + exact(AWAY)) * Decimal(LENGTH)
    return -Decimal(MU) * r / root(r @ r) ** 3


PARTS: dict[str, tuple[str, TruthOf]] = {
    "wheels_among_others": ("angles of two of four wheels after a step, as parts of it, and speeds of all (6)", wheels),
    "sensed_before_a_step": ("1 + acceleration without gravity of a spacecraft that nothing acts on (3)", sensed_first),
    "tank_shared": ("masses of a tank and of a particle of its fuel after a step with a leak (2)", shared_fuel),
    "pull_of_a_source": ("force of a central source, which states no attitude, on 1 kg at v2 + (4, -8, 8) (3)", pull),
}
