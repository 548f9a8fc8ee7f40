"""How many sections a rod gets that is curved without stress (docs/theory/rods.md, section 6)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from symofros.description.beams.beam import MAX_SECTIONS, Beam
from symofros.description.beams.elastic import PRE_STRAINS
from symofros.description.values import Value
from symofros.mechanics.beams.strain.strains import strains_of

Number = Callable[[Value, float], float]
# Bound of the distance between frames within the rod and where its strains without stress put them, over its length: a
# fifth of what a note begins at, and less than two functions a strain leave of Bathe's arc.
_BOUND = 2e-3
# Stations at which strains without stress are looked at.
_STATIONS = 33


def with_sections(beam: Beam, number: Number) -> Beam:
    """The same rod; where its sections are left to the generator, with those that its own curvature needs, too.

    Args:
        beam: Rod of a checked system.
        number: The number of a value at a station x [m]; NaN where it has none.
    """
    if not beam.modes or beam.sections:
        return beam
    needed = sections_of_turn(*_turn(beam, number))
    if needed <= 2:
        return beam
    chosen = len(strains_of(beam).sections.stations) - 1
    return replace(beam, sections=min(MAX_SECTIONS, chosen + needed - 2))


def sections_of_turn(turn: float, amplitude: float) -> int:
    """Sections, at least 2, through which a tangent that turns is interpolated to the bound.

    Args:
        turn: Angle by which the sections turn from the root to the tip [rad].
        amplitude: Share of the tangent that turns.
    """
    count, error = 2, amplitude * (0.25 * turn) ** 3 / 6.0
    while error > _BOUND:
        count += 1
        error *= 0.25 * turn / (count + 1)
    return count


def _turn(beam: Beam, number: Number) -> tuple[float, float]:
    """Angle by which the sections turn without stress, and the largest share of that which bends the axis."""
    length = number(beam.length, 0.0)
    if all(isinstance(getattr(beam, label), (int, float)) and not getattr(beam, label) for label in PRE_STRAINS):
        return 0.0, 0.0
    rows = np.array(
        [[number(getattr(beam, label), float(x)) for label in PRE_STRAINS] for x in np.linspace(0.0, length, _STATIONS)]
    )
    if not np.all(np.isfinite(rows)):
        return 0.0, 0.0
    rates = np.linalg.norm(rows, axis=1)
    largest = float(rates.max())
    if largest == 0.0:
        return 0.0, 0.0
    bends = float(np.linalg.norm(rows[:, 1:], axis=1).max())
    turn = length * float((0.5 * (rates[1:] + rates[:-1])).mean())
    return (turn, bends / largest) if math.isfinite(turn) else (0.0, 0.0)
