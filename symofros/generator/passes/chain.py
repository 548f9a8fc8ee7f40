"""Write sums of products as chains of fused multiply-adds.

A sum whose addends are sums that nothing else reads is one sum of several terms, in any order. A processor adds a
product to a number in one operation, so x + a b + c d takes two of them and (a b + c d) + x three: a chain starts with
a term that is no product (docs/theory/code.md, section 6).

Post-condition: packs are valid, as before; functions share no node that they compute, so each is optimised by itself.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.ops import ADD, MUL
from symofros.expr.packs.carry import carry_packs, mapped_edge
from symofros.expr.program import Function, Program


def chain_sums(program: Program) -> Program:
    """Write the sums of every function as chains that start with a term that is no product.

    Sums that are lanes of packs stay as they are: vectors form them, too, to the same bits. Sums that parameters
    determine stay, as they are evaluated once. Each function gets nodes of its own, because it is evaluated by itself:
    a sum that another function reads is no reason to keep it apart. Terms stand in the order of their creation, so the
    last bits depend on what was formed before.

    Returns:
        The program over a graph of its own, which holds what the functions need; results differ by rounding.
    """
    old, graph = program.graph, Graph()
    new: dict[int, Edge] = {ZERO: ZERO, ONE: ONE}
    for node in range(2, len(old)):
        if node in old.value:
            new[node] = graph.constant(old.value[node])
        elif node in old.slot:
            new[node] = graph.input(old.slot[node].group, old.slot[node].index)
    for node in needed_nodes(old, program.init):
        new[node] = graph.apply(old.op[node], *(mapped_edge(new, arg) for arg in old.args[node]))
    # Precomputed values are kept without the sign that their node has got.
    init = tuple(abs(mapped_edge(new, edge)) for edge in program.init)
    pre = {abs(new[node]): slot for node, slot in program.pre.items()}
    common, lane_sums, packs_of, functions = len(graph), frozenset(_sums_of_lanes(old)), _packs_by_lane(old), []
    for function in program.functions:
        graph.stop_sharing_from(common)
        functions.append(_with_chains(program, function, lane_sums, packs_of, graph, dict(new)))
    return replace(program, graph=graph, functions=tuple(functions), init=init, pre=pre)


def _with_chains(
    program: Program,
    function: Function,
    lane_sums: frozenset[int],
    packs_of: Mapping[int, Sequence[int]],
    graph: Graph,
    new: dict[int, Edge],
) -> Function:
    """One function, formed in another graph.

    Args:
        program: Program of the function.
        function: Function to be formed.
        lane_sums: Sums of the program that stay.
        packs_of: Indices of the packs that have a node as a lane, keyed by node.
        graph: The other graph.
        new: Edges there of numbers, inputs and precomputed values; receives those of all nodes.
    """
    old, sums = program.graph, _Sums(program, function, lane_sums)
    sizes: dict[int, int] = {}
    for node in sums.nodes:
        if node in sums.partial:
            continue
        sizes[node] = len(graph)
        if node in sums.complete:
            new[node] = graph.sum(mapped_edge(new, term) for term in sums.terms(node))
        else:
            new[node] = graph.apply(old.op[node], *(mapped_edge(new, arg) for arg in old.args[node]))
        if node in old.label:
            graph.name(new[node], old.label[node])
    # A program of many functions has many packs: only those that the function computes two lanes of are looked at.
    lanes = Counter(index for node in sizes for index in packs_of.get(node, ()))
    carry_packs((old.packs[index] for index in sorted(lanes) if lanes[index] > 1), graph, new, sizes)

    def rewritten(part: Function) -> Function:
        outputs = tuple(replace(o, edges=tuple(mapped_edge(new, edge) for edge in o.edges)) for o in part.outputs)
        solver = part.solver and replace(part.solver, parts=tuple(map(rewritten, part.solver.parts)))
        return replace(part, outputs=outputs, solver=solver)

    return rewritten(function)


def _packs_by_lane(graph: Graph) -> dict[int, list[int]]:
    """Indices of the packs that have a node as a lane, keyed by node; an index appears once a lane."""
    packs_of: dict[int, list[int]] = defaultdict(list)
    for index, pack in enumerate(graph.packs):
        for edge in pack.lanes:
            packs_of[abs(edge)].append(index)
    return packs_of


class _Sums:
    """The sums of a function, with their terms.

    Args:
        program: Program of the function.
        function: Function whose sums are wanted.
        lane_sums: Sums that stay.

    Attributes:
        nodes: Nodes that the function computes, operands first.
        complete: Sums that are written as chains.
        partial: Sums that become a part of such a chain: each is read once, by another sum.
    """

    def __init__(self, program: Program, function: Function, lane_sums: frozenset[int]) -> None:
        self._graph, edges = program.graph, function.edges()
        op, args, label = program.graph.op, program.graph.args, program.graph.label
        self.nodes = needed_nodes(self._graph, edges, program.pre)
        free = {node for node in self.nodes if op[node] == ADD and node not in lane_sums}
        reads = Counter(abs(arg) for node in self.nodes for arg in args[node])
        reads.update(map(abs, edges))
        reads_by_sums = Counter(abs(arg) for node in self.nodes if op[node] == ADD for arg in args[node])
        addends = {abs(arg) for node in free for arg in args[node]}
        # A label would be lost with a partial sum.
        self.partial = {node for node in free & addends if reads[node] == 1 and node not in label}
        self.complete = free - self.partial
        self._products = {node for node in self.nodes if op[node] == MUL and reads[node] == reads_by_sums[node]}

    def terms(self, node: int) -> list[Edge]:
        """The terms of a complete sum, in the order of their creation but for the first.

        That is the oldest term that is no product; if it is the youngest of all terms, too, nothing is to wait for it.
        """
        terms: list[Edge] = []
        stack = list(self._graph.args[node])
        while stack:
            edge = stack.pop()
            if abs(edge) in self.partial:
                stack += (arg if edge > 0 else -arg for arg in self._graph.args[abs(edge)])
            else:
                terms.append(edge)
        terms.sort(key=abs)
        first = next((i for i, edge in enumerate(terms[:-1]) if abs(edge) not in self._products), 0)
        return [terms.pop(first), *terms]


def _sums_of_lanes(graph: Graph) -> Iterator[int]:
    """Sums that a vector may form: those of a pack's lanes and operands, with the partial sums inside them."""
    for pack in graph.packs:
        yield from range(pack.first_node, 1 + max(map(abs, pack.lanes)))
        packs = (pack, *(operand for _, operand in pack.terms))
        sums = {abs(edge) for one in packs for edge in one.lanes}
        for _ in pack.terms:
            yield from sums
            sums = {abs(arg) for node in sums if graph.op[node] == ADD for arg in graph.args[node]}
