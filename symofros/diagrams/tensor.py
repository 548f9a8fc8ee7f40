"""Arrays of edges of one graph, with the operators that formulas of blocks are written in."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from math import prod
from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.expr import Edge, Graph, Terms, edges_of, terms

Edges = npt.NDArray[np.object_]


class Tensor:
    """An array whose entries are edges; arithmetic broadcasts as NumPy's does and folds as the graph does.

    Attributes:
        g: The graph.
        edges: Object array of edges.
    """

    __slots__ = ("edges", "g")
    # NumPy leaves `array * tensor` to the tensor.
    __array_priority__ = 1000.0
    __array_ufunc__ = None

    def __init__(self, g: Graph, edges: Edges) -> None:
        self.g = g
        self.edges = edges

    @staticmethod
    def of(g: Graph, edges: Iterable[Edge], shape: Sequence[int]) -> Tensor:
        """Edges, row by row, in a shape."""
        flat = np.empty(prod(shape), dtype=object)
        flat[:] = list(edges)
        return Tensor(g, flat.reshape(tuple(shape)))

    @staticmethod
    def inputs(g: Graph, group: str, shape: Sequence[int], start: int = 0) -> Tensor:
        """Consecutive entries of an input group."""
        return Tensor.of(g, (g.input(group, start + i) for i in range(prod(shape))), shape)

    @staticmethod
    def numbers(g: Graph, values: Any) -> Tensor:
        """An array of numbers."""
        array = np.asarray(values, dtype=np.float64)
        return Tensor.of(g, (g.constant(float(value)) for value in array.reshape(-1)), array.shape)

    @staticmethod
    def of_terms(g: Graph, array: Terms) -> Tensor:
        """Tensor of an array of terms, such as the result of a NumPy formula."""
        return Tensor.of(g, edges_of(g, array), array.shape)

    @property
    def terms(self) -> Terms:
        """The entries as an array that NumPy's formulas take, such as those of `symofros.base.rotations`."""
        return terms(self.g, self.flat).reshape(self.shape)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the tensor, as that of a NumPy array."""
        return tuple(self.edges.shape)

    @property
    def size(self) -> int:
        """Number of entries."""
        return int(self.edges.size)

    @property
    def flat(self) -> list[Edge]:
        """The edges, row by row."""
        return list(self.edges.reshape(-1))

    def _like(self, other: Any) -> Tensor:
        return other if isinstance(other, Tensor) else Tensor.numbers(self.g, other)

    def _with(self, other: Any, rule: Callable[[Edge, Edge], Edge]) -> Tensor:
        a, b = np.broadcast_arrays(self.edges, self._like(other).edges)
        pairs = zip(a.reshape(-1), b.reshape(-1), strict=True)
        return Tensor.of(self.g, (rule(x, y) for x, y in pairs), a.shape)

    def _each(self, rule: Callable[[Edge], Edge]) -> Tensor:
        return Tensor.of(self.g, map(rule, self.flat), self.shape)

    def __add__(self, other: Any) -> Tensor:
        return self._with(other, self.g.add)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Tensor:
        return self._with(other, self.g.sub)

    def __rsub__(self, other: Any) -> Tensor:
        return self._like(other) - self

    def __mul__(self, other: Any) -> Tensor:
        return self._with(other, self.g.mul)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Tensor:
        return self._with(other, self.g.div)

    def __rtruediv__(self, other: Any) -> Tensor:
        return self._like(other) / self

    def __neg__(self) -> Tensor:
        return self._each(lambda edge: -edge)

    def __pow__(self, exponent: float) -> Tensor:
        power = self.g.constant(exponent)
        return self._each(lambda edge: self.g.power(edge, power))

    def __matmul__(self, other: Any) -> Tensor:
        right = self._like(other)
        a = self.edges.reshape(1, -1) if self.edges.ndim == 1 else self.edges
        b = right.edges.reshape(-1, 1) if right.edges.ndim == 1 else right.edges
        if a.shape[1] != b.shape[0]:
            raise ValueError(f"a product of {self.shape} and {right.shape}")
        sums = [self._dot(row, column) for row in a for column in b.T]
        return Tensor.of(self.g, sums, (*self.shape[:-1], *right.shape[1:]))

    def _dot(self, a: Iterable[Edge], b: Iterable[Edge]) -> Edge:
        return self.g.sum(self.g.mul(x, y) for x, y in zip(a, b, strict=True))

    def __getitem__(self, index: Any) -> Tensor:
        edges = self.edges[index]
        return Tensor(self.g, edges if isinstance(edges, np.ndarray) else np.array(edges, dtype=object))

    def __len__(self) -> int:
        return len(self.edges)

    def __iter__(self) -> Iterator[Tensor]:
        return (self[i] for i in range(len(self)))

    @property
    def T(self) -> Tensor:
        """The transpose."""
        return Tensor(self.g, self.edges.T)

    def reshape(self, *shape: int) -> Tensor:
        """The same entries in another shape."""
        return Tensor(self.g, self.edges.reshape(shape))

    def apply(self, function: str, *others: Any) -> Tensor:
        """A function of the op table, entry by entry: sin, cos, sqrt, abs, sign, floor, step, min, max, atan2, ..."""
        if not others:
            return self._each(lambda edge: self.g.call(function, edge))
        return self._with(others[0], lambda x, y: self.g.call(function, x, y))

    def clipped(self, low: Any, high: Any) -> Tensor:
        """The tensor with its entries clipped to low and high."""
        return self.apply("max", low).apply("min", high)

    def sum(self) -> Tensor:
        """Sum of all entries, a scalar tensor."""
        return Tensor.of(self.g, [self.g.sum(self.flat)], ())

    def norm(self) -> Tensor:
        """The Euclidean norm of all entries."""
        return (self * self).sum().apply("sqrt")

    def cross(self, other: Tensor) -> Tensor:
        """The vector product of two (3) vectors."""
        a, b = self, other
        return joined([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def joined(parts: Sequence[Tensor]) -> Tensor:
    """Scalars and vectors, one after the other, as one vector."""
    return Tensor.of(parts[0].g, [edge for part in parts for edge in part.flat], (sum(part.size for part in parts),))


def stacked(rows: Sequence[Tensor]) -> Tensor:
    """Arrays of one shape as the rows of a larger one."""
    return Tensor(rows[0].g, np.stack([row.edges for row in rows]))


def solved(A: Tensor, b: Tensor) -> Tensor:
    """The x of A x = b for a symmetric, positive definite A (n, n): by L D L^T, without pivoting.

    Args:
        A: Symmetric; the lower triangle is read.
        b: (n) or (n, m).
    """
    n = len(A)
    L = [[A[i, j] for j in range(i + 1)] for i in range(n)]
    inverse: list[Tensor] = []
    for k in range(n):
        inverse.append(1.0 / L[k][k])
        for i in range(k + 1, n):
            whole = L[i][k]
            L[i][k] = whole * inverse[k]
            for j in range(k + 1, i + 1):
                L[i][j] = L[i][j] - whole * L[j][k]
    return _substituted(L, inverse, b)


def _substituted(L: list[list[Tensor]], inverse: list[Tensor], b: Tensor) -> Tensor:
    n = len(L)
    y = [b[i] for i in range(n)]
    for i in range(n):
        for j in range(i):
            y[i] = y[i] - L[i][j] * y[j]
    x = [y[i] * inverse[i] for i in range(n)]
    for i in reversed(range(n)):
        for j in range(i + 1, n):
            x[i] = x[i] - L[j][i] * x[j]
    return stacked(x)
