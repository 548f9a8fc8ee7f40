"""A Program evaluated in extended precision: tells rounding from error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import mpmath

from symofros.expr.edges import Edge
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.numerics.extended import extended_rule
from symofros.expr.program import Function, Program


def evaluate_precisely(
    program: Program, function: Function, inputs: Mapping[str, Sequence[Any]], digits: int = 40
) -> list[list[Any]]:
    """The outputs of one function at one state, to many digits.

    Args:
        program: Staged or not; parameters are read from the group "par" either way.
        function: One of its functions.
        inputs: Numbers of each group, as mpmath or exact types.
        digits: Decimal digits to compute with.

    Returns:
        One list an output, row by row, of mpmath numbers.
    """
    with mpmath.workdps(digits):
        values = edge_values(program, function.edges(), inputs)
    results, at = [], 0
    for output in function.outputs:
        results.append(values[at : at + len(output.edges)])
        at += len(output.edges)
    return results


def edge_values(program: Program, edges: Sequence[Edge], inputs: Mapping[str, Sequence[Any]]) -> list[Any]:
    """The values of some edges in mpmath's current precision."""
    graph = program.graph
    values: dict[int, Any] = {node: mpmath.mpf(number) for node, number in graph.value.items()}

    def value(edge: Edge) -> Any:
        node = abs(edge)
        if node == 0:
            return mpmath.mpf(0)
        if node not in values:
            slot = graph.slot[node]
            values[node] = mpmath.mpmathify(inputs[slot.group][slot.index])
        return values[node] if edge > 0 else -values[node]

    for node in needed_nodes(graph, edges):
        values[node] = extended_rule(graph.op[node], mpmath)(*map(value, graph.args[node]))
    return [value(edge) for edge in edges]
