"""From an engine's answer and the truth to a verdict."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from validation.engines.functions import FUNCTIONS
from validation.engines.interface import Array, HasLayout, Link, State, Tree, Unsupported, Vector, rows, vector
from validation.engines.truth.dynamics import Point, Truth, digits

Verdict = Literal["right", "imprecise", "wrong", "refuses", "crashes", "not offered"]

# An answer may be off by what BACKWARD roundings of each of its inputs make of it, and by FORWARD of its largest entry:
# good recursions lose some tens of roundings, engines that form 1e3 products in series some hundreds.
BACKWARD = 2000.0
FORWARD = 1e-12
# An answer that is off by more than this part of its largest entry is no matter of rounding.
GROSS = 1e-6
# What differences leave of zeros (`arithmetic`).
_NOTHING = 1e-30
_ROUNDING = 2.0**-53


@dataclass(frozen=True)
class Cell:
    """One function of one engine on one tree.

    Attributes:
        engine: Name of the plug-in.
        model: Name of the tree.
        function: Name of the function.
        verdict: The verdict.
        error: Largest deviation from the truth, as part of its largest entry; 0 without an answer.
        tolerance: What rounding explains, as part of the largest entry.
        words: What the engine says, or what breaks.
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
        allowed: Deviation that rounding explains.
        approximate: Whether the engine documents differences of finite steps: their noise is none of its faults.
    """

    value: Array
    allowed: float
    approximate: bool = False


def expected(
    function: str, tree: Tree, model: HasLayout, state: State, slack: float = 0.0, perturbations: int = 1
) -> Expected:
    """The truth, and how far roundings of the inputs move it.

    Args:
        function: Name of the function.
        tree: The tree.
        model: Says how the engine keeps its joints.
        state: Where it is evaluated.
        slack: What the engine documents to be off, as part of the largest entry.
        perturbations: Number of perturbed inputs; without any, gross faults alone are seen.
    """
    truth_of = FUNCTIONS[function.partition(":")[0]].truth
    exact_value = Truth(tree, model).value(truth_of, Point.of(state))
    value = digits(exact_value)
    moved = 0.0
    for seed in range(perturbations):
        draw = np.random.default_rng(seed)
        other = Truth(_perturbed_tree(tree, draw), model).value(truth_of, Point.of(_perturbed_state(state, draw)))
        moved = max(moved, float(np.max(np.abs(digits(other - exact_value)), initial=0.0)))
    value[np.abs(value) < _NOTHING] = 0.0
    # Of what is zero throughout, the trees' own sizes, of order one, say what is small.
    return Expected(value, BACKWARD * moved + max(FORWARD, slack) * (largest(value) or 1.0), slack > 0.0)


def largest(values: Array) -> float:
    """The largest magnitude."""
    return float(np.max(np.abs(values), initial=0.0))


def _perturbed_state(state: State, draw: np.random.Generator) -> State:
    parts = (state.q, state.v, state.a, state.tau, state.v2, state.q2)
    return State(*(_rounded(part, draw) for part in parts))


def _rounded(values: Array, draw: np.random.Generator) -> Array:
    """Values that are off by a rounding, zeros by that of the largest beside them."""
    scale = np.where(values == 0.0, largest(values), values)
    return np.asarray(values + scale * draw.choice([-_ROUNDING, _ROUNDING], values.shape) * 2.0)


def _perturbed_tree(tree: Tree, draw: np.random.Generator) -> Tree:
    return replace(tree, links=tuple(_perturbed_link(link, draw) for link in tree.links))


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
    deviation, scale = largest(answer - want.value), largest(want.value) or 1.0
    verdict: Verdict = "right"
    if deviation > want.allowed:
        gross = deviation > (1.0 if want.approximate else GROSS) * scale
        verdict = "wrong" if gross else "imprecise"
    return Cell(engine, tree.name, function, verdict, deviation / scale, want.allowed / scale)
