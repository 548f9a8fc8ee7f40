"""Verdicts on an engine's answers by the truth."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np

from .functions import FUNCTIONS
from .interface import Array, HasLayout, Link, State, Steps, Tree, Unsupported, Vector, rows, vector
from .proving.pieces import Layout
from .scales import size_of
from .truth.arithmetic import Exact
from .truth.dynamics import ROUNDING, Point, Truth, digits

# "raises": an exception inside the engine that is no refusal of its own. "refuses": in the engine's own words.
# "precondition": documented or asserted by the engine. "repairs": it changed the input, with a warning. "plug-in": a
# limit, refusal or exception of a plug-in or of this harness, which says nothing of the engine.
Verdict = Literal[
    "right",
    "imprecise",
    "wrong",
    "raises",
    "refuses",
    "precondition",
    "repairs",
    "crashes",
    "plug-in",
    "not offered",
]
# Faults of an engine.
RED: tuple[Verdict, ...] = ("wrong", "imprecise", "crashes", "raises")

# An answer may be off by what BACKWARD roundings of its inputs and of each link's force and moment make of it, and by
# FORWARD of its largest entry: good recursions lose some tens of roundings, engines that form 1e3 products in series
# some hundreds. The derivation is in docs/engines.md, "What rounding explains".
BACKWARD = 2000.0
FORWARD = 1e-12
# An answer that is off by more than this part of its largest entry is no matter of rounding: of doubles, more than half
# of the digits are gone; of other numbers, as many of theirs.
GROSS = 1e-6
# What is approximate by its documentation is wrong where it is this much worse than documented.
_FAR = 100.0
# Errors are parts of the largest entry, unless all entries are smaller than this part of what the tree makes of such.
_SMALL = 1e-3
# What differences leave of zeros (`arithmetic`).
_NOTHING = 1e-30

# Part of what an engine offers that it may refuse in words: one that refuses more is not shown to be right by the rest.
REFUSALS = 0.25


@dataclass(frozen=True)
class Cell:
    """One function of one engine on one tree.

    Attributes:
        engine: Name of the plug-in.
        model: Name of the tree.
        function: Name of the function.
        verdict: The verdict.
        error: Largest deviation from the truth, as part of its largest entry; 0 without an answer. Of states, that of
            the worst.
        tolerance: What rounding is known to explain, as part of the largest entry.
        words: What the engine says, or what breaks; at which state, unless it is the first.
    """

    engine: str
    model: str
    function: str
    verdict: Verdict
    error: float = 0.0
    tolerance: float = 0.0
    words: str = ""


@dataclass(frozen=True)
class Expected:
    """The truth of one function at one state.

    Attributes:
        value: Its value.
        allowed: Deviation that rounding explains, or what the engine documents.
        gross: Deviation beyond which it is no matter of either.
        scale: What deviations are parts of: the largest entry, or where all are small, what the tree makes of such.
        approximate: Whether the engine documents what it is off by, or has few digits.
    """

    value: Array
    allowed: float
    gross: float
    scale: float
    approximate: bool = False


def expected(
    function: str,
    tree: Tree,
    model: HasLayout,
    state: State,
    slack: float | Steps = 0.0,
    perturbations: int = 1,
    roundoff: float = ROUNDING,
) -> Expected:
    """The truth, and how far roundings of the inputs move it.

    Args:
        function: Name of the function.
        tree: The tree.
        model: Says how the engine keeps its joints.
        state: Where it is evaluated.
        slack: What the engine documents to be off (`EnginePlugin.slacks`).
        perturbations: Number of perturbed inputs; without any, an answer that is right is so with them, too.
        roundoff: Unit roundoff of the engine's numbers.
    """
    layout = Layout(model.nq, model.nv, model.slots)
    exact_value = _value(function, tree, layout, state)
    value = digits(exact_value)
    value[np.abs(value) < _NOTHING] = 0.0
    size = size_of(function, tree)
    scale = max(largest(value), _SMALL * size)
    # Roundings are so small that what they move is in proportion to them.
    roundings = roundoff / ROUNDING
    allowed = BACKWARD * roundings * _moved(function, tree, layout, state, perturbations)
    if isinstance(slack, Steps):
        # Two values, each off by what rounding explains, apart by a step.
        of = digits(_value(slack.function, tree, layout, state))
        noise = _moved(slack.function, tree, layout, state, perturbations)
        allowed += roundings * (BACKWARD * noise + FORWARD * largest(of)) / slack.step + slack.truncation * scale
    else:
        allowed += max(FORWARD * roundings, slack) * max(largest(value), size)
    gross = _FAR * allowed if slack else GROSS * roundings**0.5 * scale
    return Expected(value, allowed, gross, scale, bool(slack) or roundoff > ROUNDING)


def _value(function: str, tree: Tree, layout: Layout, state: State) -> Exact:
    truth_of = FUNCTIONS[function.partition(":")[0]].truth
    return _truth(tree, layout, None, placed(state)).value(truth_of, Point.of(state))


def _moved(function: str, tree: Tree, layout: Layout, state: State, perturbations: int) -> float:
    """How far a rounding of each input, and of each link's force and moment, moves a function."""
    truth_of = FUNCTIONS[function.partition(":")[0]].truth
    exact_value = _value(function, tree, layout, state)
    moved = 0.0
    for seed in range(perturbations):
        draw = np.random.default_rng(seed)
        truth = _truth(_perturbed_tree(tree, draw), layout, seed, placed(state))
        other = truth.value(truth_of, Point.of(_perturbed_state(state, draw)))
        moved = max(moved, largest(digits(other - exact_value)))
    return moved


@lru_cache(maxsize=12)
def _truth(tree: Tree, layout: Layout, roundings: int | None, place: bytes) -> Truth:
    """Functions of one tree at one state share what they work out: poses, and the dynamics of constraints."""
    return Truth(tree, layout, roundings)


def placed(state: State) -> bytes:
    """A key of a state."""
    return b"|".join(np.asarray(part).tobytes() for part in vars(state).values())


def refusals(cells: Collection[Cell]) -> str:
    """How much of what an engine offers it refuses, and whether that is too much to call it right.

    Args:
        cells: All cells of the engine, those of functions that it does not offer left out.
    """
    refused = sum(cell.verdict == "refuses" for cell in cells)
    bound = f"the bound of {REFUSALS:.0%}"
    held = f"within {bound}" if refused <= REFUSALS * len(cells) else f"above {bound}: what is left shows little of it"
    return f"refuses {refused} of {len(cells)} cells in its own words, {held}"


def largest(values: Array) -> float:
    """The largest magnitude."""
    return float(np.max(np.abs(values), initial=0.0))


def _perturbed_state(state: State, draw: np.random.Generator) -> State:
    parts = (state.q, state.v, state.a, state.tau, state.v2, state.q2)
    return State(*(_rounded(part, draw) for part in parts))


def _rounded(values: Array, draw: np.random.Generator) -> Array:
    """Values that are off by a rounding, zeros by that of the largest beside them."""
    scale = np.where(values == 0.0, largest(values), values)
    return np.asarray(values + scale * draw.choice([-ROUNDING, ROUNDING], values.shape))


def _perturbed_tree(tree: Tree, draw: np.random.Generator) -> Tree:
    constraints = tuple(
        replace(one, ends=tuple(end._replace(p=vector(_rounded(np.asarray(end.p), draw))) for end in one.ends))
        for one in tree.constraints
    )
    return replace(tree, links=tuple(_perturbed_link(link, draw) for link in tree.links), constraints=constraints)


def _perturbed_link(link: Link, draw: np.random.Generator) -> Link:
    def near(values: Vector) -> Vector:
        return vector(_rounded(np.asarray(values), draw))

    inertia = _rounded(np.asarray(link.inertia), draw)
    inertia = (inertia + inertia.T) / 2.0
    joints = tuple(replace(joint, p=near(joint.p)) for joint in link.joints)
    mass = float(_rounded(np.array([link.mass]), draw)[0])
    return replace(link, mass=mass, com=near(link.com), inertia=rows(inertia), joints=joints)


def judge(engine: str, tree: Tree, function: str, answer: Array | Unsupported, want: Expected) -> Cell:
    """The verdict on an answer."""
    if isinstance(answer, Unsupported):
        return Cell(engine, tree.name, function, "refuses" if answer.offered else "not offered", words=answer.reason)
    # A matrix of one column comes as a vector where arrays are Eigen's.
    if answer.size == want.value.size and answer.squeeze().shape == want.value.squeeze().shape:
        answer = answer.reshape(want.value.shape)
    if answer.shape != want.value.shape:
        return Cell(engine, tree.name, function, "wrong", words=f"shape {answer.shape}, not {want.value.shape}")
    if not np.all(np.isfinite(answer)):
        return Cell(engine, tree.name, function, "wrong", words="not finite")
    deviation = largest(answer - want.value)
    verdict: Verdict = "right"
    if deviation > want.allowed:
        verdict = "wrong" if deviation > want.gross else "imprecise"
    return Cell(engine, tree.name, function, verdict, deviation / want.scale, want.allowed / want.scale)
