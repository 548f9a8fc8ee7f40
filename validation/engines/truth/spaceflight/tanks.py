"""Tanks that drain, in many digits: mass centres and moments by what is left, and their rates.

Of the fuel's mass MASS a part is left, by f = (1 + v0 / (1 + |v0|)) / 2, which changes at the rate v1. Tanks are balls
of radius RADIUS, or cylinders of this radius and of LENGTH along z, about the origins of their frames.
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal

import numpy as np

from ..arithmetic import Exact, rate
from ..derived import TruthOf
from ..dynamics import Point

MASS, RADIUS, LENGTH = 32.0, 0.75, 1.5
_R, _ONE = Decimal(RADIUS), Decimal(1)
# For a unit of mass and of length, and of mass and radius.
_ACROSS: Exact = np.array([_ONE, _ONE, 0 * _ONE]) * (Decimal(LENGTH) ** 2 / 12)
_ALONG: Exact = np.array([_ONE, _ONE, 2 * _ONE]) / 4


def _emptying(f: Decimal) -> Exact:
    """A ball that is filled to the height 2 f of its radius: slices at z are discs of radius squared 1 - z^2."""
    z = 2 * f - 1

    def discs(z: Decimal) -> Decimal:  # Integral of (1 - z^2)^2.
        return z - 2 * z**3 / 3 + z**5 / 5

    def levers(z: Decimal) -> Decimal:  # Integral of z^2 (1 - z^2).
        return z**3 / 3 - z**5 / 5

    disc, lever = 3 * (discs(z) - discs(-_ONE)) / 16, 3 * (levers(z) - levers(-_ONE)) / 4
    centre = -3 * (2 - 2 * f) ** 2 / (4 * (3 - 2 * f)) * _R
    return np.array([centre, *(Decimal(MASS) * _R**2 * x for x in (disc + lever, disc + lever, 2 * disc))])


def _of_mass(moments: Callable[[Decimal], Exact]) -> Callable[[Decimal], Exact]:
    """Centre and moments of fuel of the mass f MASS about its centre, of moments for a unit of mass."""
    return lambda f: np.array([Decimal(0), *(Decimal(MASS) * f * moments(f))])


def _ball(square: Decimal) -> Exact:
    return np.array([square * 2 / 5] * 3, dtype=object)


def _shrinking(f: Decimal) -> Exact:
    return _ball(_R**2 * (f.ln() * 2 / 3).exp())


# How tanks drain -> part f -> z of the mass centre, moments about the tank's x, y, z (4).
TANKS: dict[str, Callable[[Decimal], Exact]] = {
    "emptying": _emptying,
    "of_constant_volume": _of_mass(lambda f: _ball(_R**2)),
    "of_constant_density": _of_mass(_shrinking),
    "burning_evenly": _of_mass(lambda f: _ACROSS + _ALONG * _R**2),
    # From within: the square of the inner radius is (1 - f) of the outer one's.
    "burning_outwards": _of_mass(lambda f: _ACROSS + _ALONG * _R**2 * (2 - f)),
}


def _part(s: Point) -> Decimal:
    return Decimal((1 + s.v[0] / (1 + abs(s.v[0]))) / 2)


def centre(kind: str) -> TruthOf:
    """Mass centre's z (1)."""
    return lambda t, s: TANKS[kind](_part(s))[:1]


def moments(kind: str) -> TruthOf:
    """Moments (3)."""
    return lambda t, s: TANKS[kind](_part(s))[1:]


def centre_rate(kind: str) -> TruthOf:
    """Time derivative of the mass centre's z (1)."""
    return lambda t, s: _rates(kind, s)[:1]


def moment_rates(kind: str) -> TruthOf:
    """Time derivatives of the moments (3)."""
    return lambda t, s: _rates(kind, s)[1:]


def _rates(kind: str, s: Point) -> Exact:
    return rate(lambda f: TANKS[kind](f[0]), np.array([_part(s)]), np.array([Decimal(s.v[1])]))
