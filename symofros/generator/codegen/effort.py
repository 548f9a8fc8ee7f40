"""What one state costs by generated code: which of several ways to compute the same is the cheapest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.program import Function, Program
from symofros.generator.codegen.limbs.plan import LimbPlan
from symofros.generator.codegen.packs import PackPlan, Store, runs_of_lanes

# Whether a function is faster with its packs: on every processor; on some (up to 256-bit vectors); on none.
PackGain = Literal["clear", "in doubt", "none"]

# Weight of an operation on a pack, or of putting a number into one, in operations on numbers; and the ratio of efforts
# up to which they don't tell which is the faster. Both from nineteen models (docs/theory/code.md, section 2).
PACKED, TIE = 2.0, 1.05
# Packs are judged in functions of up to SHORT operations; longer ones gain on AVX2, and lose 4 % at most on AVX-512.
# They don't pay where the ratio of efforts, packs over scalars, is above MOST_STORED (above 1 where no lanes are stored
# together); on 512-bit vectors, where it is above LEAST_DOUBT. From 21 functions of eight models (code.md, section 2).
SHORT, MOST_STORED, LEAST_DOUBT = 1500, 1.03, 0.9


def effort(program: Program, function: Function) -> float:
    """Operations that one state takes: those on packs by their weight, those on equal limbs once.

    Args:
        program: Staged program.
        function: Function of the program.
    """
    graph, edges, given = program.graph, function.edges(), program.pre
    packs = PackPlan(graph, needed_nodes(graph, edges, given), given, edges)
    spared = LimbPlan(graph, packs.nodes, given, edges, program.limbs, packs).spared if program.limbs else 0
    return _effort(packs) - spared


def _effort(plan: PackPlan) -> float:
    numbers = sum(node not in plan.vector_of_node for node in plan.nodes)
    return numbers + PACKED * sum(len(vector.terms) + len(vector.put) for vector in plan.vectors)


def pack_gain(plan: PackPlan, scalars: int, stores: Sequence[Store]) -> PackGain:
    """Whether a function is faster with its packs than with scalars (docs/theory/code.md, section 2).

    Lanes that are read one by one cost an operation each; neighbouring lanes that are stored together cost nothing.

    Args:
        plan: Vectors of the function.
        scalars: Operations of the function without vectors.
        stores: Outputs of the function.
    """
    if not plan.vectors or scalars > SHORT:
        return "clear"
    runs, read = 0, 0
    for vector in plan.vectors:
        own = [store for store in stores if abs(store.edge) in vector.nodes]
        lines, single = runs_of_lanes(vector, own)
        runs += len(lines)
        read += len(vector.nodes) - len(own) + len(single)
    ratio = (_effort(plan) + read) / scalars
    if ratio > (MOST_STORED if runs else 1.0):
        return "none"
    return "in doubt" if ratio > LEAST_DOUBT else "clear"


def cheapest(programs: Mapping[str, Program]) -> str:
    """The program of one function that takes the least effort; the first where that can't tell.

    Args:
        programs: Programs by name, the preferred one first.
    """
    efforts = {name: effort(program, program.functions[0]) for name, program in programs.items()}
    first, cheapest_name = next(iter(efforts)), min(efforts, key=efforts.__getitem__)
    return first if efforts[first] <= TIE * efforts[cheapest_name] else cheapest_name
