"""Write sums of products as chains of fused multiply-adds.

A sum of sums that nobody else reads is one sum of several terms, in any order. A processor adds a product to what is
there in one operation, so x + a b + c d takes two of them and (a b + c d) + x three: a chain starts with a term that is
no product (docs/theory/code.md, section 6).

Post-condition: what a pack is the sum of is older than the sums it makes, as before.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.evaluate import needed_nodes
from symofros.expr.graph import Graph
from symofros.expr.ops import ADD, MUL
from symofros.expr.pack import EMPTY, Pack
from symofros.expr.program import Function, Program
from symofros.expr.substitute import carried


def chain_sums(program: Program) -> Program:
    """Write the sums of every function as chains that start with a term that is no product.

    Sums that packs make stay as they are: vectors form them, too, to the same bits. What parameters determine is not
    worth it. Each function gets nodes of its own, because it is evaluated by itself: what another reads is no reason to
    keep a part. Terms stand in the order of their ages, so the last bits depend on what was formed before.

    Args:
        program: Staged or not.

    Returns:
        The program over a graph of its own, which holds what the functions need; results differ by rounding.
    """
    old, new = program.graph, Graph()
    at: dict[int, Edge] = {ZERO: ZERO, ONE: ONE}
    for node in range(2, len(old)):
        if node in old.value:
            at[node] = new.constant(old.value[node])
        elif node in old.slot:
            at[node] = new.input(old.slot[node].group, old.slot[node].index)
    for node in needed_nodes(old, program.init):
        at[node] = new.apply(old.op[node], *(carried(at, arg) for arg in old.args[node]))
    # What parameters determine is kept without the sign that its node has got.
    init = tuple(abs(carried(at, edge)) for edge in program.init)
    pre = {abs(at[node]): slot for node, slot in program.pre.items()}
    common, packed, functions = len(new), frozenset(_packed(old)), []
    for function in program.functions:
        new.forget(common)
        functions.append(_chained(program, function, packed, new, dict(at)))
    return replace(program, graph=new, functions=tuple(functions), init=init, pre=pre)


def _chained(program: Program, function: Function, packed: frozenset[int], new: Graph, at: dict[int, Edge]) -> Function:
    """One function, formed in another graph, where `at` has its leaves."""
    old, sums = program.graph, _Sums(program, function, packed)
    nodes = [node for node in sums.nodes if node not in sums.parts]
    ages = []  # How many nodes there were when a node's turn came.
    for node in nodes:
        ages.append(len(new))
        if node in sums.whole:
            at[node] = new.sum(carried(at, term) for term in sums.terms(node))
        else:
            at[node] = new.apply(old.op[node], *(carried(at, arg) for arg in old.args[node]))
        if node in old.label:
            new.name(at[node], old.label[node])
    ages.append(len(new))
    new.packs += _Packs(at, nodes, ages).of(old.packs)

    def rewritten(stated: Function) -> Function:
        outputs = tuple(replace(o, edges=tuple(carried(at, edge) for edge in o.edges)) for o in stated.outputs)
        solver = stated.solver and replace(stated.solver, parts=tuple(map(rewritten, stated.solver.parts)))
        return replace(stated, outputs=outputs, solver=solver)

    return rewritten(function)


def check_packs(program: Program) -> None:
    """Verify the post-condition.

    Raises:
        AssertionError: A vector would have to wait for one of its own lanes.
    """
    for pack in program.graph.packs:
        made = {abs(pack.lanes[lane]) for lane in pack.own}
        read = {abs(operand.lanes[lane]) for _, operand in pack.terms for lane in pack.literal}
        read.update(abs(factor) for factor, _ in pack.terms)
        assert min(made, default=pack.start) >= pack.start > max(read, default=0), "a pack reads its own lanes"


class _Sums:
    """The sums of a function, and what they add up.

    Args:
        program: Any.
        function: One of its functions.
        packed: Sums that stay.

    Attributes:
        nodes: What is computed, operands first.
        whole: Sums, but for those that packs make.
        parts: Sums that are read once, by one of those.
    """

    def __init__(self, program: Program, function: Function, packed: frozenset[int]) -> None:
        self._graph, edges = program.graph, function.edges()
        op, args, label = program.graph.op, program.graph.args, program.graph.label
        self.nodes = needed_nodes(self._graph, edges, program.pre)
        free = {node for node in self.nodes if op[node] == ADD and node not in packed}
        read = Counter(abs(arg) for node in self.nodes for arg in args[node])
        read.update(map(abs, edges))
        added = Counter(abs(arg) for node in self.nodes if op[node] == ADD for arg in args[node])
        summed = {abs(arg) for node in free for arg in args[node]}
        # A name would be lost with a part.
        self.parts = {node for node in free & summed if read[node] == 1 and node not in label}
        self.whole = free - self.parts
        self._products = {node for node in self.nodes if op[node] == MUL and read[node] == added[node]}

    def terms(self, whole: int) -> list[Edge]:
        """What a sum adds up, in the order in which it was made, but for what a chain starts with.

        That is the oldest term that is no product; if it is the youngest of all terms, too, nothing is to wait for it.
        """
        found: list[Edge] = []
        stack = list(self._graph.args[whole])
        while stack:
            edge = stack.pop()
            if abs(edge) in self.parts:
                stack += (arg if edge > 0 else -arg for arg in self._graph.args[abs(edge)])
            else:
                found.append(edge)
        found.sort(key=abs)
        first = next((i for i, edge in enumerate(found[:-1]) if abs(edge) not in self._products), 0)
        return [found.pop(first), *found]


def _packed(graph: Graph) -> Iterator[int]:
    """The sums that vectors form, too; those that were there before their pack, and those that packs are made of."""
    for pack in graph.packs:
        yield from range(pack.start, 1 + max(map(abs, pack.lanes)))
        sums = {abs(edge) for of in (pack, *(operand for _, operand in pack.terms)) for edge in of.lanes}
        for _ in pack.terms:
            yield from sums
            sums = {abs(arg) for node in sums if graph.op[node] == ADD for arg in graph.args[node]}


class _Packs:
    """Packs that follow their lanes into another graph.

    Args:
        at: Node -> edge in the other graph, of all that is needed.
        nodes: What moved, in order.
        ages: How many nodes the other graph had before each of them, and in the end.
    """

    def __init__(self, at: Mapping[int, Edge], nodes: Sequence[int], ages: Sequence[int]) -> None:
        self._at, self._nodes, self._ages = at, nodes, ages
        self._known: dict[int, Pack] = {id(EMPTY): EMPTY}

    def of(self, packs: Iterable[Pack]) -> Iterator[Pack]:
        """The same over there, as far as the function needs them."""
        for pack in packs:
            moved = self._one(pack)
            if len(moved.own) > 1:
                yield moved

    def _one(self, pack: Pack) -> Pack:
        waiting = [pack]
        while waiting:
            last = waiting[-1]
            operands = [operand for _, operand in last.terms] + ([] if last.base is None else [last.base])
            missing = [operand for operand in operands if id(operand) not in self._known]
            waiting += missing
            if not missing:
                self._known[id(last)] = self._moved(waiting.pop())
        return self._known[id(pack)]

    def _moved(self, pack: Pack) -> Pack:
        """A pack whose operands are there; lanes that no function needs are empty."""
        at, known = self._at, self._known
        lanes = tuple(carried(at, edge) if abs(edge) in at else ZERO for edge in pack.lanes)
        base = None if pack.base is None or self._confuses(pack, pack.base) else known[id(pack.base)]
        if not all(abs(factor) in at for factor, _ in pack.terms):
            return Pack(lanes, base=base)
        start = self._ages[bisect_left(self._nodes, pack.start)] if pack.terms else 0
        given = [pack, *(operand for _, operand in pack.terms)]
        literal = frozenset(lane for lane in pack.literal if all(abs(one.lanes[lane]) in at for one in given))
        return replace(
            pack,
            lanes=lanes,
            base=base,
            start=start,
            literal=literal,
            terms=tuple((carried(at, factor), known[id(operand)]) for factor, operand in pack.terms),
            own=frozenset(lane for lane in pack.own & literal if abs(lanes[lane]) >= start),
        )

    def _confuses(self, pack: Pack, base: Pack) -> bool:
        """Whether a lane that is zero would be taken from one that is empty only because nobody needs it."""
        return any(a == ZERO and abs(b) not in self._at for a, b in zip(pack.lanes, base.lanes, strict=True))
