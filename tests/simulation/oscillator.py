"""A mass on a spring and a damper, whose motion is known."""

from __future__ import annotations

from functools import cache

import numpy as np

import symofros as sf
from symofros.simulation.stepping.methods import METHODS


def oscillator_system(k: float = 1.0) -> sf.System:
    """x'' = -k x - c x'; the parameters k and c, and an input that adds to the acceleration."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(sf.Spring("k"), sf.Damper("c")), actuated=True)
    body = sf.RigidBody("mass", joint, sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)))
    parameters = [sf.Parameter("k", k), sf.Parameter("c", 0.0)]
    return sf.System("oscillator", [body], parameters, gravity=(0, 0, 0))


@cache
def oscillator() -> sf.Model:
    """The oscillator, compiled."""
    return sf.compile(oscillator_system())


def exact(k: float, c: float, x: float, v: float, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Displacement and speed at times t."""
    rates, modes = np.linalg.eig(np.array([[0.0, 1.0], [-k, -c]], dtype=complex))
    content = np.linalg.solve(modes, [x, v])
    motion = ((modes * content) @ np.exp(np.outer(rates, t))).real
    return motion[0], motion[1]


def fixed(method: str) -> bool | None:
    """The option `adaptive` by which a method takes fixed steps."""
    return False if METHODS[method].adaptive else None
