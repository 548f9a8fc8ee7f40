"""What one state costs by generated code: the figures by which routes are chosen (`base/routes.py`)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache

from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.program import Function, Program
from symofros.generator.codegen.limbs.plan import LimbPlan
from symofros.generator.codegen.packs import PackPlan, Store, runs_of_lanes

# Weight of an operation on a pack, or of putting a number into one, in operations on numbers, from nineteen models
# (docs/theory/code.md, section 2).
PACKED = 2.0


def effort(program: Program, function: Function) -> float:
    """Operations that one state takes: those on packs by their weight, those on equal limbs once."""
    graph, edges, given = program.graph, function.edges(), program.pre
    packs = PackPlan(graph, needed_nodes(graph, edges, given), given, edges)
    spared = LimbPlan(graph, packs.nodes, given, edges, program.limbs, packs).spared if program.limbs else 0
    return _effort(packs) - spared


def _effort(plan: PackPlan) -> float:
    numbers = sum(node not in plan.vector_of_node for node in plan.nodes)
    return numbers + PACKED * sum(len(vector.terms) + len(vector.put) for vector in plan.vectors)


def pack_figures(
    plan: PackPlan | None, scalars: int, stores: Sequence[Store]
) -> dict[str, float | Callable[[], float]]:
    """Quantities that decide whether packs make a function faster than scalars (docs/theory/code.md, section 2).

    Args:
        plan: Vectors of the function; None for none.
        scalars: Operations of the function without vectors.
        stores: Outputs of the function.
    """
    vectors = [] if plan is None else plan.vectors
    own = cache(lambda: [[store for store in stores if abs(store.edge) in vector.nodes] for vector in vectors])
    runs = cache(lambda: [runs_of_lanes(vector, of) for vector, of in zip(vectors, own(), strict=True)])

    def ratio() -> float:
        """Lanes that are read one by one cost an operation each; those that are stored together cost nothing."""
        assert plan is not None
        read = sum(len(vector.nodes) - len(of) for vector, of in zip(vectors, own(), strict=True))
        return (_effort(plan) + read + sum(len(single) for _, single in runs())) / scalars

    return {
        "vectors": len(vectors),
        "operations": scalars,
        "stored_together": lambda: sum(len(lines) for lines, _ in runs()),
        "effort_ratio": ratio,
    }
