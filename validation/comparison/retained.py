"""Beams of first and zeroth order against every term kept: by which power of the deflection they differ.

An order keeps its terms up to a degree in elastic coordinates and speeds, so with these scaled by eps the difference
to every term kept falls with the next power. Agreement of every term kept with an engine, and this power, together
say that a model of lower order is right.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

import symofros as sf

from ..adapters.compiled import SymofrosEngine
from ..contract.interface import States
from ..mechanics.assembly import Assembly
from ..mechanics.geometry import Array
from .errors import Comparison

NAME = "retained_order"

# The power of the first terms that an order leaves out.
POWERS = {"zeroth_order": 1, "first_order": 2}
# Deviation of the power that is allowed for what the next power still adds at the coarse scale: less than 0.003 on the
# reference models, so that differences are 10^-0.1 = 0.79 of what is allowed wherever the power is right.
MARGIN = 0.1
COARSE, FINE = 1e-2, 1e-3
# Differences below this, relative, are rounding of both sides, and have no power.
ROUNDING_DIFFERENCE = 1e-13
STATES = 50


def omitted_orders(system: sf.System) -> list[str]:
    """The orders below "all" of beams that deform, lowest first."""
    beams = [beam for beam in system.beams if not beam.elastic.is_exact]
    retained = {body.retain for body in beams if body.modes}
    return [order for order in POWERS if order in retained]


def judge_order(
    label: str, order: str, assembly: Assembly, ours: SymofrosEngine, untruncated: SymofrosEngine, states: States
) -> Comparison:
    """Whether M, h and Q differ from those of every term kept by the power that an order states.

    Args:
        label: Label of the model.
        order: The lowest order among its beams.
        assembly: The model as numbers; its elastic coordinates and speeds are scaled.
        ours: The model as described.
        untruncated: The same with every term kept.
        states: States, of which some are scaled.
    """
    few = states[:STATES]
    sizes = _sizes(untruncated, few)
    at = {eps: _differences(ours, untruncated, scaled(assembly, few, eps), sizes) for eps in (COARSE, FINE)}
    if not all(math.isfinite(value) for differences in at.values() for value in differences.values()):
        return Comparison(label, "symofros", NAME, "disagree", len(few), note="not a finite number in some state")
    powers = {
        name: math.log(at[COARSE][name] / fine) / math.log(COARSE / FINE)
        for name, fine in at[FINE].items()
        if fine > ROUNDING_DIFFERENCE
    }
    if not powers:
        return Comparison(label, "symofros", NAME, "unsupported", note=f"{order} leaves out nothing that counts here")
    name, power = min(powers.items(), key=lambda item: item[1])
    factor = (FINE / COARSE) ** (POWERS[order] - MARGIN)
    fine, allowed = at[FINE][name], at[COARSE][name] * factor
    listed = ", ".join(f"{key} {value:.2f}" for key, value in powers.items())
    return Comparison(
        label,
        "symofros",
        NAME,
        "agree" if fine <= allowed else "disagree",
        len(few),
        fine,
        allowed,
        note=f"{order} differs from every term kept by powers of the deflection: {listed}",
        extra={"power": power},
    )


def scaled(assembly: Assembly, states: States, eps: float) -> States:
    """The states with elastic coordinates and speeds times a factor."""
    q, v = states.q.copy(), states.v.copy()
    for mover in assembly.movers:
        if mover.kind == "elastic":
            q[:, mover.q] *= eps
            v[:, mover.v] *= eps
    return replace(states, q=q, v=v)


def _differences(
    ours: SymofrosEngine, untruncated: SymofrosEngine, states: States, sizes: dict[str, float]
) -> dict[str, float]:
    """Norms of the differences of M, h and Q over sizes independent of the scale: some forces are only elastic."""
    one, other = _terms(ours, states), _terms(untruncated, states)
    return {name: float(np.linalg.norm(one[name] - other[name])) / sizes[name] for name in one}


def _sizes(engine: SymofrosEngine, states: States) -> dict[str, float]:
    return {name: float(np.linalg.norm(value)) or 1.0 for name, value in _terms(engine, states).items()}


def _terms(engine: SymofrosEngine, states: States) -> dict[str, Array]:
    M, h, Q = engine.mass_matrix(states), engine.bias(states), engine.generalized_force(states)
    return {"M": M, "h": h, "Q": Q}
