"""Instants at which formulas of time bend, jump or change fast, found on their graph (docs/theory/simulation.md, (3a)).

What stands in a formula under an absolute value, a sign, a minimum, a maximum, a floor or a step makes a kink or a jump
where it passes zero; what stands under an exponential, a hyperbolic tangent or in a denominator makes a narrow part of
it where it is small. Only what depends on time and parameters alone is known before a run.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import chain

import numpy as np
import numpy.typing as npt

from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import Evaluation, needed_nodes
from symofros.expr.program import Program

Array = npt.NDArray[np.float64]
Law = Callable[[Array], Array]

# Points over the span at which zeros and extrema are looked for, besides those that an inner formula has shown.
_POINTS = 1025
# Halvings of an interval of time, down to neighbouring numbers; of the golden section, to the precision of an extremum.
_HALVINGS, _SECTIONS = 64, 48
_AT_EDGE = 1e-6
_GOLDEN = 0.5 * (5.0**0.5 - 1.0)
# A part of a formula that lasts longer than this share of the span is not narrow.
_NARROW = 1 / 32
# Instants beside the middle of a narrow part, in times in which the operand changes by one.
_BESIDE = np.array([-16.0, -8.0, -4.0, -2.0, -1.0, 0.0, 1.0, 2.0, 4.0, 8.0, 16.0])
# Middles that are nearer to each other, as a share of the span, are one.
_SAME_MIDDLE = 1e-9
# Operations with a kink or a jump where their operand is zero; floor jumps at every whole number.
_KINKS = frozenset({"abs", "sign", "step"})
_CHOICES = frozenset({"min", "max"})
# Those that change fast only where their operand is small; of the latter a zero is no narrow part, but where they end.
_NARROWING = frozenset({"exp", "tanh", "atan", "sinh", "cosh", "tan"})
_ENDING = frozenset({"div", "pow", "sqrt", "log", "atan2"})


def formula_instants(program: Program, edges: Sequence[Edge], par: Array, t0: float, t_end: float) -> Array:
    """Instants within a span at which a step has to end, so that the next one begins with what begins there.

    Args:
        program: Program whose graph holds the formulas.
        edges: Their edges.
        par: Run-time parameters (npar).
        t0: Start of the span [s].
        t_end: End of the span [s].

    Returns:
        Instants in order, between t0 and t_end (n) [s].
    """
    if not t_end > t0:
        return np.zeros(0)
    graph, found = program.graph, np.zeros(0)

    def law(edge: Edge) -> Law:
        evaluation = Evaluation(program, [edge], {})
        return lambda t: np.broadcast_to(evaluation({"t": t[:, np.newaxis], "par": par[np.newaxis]})[0], t.shape)

    grid = np.linspace(t0, t_end, _POINTS)
    with np.errstate(all="ignore"):  # Operands may overflow, and functions end.
        for f, op in _sources(graph, edges, law):
            points = np.union1d(grid, found)
            nearest = _extrema(f, points)
            instants = _sign_changes(f, np.union1d(points, nearest))
            if op in _ENDING:
                instants = _beside(f, np.setdiff1d(nearest, instants), t_end - t0)
            elif op in _NARROWING:
                instants = _beside(f, np.union1d(instants, nearest), t_end - t0)
            found = np.union1d(found, instants[(instants > t0) & (instants < t_end)])
    return found


def _sources(graph: Graph, edges: Sequence[Edge], law: Callable[[Edge], Law]) -> Iterator[tuple[Law, str]]:
    """What has to be small for a kink or a narrow part, operands first, and the operation that takes it."""
    timed, state = _dependence(graph, edges)

    def known(*args: Edge) -> bool:
        return any(abs(arg) in timed for arg in args) and not any(abs(arg) in state for arg in args)

    for node in needed_nodes(graph, edges):
        op, args = graph.op[node], graph.args[node]
        if op in _CHOICES and known(*args):
            first, second = map(law, args)
            yield lambda t, a=first, b=second: a(t) - b(t), op  # type: ignore[misc]
        elif op in _KINKS and known(args[0]):
            yield law(args[0]), op
        elif op == "floor" and known(args[0]):
            inner = law(args[0])
            yield lambda t, a=inner: np.where(np.floor(a(t)) % 2.0 == 0.0, 1.0, -1.0), op  # type: ignore[misc]
        elif op in _NARROWING or op in _ENDING:
            yield from ((law(arg), op) for arg in args if known(arg))


def _dependence(graph: Graph, edges: Sequence[Edge]) -> tuple[set[int], set[int]]:
    """Nodes that depend on time, and those that depend on more than time and parameters."""
    timed, state = set[int](), set[int]()
    nodes = needed_nodes(graph, edges)
    for node in chain({abs(arg) for one in nodes for arg in graph.args[one]}.union(map(abs, edges)), nodes):
        slot = graph.slot.get(node)
        if slot is not None:
            (timed if slot.group == "t" else state if slot.group != "par" else set[int]()).add(node)
        if any(abs(arg) in timed for arg in graph.args[node]):
            timed.add(node)
        if any(abs(arg) in state for arg in graph.args[node]):
            state.add(node)
    return timed, state


def _extrema(f: Law, t: Array) -> Array:
    """Where f comes nearest to zero, or furthest beyond, between two points of a grid (n) that it is larger at."""
    values = f(t)
    size = np.nan_to_num(np.abs(values), nan=np.inf)
    before, here, after = size[:-2], size[1:-1], size[2:]
    least = np.flatnonzero((here <= before) & (here <= after) & (here < np.maximum(before, after))) + 1
    low, high, side = t[least - 1], t[least + 1], np.sign(values[least])
    for _ in range(_SECTIONS if len(least) else 0):
        left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        is_left = side * f(left) < side * f(right)
        low, high = np.where(is_left, low, left), np.where(is_left, right, high)
    middle = 0.5 * (low + high)
    within = np.minimum(middle - t[least - 1], t[least + 1] - middle) > _AT_EDGE * (t[least + 1] - t[least - 1])
    return middle[within]  # Where f passes zero it is least at an edge.


def _sign_changes(f: Law, t: Array) -> Array:
    """The first number after each change of sign of f between two points of a grid (n)."""
    sign = np.sign(f(t))
    changes = np.flatnonzero((sign[1:] != sign[:-1]) & ~np.isnan(sign[1:] + sign[:-1]))
    low, high, before = t[changes], t[changes + 1], sign[changes]
    for _ in range(_HALVINGS if len(changes) else 0):
        middle = 0.5 * (low + high)
        same = np.sign(f(middle)) == before
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return high


def _beside(f: Law, middles: Array, span: float) -> Array:
    """Instants about the middles of narrow parts: there, and where f has changed by one and by more."""
    instants = []
    reach = span * 0.5 ** np.arange(5.0, 60.0)  # The longest is a narrow part's.
    for middle in middles[np.diff(middles, prepend=-np.inf) > _SAME_MIDDLE * span]:
        here = f(np.full(1, middle))
        changes = np.maximum(np.abs(f(middle + reach) - here), np.abs(f(middle - reach) - here))
        within = np.flatnonzero(changes <= 1.0)
        if len(within) and reach[within[0]] < _NARROW * span:
            instants.append(middle + reach[within[0]] * _BESIDE)
    return np.concatenate([np.zeros(0), *instants])
