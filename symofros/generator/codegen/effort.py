"""What one state costs by generated code: which of several ways to compute the same is the cheapest."""

from __future__ import annotations

from collections.abc import Mapping

from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.program import Function, Program
from symofros.generator.codegen.packs import PackPlan

# Weight of an operation on a pack, or of putting a number into one, in operations on numbers; and the ratio of efforts
# up to which they don't tell which is the faster. Both from nineteen models (docs/theory/code.md, section 2).
PACKED, TIE = 2.0, 1.05


def effort(program: Program, function: Function) -> float:
    """Operations that one state takes, those on packs by their weight.

    Args:
        program: Staged program.
        function: Function of the program.
    """
    graph, edges, given = program.graph, function.edges(), program.pre
    plan = PackPlan(graph, needed_nodes(graph, edges, given), given, edges)
    numbers = sum(node not in plan.vector_of_node for node in plan.nodes)
    return numbers + PACKED * sum(len(vector.terms) + len(vector.put) for vector in plan.vectors)


def cheapest(programs: Mapping[str, Program]) -> str:
    """The program of one function that takes the least effort; the first where that can't tell.

    Args:
        programs: Programs by name, the preferred one first.
    """
    efforts = {name: effort(program, program.functions[0]) for name, program in programs.items()}
    first, cheapest_name = next(iter(efforts)), min(efforts, key=efforts.__getitem__)
    return first if efforts[first] <= TIE * efforts[cheapest_name] else cheapest_name
