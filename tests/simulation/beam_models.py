"""A cantilever whose size, stiffness and loads are run-time parameters: one compilation serves every scale."""

from __future__ import annotations

import math
from functools import cache

import symofros as sf

NAMES = {"L": 1.0, "EI": 1.0, "rho": 1.0, "g": 0.0, "P": 0.0, "F": 0.0}


@cache
def cantilever() -> sf.Model:
    """The cantilever, compiled."""
    return sf.compile(cantilever_system())


def cantilever_system() -> sf.System:
    """A cantilever along x under a compressive force P, a transverse force F and its weight rho g a length."""
    tip = sf.BeamLoad((sf.formula("-P", "load"), sf.formula("F", "load"), 0.0), at=1.0, axes="world")
    weight = sf.BeamLoad((0.0, sf.formula("-rho*g", "weight"), 0.0), axes="world")
    beam = sf.Beam(
        "blade", sf.Joint("root", "fixed"), "L", "rho", EI_z="EI", bend_y=3, family="legendre", loads=(tip, weight)
    )
    parameters = tuple(sf.Parameter(name, value) for name, value in NAMES.items())
    return sf.System("cantilever", (beam,), gravity=(0, 0, 0), parameters=parameters)


def critical_load() -> float:
    """Euler's load of the column of length and stiffness one."""
    return math.pi**2 / 4
