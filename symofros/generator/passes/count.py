"""Operation counts per function, by kind."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.ops import OPS
from symofros.expr.program import Program


@dataclass(frozen=True)
class Operations:
    """Number of operations of each kind that are executed in one call."""

    mul: int = 0
    add: int = 0
    div: int = 0
    call: int = 0

    @property
    def total(self) -> int:
        """The number of all operations."""
        return self.mul + self.add + self.div + self.call

    def __str__(self) -> str:
        """The counts as text, such as "135 mul, 131 add, 10 call"."""
        parts = {"mul": self.mul, "add": self.add, "div": self.div, "call": self.call}
        return ", ".join(f"{count} {name}" for name, count in parts.items() if count) or "none"


def count_operations(graph: Graph, edges: Sequence[Edge], given: Collection[int] = ()) -> Operations:
    """Operations that computing some edges takes; signs are free."""
    counts = Counter(OPS[graph.op[node]].cost for node in needed_nodes(graph, edges, given))
    return Operations(counts["mul"], counts["add"], counts["div"], counts["call"])


def count_program(program: Program) -> dict[tuple[str, str], Operations]:
    """Operations of each function, keyed by (name, frame); of the init stage, keyed by ("init", "")."""
    counts = {
        (function.name, function.frame): count_operations(program.graph, function.edges(), program.pre)
        for function in program.functions
    }
    counts["init", ""] = count_operations(program.graph, program.init)
    return counts
