"""Linear systems M x = r by the factorisation M = L^T D L, which keeps the zeros between branches of a tree.

Eliminating from the tips to the base fills nothing in: L has an entry where M has one (Featherstone 2005, "Efficient
factorization of the joint-space inertia matrix for branched kinematic trees"; docs/theory/rigid.md, section 7.1).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.packs.combine import linear_combination
from symofros.expr.packs.pack import MIN_LANES, WIDTH, Pack, SignedPack

Matrix = list[list[Edge]]

# Rows of short matrices are cheaper by scalars, measured: from so many speeds on, packs of so many lanes pay.
_MANY, _LANES = 16, 4


class SingularMatrixError(ArithmeticError):
    """A matrix has no inverse, whatever its inputs are.

    Attributes:
        row: Index of a row that depends on those after it.
    """

    def __init__(self, row: int) -> None:
        super().__init__(f"row {row} depends on the rows after it")
        self.row = row


class Factors:
    """M = L^T D L.

    Args:
        g: The graph.
        M: Symmetric, with tree-shaped zeros; not changed.

    Raises:
        SingularMatrixError: A pivot is the number zero.
    """

    def __init__(self, g: Graph, M: Matrix) -> None:
        self._g = g
        self._n = len(M)
        min_lanes = _LANES if self._n >= _MANY else WIDTH
        rows = [_Row.of(g, M[i][: i + 1], min_lanes) for i in range(self._n)]
        self._inverse: list[Edge] = [ZERO] * self._n
        self._L: list[_Row] = []
        for k in reversed(range(self._n)):
            if rows[k][k] == ZERO:
                raise SingularMatrixError(k)
            self._inverse[k] = g.div(ONE, rows[k][k])
            self._L.insert(0, rows[k].times(self._inverse[k], k))
            for i in reversed(range(k)):
                rows[i] = rows[i].less(self._L[0][i], rows[k], i + 1)

    @property
    def entries(self) -> int:
        """Entries of L below its diagonal that are not zero."""
        return sum(self._L[k][i] != ZERO for k in range(self._n) for i in range(k))

    def solve(self, right: Sequence[Edge]) -> list[Edge]:
        """The solution x of M x = right (n)."""
        g, L = self._g, self._L
        residue = _Row.of(g, right, L[0].min_lanes) if L else _Row.of(g, right)
        x: list[Edge] = [ZERO] * self._n
        for k in reversed(range(self._n)):
            x[k] = g.mul(residue[k], self._inverse[k])
            residue = residue.less(residue[k], L[k], k)
        for k in range(self._n):
            for i in range(k):
                x[k] = g.sub(x[k], g.mul(L[k][i], x[i]))
        return x

    def solve_columns(self, right: Matrix) -> Matrix:
        """The solution X of M X = right (n rows), column by column."""
        count = len(right[0]) if right else 0
        rows = [_Row.of(self._g, row) for row in right]
        for k in reversed(range(self._n)):
            for i in range(k):
                rows[i] = rows[i].less(self._L[k][i], rows[k], count)
        for k in range(self._n):
            rows[k] = rows[k].times(self._inverse[k], count)
            for i in range(k):
                rows[k] = rows[k].less(self._L[k][i], rows[i], count)
        return [[row[j] for j in range(count)] for row in rows]


class _Row:
    """A row of edges in packs.

    Attributes:
        g: The graph.
        packs: Edges of the row, WIDTH at a time.
        min_lanes: Fewest wanted lanes for which a vector pays.
    """

    def __init__(self, g: Graph, packs: list[SignedPack], min_lanes: int = MIN_LANES) -> None:
        self.g = g
        self.packs = packs
        self.min_lanes = min_lanes

    @staticmethod
    def of(g: Graph, edges: Sequence[Edge], min_lanes: int = MIN_LANES) -> _Row:
        """The row of some edges."""
        padded = [*edges, *[ZERO] * (-len(edges) % WIDTH)]
        return _Row(g, [(ONE, Pack(tuple(padded[at : at + WIDTH]))) for at in range(0, len(padded), WIDTH)], min_lanes)

    def __getitem__(self, i: int) -> Edge:
        """Entry i."""
        sign, pack = self.packs[i // WIDTH]
        return self.g.mul(sign, pack.lanes[i % WIDTH])

    def times(self, factor: Edge, size: int) -> _Row:
        """The first entries times a factor."""
        return self._linear_combination([[(factor, pack)] for pack in self.packs], size)

    def less(self, factor: Edge, other: _Row, size: int) -> _Row:
        """The first entries less a factor times those of another row."""
        if factor == ZERO:
            return self
        pairs = zip(self.packs, other.packs, strict=False)  # A later row is longer.
        return self._linear_combination([[(ONE, pack), (-factor, other_pack)] for pack, other_pack in pairs], size)

    def _linear_combination(self, terms: list[list[tuple[Edge, SignedPack]]], size: int) -> _Row:
        packs = [linear_combination(self.g, terms[c], lanes, self.min_lanes) for c, lanes in _chunks(size)]
        return _Row(self.g, packs, self.min_lanes)


def _chunks(size: int) -> Iterator[tuple[int, range]]:
    """(pack, its lanes) of the first entries of a row."""
    for c in range(-(-size // WIDTH)):
        yield c, range(min(WIDTH, size - WIDTH * c))
