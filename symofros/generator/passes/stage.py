"""Hoist what depends on parameters only into an init function.

Post-condition: no function reads `par` or computes a value that only parameters determine; it reads `pre` instead.
"""

from __future__ import annotations

from dataclasses import replace

from symofros.expr.edges import Edge
from symofros.expr.graph import Graph, Slot
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.program import Program


def hoist_parameters(program: Program) -> Program:
    """Split every function at the border between parameters and the rest.

    Args:
        program: Unstaged, or staged and changed since.

    Returns:
        The program with `init` and `pre` filled in; its functions' outputs are unchanged.
    """
    graph = program.graph
    fixed = _parameter_only(graph)
    if not fixed:
        return replace(program, sizes={**program.sizes, "pre": 0})
    border: set[int] = set()
    for function in program.functions:
        edges = function.edges()
        border.update(abs(edge) for edge in edges if abs(edge) in fixed)
        for node in needed_nodes(graph, edges, fixed):
            border.update(abs(arg) for arg in graph.args[node] if abs(arg) in fixed)
    init: tuple[Edge, ...] = tuple(sorted(border))
    pre = {node: Slot("pre", i) for i, node in enumerate(init)}
    return replace(program, init=init, pre=pre, sizes={**program.sizes, "pre": len(init)})


def _parameter_only(graph: Graph) -> set[int]:
    """Nodes that depend on parameters and on nothing else but numbers."""
    fixed = _parameters(graph)
    if not fixed:
        return fixed
    numbers = graph.value
    for node in range(2, len(graph)):
        args = graph.args[node]
        if args and all(abs(arg) in fixed or arg == 0 or abs(arg) in numbers for arg in args):
            fixed.add(node)
    return fixed


def _parameters(graph: Graph) -> set[int]:
    return {node for node, slot in graph.slot.items() if slot.group == "par"}


def check_parameters_unread(program: Program) -> None:
    """Verify that functions read no parameters.

    Raises:
        AssertionError: A function still reads `par`.
    """
    graph = program.graph
    hidden = _parameters(graph).difference(program.pre)
    for function in program.functions if hidden else ():
        for node in needed_nodes(graph, function.edges(), program.pre):
            assert hidden.isdisjoint(map(abs, graph.args[node])), f"{function.name} reads par at node {node}"


def check_staged(program: Program) -> None:
    """Verify the post-condition.

    Raises:
        AssertionError: A function still reads `par`, or computes what only parameters determine.
    """
    check_parameters_unread(program)
    graph, pre = program.graph, program.pre
    for function in program.functions if pre else ():
        for node in needed_nodes(graph, function.edges(), pre):
            args = graph.args[node]
            alone = bool(args) and all(abs(arg) in pre or graph.is_constant(arg) for arg in args)
            assert not alone, f"{function.name} computes node {node}, which only parameters determine"
