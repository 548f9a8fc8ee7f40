"""Which vectors a function forms of what it computes for equal limbs."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from typing import TypeVar

from symofros.base import routes
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.ops import ADD, STOP_GRADIENT
from symofros.expr.program import Limb
from symofros.generator.codegen.limbs.counterparts import Counterparts
from symofros.generator.codegen.limbs.signs import Signs, are_numbers, choose_signs, products
from symofros.generator.codegen.limbs.vector import TYPES, LimbVector, Operand
from symofros.generator.codegen.packs import PackPlan, Vector

Vertex = TypeVar("Vertex", bound=Hashable)


def strongly_connected(needs: Mapping[Vertex, Collection[Vertex]]) -> Iterator[list[Vertex]]:
    """The groups of vertices of which each depends on each (Tarjan, 1972), of several or of one that needs itself.

    Args:
        needs: What each vertex depends on; those that depend on nothing may be missing.
    """
    order: dict[Vertex, int] = {}
    lowest: dict[Vertex, int] = {}
    open_ones: list[Vertex] = []
    done: set[Vertex] = set()
    for root in needs:
        path = [(root, iter(needs[root]))] if root not in order else []
        while path:
            vertex, remaining = path[-1]
            if vertex not in order:
                order[vertex] = lowest[vertex] = len(order)
                open_ones.append(vertex)
            following = next((other for other in remaining if other in needs and other not in order), None)
            if following is not None:
                path.append((following, iter(needs[following])))
                continue
            path.pop()
            # Of what belongs to no group yet.
            reached = [lowest[other] for other in needs[vertex] if other in order and other not in done]
            lowest[vertex] = min([order[vertex], *reached])
            if lowest[vertex] == order[vertex]:
                group = [open_ones.pop()]
                while group[-1] != vertex:
                    group.append(open_ones.pop())
                done.update(group)
                if len(group) > 1 or vertex in needs[vertex]:
                    yield group


_TRIGONOMETRIC = frozenset(("sin", "cos"))
# Operations in one statement at most.
_MAX_INLINE = 8


class LimbPlan:
    """The vectors of one function.

    Args:
        graph: Graph of the program.
        nodes: Nodes that the function computes, operands first.
        given: Nodes that the function reads from an input array.
        edges: Outputs of the function.
        limbs: Groups of equal limbs.
        packs: Vectors that the function forms besides; None for none.

    Attributes:
        vectors: All vectors that are variables.
        vector_of_node: Vector from which a node is read; nobody else reads a node of a vector that is no variable.
        spared: Operations that the vectors spare, less those that put lanes in, turn their signs and read them one by
            one; 0 where they are too few to form vectors.
    """

    def __init__(
        self,
        graph: Graph,
        nodes: Sequence[int],
        given: Collection[int],
        edges: Iterable[Edge],
        limbs: Iterable[Sequence[Limb]],
        packs: PackPlan | None = None,
    ) -> None:
        self._graph = graph
        self._pack_of_node = packs.vector_of_node if packs is not None else {}
        self._packs = packs.vectors if packs is not None else []
        self._vectors: list[LimbVector] = []
        self._formed: dict[int, LimbVector] = {}
        self._put: dict[tuple[int, ...], LimbVector] = {}
        # Sines and cosines are evaluated in blocks, from scalars.
        sines = [node for node in nodes if graph.op[node] in _TRIGONOMETRIC]
        search = Counterparts(graph, nodes, given, {*needed_nodes(graph, sines, given), *self._pack_of_node})
        for group in limbs:
            search.find(group, max(TYPES))
        self._rows, least = search.rows, routes.LIMB_SHARE * len(nodes)
        if sum(len(row.nodes) - 1 for row in self._rows.by_leader.values()) <= least:
            self._rows.remove(tuple(self._rows.by_leader))
        self._remove_cycles(nodes)
        self._remove_single()
        self._signs = choose_signs(graph, self._rows)
        for leader in sorted(self._rows.by_leader):
            self._form(leader)
        scalars = [n for n in nodes if n not in self._rows.leader_of and n not in self._pack_of_node]
        read = {abs(arg) for n in scalars for arg in graph.args[n]}
        read.update(abs(e) for vector in self._packs for e in vector.edges)
        read.update(abs(e) for vector in self._vectors for term in vector.terms for e in term.edges)
        spared = self._count(read)
        self.spared = spared if spared > least else 0
        self._inline(read.union(map(abs, edges)))
        self.vector_of_node = {node: self._formed[leader] for node, leader in self._rows.leader_of.items()}
        self.vectors = sorted((v for v in self._vectors if not v.is_inlined), key=lambda vector: vector.first_node)

    def _remove_cycles(self, nodes: Sequence[int]) -> None:
        """Leave out vectors that would wait for themselves, through others or through scalars."""
        leader_of, pack_of_node = self._rows.leader_of, self._pack_of_node

        def source(edge: Edge) -> int | Vector:
            """What computes an edge: a row, as the negative of its first node; a pack; or the node itself."""
            node = abs(edge)
            return -leader_of[node] if node in leader_of else pack_of_node.get(node, node)

        needs: dict[int | Vector, set[int | Vector]] = defaultdict(set)
        for node in nodes:
            if node not in pack_of_node:
                needs[source(node)].update(map(source, self._graph.args[node]))
        for vector in self._packs:
            needs[vector].update((*map(source, vector.edges), *vector.operands))
        for group in strongly_connected(needs):
            self._rows.remove(-x for x in group if isinstance(x, int) and x < 0)

    def _remove_single(self) -> None:
        """Drop isolated vectors: no vector user, and no vector operand or one packed from scalars for them alone."""
        while True:
            rows = self._rows.by_leader
            put = Counter(edges for row in rows.values() for edges in row.operands if self._is_put_together(edges))
            read, linked = set[int](), set[int]()
            for leader, row in rows.items():
                sources = {self._rows.leader_of[abs(edges[0])] for edges in row.operands if self._rows.has(edges)}
                read |= sources
                if sources and all(put[edges] != 1 for edges in row.operands):
                    linked.add(leader)
            alone = rows.keys() - linked - read
            if not alone:
                return
            self._rows.remove(alone)

    def _is_put_together(self, edges: Sequence[Edge]) -> bool:
        """Whether a vector of some edges has to be put together from scalars."""
        is_common = len(set(map(abs, edges))) == 1
        return not is_common and not self._rows.has(edges) and not are_numbers(self._graph, edges)

    def _form(self, leader: int) -> None:
        """Form the vector of a row: operands, whose numbers give lanes their signs."""
        row, op, signs = self._rows.by_leader[leader], self._graph.op[leader], self._signs[leader]
        terms = tuple(map(self._operand, row.operands))
        numbers = [term for term, edges in zip(terms, row.operands, strict=True) if are_numbers(self._graph, edges)]
        if op == ADD:
            for term in terms:
                term.signs = products(term.signs, signs)
            for term in numbers:
                if len(set(term.signs)) > 1:
                    term.edges, term.signs = products(term.edges, term.signs), (1,) * len(signs)
        elif numbers:
            numbers[0].edges = products(numbers[0].edges, signs, *(term.signs for term in terms))
        vector = self._formed[leader] = self._vector(leader, len(signs), op, terms)
        vector.nodes = {node: (lane, signs[lane] < 0) for lane, node in enumerate(row.nodes)}

    def _operand(self, edges: tuple[Edge, ...]) -> Operand:
        """An operand from its edge in each lane."""
        signs: Signs = tuple(1 if edge > 0 else -1 for edge in edges)
        nodes = tuple(map(abs, edges))
        if self._rows.has(edges):
            leader = self._rows.leader_of[nodes[0]]
            return Operand(self._formed[leader], (), products(signs, self._signs[leader]))
        if not self._is_put_together(edges):
            return Operand(None, nodes, signs)
        if nodes not in self._put:
            self._put[nodes] = self._vector(nodes[0], len(nodes), "", (Operand(None, nodes, (1,) * len(nodes)),))
        return Operand(self._put[nodes], (), signs)

    def _vector(self, first_node: int, lanes: int, op: str, terms: tuple[Operand, ...]) -> LimbVector:
        key = -1 - len(self._packs) - len(self._vectors)
        vector = LimbVector(key, first_node, min(width for width in TYPES if width >= lanes), op, terms)
        self._vectors.append(vector)
        return vector

    def _inline(self, read: Collection[int]) -> None:
        """Inline vectors that are read once, by another vector alone; long operands get a variable."""
        uses = Counter(term.vector for vector in self._vectors for term in vector.terms)
        for vector in sorted(self._vectors, key=lambda vector: (vector.is_computed, vector.first_node)):
            if vector.size > _MAX_INLINE:
                # The largest operand gets a variable of its own; the rest fits.
                parts = [term.vector for term in vector.terms if term.vector is not None and term.vector.is_inlined]
                max(parts, key=lambda part: part.size).is_inlined = False
            vector.is_inlined = uses[vector] == 1 and vector.nodes.keys().isdisjoint(read)

    def _count(self, read: Collection[int]) -> int:
        """Operations saved, less those that insert lanes, change signs and extract lanes."""
        spared = -sum(len(nodes) - 1 for nodes in self._put)
        for vector in self._formed.values():
            spared += (len(vector.nodes) - 1) * (vector.op != STOP_GRADIENT)
            spared -= sum(lane > 0 for node, (lane, _) in vector.nodes.items() if node in read)
            spared -= sum(vector.op == ADD and len(set(term.signs)) > 1 for term in vector.terms)
        return spared
