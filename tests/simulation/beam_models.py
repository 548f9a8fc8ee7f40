"""A cantilever whose size, stiffness and loads are run-time parameters: one compilation serves every scale."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

import symofros as sf
from symofros import blocks

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


def at_rest(share: float, L: float) -> tuple[sf.Model, sf.Equilibrium]:
    """A column under a share of its critical load, and where it rests."""
    P, F = share * critical_load() / L**2, 0.2 * (1.0 - share) / L**2
    model = cantilever().with_parameters(P=P, F=F, L=L)
    return model, sf.equilibrium(model)


def column_diagram(model: sf.Model, q: np.ndarray) -> sf.Diagram:
    """Two of these columns as a diagram."""
    diagram = sf.Diagram("bench")
    start = dict(zip(model.names.q, q.tolist(), strict=True))
    diagram.add_model("plant", cantilever_system(), start=start, parameters=dict(model.parameters))
    diagram.add(blocks.ForwardDynamics(name="first", model="plant"))
    diagram.add(blocks.ForwardDynamics(name="second", model="plant"))
    return diagram
