"""Random states at which constraints are compared: those where the rank of their Jacobian G is beyond doubt.

Left out are states where one algorithm may find another rank than the next, and states where G does not exist: a disc
that lies flat has no lowest point. Neither may hide a fault of ours. A state where only our G is not a finite number
counts against us, and so does leaving out more states than a mechanism's singular postures explain. Some mechanisms
have none to be compared at: those whose motion is prescribed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np

import symofros as sf

from ..adapters import has_beams
from ..adapters.closed import of_clear_rank
from ..adapters.compiled import SymofrosEngine
from ..contract.interface import Engine, States
from ..contract.quantities import QUANTITIES
from ..mechanics.assembly import Assembly
from ..mechanics.parts import has_quaternion
from .errors import Comparison, compute

JACOBIAN = QUANTITIES["constraint_jacobian"]

# Share of random states that may be left out. Of the mechanisms at hand Bricard's, whose six hinges leave it movable
# in spite of the count, loses 3.6 %; the others less than 1 %.
MAX_OMITTED = 0.05
# Standard deviations that the number in a small sample may lie above that share.
DEVIATIONS = 3.0


@dataclass(frozen=True)
class RegularStates:
    """Random states, sorted by what constraints can be compared at them.

    Attributes:
        states: States where G has a clear rank.
        undefined: States where our G is not finite.
        omitted: Number of random states left out, the special ones not counted.
        drawn: Number of random states drawn, the special ones not counted.
    """

    states: States
    undefined: States
    omitted: int = 0
    drawn: int = 0


def regular_states(model: SymofrosEngine, states: States, special: int) -> RegularStates:
    """Sort random states by our G and M.

    Args:
        model: Our model, with constraints.
        states: States (N).
        special: Number of the first states that are not random: postures beside which mechanisms are singular.
    """
    M, G = model.mass_matrix(states), model.constraint_jacobian(states)
    defined = np.all(np.isfinite(G), axis=(1, 2))
    # Where our M is not finite, nothing is known of the rank; the state stays, and its M disagrees.
    kept = ~np.all(np.isfinite(M), axis=(1, 2))
    judged = defined & ~kept
    kept[judged] = of_clear_rank(M[judged], G[judged])
    return RegularStates(
        _selected(states, kept), _selected(states, ~defined & ~kept), int((~kept[special:]).sum()), len(kept[special:])
    )


def _selected(states: States, which: np.ndarray) -> States:
    return States(*(getattr(states, item.name)[which] for item in fields(States)))


def judge_omissions(label: str, regular: RegularStates) -> Comparison | None:
    """A failure if too many states, or all, were left out."""
    expected = MAX_OMITTED * regular.drawn
    most = expected + DEVIATIONS * math.sqrt(expected)
    if regular.omitted <= most and len(regular.states):
        return None
    reason = (
        f"{regular.omitted} of {regular.drawn} random states left out ({len(regular.undefined)} where our G is not a "
        f"finite number, the others where its rank is in doubt); singular postures explain {MAX_OMITTED:.0%}"
    )
    return Comparison(label, "symofros", JACOBIAN.name, "failed", note=reason)


def judge_undefined(label: str, engine: Engine, undefined: States) -> Comparison | None:
    """A disagreement if an engine has numbers for G where ours are not finite.

    Args:
        label: Label of the model.
        engine: An engine that states G.
        undefined: States where our G is not finite.
    """
    if not len(undefined):
        return None
    with np.errstate(all="ignore"):  # Where G does not exist, the engine divides by zero, too.
        G = compute(engine, JACOBIAN, undefined)
    alone = int(np.all(np.isfinite(G), axis=(1, 2)).sum())
    if not alone:
        return None
    return Comparison(
        label,
        engine.name,
        JACOBIAN.name,
        "disagree",
        alone,
        tolerance=JACOBIAN.tolerance,
        note=f"our G is not a finite number in {alone} states where the engine's is",
    )


def unsampled_motion(system: sf.System, assembly: Assembly) -> str:
    """The reason why a prescribed motion prevents a comparison, which is not agreement; "" if none does."""
    driven = assembly.driven_joints
    if driven and not has_beams(system):
        return f"joint '{driven[0].name}': a prescribed motion, which no engine for rigid bodies can represent"
    for joint in driven:
        if has_quaternion(joint):
            return f"joint '{joint.name}': a prescribed motion with a quaternion, which the states do not have"
    if driven and any(isinstance(item, sf.Coupling | sf.Nonholonomic) for item in system.constraints):
        return f"joint '{driven[0].name}': a prescribed motion beside a condition by formula"
    return ""
