"""States that keep a mechanism's constraints, for engines that close loops themselves."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np

import symofros as sf

from ..adapters.closed import RANK, condition, of_clear_rank
from ..adapters.compiled import SymofrosEngine
from ..contract.conventions import times
from ..contract.interface import States
from ..mechanics.geometry import Array

# Assembly is a search in Python, and some engines rebuild their model for each state.
MOST = 40
# Of the random states from which assembly starts, many lead nowhere. States between two counts of what they led to.
TRIED, COUNTED = 4 * MOST, MOST // 4
# By how much M, each speed measured by its own inertia, and the constraints amplify rounding. Beside a posture where a
# joint's axes align or a loop is at its limit, engines differ by that, and by nothing of theirs.
WORST_CONDITION_OF_M, WORST_CONDITION = 1e5, 2e4
# Share of gamma that may be out of reach: what redundant conditions leave of the postures' own error.
CONSISTENT = 1e-8


# What assembly and the judgement of its postures take.
FUNCTIONS = ("mass_matrix", "constraint", "constraint_rate", "constraint_jacobian", "constraint_bias", "frame_pose")


def assembled_states(system: sf.System, states: States, worst: float = WORST_CONDITION) -> States:
    """States from which loops could be closed, with phi = 0 and G v = b; at most MOST.

    Args:
        system: System with constraints.
        states: States to start from; accelerations and inputs stay as they are, forces are computed anew.
        worst: By how much the constraints may amplify rounding.
    """
    model = sf.compile(system, sf.Options(functions=FUNCTIONS))
    parts: list[States] = []
    for first in range(0, min(len(states), TRIED), COUNTED):
        parts.append(_assembled(model, states[first : first + COUNTED], worst))
        if sum(map(len, parts)) >= MOST:
            break
    joined = [np.concatenate([getattr(part, item.name) for part in parts]) for item in fields(States)]
    return States(*joined)[:MOST]


def _assembled(model: sf.Model, states: States, worst: float) -> States:
    """States, of those given, from which loops could be closed."""
    assemblies, kept = [], []
    for i in range(len(states)):
        try:
            assemblies.append(sf.assemble(model, states.q[i], states.v[i], u=states.u[i]))
        except sf.AssemblyError:
            continue
        kept.append(i)
    if not kept:
        return states[:0]
    q, v = np.array([one.q for one in assemblies]), np.array([one.v for one in assemblies])
    sound = _sound(model, q, states.u[kept], worst)
    sound[sound] = _consistent(model, q[sound], v[sound], states.u[kept][sound])
    return replace(_chosen(states, np.array(kept)[sound]), q=q[sound], v=v[sound])


def with_unique_multipliers(engine: SymofrosEngine, states: States) -> States:
    """The states whose constraints are independent, so that multipliers are unique."""
    rank = engine.model.constrained_dynamics(states.q, states.v, states.u)[2]
    return _chosen(states, rank == engine.model.nc)


def _chosen(states: States, which: Any) -> States:
    return States(*(getattr(states, item.name)[which] for item in fields(States)))


def _consistent(model: sf.Model, q: Array, v: Array, u: Array) -> Array:
    """Whether an acceleration satisfies the constraints (N,): at a singular posture, not for every v with G v = b."""
    G, gamma = model.constraint_jacobian(q, u=u), model.constraint_bias(q, v, u=u)
    left = times(G @ np.asarray(np.linalg.pinv(G, rcond=RANK), dtype=np.float64), gamma) - gamma
    return np.asarray(np.abs(left).max(axis=1) < CONSISTENT * (1.0 + np.abs(gamma).max(axis=1)))


def _sound(model: sf.Model, q: Array, u: Array, worst: float) -> Array:
    M, G = model.mass_matrix(q, u=u), model.constraint_jacobian(q, u=u)
    size = np.sqrt(np.diagonal(M, axis1=1, axis2=2))
    scaled = M / (size[:, :, None] * size[:, None, :])
    sound = of_clear_rank(M, G)
    for i in np.flatnonzero(sound):
        amplified = condition(M[i : i + 1], G[i : i + 1])
        sound[i] = np.linalg.cond(scaled[i]) < WORST_CONDITION_OF_M and amplified < worst
    return sound
