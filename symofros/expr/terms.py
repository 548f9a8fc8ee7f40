"""Edges of a graph with arithmetic: arrays of them take NumPy's formulas, which become formulas of the graph."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.expr.edges import Edge
from symofros.expr.graph import Graph

Terms = npt.NDArray[Any]


class Term:
    """One edge; operators and functions form edges as the graph folds them.

    Attributes:
        g: The graph.
        edge: The edge.
    """

    __slots__ = ("edge", "g")

    def __init__(self, g: Graph, edge: Edge) -> None:
        self.g = g
        self.edge = edge

    def _edge(self, other: Any) -> Edge:
        return other.edge if isinstance(other, Term) else self.g.constant(float(other))

    def __add__(self, other: Any) -> Term:
        return Term(self.g, self.g.add(self.edge, self._edge(other)))

    def __radd__(self, other: Any) -> Term:
        return Term(self.g, self.g.add(self._edge(other), self.edge))

    def __sub__(self, other: Any) -> Term:
        return Term(self.g, self.g.sub(self.edge, self._edge(other)))

    def __rsub__(self, other: Any) -> Term:
        return Term(self.g, self.g.sub(self._edge(other), self.edge))

    def __mul__(self, other: Any) -> Term:
        return Term(self.g, self.g.mul(self.edge, self._edge(other)))

    def __rmul__(self, other: Any) -> Term:
        return Term(self.g, self.g.mul(self._edge(other), self.edge))

    def __truediv__(self, other: Any) -> Term:
        return Term(self.g, self.g.div(self.edge, self._edge(other)))

    def __rtruediv__(self, other: Any) -> Term:
        return Term(self.g, self.g.div(self._edge(other), self.edge))

    def __neg__(self) -> Term:
        return Term(self.g, -self.edge)

    def _call(self, name: str, *others: Any) -> Term:
        return Term(self.g, self.g.call(name, self.edge, *map(self._edge, others)))

    def sqrt(self) -> Term:
        """The square root."""
        return self._call("sqrt")

    def sin(self) -> Term:
        """The sine."""
        return self._call("sin")

    def cos(self) -> Term:
        """The cosine."""
        return self._call("cos")

    def tan(self) -> Term:
        """The tangent."""
        return self._call("tan")

    def arctan2(self, other: Any) -> Term:
        """The angle with this sine and that cosine."""
        return self._call("atan2", other)

    def choose(self, at_least_zero: Any, below: Any) -> Term:
        """The first where this term is at least zero, or else the second, as a sum without branches."""
        step = self._call("step")
        rest: Term = 1.0 - step
        chosen: Term = step * at_least_zero + rest * below
        return chosen


def terms(g: Graph, edges: Iterable[Edge]) -> Terms:
    """Edges as a vector of terms."""
    wrapped = [Term(g, edge) for edge in edges]
    array = np.empty(len(wrapped), dtype=object)
    array[:] = wrapped
    return array


def edges_of(g: Graph, array: Terms) -> list[Edge]:
    """The edges of an array of terms, and of numbers among them, row by row."""
    return [entry.edge if isinstance(entry, Term) else g.constant(entry) for entry in np.ravel(array)]
