"""A slide after a step in many digits: what drives it, rubs at it or stops it.

It has the mass MASS, stands at f(tau[0]), moves with a[0] and is commanded v[0]; nothing else pulls at it. With h the
step, its coordinate becomes q + h u+, u+ its speed after the step; f is that of `systems.bounded`.
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal

import numpy as np

from ...interface import STEP
from ..arithmetic import Exact
from ..derived import TruthOf
from ..dynamics import Point, Truth
from .systems import bounded

MASS, FRICTION, GRAVITY = 2.0, 3.0, 9.0
# Greatest force, speed and acceleration of bounded drives; a coordinate that limits stop at.
FORCE, SPEED, ACCELERATION, LIMIT = 5.0, 0.125, 0.75, 0.5
_STEP, _MASS = Decimal(STEP), Decimal(MASS)


def place(s: Point) -> Decimal:
    """Coordinate before the step."""
    return Decimal(bounded(s.tau)[0])


def _clipped(x: Decimal, bound: float) -> Decimal:
    return min(max(x, -Decimal(bound)), Decimal(bound))


def _to(speed: Callable[[Point], Decimal]) -> TruthOf:
    """Coordinate and speed (2) after a step."""

    def function(t: Truth, s: Point) -> Exact:
        after = speed(s)
        return np.array([place(s) + _STEP * after, after])

    return function


def _stopped(speed: Callable[[Point], Decimal]) -> TruthOf:
    """The same from LIMIT."""

    def function(t: Truth, s: Point) -> Exact:
        after = speed(s)
        return np.array([Decimal(LIMIT) + _STEP * after, after])

    return function


def _forced(s: Point, force: Decimal) -> Decimal:
    return Decimal(s.a[0] + _STEP * force / _MASS)


def _rubbed(s: Point) -> Decimal:
    """Dry friction takes no more speed than there is."""
    loss = _STEP * Decimal(FRICTION) / _MASS
    return Decimal(s.a[0] - _clipped(s.a[0], float(loss)))


def _served(s: Point) -> Decimal:
    return Decimal(s.a[0] + _clipped(s.v[0] - s.a[0], float(_STEP * Decimal(FORCE) / _MASS)))


# Name -> how it is driven, what it does in a step.
DRIVES: dict[str, tuple[str, TruthOf]] = {
    "force": ("under a commanded force", _to(lambda s: _forced(s, s.v[0]))),
    "force_bounded": ("under a commanded force with a bound", _to(lambda s: _forced(s, _clipped(s.v[0], FORCE)))),
    "passive": ("that nothing drives", _to(lambda s: s.a[0])),
    "velocity": ("with a commanded speed", _to(lambda s: s.v[0])),
    "velocity_bounded": ("with a commanded speed with a bound", _to(lambda s: _clipped(s.v[0], SPEED))),
    "acceleration": ("with a commanded acceleration", _to(lambda s: s.a[0] + _STEP * s.v[0])),
    "acceleration_bounded": (
        "with a commanded acceleration with a bound",
        _to(lambda s: s.a[0] + _STEP * _clipped(s.v[0], ACCELERATION)),
    ),
    "locked": ("that is locked", _to(lambda s: Decimal(0))),
    "servo": ("with a servo that no force is too large for", _to(lambda s: s.v[0])),
    "servo_bounded": ("with a servo of a greatest force", _to(_served)),
    "friction": ("with dry friction", _to(_rubbed)),
    "at_limit": ("at its limit, towards it", _stopped(lambda s: Decimal(0))),
    "from_limit": ("at its limit, away from it", _stopped(lambda s: -abs(s.a[0]))),
    "held_at_limit": ("at its limit, at rest, that a force presses against it", _stopped(lambda s: Decimal(0))),
    "servo_from_limit": (
        "at its limit, at rest, that a load presses against it and a servo drives away",
        _stopped(lambda s: -abs(s.v[0]) - 1),
    ),
}
