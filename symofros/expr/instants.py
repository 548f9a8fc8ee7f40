"""Operands of formulas of time whose zeros and extrema are instants (docs/theory/simulation.md, (3a)).

What stands in a formula under an absolute value, a sign, a minimum, a maximum, a floor or a step makes a kink or a jump
where it passes zero; what stands under an exponential, a hyperbolic tangent or in a denominator makes a narrow part of
it where it is small. Only what depends on time and parameters alone is known before a run. The instants are sought by
native/stepping/events/formula_instants.c, for runs and in packages.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from enum import IntEnum
from itertools import chain
from typing import NamedTuple

from symofros.expr.edges import ONE, Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.program import Function, Output, Program

# Function of models and packages that gives operands of formulas of time; row of base/functions.py.
OPERANDS = "instant_operands"


class InstantKind(IntEnum):
    """What a formula does where an operand is small: sym_instant_kind of symofros_stepper.h."""

    KINK = 0
    NARROW = 1
    END = 2


class Operand(NamedTuple):
    """An operand of a formula of time.

    Attributes:
        edge: Its value, of time and parameters.
        kind: What the formula does where it is small.
    """

    edge: Edge
    kind: InstantKind


# Operations with a kink or a jump where their operand is zero; floor jumps at every whole number.
_KINKS = frozenset({"abs", "sign", "step"})
_CHOICES = frozenset({"min", "max"})
# Those that change fast only where their operand is small; of the latter a zero is no narrow part, but where they end.
_NARROWING = frozenset({"exp", "tanh", "atan", "sinh", "cosh", "tan"})
_ENDING = frozenset({"div", "pow", "sqrt", "log", "atan2"})


def instant_operands(graph: Graph, edges: Sequence[Edge], *, of_states: bool = False) -> tuple[Operand, ...]:
    """Operands that depend on time and parameters alone, those of inner formulas first.

    Args:
        graph: Graph of the formulas, which receives what the operands take besides.
        edges: Formulas.
        of_states: Whether what depends on the state counts, too: along a motion it is known.
    """
    return tuple(dict.fromkeys(_operands(graph, edges, of_states)))


def operands_function(name: str, graph: Graph, edges: Sequence[Edge]) -> Function:
    """A function of time that gives the operands of formulas, and what kind each is; see `instant_operands`."""
    operands = instant_operands(graph, edges)
    kinds = tuple(graph.constant(float(operand.kind)) for operand in operands)
    shape, values = (len(operands),), tuple(operand.edge for operand in operands)
    return Function(name, "", ("t",), (Output("operand", shape, values), Output("kind", shape, kinds)))


def with_instants(program: Program) -> Program:
    """A program, and what packages ask for the instants of the formulas of time in its functions, if they have any.

    Args:
        program: Functions, not staged yet.
    """
    edges = [edge for function in program.functions for edge in function.edges()]
    function = operands_function(OPERANDS, program.graph, edges)
    return replace(program, functions=(*program.functions, function)) if function.outputs[0].edges else program


def _operands(graph: Graph, edges: Sequence[Edge], of_states: bool) -> Iterator[Operand]:
    timed, state = _dependence(graph, edges)
    if of_states:
        timed, state = timed | state, set()

    def known(*args: Edge) -> bool:
        return any(abs(arg) in timed for arg in args) and not any(abs(arg) in state for arg in args)

    for node in needed_nodes(graph, edges):
        op, args = graph.op[node], graph.args[node]
        if op in _CHOICES and known(*args):
            yield Operand(graph.sub(*args), InstantKind.KINK)
        elif op in _KINKS and known(args[0]):
            yield Operand(args[0], InstantKind.KINK)
        elif op == "floor" and known(args[0]):
            yield Operand(_parity(graph, args[0]), InstantKind.KINK)
        elif op in _NARROWING or op in _ENDING:
            kind = InstantKind.NARROW if op in _NARROWING else InstantKind.END
            first = int(of_states and op == "div")  # A numerator that passes zero ends nothing.
            yield from (Operand(arg, kind) for arg in args[first:] if known(arg))


def _parity(graph: Graph, edge: Edge) -> Edge:
    """1 where the largest whole number up to a value is even, -1 where it is odd."""
    whole, half, two = graph.call("floor", edge), graph.constant(0.5), graph.constant(2.0)
    odd = graph.sub(whole, graph.mul(two, graph.call("floor", graph.mul(half, whole))))
    return graph.sub(ONE, graph.mul(two, odd))


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
