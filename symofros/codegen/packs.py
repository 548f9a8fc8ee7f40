"""Packs in C: which of a graph's packs a function forms as vectors, and their text.

A pack is formed as a vector where enough of its lanes are wanted; each of those is then read from the vector. Lanes
that a combination does not give are put in one by one.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, field

from symofros.expr.evaluate import needed_nodes
from symofros.expr.graph import ONE, Edge, Graph
from symofros.expr.packs import WIDTH, Pack

# With fewer lanes a vector saves less than putting lanes in and reading them costs.
_LEAST = 3


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
        terms: (factor, vector) it is the sum of.
        source: Else, the vector it is a copy of; None if it starts from zeros.
        put: Lane -> the edge put into it.
        nodes: Node -> its lane, and whether the lane holds its negative; of the nodes that are read from it.
    """

    key: int
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


class PackPlan:
    """The vectors of one function.

    Args:
        graph: Of the program.
        wanted: Nodes that the function computes if all are scalars.
        given: Nodes it reads from an input array instead.
        edges: Its outputs.

    Attributes:
        home: Node -> the vector it is read from.
        nodes: Nodes that the function needs now, operands first, those with a home among them.
    """

    def __init__(self, graph: Graph, wanted: Sequence[int], given: Collection[int], edges: Iterable[Edge]) -> None:
        self._graph = graph
        self._given = given
        self._known = {*wanted, *given, *graph.value, 0} | {n for n, slot in graph.slot.items() if slot.group != "par"}
        self._formed: dict[Pack, list[int]] = {}
        self._of: dict[int, Pack] = {}
        self._vectors: dict[Pack, Vector] = {}
        self.home: dict[int, Vector] = {}
        self._right: set[tuple[Vector, int]] = set()
        # Angles come first, and from scalars: all sines and cosines are evaluated in blocks.
        angles = [graph.args[node][0] for node in wanted if graph.op[node] in ("sin", "cos")]
        self._choose(set(wanted).difference(needed_nodes(graph, angles, given)))
        self.nodes = self._needed([abs(edge) for edge in edges])

    def _choose(self, wanted: set[int]) -> None:
        for pack in self._graph.packs:
            lanes = [lane for lane in pack.own if self._is_open(pack, lane, wanted)]
            # Lanes of one value share its node: the first is its home.
            lanes = list({abs(pack.lanes[lane]): lane for lane in sorted(lanes, reverse=True)}.values())
            lanes = self._without_parts_of_others(pack, lanes)
            if len(lanes) >= _LEAST:
                self._formed[pack] = lanes
                self._of.update((abs(pack.lanes[lane]), pack) for lane in lanes)

    def _is_open(self, pack: Pack, lane: int, wanted: set[int]) -> bool:
        node = abs(pack.lanes[lane])
        if node not in wanted or node in self._of:
            return False
        return all(abs(operand.lanes[lane]) in self._known for _, operand in pack.terms)

    def _without_parts_of_others(self, pack: Pack, lanes: list[int]) -> list[int]:
        """Less those lanes that others are made of, which scalars give: a vector can't wait for what waits for it."""
        while True:
            stack = [abs(edge) for lane, edge in enumerate(pack.lanes) if lane not in lanes]
            parts = set[int]()
            while stack:
                node = stack.pop()
                if node >= pack.start and node not in parts:
                    parts.add(node)
                    stack.extend(map(abs, self._graph.args[node]))
            kept = [lane for lane in lanes if abs(pack.lanes[lane]) not in parts]
            if len(kept) == len(lanes):
                return kept
            lanes = kept

    def _needed(self, stack: list[int]) -> list[int]:
        """Follow operands from the outputs, through vectors where there are any."""
        graph, found = self._graph, set[int]()
        while stack:
            node = stack.pop()
            if node in found or node == 0 or node in graph.slot or node in graph.value or node in self._given:
                continue
            found.add(node)
            if node not in self._of:
                stack.extend(map(abs, graph.args[node]))
                continue
            self.home[node] = self._form(self._of[node], stack)
        return sorted(found)

    def _form(self, pack: Pack, stack: list[int]) -> Vector:
        """The vector of a pack that is formed, with its operands."""
        vector = self._vectors.get(pack)
        if vector is None:
            vector = self._vectors[pack] = Vector(-1 - len(self._vectors))
            lanes = self._formed[pack]
            vector.nodes = {abs(pack.lanes[lane]): (lane, pack.lanes[lane] < 0) for lane in lanes}
            self._right.update((vector, lane) for lane in lanes)
            vector.terms = tuple((factor, self._take(operand, lanes, stack)) for factor, operand in pack.terms)
            stack.extend(abs(factor) for factor, _ in pack.terms)
        return vector

    def _take(self, pack: Pack, lanes: Iterable[int], stack: list[int]) -> Vector:
        """The vector of any pack, right in the lanes that somebody reads."""
        is_formed = pack in self._formed
        source = pack.base
        while source is not None and source not in self._formed:
            source = source.base
        if is_formed:
            vector = self._form(pack, stack)
        else:
            vector = self._vectors.setdefault(pack, Vector(-1 - len(self._vectors)))
        for lane in lanes:
            if (vector, lane) in self._right:
                continue
            self._right.add((vector, lane))
            edge = pack.lanes[lane]
            if is_formed and not any(operand.lanes[lane] for _, operand in pack.terms):
                for _, operand in pack.terms:
                    self._take(operand, (lane,), stack)
            elif source is not None and source.lanes[lane] == edge:
                vector.source = self._take(source, (lane,), stack)
            else:
                vector.put[lane] = edge
                stack.append(abs(edge))
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
        sign = (" - " if result else "-") if factor < 0 else (" + " if result else "")
        number = "" if abs(factor) == ONE else f"{text(abs(factor))} * "
        result += f"{sign}{number}{vector_name(vector.key)}"
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
