"""Equal limbs in C: what a function computes for each of them, as vectors with a lane a limb.

A leg's equations are those of the other legs, with other joints and other numbers. Nodes correspond if the same
operation forms them from operands that correspond, from numbers, or from what the limbs have in common; they are found
from the joints on. A lane may hold the negative of its node, as mirrored limbs have it. Every lane is computed by the
operations of its node from the same operands (docs/theory/code.md, section 10).
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import reduce
from graphlib import CycleError, TopologicalSorter
from math import prod
from operator import or_, xor

from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.ops import ADD, DIV, MUL, STOP_GRADIENT
from symofros.expr.program import Limb
from symofros.generator.codegen.packs import PackPlan, Store, vector_name

# Types of vectors by their lanes; limbs beyond the last are taken in turns of as many.
TYPES = {2: "sym_pair", 4: "sym_quad"}
_WIDEST = 4
_ARITHMETIC = (ADD, MUL, DIV, STOP_GRADIENT)
_TRIGONOMETRIC = ("sin", "cos")
# Operations between a node and the operands that are known to correspond; operations in one statement.
_DEEPEST, _MAX_INLINE = 6, 8
# Vectors are formed where they spare this share of a function's operations, lanes that are put in or read deducted.
LEAST_SHARE = 0.08

Signs = tuple[int, ...]


@dataclass(eq=False)
class Operand:
    """What a vector is computed from: another vector, or an edge in each lane.

    Attributes:
        vector: The vector; None for edges.
        edges: Numbers, one a lane, or an edge that the limbs have in common; none beside a vector.
        signs: Sign by which each lane counts.
    """

    vector: LimbVector | None
    edges: tuple[Edge, ...]
    signs: Signs

    @property
    def is_common(self) -> bool:
        """Whether all lanes hold one edge."""
        return self.vector is None and len(set(self.edges)) == 1


@dataclass(eq=False)
class LimbVector:
    """A vector variable with a lane for each of some equal limbs, or a part of another one's text.

    Attributes:
        key: Negative number of the variable.
        first_node: Node of the first limb.
        width: Lanes of the variable, those beyond the last limb included.
        op: Operation; "" where scalars are put together.
        terms: Operands.
        nodes: (lane, whether the lane holds the negative) of each node that is read from the vector.
        is_inlined: Whether it stands where it is used.
    """

    key: int
    first_node: int
    width: int
    op: str
    terms: tuple[Operand, ...]
    nodes: dict[int, tuple[int, bool]] = field(default_factory=dict)
    is_inlined: bool = False

    @property
    def _mentioned(self) -> Iterator[Operand]:
        """The operands that its text mentions."""
        waiting = [*self.terms]
        while waiting:
            term = waiting.pop()
            if term.vector is not None and term.vector.is_inlined:
                waiting += term.vector.terms
            else:
                yield term

    @property
    def operands(self) -> list[LimbVector]:
        """Vectors that its text mentions."""
        return [term.vector for term in self._mentioned if term.vector is not None]

    @property
    def edges(self) -> list[Edge]:
        """Scalars that its text mentions."""
        return [edge for term in self._mentioned for edge in term.edges]

    @property
    def is_computed(self) -> bool:
        """Whether an operation gives it."""
        return bool(self.op)

    @property
    def size(self) -> int:
        """Operations of its text."""
        inlined = (term.vector.size for term in self.terms if term.vector is not None and term.vector.is_inlined)
        return (self.op in (ADD, MUL, DIV)) + sum(inlined)

    def lane_text(self, lane: int) -> str:
        """Where a lane is read."""
        return f"{vector_name(self.key)}[{lane}]"

    def lines(self, text: Callable[[Edge], str]) -> list[str]:
        """The line that defines it.

        Args:
            text: Text of a scalar edge.
        """
        return [f"    const {TYPES[self.width]} {vector_name(self.key)} = {self._operation(text)};"]

    def load_line(self, array: str, index: int) -> str:
        """The line that reads it from an array."""
        kind = TYPES[self.width]
        return f"    const {kind} {vector_name(self.key)} = *(const {kind}_anywhere *)({array} + {index});"

    def store_line(self, array: str, index: int) -> str:
        """The line that leaves it in an array."""
        return f"    *({TYPES[self.width]}_anywhere *)({array} + {index}) = {vector_name(self.key)};"

    def stores_of_runs(self, stores: Sequence[Store]) -> tuple[list[str], Sequence[Store]]:
        """Lanes are stored one by one: entries of limbs lie apart."""
        return [], stores

    def _operation(self, text: Callable[[Edge], str]) -> str:
        if self.op == "":
            return self._literal([text(edge) for edge in self.terms[0].edges])
        first, *others = self.terms
        if not others:
            return self._operand(first, text)
        (second,) = others
        if self.op == ADD:
            sign = "-" if max(second.signs) < 0 else "+"
            return f"{self._operand(first, text)} {sign} {self._operand(second, text, is_right=True)}"
        sign = "*" if self.op == MUL else "/"
        left = self._operand(first, text, is_factor=True)
        return f"{left} {sign} {self._operand(second, text, is_factor=True, is_right=True)}"

    def _operand(
        self, term: Operand, text: Callable[[Edge], str], is_factor: bool = False, is_right: bool = False
    ) -> str:
        """An operand's text, in parentheses where C would otherwise group or associate differently.

        Args:
            term: The operand.
            text: Text of a scalar edge.
            is_factor: Whether it is a factor.
            is_right: Whether it follows the sign.
        """
        if term.vector is None and not term.is_common:
            return self._literal([text(edge) for edge in term.edges])
        mixed = self.op == ADD and len(set(term.signs)) > 1
        if term.vector is None:
            shown = text(abs(term.edges[0]))
        elif term.vector.is_inlined and term.vector.op:
            is_sum = term.vector.op in (ADD, STOP_GRADIENT)
            needs = mixed or is_sum and (is_factor or is_right) or (is_factor and is_right)
            shown = f"({term.vector._operation(text)})" if needs else term.vector._operation(text)
        else:
            shown = term.vector._operation(text) if term.vector.is_inlined else vector_name(term.vector.key)
        return f"{self._literal([repr(float(sign)) for sign in term.signs])} * {shown}" if mixed else shown

    def _literal(self, lanes: Sequence[str]) -> str:
        """Such as "(sym_pair){0.1, 0.2}"; lanes beyond the last limb repeat the first, so that they are as harmless."""
        padded = [*lanes, *[lanes[0]] * (self.width - len(lanes))]
        return f"({TYPES[self.width]}){{{', '.join(padded)}}}"


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
        vector_of_node: Vector from which a node is read, or in whose text it is hidden.
        hidden: Nodes that are parts of a text and read by nobody else.
        spared: Operations that the vectors spare, less those that put lanes in, turn their signs and read them one by
            one; 0 where they are too few.
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
        # Sines and cosines are evaluated in blocks, from scalars.
        angles = set(needed_nodes(graph, [graph.args[n][0] for n in nodes if graph.op[n] in _TRIGONOMETRIC], given))
        free = {n for n in nodes if graph.op[n] in _ARITHMETIC and n not in self._pack_of_node and n not in angles}
        search = _Search(graph, nodes, given, free)
        for group in limbs:
            turns = -(-len(group) // _WIDEST)
            for start in range(turns):
                if len(group[start::turns]) > 1:
                    search.match(group[start::turns])
        self._rows, self._leader_of = search.rows, search.leader_of
        self._dissolve_cycles(nodes)
        self._dissolve_single()
        scalars = [n for n in nodes if n not in self._leader_of and n not in self._pack_of_node]
        self._read = {abs(arg) for n in scalars for arg in graph.args[n]}
        self._read.update(abs(edge) for vector in self._packs for edge in vector.edges)
        self._vectors: list[LimbVector] = []
        self._formed: dict[int, LimbVector] = {}
        self._put: dict[tuple[int, ...], LimbVector] = {}
        self._signs: dict[LimbVector, Signs] = {}
        self._signs_of_row = self._choose_signs()
        for leader in sorted(self._rows):
            self._form(leader)
        # An operand may be no row's, but read by lanes that are in common.
        self._read.update(abs(e) for vector in self._vectors for term in vector.terms for e in term.edges)
        spared = self._spared()
        self.spared = spared if spared >= LEAST_SHARE * len(nodes) else 0
        self._inline(self._read.union(map(abs, edges)))
        self.vector_of_node = {node: self._formed[leader] for node, leader in self._leader_of.items()}
        self.vectors = sorted((v for v in self._vectors if not v.is_inlined), key=lambda vector: vector.first_node)
        self.hidden = {node for node, vector in self.vector_of_node.items() if vector.is_inlined}

    def _is_row(self, edges: Sequence[Edge]) -> bool:
        """Whether edges are the lanes of a row, up to signs."""
        leader = self._leader_of.get(abs(edges[0]))
        return leader is not None and self._rows[leader].nodes == tuple(map(abs, edges))

    def _is_put_together(self, edges: Sequence[Edge]) -> bool:
        """Whether a vector of some edges has to be put together from scalars."""
        nodes = set(map(abs, edges))
        return len(nodes) > 1 and not self._is_row(edges) and not nodes <= self._graph.value.keys()

    def _dissolve(self, leaders: Iterable[int]) -> None:
        for leader in leaders:
            for node in self._rows.pop(leader).nodes:
                del self._leader_of[node]

    def _dissolve_single(self) -> None:
        """Leave out vectors that go into no others and come from none, or from scalars of each limb, too."""
        while True:
            read, linked = set[int](), set[int]()
            for leader, row in self._rows.items():
                sources = {self._leader_of[abs(lanes[0])] for lanes in row.operands if self._is_row(lanes)}
                read |= sources
                if sources and not any(map(self._is_put_together, row.operands)):
                    linked.add(leader)
            alone = self._rows.keys() - linked - read
            if not alone:
                return
            self._dissolve(alone)

    def _dissolve_cycles(self, nodes: Sequence[int]) -> None:
        """Leave out vectors that would wait for themselves, through others or through scalars."""

        def item(edge: Edge) -> Hashable:
            """What computes an edge: the vector of its row, its pack, or the node itself."""
            node = abs(edge)
            if node in self._leader_of:
                return "row", self._leader_of[node]
            return self._pack_of_node.get(node, node)

        while True:
            needs: dict[Hashable, set[Hashable]] = defaultdict(set)
            for node in nodes:
                if node not in self._pack_of_node:
                    needs[item(node)].update(map(item, self._graph.args[node]))
            for vector in self._packs:
                needs[vector].update((*map(item, vector.edges), *vector.operands))
            try:
                TopologicalSorter(needs).prepare()
            except CycleError as error:
                self._dissolve({vertex[1] for vertex in error.args[1] if isinstance(vertex, tuple)})
            else:
                return

    def _choose_signs(self) -> dict[int, Signs]:
        """By which sign each lane of each row holds its node, so that both terms of a sum have one sign in all lanes.

        Signs are sums modulo 2 of unknowns, one for each product with a number, whose sign is free. A sum equates two
        of them; where that contradicts others, the second term has signs of its own.
        """
        width = max((len(row.nodes) for row in self._rows.values()), default=0)
        lanes = [_Parities() for _ in range(1, width)]
        for leader in sorted(self._rows):
            row, op = self._rows[leader], self._graph.op[leader]
            for k in range(1, len(row.nodes)):
                parities, known = lanes[k - 1], list[int]()
                has_number = False
                for edges in row.operands:
                    if all(abs(edge) in self._graph.value for edge in edges):
                        has_number = True
                        continue
                    own = parities.of[self._leader_of[abs(edges[0])]] if self._is_row(edges) else 0
                    known.append(own ^ ((edges[k] < 0) != (edges[0] < 0)))
                if op == ADD:
                    parities.of[leader] = known[0]
                    if len(known) > 1:
                        parities.equate(known[0], known[1])
                else:
                    parities.of[leader] = parities.unknown() if has_number else reduce(xor, known)
        return {
            leader: (1, *(-1 if lanes[k].value(leader) else 1 for k in range(len(row.nodes) - 1)))
            for leader, row in self._rows.items()
        }

    def _vector(self, first_node: int, op: str, terms: tuple[Operand, ...], signs: Signs) -> LimbVector:
        key = -1 - len(self._packs) - len(self._vectors)
        vector = LimbVector(key, first_node, min(width for width in TYPES if width >= len(signs)), op, terms)
        self._vectors.append(vector)
        self._signs[vector] = signs
        return vector

    def _form(self, leader: int) -> None:
        """Form the vector of a row: operands, whose numbers give lanes their signs."""
        row, op = self._rows[leader], self._graph.op[leader]
        terms = tuple(map(self._operand, row.operands))
        signs = self._signs_of_row[leader]
        numbers = [term for term in terms if term.vector is None and term.edges[0] in self._graph.value]
        if op == ADD:
            for term in terms:
                term.signs = _products(term.signs, signs)
            for term in numbers:
                term.edges, term.signs = _products(term.edges, term.signs), (1,) * len(signs)
        elif numbers:
            numbers[0].edges = _products(numbers[0].edges, signs, *(term.signs for term in terms))
        vector = self._formed[leader] = self._vector(leader, op, terms, signs)
        vector.nodes = {node: (k, signs[k] < 0) for k, node in enumerate(row.nodes)}

    def _operand(self, edges: tuple[Edge, ...]) -> Operand:
        """An operand from its edge in each lane."""
        signs = tuple(1 if edge > 0 else -1 for edge in edges)
        nodes = tuple(map(abs, edges))
        if self._is_row(edges):
            vector = self._formed[self._leader_of[nodes[0]]]
            return Operand(vector, (), _products(signs, self._signs[vector]))
        if not self._is_put_together(edges):
            return Operand(None, nodes, signs)
        if nodes not in self._put:
            ones = (1,) * len(nodes)
            self._put[nodes] = self._vector(nodes[0], "", (Operand(None, nodes, ones),), ones)
        return Operand(self._put[nodes], (), signs)

    def _inline(self, read: Collection[int]) -> None:
        """Let vectors that one other reads, and nobody else, stand where they are used."""
        uses = Counter(term.vector for vector in self._vectors for term in vector.terms)
        for vector in sorted(self._vectors, key=lambda vector: (bool(vector.op), vector.first_node)):
            if vector.size > _MAX_INLINE:
                # The largest operand gets a variable of its own; the rest fits.
                parts = [term.vector for term in vector.terms if term.vector is not None and term.vector.is_inlined]
                max(parts, key=lambda part: part.size).is_inlined = False
            vector.is_inlined = uses[vector] == 1 and vector.nodes.keys().isdisjoint(read)

    def _spared(self) -> int:
        spared = -sum(len(nodes) - 1 for nodes in self._put)
        for vector in self._formed.values():
            spared += (len(vector.nodes) - 1) * (vector.op != STOP_GRADIENT)
            spared -= sum(lane > 0 for node, (lane, _) in vector.nodes.items() if node in self._read)
            spared -= sum(vector.op == ADD and len(set(term.signs)) > 1 for term in vector.terms)
        return spared


def _products(*rows: Sequence[int]) -> tuple[int, ...]:
    """The products of some rows of signs, or of edges and signs, lane by lane."""
    return tuple(map(prod, zip(*rows, strict=True)))


class _Parities:
    """Sums modulo 2 of unknowns, as bits of an integer; bit 0 is the number one.

    Attributes:
        of: Sum of each row, keyed by its first node.
    """

    def __init__(self) -> None:
        self.of: dict[int, int] = {}
        self._unknowns = 0
        self._known: dict[int, int] = {}  # Sum of earlier unknowns that an unknown equals, keyed by its bit.

    def unknown(self) -> int:
        """A new unknown."""
        self._unknowns += 1
        return 1 << self._unknowns

    def equate(self, one: int, other: int) -> None:
        """Let two sums be equal, unless that contradicts what is stated already."""
        rest = self._reduced(one ^ other)
        if rest > 1:
            last = rest.bit_length() - 1
            self._known[last] = rest ^ (1 << last)

    def value(self, row: int) -> int:
        """The sum of a row, 0 or 1; unknowns of which nothing is stated are 0."""
        return self._reduced(self.of[row]) & 1

    def _reduced(self, total: int) -> int:
        """A sum without the unknowns that others give."""
        for bit in range(total.bit_length() - 1, 0, -1):
            if total >> bit & 1 and bit in self._known:
                total ^= 1 << bit | self._known[bit]
        return total


@dataclass(frozen=True)
class _Row:
    """Nodes that correspond, a lane each.

    Attributes:
        nodes: The nodes.
        operands: For each operand, its edge in each lane.
    """

    nodes: tuple[int, ...]
    operands: tuple[tuple[Edge, ...], ...]


class _Search:
    """Finds the nodes that correspond.

    Args:
        graph: Graph of the program.
        nodes: Nodes that the function computes, operands first.
        given: Nodes that the function reads from an input array.
        free: Nodes that may be lanes of a vector.

    Attributes:
        rows: Rows of nodes that vectors can compute, keyed by the node of the first limb.
        leader_of: First node of the row of each node.
    """

    def __init__(self, graph: Graph, nodes: Sequence[int], given: Collection[int], free: Collection[int]) -> None:
        self._graph, self._nodes, self._given, self._free = graph, nodes, given, free
        self._users: dict[int, list[int]] = defaultdict(list)
        for node in nodes:
            for arg in dict.fromkeys(map(abs, graph.args[node])):
                self._users[arg].append(node)
        self._node_of = {slot: node for node, slot in graph.slot.items()}
        self._taken: set[int] = set()
        self._partners: dict[int, tuple[int, ...]] = {}
        self._limbs: dict[int, int] = {}
        self.rows: dict[int, _Row] = {}
        self.leader_of: dict[int, int] = {}

    def match(self, limbs: Sequence[Limb]) -> None:
        """Find the rows of some equal limbs."""
        self._partners = {}
        for slots in zip(*limbs, strict=True):
            nodes = tuple(self._node_of[slot] for slot in slots if slot in self._node_of)
            if len(nodes) == len(limbs):
                self._join(nodes)
        # The limbs whose joints a node depends on, as bits.
        self._limbs = {}
        for k, limb in enumerate(limbs):
            self._limbs.update((self._node_of[slot], 1 << k) for slot in limb if slot in self._node_of)
        for node in self._nodes:
            self._limbs[node] = reduce(or_, (self._limbs.get(abs(arg), 0) for arg in self._graph.args[node]))
        for node in self._nodes:
            if node in self._taken:
                continue
            known = [arg for arg in map(abs, self._graph.args[node]) if arg in self._partners]
            if not any(self._match_users(node, arg, len(limbs)) for arg in known):
                any(self._match_loosely(node, arg) for arg in known)

    def _join(self, nodes: tuple[int, ...]) -> None:
        self._partners[nodes[0]] = nodes[1:]
        self._taken.update(nodes)

    def _match_users(self, node: int, operand: int, limbs: int) -> bool:
        """Find what corresponds to a node among the users of what corresponds to one of its operands."""
        found: list[dict[int, tuple[int, tuple[Edge, ...]]]] = []
        for partner in self._partners[operand]:
            trial: dict[int, tuple[int, tuple[Edge, ...]]] = {}
            lane = len(found)
            if not any(self._agree(node, other, lane, trial) for other in self._users[partner]):
                return False
            if found and trial.keys() != found[0].keys():
                return False
            found.append(trial)
        if len(set(found[0]).union(*({n for n, _ in trial.values()} for trial in found))) < limbs * len(found[0]):
            return False
        for leader in sorted(found[0]):
            nodes = (leader, *(trial[leader][0] for trial in found))
            self._join(nodes)
            if self._graph.op[leader] not in _TRIGONOMETRIC:
                operands = zip(self._graph.args[leader], *(trial[leader][1] for trial in found), strict=True)
                self.rows[leader] = _Row(nodes, tuple(operands))
                self.leader_of.update(dict.fromkeys(nodes, leader))
        return True

    def _match_loosely(self, node: int, operand: int) -> bool:
        """Find what corresponds to a node but for its other operand, by the place among the users of the first.

        Limbs may differ at their ends; what follows is alike again.
        """
        graph = self._graph
        op = graph.op[node]
        if op not in (ADD, MUL) or node not in self._free:
            return False
        place = [user for user in self._users[operand] if graph.op[user] == op].index(node)
        count = sum(graph.op[user] == op for user in self._users[operand])
        at = 0 if abs(graph.args[node][0]) == operand else 1
        nodes, operands = [node], [graph.args[node]]
        for partner in self._partners[operand]:
            alike = [user for user in self._users[partner] if graph.op[user] == op]
            if len(alike) != count or alike[place] in self._taken or alike[place] not in self._free:
                return False
            nodes.append(alike[place])
            a, b = graph.args[alike[place]]
            operands.append((a, b) if abs((a, b)[at]) == partner else (b, a))
        others = [abs(edges[1 - at]) for edges in operands]
        if len(set(nodes)) < len(nodes) or not self.leader_of.keys().isdisjoint(others):
            return False
        # What depends on several limbs may wait for one of these nodes.
        if any(self._limbs.get(other, 0) & ~(1 << k) for k, other in enumerate(others)):
            return False
        self._join(tuple(nodes))
        self.rows[node] = _Row(tuple(nodes), tuple(zip(*operands, strict=True)))
        self.leader_of.update(dict.fromkeys(nodes, node))
        return True

    def _agree(
        self, edge: Edge, other: Edge, lane: int, trial: dict[int, tuple[int, tuple[Edge, ...]]], depth: int = 0
    ) -> bool:
        """Whether two edges correspond, up to signs.

        Args:
            edge: Edge of the first limb.
            other: Edge of another limb.
            lane: That limb, from 0.
            trial: Nodes that correspond if all does, keyed by those of the first limb, each with its operands in the
                order of the first's; what is found is added.
            depth: Operations between the edge and the node that is asked for.
        """
        graph, a, b = self._graph, abs(edge), abs(other)
        if a in graph.value or b in graph.value:
            return a in graph.value and b in graph.value
        if a in self._given or b in self._given:
            return a in self._given and b in self._given
        if a in self._partners:
            return self._partners[a][lane] == b
        if a in trial:
            return trial[a][0] == b
        if a == b:
            return a not in self._taken and all(a != node for node, _ in trial.values())
        if a in graph.slot or b in graph.slot:
            group = graph.slot[a].group if a in graph.slot and b in graph.slot else "q"
            return group not in ("q", "v", "a") and not {a, b} & self._taken
        if {a, b} & self._taken or b in trial or any(b == node for node, _ in trial.values()):
            return False
        op = graph.op[a]
        is_allowed = (a in self._free and b in self._free) or op in _TRIGONOMETRIC
        if not is_allowed or graph.op[b] != op or depth > _DEEPEST:
            return False
        before, args = dict(trial), graph.args[b]
        for order in (args, args[::-1]) if op in (ADD, MUL) else (args,):
            trial[a] = b, order
            if all(self._agree(x, y, lane, trial, depth + 1) for x, y in zip(graph.args[a], order, strict=True)):
                return True
            trial.clear()
            trial.update(before)
        return False
