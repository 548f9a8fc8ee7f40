"""What the reference tests of beams share: their data, and exact linearisation about a state of rest."""

from __future__ import annotations

from typing import Any

import numpy as np

import symofros as sf
from validation.accuracy.reference import data as data

# Of a system whose beams are clamped or driven, all that linearisation takes.
FUNCTIONS = ("mass_matrix", "bias", "generalized_force")


def cantilever(joint: sf.Joint | None = None, **changed: Any) -> sf.Beam:
    """A beam with length, mass per length and stiffness one, clamped to the world."""
    plain: dict[str, Any] = {"length": 1.0, "rhoA": 1.0, "family": "legendre"}
    for direction, stiffness in (("bend_y", "EI_z"), ("bend_z", "EI_y")):
        if changed.get(direction):
            plain[stiffness] = 1.0
    return sf.Beam("b", joint or sf.Joint("root", "fixed"), **(plain | changed))


def compiled(*bodies: sf.Beam | sf.RigidBody, functions: tuple[str, ...] = FUNCTIONS, **more: Any) -> sf.Model:
    stated = sf.System("s", bodies, **({"gravity": (0, 0, 0)} | more))
    return sf.compile(stated, sf.Options(functions, backend="interpreter"))


def stiffness(m: sf.Model, q: np.ndarray | None = None, u: Any = None, step: float = 0.5, **par: float) -> np.ndarray:
    """K = d(h - Q)/dq (nv, nv) by central differences: exact for a beam alone, whose forces are of second degree."""
    m = m.with_parameters(**par)
    q = np.zeros(m.nq) if q is None else q
    still, steps = np.zeros(m.nv), step * np.eye(m.nq)
    ahead, behind = (
        m.bias(q + dq, still, u=u) - m.generalized_force(q + dq, still, () if u is None else u)
        for dq in (steps, -steps)
    )
    return (ahead - behind).T / (2 * step)
