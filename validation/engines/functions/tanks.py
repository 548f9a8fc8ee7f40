"""Tanks that drain: what is left of their fuel has a mass centre and moments, and these have rates."""

from __future__ import annotations

from ..truth import tanks
from .function import functions_of

_OF = (
    ("centre", "z of the mass centre (1)", tanks.centre),
    ("centre_rate", "its time derivative (1)", tanks.centre_rate),
    ("moments", "moments about x, y, z (3)", tanks.moments),
    ("moment_rates", "their time derivatives (3)", tanks.moment_rates),
)
TANKS = functions_of(
    {f"tank_{name}_{kind}": (f"{words} of a tank {kind}", of(kind)) for kind in tanks.TANKS for name, words, of in _OF},
    "turns",
)
