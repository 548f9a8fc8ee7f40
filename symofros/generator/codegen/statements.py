"""Nodes -> C statements: a value used once stands where it is used, every other has a variable.

Sines and cosines are evaluated together, up to `WIDEST` angles at a time: those with as many
sines beneath them. None of these choices changes a bit of the result: C evaluates the parenthesised text
as the graph states it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from heapq import merge

from symofros.base.names import local_name
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph, Slot
from symofros.expr.ops import ADD, DIV, MUL, OPS, STOP_GRADIENT
from symofros.generator.codegen.limbs.plan import LimbPlan
from symofros.generator.codegen.limbs.vector import LimbVector
from symofros.generator.codegen.packs import PackPlan, Store, Vector

# Operations per statement at most: long lines help neither people nor compilers.
_MAX_INLINE = 8
# Angles evaluated at once: the doubles of the widest vectors.
WIDEST = 8
_TRIGONOMETRIC = frozenset(("sin", "cos"))
# What a text mentions: a number, (NUMBER, value); a variable, (VARIABLE, node); an entry of an array, (array, index).
NUMBER, VARIABLE = "number", "variable"
Leaf = tuple[str, float]


@dataclass(frozen=True)
class Statement:
    """One C statement.

    Attributes:
        nodes: Nodes that are computed: none for a store alone, several for sines and cosines.
        stores: Output entries that are filled.
        reads: Keys of the variables that the text mentions.
        angles: Edges whose sines and cosines are computed; none for any other statement.
        vector: Vector that is defined, from which its nodes are read; none for any other statement.
    """

    nodes: tuple[int, ...]
    stores: tuple[Store, ...]
    reads: tuple[int, ...]
    angles: tuple[Edge, ...] = ()
    vector: Vector | LimbVector | None = None

    def __len__(self) -> int:
        """Statements of the text."""
        return 1

    @property
    def keys(self) -> tuple[int, ...]:
        """Keys of the variables it defines: a node's own, or its vector's."""
        return self.nodes if self.vector is None else (self.vector.key,)


class StatementWriter:
    """Turns the nodes of one function into statements and their text.

    Args:
        graph: Graph of the program.
        nodes: Nodes that the function computes, operands first.
        given: Nodes that are read from an input array.
        stores: Outputs of the function.
        plans: Vectors from which nodes are read.

    Attributes:
        vectors: Vectors by their keys.
    """

    def __init__(
        self,
        graph: Graph,
        nodes: Sequence[int],
        given: Mapping[int, Slot],
        stores: Sequence[Store],
        plans: Sequence[PackPlan | LimbPlan] = (),
    ) -> None:
        self.graph = graph
        self.given = given
        self.stores = stores
        self._vector_of_node: dict[int, Vector | LimbVector] = {}
        self.vectors: dict[int, Vector | LimbVector] = {}
        for plan in plans:
            self._vector_of_node.update(plan.vector_of_node)
            self.vectors.update((vector.key, vector) for vector in plan.vectors)
        self._inlined = self._choose_inlined(nodes, stores)
        self._nodes = nodes
        self._variables = [node for node in nodes if node not in self._inlined]
        self._names: dict[int, str] = {}
        # Names of nodes without a label that are stored as they are: by their first entry, M_8_ of M[8].
        self._entries = {store.edge: f"{store.array}_{store.index}_" for store in reversed(stores)}
        self.lanes, self._suffix = False, ""
        self._mentions: list[Leaf] | None = None

    def in_lanes(self, single: bool = False) -> StatementWriter:
        """A writer of the same statements on vectors, one state a lane; numbers are one for all lanes.

        Args:
            single: Whether lanes hold floats.
        """
        writer = copy(self)
        writer.lanes, writer._suffix = True, "f" if single else ""
        return writer

    def marked(self) -> tuple[StatementWriter, list[Leaf]]:
        """A writer whose texts have "@KIND" for each leaf, and the list that receives the leaves in the same order."""
        writer = copy(self)
        mentions: list[Leaf] = []
        writer._mentions = mentions
        return writer, mentions

    def _choose_inlined(self, nodes: Sequence[int], stores: Sequence[Store]) -> set[int]:
        graph, vector_of_node = self.graph, self._vector_of_node
        uses: dict[int, int] = {}
        for node in nodes:
            for arg in graph.args[node] if node not in vector_of_node else ():
                uses[abs(arg)] = uses.get(abs(arg), 0) + 1
        # Vectors read variables: what a vector needs may be needed by several lanes.
        stored = {abs(store.edge) for store in stores} | {
            abs(e) for vector in self.vectors.values() for e in vector.edges
        }
        size: dict[int, int] = {}
        inlined: set[int] = set()
        for node in nodes:
            if node in vector_of_node:
                continue
            parts = [abs(arg) for arg in graph.args[node] if abs(arg) in inlined]
            total = 1 + sum(size[part] for part in parts)
            if total > _MAX_INLINE:
                # The largest operand gets a variable of its own; the rest fits.
                largest = max(parts, key=lambda part: size[part])
                inlined.discard(largest)
                total -= size[largest]
            size[node] = total
            # Function calls keep a variable: sines and cosines are evaluated by blocks, other calls stay in view.
            if uses.get(node) == 1 and node not in stored and node not in graph.label and self._is_arithmetic(node):
                inlined.add(node)
        return inlined

    def _is_arithmetic(self, node: int) -> bool:
        return self.graph.op[node] in (ADD, MUL, DIV)

    def statements(self) -> list[Statement]:
        """The statements, operands first; each output is stored as soon as its value is known."""
        waiting: dict[int, list[Store]] = {}
        variables = set(self._variables)
        result = []
        for store in self.stores:
            node = abs(store.edge)
            if node in variables:
                waiting.setdefault(node, []).append(store)
            elif node != 0:  # A number or an input; zeros are cleared at once.
                result.append(Statement((), (store,), ()))
        for nodes, angles, vector in self._ordered():
            stores = tuple(store for node in nodes for store in waiting.get(node, ()))
            if vector is None:
                reads = dict.fromkeys(self._mentioned(angles or self.graph.args[nodes[0]]))
            else:
                reads = dict.fromkeys([*self._mentioned(vector.edges), *(v.key for v in vector.operands)])
            result.append(Statement(nodes, stores, tuple(reads), angles, vector))
        return result

    def _ordered(self) -> Iterator[tuple[tuple[int, ...], tuple[Edge, ...], Vector | LimbVector | None]]:
        """(nodes, angles, vector) of each statement: nodes one by one, sines and cosines by blocks, vectors whole."""
        blocks, done = self._blocks(), set[int]()

        def needs(key: int) -> list[int]:
            """Keys of the variables that a statement reads, in the order in which they are formed."""
            if key > 0:
                return sorted(self._mentioned(blocks[key][0] if key in blocks else self.graph.args[key]))
            vector = self.vectors[key]
            return [*(operand.key for operand in vector.operands), *sorted(self._mentioned(vector.edges))]

        # Vectors that are only put together are formed where they are read.
        computed = sorted((vector.first_node, vector.key) for vector in self.vectors.values() if vector.is_computed)
        scalars = ((node, node) for node in self._variables if node not in self._vector_of_node)
        for _, last in merge(computed, scalars):
            waiting = [last]
            while waiting:
                key = waiting[-1]
                missing = [before for before in needs(key) if before not in done] if key not in done else []
                if missing:
                    waiting += reversed(missing)
                    continue
                waiting.pop()
                if key in done:
                    continue
                vector = self.vectors.get(key)
                if vector is not None:
                    done.add(key)
                    yield tuple(vector.nodes), (), vector
                else:
                    angles, nodes = blocks.get(key, ((), (key,)))
                    done.update(nodes)
                    yield nodes, angles, None

    def _blocks(self) -> dict[int, tuple[tuple[Edge, ...], tuple[int, ...]]]:
        """Sine or cosine -> (angles, sines and cosines) of its block: angles that as many others lie under."""
        graph = self.graph
        depth: dict[int, int] = {}
        levels: dict[int, dict[Edge, list[int]]] = {}
        for node in self._nodes:
            depth[node] = max((depth.get(abs(arg), 0) for arg in graph.args[node]), default=0)
            if graph.op[node] in _TRIGONOMETRIC:
                levels.setdefault(depth[node], {}).setdefault(graph.args[node][0], []).append(node)
                depth[node] += 1
        blocks = {}
        for level in levels.values():
            for i in range(0, len(level), WIDEST):
                angles = tuple(level)[i : i + WIDEST]
                nodes = tuple(node for angle in angles for node in level[angle])
                blocks.update(dict.fromkeys(nodes, (angles, nodes)))
        return blocks

    def _mentioned(self, edges: Iterable[Edge]) -> Iterator[int]:
        """Nodes with variables in the text of some edges."""
        stack = list(edges)
        while stack:
            arg = abs(stack.pop())
            if arg in self._inlined:
                stack.extend(self.graph.args[arg])
            elif not self._is_available(arg):
                yield self._vector_of_node[arg].key if arg in self._vector_of_node else arg

    def _is_available(self, node: int) -> bool:
        """Whether a node is a number or an entry of an input array."""
        return node == 0 or node in self.given or node in self.graph.value or node in self.graph.slot

    def name(self, node: int) -> str:
        """C expression of a node's value: its variable, or its lane of a vector."""
        if node in self._vector_of_node:
            vector = self._vector_of_node[node]
            return vector.lane_text(vector.nodes[node][0])
        if node not in self._names:
            label = self.graph.label.get(node)
            self._names[node] = local_name(label, node) if label else f"{self._entries.get(node, 't')}{node}"
        return self._names[node]

    def operation(self, node: int) -> str:
        """The right-hand side of a node's statement."""
        graph = self.graph
        op, args = graph.op[node], graph.args[node]
        if op == ADD:
            a, b = args  # The first is positive by construction.
            return f"{self._operand(a)} {'+' if b > 0 else '-'} {self._operand(abs(b), is_right=True)}"
        if op in (MUL, DIV):
            a, b = args  # Both are positive by construction.
            return OPS[op].c.format(self._operand(a, is_factor=True), self._operand(b, is_factor=True, is_right=True))
        if op == STOP_GRADIENT:
            return self.whole(args[0])
        if self.lanes:
            return f"sym_v_{op}({', '.join(map(self.whole, args))})"
        return OPS[op].c.format(*map(self.text, args))

    def whole(self, edge: Edge) -> str:
        """The text of an edge where a vector may stand and a single number may not."""
        text = self.text(edge)
        if self.lanes and self.graph.is_constant(edge):
            return f"sym_set({text})"
        return f"SYM_WHOLE({text})" if self.lanes and abs(edge) in self.given else text

    def store(self, store: Store) -> str:
        """The statement that fills an output's entry."""
        if self.lanes:
            return f"SYM_PUT({store.array}, {store.index}, {self.whole(store.edge)});"
        return f"{self.leaf(store.array, store.index)} = {self.whole(store.edge)};"

    def _operand(self, node: int, is_factor: bool = False, is_right: bool = False) -> str:
        """An operand's text, in parentheses where C would otherwise group or associate differently."""
        if node not in self._inlined:
            return self.text(node)
        is_sum = self.graph.op[node] == ADD
        needs = is_sum and (is_factor or is_right) or (is_factor and is_right)
        return f"({self.operation(node)})" if needs else self.operation(node)

    def text(self, edge: Edge) -> str:
        """The text of an edge: a number, an input entry, a variable, or an inlined operation."""
        node, is_negative = abs(edge), edge < 0
        number = self.graph.number(edge)
        if number is not None:
            return self.leaf(NUMBER, number)
        slot = self.given.get(node) or self.graph.slot.get(node)
        if slot is not None:
            in_columns = self.lanes and node not in self.given
            text = f"SYM_AT({slot.group}, {slot.index})" if in_columns else self.leaf(slot.group, slot.index)
        else:
            text = f"({self.operation(node)})" if node in self._inlined else self.leaf(VARIABLE, node)
            is_negative ^= node in self._vector_of_node and self._vector_of_node[node].nodes[node][1]
        return f"-{text}" if is_negative else text

    def leaf(self, kind: str, which: float) -> str:
        """C expression of an operand; its placeholder while the mentions of a statement are collected."""
        if self._mentions is not None:
            self._mentions.append((kind, which))
            return f"@{kind}"
        if kind == NUMBER:
            return f"{which!r}{self._suffix}"
        return self.name(int(which)) if kind == VARIABLE else f"{kind}[{which}]"
