"""Packs in C: which of a graph's packs a function forms as vectors, and their text.

The contract of packs is in symofros/expr/packs. A pack is formed as a vector where enough of its new lanes are wanted;
each of those is then read from the vector. Lanes that a linear combination does not give are put in one by one.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.packs.pack import WIDTH, Pack


@dataclass(frozen=True)
class Store:
    """An output entry: array name, index, edge."""

    array: str
    index: int
    edge: Edge


@dataclass(eq=False)
class Vector:
    """A vector variable.

    Attributes:
        key: Negative number of the variable; a scalar's variable has the positive number of its node.
        first_node: Node before which a linear combination is written; 0 for any other vector.
        terms: (factor, vector) of a linear combination; empty for any other vector.
        source: Vector that is copied where there are no terms; None if the vector starts from zeros.
        put: Edge put into a lane, keyed by lane.
        nodes: (lane, whether the lane holds the negative) of each node that is read from the vector.
    """

    key: int
    first_node: int
    terms: tuple[tuple[Edge, Vector], ...] = ()
    source: Vector | None = None
    put: dict[int, Edge] = field(default_factory=dict)
    nodes: dict[int, tuple[int, bool]] = field(default_factory=dict)

    @property
    def width(self) -> int:
        """Doubles of the variable."""
        return WIDTH

    @property
    def is_computed(self) -> bool:
        """Whether it is a linear combination."""
        return bool(self.terms)

    @property
    def operands(self) -> list[Vector]:
        """Vectors that its text mentions."""
        return [vector for _, vector in self.terms] + ([self.source] if self.source else [])

    @property
    def edges(self) -> list[Edge]:
        """Scalars that its text mentions."""
        return [factor for factor, _ in self.terms] + list(self.put.values())

    def lane_text(self, lane: int) -> str:
        """C expression of a lane."""
        return f"sym_lane({vector_name(self.key)}, {lane})"

    def lines(self, text: Callable[[Edge], str]) -> list[str]:
        """The lines that define it."""
        name = vector_name(self.key)
        if self.terms:
            start = _sum(self.terms, text)
        elif self.source is not None:
            start = vector_name(self.source.key)
        else:
            lanes = ", ".join(text(self.put.get(lane, ZERO)) for lane in range(WIDTH))
            return [f"    const sym_pack {name} = SYM_PACK({lanes});"]
        if not self.put:
            return [f"    const sym_pack {name} = {start};"]
        puts = [f"    {name} = sym_with({name}, {lane}, {text(edge)});" for lane, edge in sorted(self.put.items())]
        return [f"    sym_pack {name} = {start};", *puts]

    def load_line(self, array: str, index: int) -> str:
        """The line that reads it from an array."""
        return f"    const sym_pack {vector_name(self.key)} = sym_pack_load({array} + {index});"

    def store_line(self, array: str, index: int) -> str:
        """The line that leaves it in an array."""
        return f"    sym_pack_store({array} + {index}, {vector_name(self.key)});"

    def stores_of_runs(self, stores: Sequence[Store]) -> tuple[list[str], Sequence[Store]]:
        """Lines that fill neighbouring entries of outputs from neighbouring lanes, and the stores that remain."""
        return runs_of_lanes(self, stores)


@dataclass(frozen=True)
class _FormedPack:
    """A pack that a function forms as a vector.

    Attributes:
        lane_of_node: Lane of each node that is read from the vector.
        exact_lanes: Lanes that the terms give, as all their operands are available.
    """

    lane_of_node: dict[int, int]
    exact_lanes: frozenset[int]


class PackPlan:
    """The vectors of one function.

    Args:
        graph: Graph of the program.
        wanted: Nodes that the function computes if all are scalars.
        given: Nodes that the function reads from an input array.
        edges: Outputs of the function.

    Attributes:
        vector_of_node: Vector from which a node is read.
        nodes: Nodes that the function needs one by one, operands first; those that are read from vectors among them.
        vectors: All vectors, in the order of their `first_node`.
    """

    def __init__(self, graph: Graph, wanted: Sequence[int], given: Collection[int], edges: Iterable[Edge]) -> None:
        self._graph = graph
        self._given = given
        inputs = {node for node, slot in graph.slot.items() if slot.group != "par"}
        self._available = {*wanted, *given, *graph.value, ZERO, *inputs}
        self._formed: dict[Pack, _FormedPack] = {}
        self._pack_of_node: dict[int, Pack] = {}
        self._vectors: dict[Pack, Vector] = {}
        self.vector_of_node: dict[int, Vector] = {}
        self._ready_lanes: set[tuple[Pack, int]] = set()
        self._pending: list[Callable[[], None]] = []
        self._needed: set[int] = set()
        # Angles come first, and from scalars: all sines and cosines are evaluated in blocks.
        angles = [graph.args[node][0] for node in wanted if graph.op[node] in ("sin", "cos")]
        self._choose(set(wanted).difference(needed_nodes(graph, angles, given)))
        self._resolve([abs(edge) for edge in edges])
        self.nodes = sorted(self._needed)
        self.vectors = sorted(self._vectors.values(), key=lambda vector: vector.first_node)

    def _choose(self, wanted: set[int]) -> None:
        """Select the packs to be formed: those with enough lanes that are wanted and can be computed."""
        for pack in self._graph.packs:
            if not self._are_available(factor for factor, _ in pack.terms):
                continue  # Parameters alone determine it, in lanes that this function does not need.
            exact = frozenset(
                lane for lane in pack.exact_lanes if self._are_available(edge for _, edge in pack.operands(lane))
            )
            lane_of_node: dict[int, int] = {}
            for lane in sorted(exact & pack.new_lanes):
                node = abs(pack.lanes[lane])
                if node in wanted and node not in self._pack_of_node:
                    lane_of_node.setdefault(node, lane)
            put = [edge for lane, edge in enumerate(pack.lanes) if lane not in exact and self._are_available((edge,))]
            for node in self._made_of(put, lane_of_node):
                del lane_of_node[node]
            if len(lane_of_node) >= pack.min_lanes:
                self._formed[pack] = _FormedPack(lane_of_node, exact)
                self._pack_of_node.update(dict.fromkeys(lane_of_node, pack))

    def _are_available(self, edges: Iterable[Edge]) -> bool:
        return all(abs(edge) in self._available for edge in edges)

    def _made_of(self, edges: Iterable[Edge], candidates: Collection[int]) -> list[int]:
        """The candidates that some edges depend on: a vector can't wait for scalars that wait for one of its lanes."""
        oldest = min(candidates, default=len(self._graph))
        stack, operands = [abs(edge) for edge in edges], set[int]()
        while stack:
            node = stack.pop()
            if node >= oldest and node not in operands:  # Operands have smaller numbers than results.
                operands.add(node)
                stack.extend(map(abs, self._graph.args[node]))
        return [node for node in candidates if node in operands]

    def _resolve(self, nodes: Iterable[int]) -> None:
        """Mark everything that some nodes depend on as needed: scalars, vectors and inserted lanes."""
        self._pending = [partial(self._need_node, node) for node in nodes]
        while self._pending:
            self._pending.pop()()

    def _need_node(self, node: int) -> None:
        """State that a scalar is read: from its vector, or else from its operands."""
        graph = self._graph
        if node == ZERO or node in self._needed or node in graph.slot or node in graph.value or node in self._given:
            return
        self._needed.add(node)
        pack = self._pack_of_node.get(node)
        if pack is None:
            self._pending += [partial(self._need_node, abs(arg)) for arg in graph.args[node]]
            return
        lane = self._formed[pack].lane_of_node[node]
        vector = self.vector_of_node[node] = self._vector(pack)
        vector.nodes[node] = lane, pack.lanes[lane] < 0
        self._pending.append(partial(self._need_lane, pack, lane))

    def _need_lane(self, pack: Pack, lane: int) -> None:
        """State that a lane of a vector is read: from its terms, from the vector it is copied from, or put in."""
        if (pack, lane) in self._ready_lanes:
            return
        self._ready_lanes.add((pack, lane))
        vector, edge = self._vector(pack), pack.lanes[lane]
        source = pack.base
        while source is not None and source not in self._formed:
            source = source.base
        if pack in self._formed and lane in self._formed[pack].exact_lanes:
            self._pending += [partial(self._need_lane, operand, lane) for _, operand in pack.terms]
        elif source is not None and source.lanes[lane] == edge:
            vector.source = self._vector(source)
            self._pending.append(partial(self._need_lane, source, lane))
        else:
            vector.put[lane] = edge
            self._pending.append(partial(self._need_node, abs(edge)))

    def _need_terms(self, pack: Pack) -> None:
        """State that a vector is formed from its terms: it reads their factors and vectors."""
        self._vectors[pack].terms = tuple((factor, self._vector(operand)) for factor, operand in pack.terms)
        self._pending += [partial(self._need_node, abs(factor)) for factor, _ in pack.terms]

    def _vector(self, pack: Pack) -> Vector:
        """The vector of a pack that is read."""
        vector = self._vectors.get(pack)
        if vector is None:
            vector = self._vectors[pack] = Vector(-1 - len(self._vectors), pack.first_node)
            if pack in self._formed:
                self._pending.append(partial(self._need_terms, pack))
        return vector


def vector_name(key: int) -> str:
    """The variable of a vector, by its key."""
    return f"p{-key}"


def _sum(terms: Sequence[tuple[Edge, Vector]], text: Callable[[Edge], str]) -> str:
    """Text "sym_minus(sym_scaled(c, p3), s, p4)"."""
    result = ""
    for factor, vector in terms:
        name, number = vector_name(vector.key), text(factor)
        if not result:
            result = name if factor == ONE else f"sym_scaled({number}, {name})"
        else:
            operation = "sym_minus" if number.startswith("-") else "sym_plus"
            result = f"{operation}({result}, {number.removeprefix('-')}, {name})"
    return result


def runs_of_lanes(vector: Vector, stores: Sequence[Store]) -> tuple[list[str], list[Store]]:
    """Lines that store neighbouring lanes into neighbouring entries, and the stores that remain."""
    lines: list[str] = []
    remaining: list[Store] = []
    run: list[_LaneStore] = []
    for store in sorted(stores, key=lambda store: (store.array, store.index)):
        lane, is_negative = vector.nodes[abs(store.edge)]
        item = _LaneStore(store, lane, is_negative ^ (store.edge < 0))
        if run and not item.follows(run[-1]):
            _end_run(vector, run, lines, remaining)
            run = []
        run.append(item)
    if run:
        _end_run(vector, run, lines, remaining)
    return lines, remaining


@dataclass(frozen=True)
class _LaneStore:
    """A store of a lane.

    Attributes:
        store: Output entry.
        lane: Lane that is stored.
        is_negative: Whether the entry is the negative of the lane.
    """

    store: Store
    lane: int
    is_negative: bool

    def follows(self, last: _LaneStore) -> bool:
        """Whether lane and output entry directly follow those of another store, with the same sign."""
        is_next_entry = self.store.array == last.store.array and self.store.index == last.store.index + 1
        return is_next_entry and self.lane == last.lane + 1 and self.is_negative == last.is_negative


def _end_run(vector: Vector, run: Sequence[_LaneStore], lines: list[str], remaining: list[Store]) -> None:
    """Write a run of stores; a single store remains."""
    if len(run) < 2:
        remaining += [item.store for item in run]
        return
    first = run[0]
    target = f"{first.store.array} + {first.store.index}"
    name = vector_name(vector.key)
    source = f"sym_scaled(-1.0, {name})" if first.is_negative else name
    lines.append(f"    sym_pack_part({target}, {source}, {first.lane}, {len(run)});")
