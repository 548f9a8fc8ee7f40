"""The hash-consed scalar graph that all symbolic work runs on.

An *edge* is a signed integer: `+n` is the value of node n, `-n` its negation, `0` the number zero. Signs live on
edges, so `a - b` and `b - a` share one node and negation is free. Node 1 is the number one. Constructors fold
constants, zeros and ones, so that a mechanism's structure (planar, axis-aligned, massless) removes its own cost.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.numerics.extended import nearest
from symofros.expr.ops import ADD, DIV, MUL, OPS
from symofros.expr.packs.pack import Pack

_CONSTANT = "constant"
_INPUT = "input"


@dataclass(frozen=True, slots=True)
class Slot:
    """One entry of a named input vector, as in q[3]."""

    group: str
    index: int


class Graph:
    """A growing set of scalar operations; nodes are interned, operands precede results.

    Attributes:
        op: Operation name of each node ("constant" and "input" for leaves); index 0 is unused.
        args: Operand edges of each node.
        value: The number of a constant node, keyed by node.
        slot: The input slot of an input node, keyed by node.
        label: A readable name of a node, where it has one.
        packs: Vectors of nodes formed by the same operations (symofros/expr/packs), in the order of their creation.
    """

    def __init__(self) -> None:
        self.op: list[str] = ["", _CONSTANT]
        self.args: list[tuple[Edge, ...]] = [(), ()]
        self.value: dict[int, float] = {1: 1.0}
        self.slot: dict[int, Slot] = {}
        self.label: dict[int, str] = {}
        self.packs: list[Pack] = []
        self._known: dict[object, int] = {1.0: 1}

    def __deepcopy__(self, memo: dict[int, object]) -> Graph:
        """A graph that grows by itself: its lists and tables are new, what they hold is never changed."""
        result = memo[id(self)] = Graph.__new__(Graph)
        for name, held in vars(self).items():
            setattr(result, name, held.copy())
        return result

    def __len__(self) -> int:
        """Number of nodes, the unused node 0 included."""
        return len(self.op)

    def _node(self, key: object, op: str, args: tuple[Edge, ...]) -> int:
        known = self._known
        node = known.get(key)
        if node is None:
            node = len(self.op)
            known[key] = node
            self.op.append(op)
            self.args.append(args)
        return node

    def constant(self, value: float) -> Edge:
        """The edge of a number."""
        value = float(value)
        if value == 0.0:
            return ZERO
        size = abs(value)
        node = self._node(size, _CONSTANT, ())
        self.value[node] = size
        return node if value > 0.0 or value != value else -node

    def stop_sharing_from(self, first: int) -> None:
        """Reuse no node from `first` on for operations that are formed later, so that each function has its own."""
        self._known = {key: node for key, node in self._known.items() if node < first}

    def input(self, group: str, index: int) -> Edge:
        """The edge of entry `index` of the input vector `group`."""
        slot = Slot(group, index)
        node = self._node(slot, _INPUT, ())
        self.slot[node] = slot
        return node

    def is_constant(self, edge: Edge) -> bool:
        """Whether an edge is a number."""
        return edge == 0 or abs(edge) in self.value

    def number(self, edge: Edge) -> float | None:
        """The number of a constant edge; None for anything else."""
        if edge == 0:
            return 0.0
        value = self.value.get(abs(edge))
        return value if value is None or edge > 0 else -value

    def add(self, a: Edge, b: Edge) -> Edge:
        """The sum a + b."""
        if a == 0:
            return b
        if b == 0:
            return a
        if a == -b:
            return ZERO
        na, nb = abs(a), abs(b)
        value = self.value
        if na in value and nb in value:
            return self.constant((value[na] if a > 0 else -value[na]) + (value[nb] if b > 0 else -value[nb]))
        if a == b:
            return self.mul(self.constant(2.0), a)
        if na > nb:
            a, b = b, a
        # The first operand is made positive: -x - y is -(x + y), and y - x is -(x - y).
        if a < 0:
            return -self._node((ADD, -a, -b), ADD, (-a, -b))
        return self._node((ADD, a, b), ADD, (a, b))

    def sub(self, a: Edge, b: Edge) -> Edge:
        """The difference a - b."""
        return self.add(a, -b)

    def mul(self, a: Edge, b: Edge) -> Edge:
        """The product a b."""
        if a == 0 or b == 0:
            return ZERO
        if a == 1:
            return b
        if b == 1:
            return a
        if a == -1:
            return -b
        if b == -1:
            return -a
        negative = (a < 0) != (b < 0)
        a, b = abs(a), abs(b)
        if a > b:
            a, b = b, a
        value = self.value
        if a in value or b in value:
            folded = self._scale(a, b)
            if folded is not None:
                return -folded if negative else folded
        node = self._node((MUL, a, b), MUL, (a, b))
        return -node if negative else node

    def _scale(self, a: int, b: int) -> Edge | None:
        """Fold a constant factor into a constant operand: c1 c2, and c1 (c2 x) = (c1 c2) x."""
        value = self.value
        if b in value:
            a, b = b, a
        if b in value:
            return self.constant(value[a] * value[b])
        if self.op[b] == MUL:
            x, y = self.args[b]
            if x in value:
                return self.mul(self.constant(value[a] * value[x]), y)
            if y in value:
                return self.mul(self.constant(value[a] * value[y]), x)
        return None

    def div(self, a: Edge, b: Edge) -> Edge:
        """The quotient a / b.

        Raises:
            ZeroDivisionError: b is the number zero.
        """
        if b == 0:
            raise ZeroDivisionError("division by the constant zero")
        if a == 0:
            return ZERO
        if abs(b) == 1:
            return a if b > 0 else -a
        negative = (a < 0) != (b < 0)
        a, b = abs(a), abs(b)
        if a == b:
            edge = ONE
        elif a in self.value and b in self.value:
            edge = self.constant(self.value[a] / self.value[b])
        else:
            edge = self._node((DIV, a, b), DIV, (a, b))
        return -edge if negative else edge

    def call(self, name: str, *args: Edge) -> Edge:
        """A function of the op table; signs move out of odd and even functions, numbers fold.

        Raises:
            KeyError: No such function.
            ArithmeticError: The folded value is not a number.
        """
        op = OPS[name]
        negative = False
        if op.parity and args[0] < 0:
            negative = op.parity == "odd"
            args = (-args[0],)
        numbers = [number for arg in args if (number := self.number(arg)) is not None]
        if len(numbers) == len(args):
            folded = nearest(name, *numbers)
            if folded != folded:
                raise ArithmeticError(f"{name}({', '.join(map(repr, numbers))}) is not a number")
            edge = self.constant(folded)
        else:
            edge = self._node((name, *args), name, args)
        return -edge if negative else edge

    def apply(self, op: str, *args: Edge) -> Edge:
        """An operation by its name: a sum, a product, a quotient, or a function of the op table."""
        if op == ADD:
            return self.add(*args)
        if op == MUL:
            return self.mul(*args)
        return self.div(*args) if op == DIV else self.call(op, *args)

    def sqrt(self, a: Edge) -> Edge:
        """The square root of a."""
        return self.call("sqrt", a)

    def sum(self, terms: Iterable[Edge]) -> Edge:
        """The sum of the terms, left to right."""
        total = ZERO
        for term in terms:
            total = self.add(total, term)
        return total

    def power(self, base: Edge, exponent: Edge) -> Edge:
        """The power base ** exponent; small whole exponents become products, one half a square root."""
        number = self.number(exponent)
        if number is None or (abs(number) > 16 and self.number(base) is None):
            return self.call("pow", base, exponent)
        if number == 0.5:
            return self.sqrt(base)
        if number != int(number) or abs(number) > 16:
            return self.call("pow", base, exponent)
        result, square, n = ONE, base, int(abs(number))
        while n:
            if n & 1:
                result = self.mul(result, square)
            square = self.mul(square, square) if n > 1 else square
            n >>= 1
        return self.div(ONE, result) if number < 0 else result

    def name(self, edge: Edge, label: str) -> Edge:
        """Give the node of a computed edge a readable name, unless it has one; returns the edge."""
        node = abs(edge)
        if node > 1 and node not in self.value and node not in self.slot:
            self.label.setdefault(node, label)
        return edge
