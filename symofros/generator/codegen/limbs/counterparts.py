"""Nodes of equal limbs that correspond: the same operation forms them from operands that correspond, up to signs.

Operands correspond, too, if they are numbers, or the same node for all limbs. They are found from the joints on.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, field
from functools import reduce
from heapq import heappop, heappush
from operator import or_

from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.ops import ADD, DIV, MUL, STOP_GRADIENT
from symofros.expr.program import Limb

_ARITHMETIC = (ADD, MUL, DIV, STOP_GRADIENT)
# Operations between a node and operands that are known to correspond.
_DEEPEST = 6
# Counterparts of nodes of the first limb, keyed by these, each with its operands in the order of the node's.
_Trial = dict[int, tuple[int, tuple[Edge, ...]]]


@dataclass(frozen=True)
class Row:
    """Nodes that correspond, a lane each.

    Attributes:
        nodes: The nodes, that of the first limb first.
        operands: For each operand, its edge in each lane.
    """

    nodes: tuple[int, ...]
    operands: tuple[tuple[Edge, ...], ...]


@dataclass
class Rows:
    """Rows that have no node in common.

    Attributes:
        by_leader: Rows, keyed by the node of the first limb.
        leader_of: That node, for every node of a row.
    """

    by_leader: dict[int, Row] = field(default_factory=dict)
    leader_of: dict[int, int] = field(default_factory=dict)

    def add(self, row: Row) -> None:
        """Add a row."""
        self.by_leader[row.nodes[0]] = row
        self.leader_of.update(dict.fromkeys(row.nodes, row.nodes[0]))

    def remove(self, leaders: Iterable[int]) -> None:
        """Take rows out, by their first nodes."""
        for leader in leaders:
            for node in self.by_leader.pop(leader).nodes:
                del self.leader_of[node]

    def has(self, edges: Sequence[Edge]) -> bool:
        """Whether edges are the nodes of a row in their order, up to signs."""
        leader = self.leader_of.get(abs(edges[0]))
        return leader is not None and self.by_leader[leader].nodes == tuple(map(abs, edges))


class Counterparts:
    """Finds rows of corresponding nodes in equal limbs.

    Args:
        graph: Graph of the program.
        nodes: Nodes that the function computes, operands first.
        given: Nodes that the function reads from an input array.
        scalars: Nodes that must stay scalar; of the rest only arithmetic nodes are grouped.

    Attributes:
        rows: What was found.
    """

    def __init__(self, graph: Graph, nodes: Sequence[int], given: Collection[int], scalars: Collection[int]) -> None:
        self.rows = Rows()
        self._graph, self._given, self._scalars = graph, given, scalars
        self._all = needed_nodes(graph, nodes, given)  # Those within packs, too.
        self._free = {node for node in nodes if graph.op[node] in _ARITHMETIC}.difference(scalars)
        self._users: dict[int, list[int]] = defaultdict(list)
        for node in nodes:
            for arg in dict.fromkeys(map(abs, graph.args[node])):
                self._users[arg].append(node)
        self._node_of = {slot: node for node, slot in graph.slot.items()}
        self._taken: set[int] = set()
        self._partners: dict[int, tuple[int, ...]] = {}  # Of nodes of the first limb.
        self._limbs: dict[int, int] = {}  # Limbs whose joints a node depends on, as bits.
        self._waiting: list[int] = []

    def find(self, limbs: Sequence[Limb], widest: int) -> None:
        """Find the rows of some equal limbs.

        Args:
            limbs: The limbs; more than the widest row has lanes are taken in turns.
            widest: Lanes of the widest row.
        """
        self._limbs = {}
        for k, limb in enumerate(limbs):
            self._limbs.update((self._node_of[slot], 1 << k) for slot in limb if slot in self._node_of)
        for node in self._all:
            self._limbs[node] = reduce(or_, (self._limbs.get(abs(arg), 0) for arg in self._graph.args[node]))
        turns = -(-len(limbs) // widest)
        for start in range(turns):
            if len(limbs[start::turns]) > 1:
                self._find_rows(limbs[start::turns])

    def _find_rows(self, limbs: Sequence[Limb]) -> None:
        """Go from the joints of the first limb to all that they are read by, in order."""
        self._partners, self._waiting = {}, []
        for slots in zip(*limbs, strict=True):
            nodes = [self._node_of[slot] for slot in slots if slot in self._node_of]
            if len(nodes) == len(limbs):
                self._join(nodes)
        last = 0
        while self._waiting:
            node = heappop(self._waiting)
            if node == last or node in self._taken:
                continue
            last = node
            known = [arg for arg in map(abs, self._graph.args[node]) if arg in self._partners]
            ways: tuple[Callable[[int, int], bool], ...] = (self._match, self._match_in_part)
            any(way(node, arg) for way in ways for arg in known)

    def _join(self, nodes: Sequence[int]) -> None:
        self._partners[nodes[0]] = tuple(nodes[1:])
        self._taken.update(nodes)
        for user in self._users[nodes[0]]:
            heappush(self._waiting, user)

    def _match(self, node: int, operand: int) -> bool:
        """Match a node in each lane with a user of its operand's counterpart and add the rows; whether it succeeds."""
        found: list[_Trial] = []
        for lane, partner in enumerate(self._partners[operand]):
            trial: _Trial = {}
            others = (other for other in self._users[partner] if other not in self._taken)
            if not any(self._agree(node, other, lane, trial) for other in others):
                return False
            found.append(trial)
        leaders = sorted(found[0])
        rows = [(leader, *(trial[leader][0] for trial in found if leader in trial)) for leader in leaders]
        is_whole = all(sorted(trial) == leaders for trial in found)
        if not is_whole or len(set().union(*rows)) < sum(map(len, rows)):  # No node is two nodes' counterpart.
            return False
        for nodes in rows:
            self._join(nodes)
            if nodes[0] in self._free:
                operands = (self._graph.args[nodes[0]], *(trial[nodes[0]][1] for trial in found))
                self.rows.add(Row(nodes, tuple(zip(*operands, strict=True))))
        return True

    def _match_in_part(self, node: int, operand: int) -> bool:
        """Find the counterparts of a sum or product whose other operands do not correspond, by place among the users.

        Limbs may differ at their ends; what is added to that is alike again.
        """
        graph, op = self._graph, self._graph.op[node]
        if op not in (ADD, MUL):
            return False
        matching = [
            [user for user in self._users[x] if graph.op[user] == op] for x in (operand, *self._partners[operand])
        ]
        if len(set(map(len, matching))) > 1:
            return False
        nodes = tuple(users[matching[0].index(node)] for users in matching)
        at = 0 if abs(graph.args[node][0]) == operand else 1
        operands = [graph.args[node]]
        for other, partner in zip(nodes[1:], self._partners[operand], strict=True):
            args = graph.args[other]
            operands.append(args if abs(args[at]) == partner else args[::-1])
        others = [abs(args[1 - at]) for args in operands]
        is_free = self._free.issuperset(nodes) and self._taken.isdisjoint(nodes) and len(set(nodes)) == len(nodes)
        # What depends on several limbs may wait for one of these nodes.
        is_own = all(
            self._limbs.get(x, 0) & ~self._limbs[abs(args[at])] == 0 for x, args in zip(others, operands, strict=True)
        )
        # Operands that are inputs or numbers are no evidence that limbs correspond.
        is_inner = operand in self.rows.leader_of or all(graph.args[other] for other in others)
        # Neither part of another row nor of this one.
        is_apart = self.rows.leader_of.keys().isdisjoint(others) and set(nodes).isdisjoint(others)
        if not (is_free and is_own and is_inner and is_apart):
            return False
        self._join(nodes)
        self.rows.add(Row(nodes, tuple(zip(*operands, strict=True))))
        return True

    def _agree(self, edge: Edge, other: Edge, lane: int, trial: _Trial, depth: int = 0) -> bool:
        """Whether two edges correspond, up to signs.

        Args:
            edge: Edge of the first limb.
            other: Edge of another limb.
            lane: That limb, from 0.
            trial: Nodes that correspond if all does; what is found is added.
            depth: Operations between the edge and the node that is asked for.
        """
        graph, a, b = self._graph, abs(edge), abs(other)
        for known in (graph.value, self._given):
            if a in known or b in known:
                return a in known and b in known
        if a in self._partners:
            return self._partners[a][lane] == b
        if a in trial:
            return trial[a][0] == b
        if a == b or {a, b} & self._taken:
            return a == b and a not in self._taken
        if a in graph.slot or b in graph.slot:
            return a in graph.slot and b in graph.slot and graph.slot[a].group == graph.slot[b].group
        op = graph.op[a]
        is_alike = graph.op[b] == op and (a in self._free) == (b in self._free)
        if not is_alike or (a not in self._free and a not in self._scalars) or depth > _DEEPEST:
            return False
        before, args = dict(trial), graph.args[b]
        for order in (args, args[::-1]) if op in (ADD, MUL) else (args,):
            trial[a] = b, order
            if all(self._agree(x, y, lane, trial, depth + 1) for x, y in zip(graph.args[a], order, strict=True)):
                return True
            trial.clear()
            trial.update(before)
        return False
