"""Packs in C: which of a graph's packs a function forms as vectors, and their text.

A pack is formed as a vector where enough of its lanes are wanted; each of those is then read from the vector. Lanes
that a combination does not give are put in one by one.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, field

from symofros.expr.edges import ONE, Edge
from symofros.expr.evaluate import needed_nodes
from symofros.expr.graph import Graph
from symofros.expr.pack import WIDTH, Pack


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
        key: Negative, where a scalar's variable has its node's positive number.
        start: What it is the sum of is older than this node; 0 where it is not a sum.
        terms: (factor, vector) it is the sum of.
        source: Else, the vector it is a copy of; None if it starts from zeros.
        put: Lane -> the edge put into it.
        nodes: Node -> its lane, and whether the lane holds its negative; of the nodes that are read from it.
    """

    key: int
    start: int
    terms: tuple[tuple[Edge, Vector], ...] = ()
    source: Vector | None = None
    put: dict[int, Edge] = field(default_factory=dict)
    nodes: dict[int, tuple[int, bool]] = field(default_factory=dict)

    @property
    def operands(self) -> list[Vector]:
        """Vectors that its text mentions."""
        return [vector for _, vector in self.terms] + ([self.source] if self.source else [])

    @property
    def edges(self) -> list[Edge]:
        """Scalars that its text mentions."""
        return [factor for factor, _ in self.terms] + list(self.put.values())


@dataclass(frozen=True)
class _Formed:
    """A pack that is formed: node -> lane of those that are read from it; lanes that its terms give."""

    homes: dict[int, int]
    right: frozenset[int]


class PackPlan:
    """The vectors of one function.

    Args:
        graph: Of the program.
        wanted: Nodes that the function computes if all are scalars.
        given: Nodes it reads from an input array instead.
        edges: Its outputs.

    Attributes:
        home: Node -> the vector it is read from.
        nodes: Nodes that the function needs one by one, operands first, those with a home among them.
        vectors: All vectors, in the order of their `start`.
    """

    def __init__(self, graph: Graph, wanted: Sequence[int], given: Collection[int], edges: Iterable[Edge]) -> None:
        self._graph = graph
        self._given = given
        self._known = {*wanted, *given, *graph.value, 0} | {n for n, slot in graph.slot.items() if slot.group != "par"}
        self._formed: dict[Pack, _Formed] = {}
        self._of: dict[int, Pack] = {}
        self._vectors: dict[Pack, Vector] = {}
        self.home: dict[int, Vector] = {}
        self._filled: set[tuple[Pack, int]] = set()
        # Angles come first, and from scalars: all sines and cosines are evaluated in blocks.
        angles = [graph.args[node][0] for node in wanted if graph.op[node] in ("sin", "cos")]
        self._choose(set(wanted).difference(needed_nodes(graph, angles, given)))
        self.nodes = self._follow(abs(edge) for edge in edges)
        self.vectors = sorted(self._vectors.values(), key=lambda vector: vector.start)

    def _choose(self, wanted: set[int]) -> None:
        for pack in self._graph.packs:
            if not self._are_known(factor for factor, _ in pack.terms):
                continue  # Parameters alone determine it, in lanes that this function does not need.
            right = {lane for lane in pack.literal if self._are_known(operand.lanes[lane] for _, operand in pack.terms)}
            # The lanes' nodes, less those that lanes which scalars give are made of.
            given = [edge for lane, edge in enumerate(pack.lanes) if lane not in right and self._are_known((edge,))]
            parts = self._parts(given, pack.start)
            homes: dict[int, int] = {}
            for lane in sorted(right & pack.own):
                node = abs(pack.lanes[lane])
                if node in wanted and node not in self._of and node not in parts:
                    homes.setdefault(node, lane)
            if len(homes) >= pack.least:
                self._formed[pack] = _Formed(homes, frozenset(right))
                self._of.update(dict.fromkeys(homes, pack))

    def _are_known(self, edges: Iterable[Edge]) -> bool:
        return all(abs(edge) in self._known for edge in edges)

    def _parts(self, edges: Iterable[Edge], start: int) -> set[int]:
        """The nodes from `start` on that some edges are made of: a vector can't wait for what waits for it."""
        stack, parts = [abs(edge) for edge in edges], set[int]()
        while stack:
            node = stack.pop()
            if node >= start and node not in parts:
                parts.add(node)
                stack.extend(map(abs, self._graph.args[node]))
        return parts

    def _follow(self, nodes: Iterable[int]) -> list[int]:
        """The nodes that some nodes need, operands first, and on the way all that vectors need."""
        graph, found = self._graph, set[int]()
        self._waiting: list[int | Pack | tuple[Pack, int]] = list(nodes)
        while self._waiting:
            item = self._waiting.pop()
            if isinstance(item, tuple):
                self._fill(*item)
            elif isinstance(item, Pack):
                self._vectors[item].terms = tuple((factor, self._vector(operand)) for factor, operand in item.terms)
                self._waiting += [abs(factor) for factor, _ in item.terms]
            elif not (item in found or item == 0 or item in graph.slot or item in graph.value or item in self._given):
                found.add(item)
                pack = self._of.get(item)
                if pack is None:
                    self._waiting.extend(map(abs, graph.args[item]))
                    continue
                lane = self._formed[pack].homes[item]
                self.home[item] = self._vector(pack)
                self.home[item].nodes[item] = lane, pack.lanes[lane] < 0
                self._waiting.append((pack, lane))
        return sorted(found)

    def _fill(self, pack: Pack, lane: int) -> None:
        """See to it that a vector is right in a lane that somebody reads."""
        if (pack, lane) in self._filled:
            return
        self._filled.add((pack, lane))
        vector, edge = self._vector(pack), pack.lanes[lane]
        source = pack.base
        while source is not None and source not in self._formed:
            source = source.base
        if pack in self._formed and lane in self._formed[pack].right:
            self._waiting += [(operand, lane) for _, operand in pack.terms]
        elif source is not None and source.lanes[lane] == edge:
            vector.source = self._vector(source)
            self._waiting.append((source, lane))
        else:
            vector.put[lane] = edge
            self._waiting.append(abs(edge))

    def _vector(self, pack: Pack) -> Vector:
        """The vector of a pack that somebody reads."""
        vector = self._vectors.get(pack)
        if vector is None:
            vector = self._vectors[pack] = Vector(-1 - len(self._vectors), pack.start)
            if pack in self._formed:
                self._waiting.append(pack)
        return vector


def vector_name(key: int) -> str:
    """The variable of a vector, by its key."""
    return f"p{-key}"


def vector_lines(vector: Vector, text: Callable[[Edge], str]) -> list[str]:
    """The lines that define a vector.

    Args:
        vector: The vector.
        text: Text of a scalar edge.
    """
    name = vector_name(vector.key)
    if vector.terms:
        start = _sum(vector.terms, text)
    elif vector.source is not None:
        start = vector_name(vector.source.key)
    else:
        return [f"    const sym_pack {name} = {{{', '.join(text(vector.put.get(i, 0)) for i in range(WIDTH))}}};"]
    if not vector.put:
        return [f"    const sym_pack {name} = {start};"]
    puts = [f"    {name}[{lane}] = {text(edge)};" for lane, edge in sorted(vector.put.items())]
    return [f"    sym_pack {name} = {start};", *puts]


def _sum(terms: Sequence[tuple[Edge, Vector]], text: Callable[[Edge], str]) -> str:
    """Such as "c * p3 - s * p4"."""
    result = ""
    for factor, vector in terms:
        number = "" if abs(factor) == ONE else f"{text(factor)} * "
        is_negative = number.startswith("-") or factor == -ONE
        sign = (" - " if is_negative else " + ") if result else "-" * is_negative
        result += f"{sign}{number.removeprefix('-')}{vector_name(vector.key)}"
    return result


def runs_of_lanes(vector: Vector, stores: Sequence[Store]) -> tuple[list[str], list[Store]]:
    """Stores of neighbouring lanes into neighbouring entries, as lines; and the stores that are left.

    Args:
        vector: What is stored.
        stores: Of its lanes.
    """
    lines: list[str] = []
    left: list[Store] = []
    run: list[tuple[Store, int, bool]] = []
    for store in sorted(stores, key=lambda store: (store.array, store.index)):
        lane, is_negative = vector.nodes[abs(store.edge)]
        item = (store, lane, is_negative ^ (store.edge < 0))
        if run and not _follows(run[-1], item):
            _end(vector, run, lines, left)
            run = []
        run.append(item)
    if run:
        _end(vector, run, lines, left)
    return lines, left


def _follows(last: tuple[Store, int, bool], item: tuple[Store, int, bool]) -> bool:
    a, b = last[0], item[0]
    return (b.array, b.index, item[1], item[2]) == (a.array, a.index + 1, last[1] + 1, last[2])


def _end(vector: Vector, run: list[tuple[Store, int, bool]], lines: list[str], left: list[Store]) -> None:
    store, lane, is_negative = run[0]
    if len(run) < 2:
        left += [store for store, _, _ in run]
        return
    sign = "-" if is_negative else ""
    lines.append(
        f"    sym_pack_part({store.array} + {store.index}, {sign}{vector_name(vector.key)}, {lane}, {len(run)});"
    )
